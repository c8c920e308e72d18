"""What must not crash, hang or be silently wrong: threads, forks, circles, the end of the interpreter, odd values."""

import gc
import os
import signal
import subprocess
import sys
import threading
import time
import weakref
from pathlib import Path

import numpy as np
import pytest

import vbond
from conftest import clamp, rod_keys


def endless() -> vbond.Run:
    keys = rod_keys()
    keys["stage"][0]["duration"] = "1e9 T0"
    keys["output"]["history"]["every"] = "1e8 T0"
    return vbond.Run(vbond.Case.from_dict(keys))


def in_a_process(program: str) -> subprocess.CompletedProcess:
    """With endless() at hand; one that hangs is an error."""
    head = f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r}); from test_safety import *\n"
    return subprocess.run([sys.executable, "-c", head + program], capture_output=True, text=True, timeout=60)


def test_nothing_of_a_run_at_work_can_be_looked_at():
    run = endless()
    worker = threading.Thread(target=lambda: run.step(3_000_000))
    worker.start()
    looks = ("time", "steps", "stage", "complete", "time_step", "notes")
    refused = set()
    while worker.is_alive():
        for name in looks:
            try:
                getattr(run, name)
            except ValueError as e:
                assert f"{name}: this run is at work in another thread" in str(e)
                refused.add(name)
        assert repr(run).startswith("<vbond.Run: rod")
        time.sleep(1e-3)
    assert refused == set(looks)


def test_a_daemon_thread_that_computes_as_python_ends_does_no_harm():
    done = in_a_process("threading.Thread(target=endless().run, daemon=True).start(); time.sleep(0.3)")
    assert done.returncode == 0, done.stderr


def test_a_run_with_threads_is_refused_in_a_child_process_and_ends_there():
    done = in_a_process("""
keys = rod_keys()
keys["specimen"][0]["particles"] = 20000
keys["output"]["history"]["every"] = "1e8 T0"
case = vbond.Case.from_dict(keys)
run, single = vbond.Run(case, threads=2), vbond.Run(case)
run.step(2), single.step(2)
if os.fork() == 0:
    try:
        run.step(1)
    except ValueError as e:
        print(e)
    del run  # waits for no thread of the parent
    gc.collect()
    print(single.step(1), flush=True)
    os._exit(0)
os.wait()
print(run.step(1))""")
    assert done.returncode == 0, done.stderr
    said = done.stdout.splitlines()
    assert "in the process that made it; make it here" in said[0] and said[1:] == ["1", "1"]


def test_a_run_is_made_once_however_many_threads_try():
    keys = rod_keys(20000)
    checked = vbond.Case.from_dict(keys)._checked
    bare = vbond._vbond.CheckedRun()
    made = []

    def make():
        try:
            bare._make(checked, 1, True)
            made.append(bare)
        except ValueError:
            pass

    threads = [threading.Thread(target=make) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(made) == 1


def test_callbacks_that_refer_to_their_run_are_freed_with_it(case):
    run = vbond.Run(case)
    run.on_step(1, lambda _, itself=run: None)
    freed = weakref.ref(run)
    run.step(3)
    del run
    gc.collect()
    assert freed() is None


def test_a_callback_that_is_added_by_another_is_called_from_the_next_step_on():
    run, seen = endless(), []

    def add(now):
        assert len(seen) < 10  # else it is called by the step that adds it, for ever
        seen.append(now.steps)
        now.on_step(1, add)

    run.on_step(1, add)
    run.step(3)
    assert seen == [1, 2, 2, 3, 3, 3, 3]


def test_ctrl_c_is_noticed_in_a_static_stage_after_fast_steps(keys):
    keys["specimen"][0]["particles"] = 400
    keys["stage"] = [{"name": "fly", "duration": "100 T0"},
                     {"kind": "path", "name": "far", "supports": [clamp],
                      "most_points": 100000, "largest_step": 0.01, "loads": [{"group": "last", "force": [-1e-7, 1e-9, 0]}],
                      "stop": {"load_factor": {"above": 1e6}}}]
    run = vbond.Run(vbond.Case.from_dict(keys))
    run.run_stage()
    threading.Timer(0.3, lambda: signal.raise_signal(signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        run.run_stage()
    assert run.stage == "far"


def test_nothing_can_be_added_after_the_end(run):
    run.run()
    with pytest.raises(ValueError, match="all its stages are behind it"):
        run.add_load("all", force=[1, 0, 0])


def test_an_array_with_masked_places_is_refused(run):
    with pytest.raises(TypeError, match="velocities: a masked array"):
        run.set_velocities(np.ma.masked_array(np.ones((10, 3)), mask=True))


def test_any_layout_of_an_array_is_read_as_it_is_meant(run):
    wanted = np.arange(30.0).reshape(10, 3)
    for given in (np.asfortranarray(wanted), np.repeat(wanted, 2, axis=0)[::2], wanted.astype(np.float16),
                  wanted.astype(">f8"), wanted.astype(np.uint8), wanted.tolist()):
        run.set_velocities(given)
        assert np.array_equal(run.state.velocities, wanted)


def itself() -> dict:
    keys: dict = {}
    keys["stage"] = [keys]
    return keys


odd_values = {
    "a character beyond 16 bits in a key": (lambda: {**rod_keys(), "\U0001f600": 1}, vbond.CaseError,
                                            "\U0001f600 = 1\n +no such key"),
    "half a character": (lambda: {"title": "\ud800"}, ValueError, "title: .*lone surrogate"),
    "half a character in a key": (lambda: {"\ud800": 1}, ValueError, "case: .*lone surrogate"),
    "more than 64 bits": (lambda: {"velocities": [{"seed": 2**63}]}, ValueError, r"velocities\[0\].seed: .*64 bits"),
    "a dict in itself": (itself, ValueError, "stands in itself"),
    "a key with a dot": (lambda: {**rod_keys(), "time.step": 1}, vbond.CaseError, "time.step = 1\n +no such key"),
}


@pytest.mark.parametrize("name", odd_values)
def test_odd_values_of_a_dict_are_told(name):
    keys, kind, words = odd_values[name]
    with pytest.raises(kind, match=words):
        vbond.Case.from_dict(keys())


def test_any_text_goes_through_a_dict(keys):
    keys["title"] = "a\0b\x7f\x85\"'\\ \n\t\U0001f600"
    assert vbond.Case.from_dict(keys).title == keys["title"]


def test_a_key_of_a_change_ends_at_no_equals_sign(case):
    with pytest.raises(ValueError, match="a key has no ="):
        case.changed({"title=other #": "name"})


def test_tables_that_are_still_empty_have_no_columns(tmp_path):
    (tmp_path / "resolved.toml").touch()
    (tmp_path / "breaks.csv").touch()
    assert vbond.open(tmp_path).breaks == {}

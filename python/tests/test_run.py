"""Runs in memory: steps, stages, callbacks, Ctrl-C, what they show."""

import signal
import threading
import time
import warnings

import numpy as np
import pytest

import vbond
from conftest import clamp, rod_keys
from test_cases import bits


def test_steps_one_by_one_in_blocks_and_as_a_whole_give_the_same_bits(case):
    whole, blocks, single = vbond.Run(case), vbond.Run(case), vbond.Run(case, threads=2)
    assert [result.stop for result in whole.run()] == ["duration"]
    while not blocks.complete:
        assert blocks.step(37) > 0
    while not single.complete:
        assert single.step() == 1
    assert whole.steps == blocks.steps == single.steps == 200
    assert bits(whole.history) == bits(blocks.history) == bits(single.history)
    assert whole.state.positions.tobytes() == blocks.state.positions.tobytes() == single.state.positions.tobytes()


def test_a_run_says_where_it_is(run):
    assert (run.stage, run.steps, run.complete, run.time) == ("fly", 0, False, 0)
    assert run.step(0) == 0 and run.step(50) == 50
    assert run.time == pytest.approx(50 * run.time_step)
    assert run.step(10**6) == 150
    assert run.complete and run.stage is None
    assert run.results[0].name == "fly" and run.results[0].steps == 200
    assert run.notes == [] and run.reports == []


def test_energies_are_conserved_and_are_those_of_the_history(run):
    run.step(100)
    energies = run.energies
    kinetic = 0.5 * (run.state.masses[:, None] * run.state.velocities**2).sum()
    assert energies["kinetic_translation"] == pytest.approx(kinetic, rel=1e-12)
    assert energies["U_L"] == pytest.approx(run.state.bonds["U_L"].sum(), rel=1e-9)
    run.run()
    total = run.history["total"]
    assert np.ptp(total) < 1e-2 * total[0]


def test_energies_before_between_and_after_stages_are_those_of_rows_there(keys):
    keys["specimen"].append({"kind": "list", "name": "balls", "positions": [[0, 3, 0.35], [0, 3.9, 0.4]],
                             "radius": 0.4, "mass": 1.0})
    keys["wall"] = [{"name": "floor", "shape": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}]
    keys["contact"] = {"law": "linear", "k": 1.0, "tangential": "linear", "k_t": 0.5, "friction": 0.5}
    keys["specimen"][0].update(name="rod", origin=[0, 0, 2])
    keys["bonds"][0]["between"] = ["rod", "rod"]
    keys["velocities"].append({"group": "balls", "velocity": [0.01, 0, 0], "angular_velocity": [0, 0.02, 0]})
    rise = {"walls": [{"wall": "floor", "velocity": [0, 0, 0.001]}]}
    keys["stage"] = [{"name": "a", "duration": "0.2 T0", **rise}, {"name": "b", "duration": "0.2 T0", **rise},
                     {"kind": "equilibrium", "name": "rest", "supports": [{**clamp, "group": "all"}]}]
    run = vbond.Run(vbond.Case.from_dict(keys))

    def is_of_row(energies, row):
        for name, energy in energies.items():
            if name in run.history:
                assert energy == pytest.approx(run.history[name][row], rel=1e-12, abs=1e-18), name

    before = run.energies
    run.run_stage()
    is_of_row(before, 0)
    is_of_row(run.energies, -1)
    assert run.energies["kinetic_rotation"] > 0 and run.energies["contact"] > 0
    contact = run.energies["contact"]
    run.set_velocities(2 * run.state.velocities)
    now = run.energies
    run.step(0)
    assert run.energies == pytest.approx(now, rel=1e-12) and now["contact"] == contact
    run.run_stage()
    is_of_row(run.energies, -1)
    run.run_stage()
    assert run.energies["kinetic_translation"] == run.energies["kinetic_rotation"] == 0


def test_a_callback_sees_each_step_it_asked_for_and_may_end_the_stage(run):
    seen = []

    def look(now):
        assert now is run
        seen.append((now.steps, now.state.step))
        return now.steps >= 60

    run.on_step(20, look)
    result = run.run_stage()
    assert seen == [(20, 20), (40, 40), (60, 60)]
    assert result.steps == 60 and run.complete


def test_callbacks_at_different_intervals(run):
    seen = []
    run.on_step(30, lambda now: seen.append(now.steps))
    run.on_step(50, lambda now: seen.append(-now.steps))
    assert run.step(70) == 70
    run.run()
    assert seen == [30, -50, 60, 90, -100, 120, 150, -150, 180]  # the stage's last step is its end


def test_callbacks_change_no_bit(case):
    plain, watched = vbond.Run(case), vbond.Run(case)
    watched.on_step(7, lambda now: now.state and None)
    plain.run(), watched.run()
    assert bits(plain.history) == bits(watched.history)


def test_what_a_callback_raises_comes_out_and_the_run_can_go_on(run):
    def fall(_):
        raise KeyError("mine")

    run.on_step(10, fall)
    with pytest.raises(KeyError, match="mine"):
        run.run()
    assert run.steps == 10
    with pytest.raises(KeyError):
        run.step(100)
    assert run.steps == 20


def test_ctrl_c_interrupts_a_run_that_can_go_on(keys):
    keys["stage"][0]["duration"] = "1e9 T0"
    keys["output"]["history"]["every"] = "1e8 T0"
    run = vbond.Run(vbond.Case.from_dict(keys))
    threading.Timer(0.3, lambda: signal.raise_signal(signal.SIGINT)).start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        run.run()
    assert time.monotonic() - start < 30
    made = run.steps
    assert made > 0 and run.step(100) == 100 and run.steps == made + 100


def test_other_threads_go_on_but_may_not_use_a_run_at_work(keys):
    keys["stage"][0]["duration"] = "1e9 T0"
    keys["output"]["history"]["every"] = "1e8 T0"
    run = vbond.Run(vbond.Case.from_dict(keys))
    worker = threading.Thread(target=lambda: run.step(3_000_000))
    worker.start()
    refused = 0
    while worker.is_alive():
        try:
            run.state
        except ValueError as e:
            assert "at work in another thread" in str(e)
            refused += 1
        time.sleep(1e-3)
    assert refused > 10 and run.steps == 3_000_000


def test_velocities_and_loads_are_set(run):
    n = len(run.state)
    run.set_velocities(np.zeros((n, 3)), np.zeros((n, 3)))
    assert not run.state.velocities.any() and not run.state.angular_velocities.any()
    run.add_load("last", force=[1e-3, 0, 0])
    run.step(0)
    forces, moments = run.loads
    assert forces[-1] == pytest.approx([1e-3, 0, 0], abs=1e-15) and forces.shape == moments.shape == (n, 3)
    run.step(20)
    assert (run.state.masses[:, None] * run.state.velocities).sum(axis=0)[0] == pytest.approx(1e-3 * run.time, rel=1e-12)
    assert run.energies["work_loads"] != 0
    run.add_load([0, 1], force=(0, 0, 1e-3), moment=(1e-4, 0, 0))
    assert run.loads[0][0][2] - forces[0][2] == pytest.approx(1e-3, abs=1e-4)


def test_what_supports_hold_keeps_its_velocities(keys):
    pulled = {"group": "last", "fix": ["x", [0, 1, 1]], "velocity": [1e-3, 0, 0]}
    turned = {"group": "middle", "rigid": True, "velocity": [0, 2e-3, 0], "angular_velocity": [0, 0, 1e-3]}
    keys["groups"] = {"middle": {"indices": [4]}}
    keys["stage"][0]["supports"] = [clamp, pulled, turned]
    run = vbond.Run(vbond.Case.from_dict(keys))
    run.step(10)
    v, work = run.state.velocities.copy(), run.energies["work_supports"]
    new = np.tile([0.01, 0.02, 0.04], (10, 1))
    run.set_velocities(new, new)
    now, omega = run.state.velocities, run.state.angular_velocities
    assert np.array_equal(now[1:4], new[1:4]) and np.array_equal(omega[9], new[9])
    assert not now[0].any() and not omega[0].any()
    assert now[9] == pytest.approx([v[9, 0], -0.01 + 0.5 * (v[9, 1] + v[9, 2]), 0.01 + 0.5 * (v[9, 1] + v[9, 2])], abs=1e-15)
    assert now[4] == pytest.approx([0, 2e-3, 0], abs=1e-15) and omega[4] == pytest.approx([0, 0, 1e-3], abs=1e-15)
    run.step(0)
    assert run.energies["work_supports"] == work
    run.step(1)
    assert abs(run.energies["work_supports"] - work) < 1e-5  # an impulse that makes velocities right takes 1e-3


def test_a_stage_is_ended_by_hand(case):
    run = vbond.Run(case.with_stages([{"name": "a", "duration": "9 T0"}, {"name": "b", "duration": "1 T0"}]))
    run.step(10)
    run.end_stage()
    assert run.stage == "b" and run.results[0].steps == 10
    assert [result.name for result in run.run()] == ["a", "b"]


def test_a_run_that_diverges_is_told_and_does_not_go_on():
    keys = rod_keys()
    keys["time"] = {"step": "0.5 T0", "insist": True}
    keys["stage"][0]["duration"] = "400 T0"
    run = vbond.Run(vbond.Case.from_dict(keys))
    with pytest.raises(vbond.Diverged) as told:
        run.run()
    assert told.value.step > 0 and "step" in str(told.value)
    assert len(run.state) == 10 and run.results[-1].stop == "diverged"
    for again in (run.step, run.run, run.run_stage):
        with pytest.raises(ValueError, match="failed and cannot go on"):
            again()


def test_peaks_and_static_stages_have_results(keys):
    keys["stage"] = [{"kind": "equilibrium", "name": "push", "supports": [clamp],
                      "loads": [{"group": "last", "force": [0, 1e-5, 0]}]},
                     {"name": "swing", "duration": "1 T0", "supports": [clamp]}]
    run = vbond.Run(vbond.Case.from_dict(keys))
    push, swing = run.run()
    assert push.statics.ended == push.stop == "converged" and push.statics.load_factor == 1
    assert swing.statics is None and swing.stop == "duration" and swing.critical_force is None
    assert run.history["load_factor"][1] == 1 and np.isnan(run.history["load_factor"][-1])


def test_a_run_that_goes_unphysical_is_stopped_as_by_the_program(tmp_path):
    keys = rod_keys()
    keys["velocities"] = [{"kind": "gaussian", "magnitude": 0.2, "seed": 3}]
    keys["time"] = {"fraction": 1.0}
    case = vbond.Case.from_dict(keys)
    with pytest.raises(vbond.Diverged, match="balance is off") as stopped:
        vbond.Run(case).run()
    with pytest.raises(vbond.ProgramError) as of_program:
        vbond.run(case, tmp_path / "out")
    assert stopped.value.step > 0
    assert str(stopped.value).split("\n")[0] in str(of_program.value)


def test_a_bond_bent_too_far_is_a_warning(case):
    run = vbond.Run(case)
    spin = np.zeros((10, 3))
    spin[4, 2] = 3.0
    run.set_velocities(np.zeros((10, 3)), spin)
    with pytest.warns(vbond.RunWarning, match="bond 3 .* has snapped"):
        run.run()
    assert any("snapped" in report for report in run.reports)


def test_a_warning_made_an_error_leaves_a_run_that_can_go_on(case):
    run = vbond.Run(case)
    spin = np.zeros((10, 3))
    spin[4, 2] = 3.0
    run.set_velocities(np.zeros((10, 3)), spin)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(vbond.RunWarning):
            run.step(100)
    run.run()
    assert run.complete

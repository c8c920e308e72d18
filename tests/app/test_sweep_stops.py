"""Points whose output could not be written, or whose run was killed, have not ended: they are named, stand in no journal,
and the same command goes on with them to what an undisturbed sweep has."""
import os
import resource
import signal
import subprocess
from pathlib import Path

import pytest
from program import EXAMPLES, Started, disk, lines, same_bytes, table, vbond

SWEEP = ["sweep", EXAMPLES / "two_particles.toml", "--jobs", 2]
SETS = ["bonds[0].nu=range(0.1, 0.4, 4)", "stage[0].duration=2000 T0", "output.history.every=1 T0", "output.frames.every=1e4 T0",
        "output.checkpoint.every=100 T0"]
GOES_ON = "points have ended; the same command goes on"


@pytest.fixture(scope="module", autouse=True)
def whole(work):
    sweep("whole")


def sweep(folder, status=0, **options):
    return vbond(*SWEEP, "-o", folder, sets=SETS, status=status, **options)


def rows(folder):
    return [{name: value for name, value in row.items() if name != "seconds"} for row in table(f"{folder}/sweep.csv")]


def goes_on(folder):
    """To the same results."""
    sweep(folder, out="4 points, 0 failed")
    assert rows(folder) == rows("whole")
    assert lines(f"{folder}/sweep.journal") == 4
    for k in range(1, 5):
        assert same_bytes(f"whole/000{k}/history.csv", f"{folder}/000{k}/history.csv"), f"another history of point {k}"


def stopped(folder, why, **options):
    """Nothing is written down as ended, no more points were begun than run at once, which are named."""
    sweep(folder, status=3, err=["point 1 has not ended: ", "point 2 has not ended: ", why, f"0 of 4 {GOES_ON}"], **options)
    journal = Path(folder, "sweep.journal")
    assert not journal.exists() or not journal.read_text()
    assert not Path(folder, "0003").exists(), "a third point was begun"


def test_a_limit_for_each_file():  # the history of a whole run has more than twice that
    stopped("limited", "File too large", limits={resource.RLIMIT_FSIZE: Path("whole/0001/history.csv").stat().st_size // 2048 * 1024})
    goes_on("limited")


def test_a_full_disk():
    with disk("300k") as resize:
        stopped("disk/out", "has not ended")
        sweep("disk/out", status=3)  # tried too early
        resize("256m")
        goes_on("disk/out")


def test_a_run_that_is_killed():  # the other points go on
    with Started(*SWEEP, "-o", "killed", sets=SETS) as run:
        run.until(lambda: children(run.pid) and list(Path("killed").rglob("checkpoint.h5")))
        os.kill(children(run.pid)[0], signal.SIGKILL)
        run.ended().expect(137, err=[" has not ended: ended by signal 9", f"3 of 4 {GOES_ON}"])
    assert lines("killed/sweep.journal") == 3 and "failed" not in Path("killed/sweep.journal").read_text()
    goes_on("killed")


def test_one_that_was_killed_before_it_had_written_what_it_is():
    Path("early").mkdir()
    Path("early/sweep.toml.part").write_text("# vbond sw")
    goes_on("early")
    Path("others").mkdir()
    Path("others/notes.part").write_text("mine")
    sweep("others", status=2, err="is not empty, and holds no sweep")


def children(pid):
    return [int(child) for child in subprocess.run(["pgrep", "-P", str(pid)], capture_output=True, text=True).stdout.split()]

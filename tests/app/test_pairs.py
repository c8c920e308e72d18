"""Pairs of processes that want the same output folder at the same time. One wins, the other says who has it and ends with
status 3, and the results are those of an undisturbed run, byte for byte."""
import os
import shutil
from pathlib import Path

import pytest
from program import HERE, Started, expect_same, vbond

NEW, FORCED, RESUMED = "run case.toml -o out", "run case.toml -o out --force", "resume out"


@pytest.fixture(scope="module", autouse=True)
def whole(work):
    shutil.copy(HERE / "resume.toml", "case.toml")
    vbond("run case.toml -o whole")
    with Started("run case.toml -o half") as run:
        run.until(Path("half/checkpoint.h5").exists).stop()


@pytest.mark.parametrize("attempt", range(2))
@pytest.mark.parametrize("before, commands", [
    (None, [NEW, NEW]), ("whole", [FORCED, FORCED]), ("half", [RESUMED, RESUMED]), ("half", [FORCED, RESUMED])])
def test_one_of_two_wins(before, commands, attempt):
    for _ in range(20):
        shutil.rmtree("out", ignore_errors=True)
        if before:
            shutil.copytree(before, "out")
        with Started(commands[0]) as one, Started(commands[1]) as two:
            (first, winner), (loser, _) = sorted([(one.ended(), one.pid), (two.ended(), two.pid)], key=lambda run: run[0].status)
        # one after the other, on a machine with much to do, is no pair
        if loser.status != 0 and "already exists" not in first.err + loser.err:
            break
    assert (first.status, loser.status) == (0, 3), f"{first}\n{loser}"
    loser.expect(3, err=[f"out: is in use by process {winner} on {os.uname().nodename} since 20", "which holds run.lock"])
    assert not loser.out, f"the loser printed: {loser}"
    expect_same("whole", "out")

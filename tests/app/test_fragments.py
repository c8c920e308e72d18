"""A block with damped bonds that breaks into many fragments, which rub on each other and on walls, leaves the same files,
byte for byte, with every instruction set and number of threads, and stopped and resumed in the midst of breaking with
others of both."""
import signal
from shutil import rmtree

import pytest
from program import HERE, column, expect_same, instruction_sets, lines, number, stop_at, vbond

CASE = HERE / "fragments.toml"


@pytest.fixture(scope="module")
def whole(work):
    vbond("run", CASE, *"-o whole --threads 1".split(), env={"VBOND_SIMD": "baseline"})
    assert column("whole", "fragments")[-1] >= 20
    assert column("whole", "dissipated")[-1] != 0
    return "whole"


# each set, and each number of threads
@pytest.mark.parametrize("simd, threads", zip(3 * instruction_sets(), [3, 2, 1]))
def test_same_with(whole, simd, threads):
    vbond("run", CASE, "-o", "other", "--threads", threads, env={"VBOND_SIMD": simd})
    assert number("other", "threads_used") == threads
    expect_same(whole, "other")
    rmtree("other")


@pytest.mark.parametrize("by", [signal.SIGTERM, signal.SIGKILL])
def test_stopped_in_the_midst_of_breaking(whole, by):
    # once two thirds of all breaks are written, while more go on
    breaks, folder = lines("whole/breaks.csv"), by.name
    stop_at(breaks * 2 // 3, folder, "run", CASE, "-o", folder, "--threads", 3, by=by, table="breaks.csv",
            env={"VBOND_SIMD": instruction_sets()[-1]})
    assert lines(f"{folder}/breaks.csv") < breaks, "nothing was left to break"
    vbond("resume", folder, "--threads", 2, env={"VBOND_SIMD": "baseline"})
    expect_same(whole, folder)

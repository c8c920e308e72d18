"""A heated rod, killed on its way and resumed, leaves the same history; what is left of the heat is what yielded."""
from pathlib import Path
from signal import SIGKILL

from program import HERE, Started, column, lines, same_bytes, vbond


def test_a_heated_rod_goes_on():
    case = HERE / "heat.toml"
    vbond("run", case, "-o", "whole")
    left = column("whole", "axial_force.all")[-1]
    assert 0.00499 < left < 0.00501, "the force that is left is not 0.005"
    with Started("run", case, "-o", "killed") as run:
        run.until(lambda: Path("killed/checkpoint.h5").exists() and lines("killed/history.csv") > 100).stop(SIGKILL)
    vbond("resume killed")
    assert same_bytes("whole/history.csv", "killed/history.csv"), "resumed, it has another history"

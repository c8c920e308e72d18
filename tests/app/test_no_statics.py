"""A program built with -DVBOND_STATICS=OFF: dynamics as ever, statics refused by name, and nothing of it linked."""
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from program import EXAMPLES, PROGRAM, edited, refused, vbond, write


def test_dynamics_as_ever():
    vbond("run", EXAMPLES / "two_particles.toml", "-o", "swing", out="results in swing")
    assert all(Path("swing", name).stat().st_size for name in ("run.json", "history.csv"))


@pytest.mark.parametrize("name, changes, told", [
    ("rod_buckling", [], 'stage "critical" is static'), ("two_particles", [("^step = .*", 'step = "exact"')], 'time.step = "exact"')])
def test_statics_are_refused(name, changes, told):  # at the place, and how to get them
    refused(write("static.toml", edited((EXAMPLES / f"{name}.toml").read_text(), *changes)), "static.toml:", told,
            "this vbond was built without statics", "build it with -DVBOND_STATICS=ON")
    vbond("run static.toml", status=2)
    assert not list(Path().rglob("*.out"))


@pytest.mark.skipif(not shutil.which("ldd"), reason="no ldd")
def test_no_library_of_statics_is_linked():
    linked = subprocess.run(["ldd", PROGRAM], capture_output=True, text=True).stdout
    assert not re.search("cholmod|blas|suitesparse|amd|metis", linked)


def test_laboratory_tests_at_rest_are_refused():
    vbond("test", "tension", EXAMPLES / "packed_cylinder.toml", "-o", "pulled", status=2, err=["this vbond was built without statics"])
    assert not Path("pulled").exists()


def test_strengths_at_rest_are_refused():
    vbond("calibrate", EXAMPLES / "packed_cylinder.toml", "--tensile", "1 MPa", "-o", "strong", status=2,
          err=["this vbond was built without statics", "--motion"])
    assert not Path("strong").exists()


def test_fits_are_refused():
    write("data.csv", "time,total\n0,1\n")
    vbond("fit", EXAMPLES / "two_particles.toml", "data.csv", "--vary", "bonds[0].E", "--x", "time", "--compare", "total", status=2,
          err=["two_particles.toml", "this vbond was built without statics", "Ceres"])

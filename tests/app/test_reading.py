"""What a reading error does: it is told with the name of the file and the system's reason, status 3, and nothing is
written. The end of what could be read is never taken as the end of the file."""
import os
from pathlib import Path

import pytest
from program import PROGRAM, ROOT, call, vbond, write

FAILING_READ = os.environ.get("VBOND_FAILING_READ", ROOT / "build/release/tests/app/libfailing_read.so")
ERROR = "cannot be read: Input/output error"
STIFFNESS = "stiffness = { c_A = 1, c_D = 0.3, c_B = 0.04, c_T = 0.03 }"
POINTS = f"""[[specimen]]
kind = "csv"
file = "points.csv"
mass = 1
radius = 0.4
[[bonds]]
file = "pairs.csv"
{STIFFNESS}
[contact]
law = "linear"
k = 1
[[wall]]
name = "plate"
shape = "mesh"
file = "plate.stl"
[[stage]]
name = "first"
duration = 1.0
[[stage]]
name = "second"
duration = 1.0
"""


@pytest.fixture(scope="module", autouse=True)
def files(work):
    write("points.csv", "x,y,z\n" + "".join(f"{k},0,0\n" for k in range(10)))
    write("pairs.csv", "i,j\n" + "".join(f"{k},{k + 1}\n" for k in range(9)))
    write("atoms.data", """two atoms

2 atoms
1 bonds
0 9 xlo xhi
0 9 ylo yhi
0 9 zlo zhi

Masses

1 1

Atoms # bond

1 1 1 0 0 0
2 1 1 1 0 0

Bonds

1 1 1 2
""")
    write("plate.stl", "solid plate\nfacet normal 0 0 1\nouter loop\nvertex 0 0 -2\nvertex 9 0 -2\nvertex 0 9 -2\n"
                       "endloop\nendfacet\nendsolid plate\n")
    write("points.toml", POINTS)
    write("atoms.toml", f"""specimen = [{{kind = "lammps", file = "atoms.data", radius = 0.4}}]
bonds = [{{from_specimen = true, {STIFFNESS}}}]
stage = [{{duration = 1.0}}]
""")
    write("rows.toml", POINTS, ("^mass = 1$", 'mass = 1\nbonds_file = "pairs.csv"'), ('^file = "pairs.csv"', "from_specimen = true"))
    for case in ("points", "atoms", "rows"):
        vbond(f"check {case}.toml")


def test_files_of_which_nothing_can_be_read():
    os.symlink("/proc/self/mem", "memory.csv")
    vbond("run", write("memory.toml", POINTS, ("points.csv", "memory.csv")), status=3, err=f"memory.csv: {ERROR}")
    assert not Path("memory.out").exists()
    os.symlink("/proc/self/mem", "memory.stl")
    vbond("check", write("mesh.toml", POINTS, ("plate.stl", "memory.stl")), status=3, err=f"memory.stl: {ERROR}")
    vbond("check /proc/self/mem", status=3, err=f"/proc/self/mem: {ERROR}")
    vbond("check .", status=3, err="cannot be read: Is a directory")
    os.mkdir("folder.csv")
    vbond("check", write("folder.toml", POINTS, ("points.csv", "folder.csv")), status=2, err="cannot be read: it is a folder")


BEFORE_SECOND = POINTS.index('name = "second"') - 10


@pytest.mark.skipif(call([PROGRAM, "--version"], env={"LD_PRELOAD": str(FAILING_READ)}).status != 0,
                    reason="the program takes no preloaded library (sanitizers)")
@pytest.mark.parametrize("file, after, command", [
    ("points.csv", 27, "run points.toml"), ("pairs.csv", 20, "check points.toml"), ("pairs.csv", 20, "check rows.toml"),
    ("atoms.data", 100, "check atoms.toml"), ("plate.stl", 60, "check points.toml"),
    ("points.toml", BEFORE_SECOND, "check points.toml"), ("points.toml", BEFORE_SECOND, "check -")])
def test_reading_that_fails_in_the_middle(file, after, command):
    env = {"LD_PRELOAD": str(FAILING_READ), "VBOND_FAILING_FILE": str(Path(file).resolve()), "VBOND_FAILING_AT": str(after)}
    with open("points.toml") as case:
        vbond(command, stdin=case, env=env, status=3, err=f"{'the standard input' if command == 'check -' else file}: {ERROR}")
    assert not Path("points.out").exists(), "a run that read half of its points leaves a folder"

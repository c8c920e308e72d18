"""An output folder holds copies of all files that its case reads: it may be moved to where the inputs are not, and tells of
the run as it was after they were edited."""
import os
import re
import shutil
from pathlib import Path

import pytest
from program import Started, contents, edit, expect_same, lines, same_bytes, stop_at, values, vbond, write

STIFFNESS = "stiffness = { c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002 }"
RUN = "run in/cases/case.toml --threads 1 -o"
COPIES = {"points/body.csv": "body.csv", "more/body.csv": "body_2.csv", "more/Body.CSV": "Body_3.CSV", "points/rod.data": "rod.data"}


def write_inputs():
    """A case that reads files: under one name in two folders, by an absolute path, through "..", twice. Always the same."""
    for folder in ("points", "more", "cases"):
        os.makedirs(f"in/{folder}", exist_ok=True)
    write("in/points/body.csv", "x,y,z\n0,0,0\n1,0,0\n2,0,0\n")
    write("in/more/body.csv", "x,y,z\n0,3,0\n1,3,0\n")
    write("in/more/Body.CSV", "x,y,z\n0,6,0\n1,6,0\n")
    write('in/more/pairs of = "it".csv', "i,j\n0,1\n1,2\n")
    write("in/points/rod.data", "rod\n\n2 atoms\n1 bonds\n\nAtoms # bond\n\n1 1 1 0 9 0\n2 1 1 1 9 0\n\nBonds\n\n1 1 1 2\n")
    write("in/more/none.csv", "i,j\n")
    write("in/more/later.csv", "i,j\n3,4\n")
    if not Path("in/more/link.csv").is_symlink():
        os.symlink("none.csv", "in/more/link.csv")
    body = "mass = 1.0\ninertia = 0.1\nradius = 0.3\n"
    case = ["[time]\nstep = 0.01\n[output]\nhistory = { every = 1 }\nframes = { every = 500 }\ncheckpoint = { every = 100 }\n"]
    case += [f'[[specimen]]\nname = "s{k}"\nkind = "csv"\nfile = "{file}"\n{body}'
             for k, file in enumerate(("../points/body.csv", Path("in/more/body.csv").resolve(), "../more/Body.CSV"))]
    case += [f'[[specimen]]\nname = "rod"\nkind = "lammps"\nfile = "../points/rod.data"\n{body}']
    case += [f"[[bonds]]\nfile = '{file}'\n{STIFFNESS}\n" + ('when = "stage"\nstages = ["later"]\n' if "later" in file else "")
             for file in ('../more/pairs of = "it".csv', "../more/none.csv", "../more/../more/link.csv", "../more/later.csv")]
    write("in/cases/case.toml", "".join(case) + f"""[[bonds]]
from_specimen = true
{STIFFNESS}
[[velocities]]
kind = "ball"
magnitude = 0.001
[[stage]]
name = "swing"
duration = 1500.0
[[stage]]
name = "later"
duration = 500.0
""")


@pytest.fixture(autouse=True)
def inputs(work):
    write_inputs()


@pytest.fixture(scope="module")
def whole(work):
    write_inputs()
    vbond(RUN, "whole")
    return "whole"


def test_copies_of_all_files(whole, work):
    assert re.findall("^file = (.*)", Path("whole/resolved.toml").read_text(), re.M) == [
        '"inputs/body.csv"', '"inputs/body_2.csv"', '"inputs/Body_3.CSV"', '"inputs/rod.data"', r'"inputs/pairs of = \"it\".csv"',
        '"inputs/none.csv"', '"inputs/none.csv"', '"inputs/later.csv"']
    for file, copy in COPIES.items():
        assert same_bytes(f"in/{file}", f"whole/inputs/{copy}")
    found = list(Path("whole/inputs").rglob("*"))
    assert len(found) == 7 and all(path.is_file() and not path.is_symlink() for path in found)
    named = [name for name, text in contents("whole").items() if str(work).encode() in text]
    assert not named, "the folder names a place outside"


def test_inputs_are_edited_while_the_run_reads_them(whole):  # bonds of a later stage are those of the copies
    with Started(RUN, "edited") as run:
        run.until(lambda: lines("edited/history.csv") >= 100)
        write("in/more/later.csv", "i,j\n0,4\n")
        run.ended().expect()
    expect_same(whole, "edited")


def test_a_folder_is_moved_elsewhere(whole, monkeypatch):  # without the inputs
    stop_at(500, "stopped", RUN, "stopped")
    assert "interrupted" in values("stopped", "stop")
    shutil.copytree("whole", "far/away/whole")
    shutil.move("stopped", "far/away/stopped")
    shutil.move("in", "gone")
    with monkeypatch.context() as there:
        there.chdir("far")
        for command in ("report away/whole", "plot away/whole total", "resume away/stopped --threads 1", "report away/stopped",
                        "check away/whole/resolved.toml"):
            vbond(command)
    expect_same(whole, "far/away/stopped", "report.html")
    assert "The case reads inputs/Body_3.CSV" in Path("far/away/whole/report.html").read_text(), "the page does not name the copies"


def test_inputs_are_edited_afterwards(whole):
    vbond("report whole")
    before = Path("whole/report.html").read_text()
    write("in/points/body.csv", "x,y,z\n0,0,0\n7,0,0\n8,0,0\n")
    write("in/more/body.csv", "x,y,z\n")
    edit("in/cases/case.toml", ("^duration = .*", "duration = 1.0"))
    vbond("report whole")
    assert Path("whole/report.html").read_text() == before, "the page tells of the edited inputs"


def test_a_folder_is_used_again(whole):
    shutil.copytree("whole", "used")
    edit("in/cases/case.toml", ("^duration = .*", "duration = 10.0"))
    write("in/points/body.csv", "x,y,z\n0,0,0\n1,0,0\n2,0,0.125\n")
    write("used/inputs/notes.txt", "mine\n")
    vbond(RUN, "used", "--force")
    assert same_bytes("in/points/body.csv", "used/inputs/body.csv"), "--force keeps the old copy"
    assert len(contents("used/inputs")) == 8 and Path("used/inputs/notes.txt").read_text() == "mine\n"
    # its own copies as inputs: they are still there when they are read
    shutil.copytree("used", "twice")
    vbond("run twice/resolved.toml -o twice --force")
    expect_same("used", "twice")
    # a name that another file has in that place, which the user put there
    shutil.rmtree("twice")
    os.makedirs("twice/inputs")
    vbond(RUN, "twice", status=2)
    write("twice/inputs/body.csv", "theirs\n")
    vbond(RUN, "twice", "--force")
    assert Path("twice/inputs/body.csv").read_text() == "theirs\n", "a file of the user was replaced"
    assert 'file = "inputs/body_2.csv"\n' in Path("twice/resolved.toml").read_text(), "no other name"
    # copies that the next case does not read are gone; the folder goes with the last of them
    vbond("run", write("plain.toml", PLAIN), "-o", "twice", "--force")
    assert os.listdir("twice/inputs") == ["body.csv"], "copies of an earlier run are left"
    Path("used/inputs/notes.txt").unlink()
    vbond("run plain.toml -o used --force")
    assert not Path("used/inputs").exists(), "an empty folder is left"


PLAIN = """time = {step = 0.01}
output = {history = {every = 1}, frames = {every = 500}, checkpoint = {every = 100}}
specimen = [{kind = "rod", particles = 2, mass = 1.0, radius = 0.3}]
stage = [{duration = 1.0}]
"""


def test_what_cannot_be_copied():
    os.mkfifo("in/more/pipe.csv")
    write("piped.toml", PLAIN, ('kind = "rod".*', 'kind = "rod", particles = 2, mass = 1.0, radius = 0.3},\n'
                                '  {name = "p", kind = "csv", file = "in/more/pipe.csv", mass = 1.0}]'))
    vbond("check piped.toml", status=2, timeout=10, err=["piped.toml:", 'in/more/pipe.csv" cannot be read: it is not a regular file'])

"""What happens around a run: its folder is in use, its streams are closed or lose their reader, its files are touched, its
case is edited before it goes on, its body is too large for the memory."""
import csv
import fcntl
import os
import re
import resource
import shutil
import signal
import subprocess
from pathlib import Path

import pytest
from program import (EXAMPLES, HERE, PROGRAM, Started, call, column, contents, edit, expect_same, frames, lines, stop_at,
                     values, vbond, write)


@pytest.fixture(scope="module", autouse=True)
def whole(work):
    shutil.copy(EXAMPLES / "two_particles.toml", "good.toml")
    shutil.copy(HERE / "resume.toml", "long.toml")
    vbond("run good.toml -o whole")
    vbond("run long.toml -o whole_long")


def test_a_folder_in_use():
    shutil.copytree("whole", "busy")
    before = contents("busy")

    def while_held(lock, *commands):
        with open(f"busy/{lock}", "w") as held:
            fcntl.flock(held, fcntl.LOCK_EX)
            for command in commands:
                vbond(command, status=3, err=[f"which holds {lock}", "busy: is in use by another process", "wait until it has ended"])
        assert contents("busy", "*.lock") == before, "the folder of another was touched"

    while_held("run.lock", "resume busy", "run good.toml -o busy --force", "run good.toml -o busy")
    while_held("report.lock", "run good.toml -o busy --force")
    # What a killed run leaves of its lock keeps nobody out, and is gone in the end.
    write("busy/run.lock", "process 1 on nowhere since 2001-01-01 00:00:00 UTC\n")
    vbond("resume busy")
    assert not Path("busy/run.lock").exists()
    os.mkdir("new")
    Path("new/run.lock").touch()
    vbond("run good.toml -o new")
    expect_same("whole", "new")


# ---- standard streams -----------------------------------------------------------------------------------------------
def test_closed_streams():
    call(["bash", "-c", '"$0" run good.toml -o closed <&- >&- 2>&-', PROGRAM]).expect()
    expect_same("whole", "closed")


def test_a_pipe_without_a_reader():
    with subprocess.Popen([PROGRAM, *"run long.toml -o broken".split()], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
        run.stdout.readline()
        run.stdout.close()
        said = run.stderr.read()
    assert run.returncode in (141, -signal.SIGPIPE) and f"go on with: {PROGRAM} resume broken" in said, f"{run.returncode}: {said}"
    assert "interrupted" in values("broken", "stop")
    vbond("resume broken")
    expect_same("whole_long", "broken")


def test_the_command_that_goes_on_can_be_handed_to_a_shell_as_it_is_printed():
    os.symlink(PROGRAM, "the program")
    odd = """it's $HOME "a" b"""
    run = stop_at(100, odd, "run long.toml -o", odd, program="./the program")
    call(["bash", "-c", re.search("go on with: (.*)", run.err).group(1)]).expect()
    expect_same("whole_long", odd)


# ---- files that others touch, in the middle of a run, which notices and ends ----------------------------------------
@pytest.mark.parametrize("what, file", [("removed", "history.csv"), ("replaced", "history.csv"), ("changed by others", "dump.lammpstrj"),
                                        ("removed", "dump.lammpstrj")])
def test_touched(what, file):
    shutil.rmtree("touched", ignore_errors=True)
    path = Path("touched", file)
    with Started("run long.toml -o touched") as run:
        run.until(lambda: lines("touched/history.csv") >= 900)
        if what == "removed":
            path.unlink()
        elif what == "replaced":
            write("other", path.read_text().splitlines(keepends=True)[0])
            os.replace("other", path)
        else:
            with path.open("a") as dump:
                dump.write("\n")
        run.ended().expect(3, err=[f"touched/{file}: was {what} while the run wrote it",
                                   f"go on from the last checkpoint with: {PROGRAM} resume touched"])
    if (what, file) == ("removed", "history.csv"):
        vbond("resume touched", err="history.csv is not there any more: a new one begins here")
        new, old = (Path(folder, file).read_text().splitlines()[-500:] for folder in ("touched", "whole_long"))
        assert new == old, "the new history is another one"


# ---- going on with an edited case -----------------------------------------------------------------------------------
def first_columns(folder, count):
    with open(f"{folder}/history.csv") as history:
        return [row[:count] for row in csv.reader(history)]


def test_an_edited_case():
    # More columns and frames that were not asked for before; then without what was asked for.
    with Started("run long.toml -o edited") as run:
        run.until(lambda: lines("edited/history.csv") >= 900)
        descriptors = Path(f"/proc/{run.pid}/fd")
        if os.access(f"/proc/{run.pid}/fdinfo", os.R_OK):  # the lock is the run's alone: no child would keep it
            lock = next(link.name for link in descriptors.iterdir() if linked(link).endswith("/run.lock"))
            flags = re.search("^flags:\\s*([0-7]+)$", Path(f"/proc/{run.pid}/fdinfo/{lock}").read_text(), re.M).group(1)
            assert int(flags, 8) & os.O_CLOEXEC, "a child would inherit the lock"
            # and who it is can be read
            assert re.fullmatch(f"process {run.pid} on {os.uname().nodename} since 20[0-9-]+ [0-9:]+ UTC\n", Path("edited/run.lock").read_text())
        run.stop(signal.SIGKILL)
    shutil.copytree("edited", "without")
    edit("edited/resolved.toml", (r"displacements = \[8, 20\]", "displacements = [8, 20, 3]"))
    vbond("resume edited")
    assert first_columns("edited", 31) == first_columns("whole_long", 31), "an added column changes the others"
    assert first_columns("edited", None)[0][-3:] == [f"displacement.3.{axis}" for axis in "xyz"]
    added = column("edited", "displacement.3.x")
    assert added[1] is None, "a row from before knows the new column"
    assert isinstance(added[-1], float), "the new column stays empty"
    edit("without/resolved.toml", (r"displacements = \[8, 20\]", "displacements = []"), ("^(lammps_dump|frames) = .*\n", ""))
    vbond("resume without")
    assert first_columns("without", 25) == first_columns("whole_long", 25), "a column left out changes the others"
    assert column("without", "displacement.8.x")[-1] is None, "a column that is not wanted goes on"
    for pvd in Path("without").glob("*.pvd"):
        assert all(Path("without", frame).exists() for _, frame in frames(pvd)), f"{pvd} names a frame that is not there"


def linked(link):
    try:
        return os.readlink(link)
    except OSError:  # other files come and go
        return ""


# ---- memory ---------------------------------------------------------------------------------------------------------
COEFFICIENTS = "coefficients = {B1 = 1.0, B2 = -0.005, B3 = 0.015, B4 = 0.002}"
FEW = {resource.RLIMIT_AS: 1000000 * 1024}


def body(name, kind, distance):
    return write(f"{name}.toml", f"""specimen = [{{{kind}, radius = 0.4, mass = 1.0}}]
bonds = [{{distance = {distance}, {COEFFICIENTS}}}]
stage = [{{duration = "1 T0"}}]
""")


@pytest.mark.skipif(call([PROGRAM, "--version"], limits=FEW).status != 0,
                    reason="the program does not start with little memory, as under a sanitizer")
def test_bodies_that_are_too_large_for_the_memory():
    refused = ["check", "run -o refused"]
    huge, joined = body("huge", 'kind = "block", cells = [400, 400, 400]', 1.1), body("joined", 'kind = "block", cells = [40, 40, 40]', 1000.0)
    # The estimate fits, but it is not all that it takes to make the bonds.
    rod = body("rod", 'kind = "rod", particles = 1000000', 1.1)
    mebibytes = float(re.search("^memory +([0-9.]*) MiB", vbond("check", rod).out, re.M).group(1))
    for command in refused:
        vbond(command, huge, limits=FEW, status=2, err=["huge.toml: 64000000 particles take at least", " GiB of memory", "there may be 977 MiB",
                                                        "take fewer particles"])
        vbond(command, joined, limits=FEW, status=2, err=["joined.toml:", 'bonds "bonds-1": more than', "pairs of 64000 particles are within 1000",
                                                          "0.954 GiB", "right unit?"])
        vbond(command, rod, limits={resource.RLIMIT_AS: int(1054 * mebibytes) * 1024}, status=1,
              err=["memory has run out; there may be", "take fewer particles"])
    assert not Path("refused").exists()


# A bond of 1 N/mm is pressed at 10 mm/s for 4 ms, and ever more slowly for half a millisecond: by 42.5 um.
PEAK = """units = {system = "SI"}
specimen = [{kind = "rod", particles = 2, spacing = "1 mm", radius = "0.3 mm", mass = "1 g"}]
bonds = [{distance = "1.1 mm", stiffness = {c_A = 1e3, c_D = 30, c_B = 2e-3, c_T = 2e-3}}]
[[stage]]
name = "press"
duration = "9 ms"
supports = [{group = "first", fix = ["x", "y", "z"]},
  {group = "last", fix = ["x", "y", "z"], velocity = [-0.01, 0, 0], table = [[0, 1.0], ["4 ms", 1.0], ["5 ms", -1.0]]}]
stop = {peak = {quantity = "reaction", group = "first", direction = [1, 0, 0], drop = 0.5, average_over = "0.1 ms"}}
"""


def test_a_stage_that_ends_at_a_peak_tells_its_force():
    write("peak.toml", PEAK)
    said = vbond("run peak.toml -o peak", no_out="critical force").out
    # the mean of a block of 0.1 ms, within which it falls short by 10 mm/s (0.1 ms)^2/(2 ms) at most
    assert float(re.search(r'peak force of stage "press": (\S+) N\n', said)[1]) == pytest.approx(0.0425, rel=2e-3)

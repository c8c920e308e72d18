"""Exit statuses, and what the program says and leaves behind with each of them."""
import os
import re
import shutil
from pathlib import Path

import pytest
from program import EXAMPLES, HERE, contents, edit, edited, frames, line_of, lines, number, refused, table, values, vbond, write

GOOD = (EXAMPLES / "two_particles.toml").read_text()
# The pair twists, for which the step is small enough; its critical step is the one of stretching, 0.225 T0, so that
# a stretch of 1e-9 grows until it is seen. Before that the energy is off by the (omega dt)^2 / 4 = 0.034 of leap-frog in
# the twist, omega^2 = 2 c_T / Theta = 0.0651.
WILD = edited(GOOD, ("^step = .*", 'step = "0.228 T0"\ninsist = true'), ("^velocity = .*", "velocity = [1e-9, 0, 0]"))
COMMANDS = ["run", "check", "resume", "calibrate", "report", "plot", "breaks"]


@pytest.fixture(scope="module", autouse=True)
def good(work):
    write("good.toml", GOOD)
    write("wild.toml", WILD)
    run = vbond("run good.toml", out="results in good.out").silent()
    assert Path("good.out/run.json").stat().st_size, f"no results in good.out: {run}"


# ---- 0 --------------------------------------------------------------------------------------------------------------
def test_help_and_version():
    vbond("--help", out=[*COMMANDS, "129/130/141/143 on a signal"])
    assert re.fullmatch(r"vbond [0-9]+\.[0-9]+\.[0-9]+\n", vbond("--version").out)


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_has_a_help(command):
    vbond(command, "--help", out=["Usage:", "Options:"])


def test_a_run_says_what_it_runs_with():
    os.mkdir("empty")
    said = vbond("run good.toml -o empty --threads 1").out
    assert re.search("^instruction set  (baseline|avx2|avx512), 1 thread$", said, re.M), said
    assert values("empty", "instruction_set")[0] in ("baseline", "avx2", "avx512") and number("empty", "threads") == 1


def test_check_tells_of_the_body_and_writes_nothing(monkeypatch):
    os.mkdir("elsewhere")
    monkeypatch.chdir("elsewhere")
    said = vbond("check ../good.toml", no_out=["overlapping", "unit missing"], out=[
        "particles        2", "bonds            1, on average 1 neighbour per particle", "critical step    1.41421",
        "no mistakes found", "extent           x 0 to 1, y 0 to 0, z 0 to 0", "total mass       2", "bond lengths     1 to 1"]).out
    assert re.search("^memory  +[0-9.e-]+ [KMG]iB: [0-9]+ bytes per particle, [0-9]+ per bond", said, re.M), said
    said = vbond("check ../good.toml --ranks 4").out
    assert re.search(r"^on 4 ranks  +[0-9.e-]+ MiB each: each makes all particles, and steps its own", said, re.M), said
    vbond("check ../good.toml --ranks 0", status=2)
    assert not os.listdir(), "check writes files"


def test_check_tells_of_unequal_moments():
    vbond("check", HERE / "tops.toml", out="inertia          200 of 200 particles have unequal moments")


def test_check_tells_of_overlaps_and_of_a_unit_that_is_missing():
    # Three spheres that overlap by 0.2 in two pairs of three, c_H = 1: 2 times 0.4 0.2^2.5 = 0.0143108. The duration
    # lost its unit: five steps of 0.2 and no T0.
    write("overlap.toml", """
specimen = [{kind = "rod", particles = 3, spacing = 1.0, radius = 0.6, mass = 1.0}]
contact = {law = "paper-hertz", c_H = 1.0}
time = {step = 0.2}
stage = [{duration = 1}]
""")
    vbond("check overlap.toml", out=["contact energy   at the start 0.0143108 from 2 overlapping pairs",
                                     "at most 5 steps: so few; is a unit missing"])


# ---- 1: the run goes unphysical -------------------------------------------------------------------------------------
@pytest.mark.parametrize("speed", [0.9, 1.1, 2.2, 5, 20, 1000])
def test_balls_cross_each_other(speed):
    # Two balls of radius 0.4, with the automatic step; c_H = 1 holds a relative speed of 0.957 at most.
    write("balls.toml", f"""
specimen = [{{kind = "rod", particles = 2, spacing = 2.0, radius = 0.4, mass = 1.0}}]
groups = {{left = {{indices = [0]}}}}
contact = {{law = "paper-hertz", c_H = 1.0}}
velocities = [{{group = "left", velocity = [{speed}, 0, 0]}}]
stage = [{{duration = 20}}]
""")
    run = ["run balls.toml", "-o", f"balls-{speed}"]
    if speed == 0.9:
        vbond(*run, err="particles 0 and 1 are not bonded and overlap by")
        return
    vbond(*run, status=1, err=["particle 0 moves by", "time.step = ", "stiffer contact",
                               "particles 0 and 1: they have passed through one another"])
    assert "they have passed" in values(f"balls-{speed}", "failure")[0]
    assert number(f"balls-{speed}", "too_fast") > 1, "run.json does not know who is too fast"


def test_a_run_that_diverges_keeps_what_was_good():
    said = vbond("run wild.toml -o wild", status=1, out=["ABOVE", "results up to there in wild"],
                 err=["the run went unphysical at step", "bond 0 (particles 0, 1)", "smaller time.step"]).err
    assert re.search("step [1-9][0-9]*: ", said), f"no step is named: {said}"
    text = Path("wild/history.csv").read_text()
    assert not re.search("nan|inf", text) and len({line.count(",") for line in text.splitlines()}) == 1, text
    assert lines("wild/history.csv") >= 20
    assert all(abs(row["balance_error"]) <= 0.034 for row in table("wild")[:8]), text
    last = Path("wild", frames("wild/particles.pvd")[-1][1])
    assert last.read_bytes().rstrip().endswith(b"</VTKFile>"), f"{last} is not whole"
    assert not list(Path("wild").rglob("*.part")), "half a file is left"
    assert "diverged" in values("wild", "stop")
    # Its timing must not make `check` fail: the case has no mistake.
    vbond("check wild.toml", out=["ABOVE", "no mistakes found"])


# ---- 2: usage and cases ---------------------------------------------------------------------------------------------
@pytest.mark.parametrize("command, texts", [
    ("", ["Usage:", "check", "calibrate"]), ("walk", []), ("run", []),
    ("run good.toml --treads 2 -o refused", ["--treads"]), ("run good.toml --threads 0 -o refused", ["--threads"]),
    ("run good.toml wild.toml -o refused", [])])
def test_usage(command, texts):
    vbond(command, status=2, err=texts)
    assert not Path("refused").exists()


def test_mistakes_are_told_with_their_places():
    # Mistakes of every sort are told at once.
    write("bad.toml", GOOD, ("^particles = 2", "particles = -2"), ("^spacing", "spacings"), ('"bernoulli-euler"', '"euler"'),
          ('^group = "first"', "group = 7"))
    refused("bad.toml", "did you mean spacing?", '"bernoulli-euler"', *(
        f"bad.toml:{line_of('bad.toml', key)}:" for key in ("particles", "spacings", "theory", "group")))
    # What shows only when the body is built.
    write("nobody.toml", GOOD, ('^group = "first"', 'group = "frist"'))
    refused("nobody.toml", f"nobody.toml:{line_of('nobody.toml', 'group')}:", '"first"')
    write("fast.toml", GOOD, ("^step = .*", 'step = "0.24 T0"'))
    refused("fast.toml", f"fast.toml:{line_of('fast.toml', 'step')}:", "time.step", "insist = true")


def test_an_earlier_output_stays_as_it_is_unless_forced():
    write("mine.toml", GOOD)
    vbond("run mine.toml", out="results in mine.out")
    before = contents("mine.out")
    vbond("run mine.toml", out=["output folder    mine-2.out", "results in mine-2.out"])
    os.mkdir("mine-3.out")
    vbond("run mine.toml", out="results in mine-4.out")
    vbond("run mine.toml -o mine.out", status=2, err=["mine.out already exists", "--force"])
    assert contents("mine.out") == before, "a refused run touched mine.out"
    mine = ["my_notes.txt", "frames/particles_best.vtp", "frames/picture.png", "frames/bonds_1.vtp.bak"]
    theirs = ["frames/particles_999999999999.vtp", "frames/bonds_999999999999.vtp", "checkpoint.h5.part"]
    for name in mine + theirs:
        Path("mine.out", name).touch()
    vbond("run mine.toml --force", out="results in mine.out")
    left = [name for name in mine + theirs if Path("mine.out", name).exists()]
    assert left == mine, "--force takes files of earlier runs, and no others"


# ---- 3: files -------------------------------------------------------------------------------------------------------
def test_folders_that_cannot_be_written():
    Path("file").touch()
    vbond("run good.toml -o file/out", status=3, err=["file/out", "cannot"])
    for force in ("", "--force"):
        vbond(f"run good.toml -o file {force}", status=3, err="file: is not a folder")
    os.makedirs("blocked/history.csv/mine")
    vbond("run good.toml -o blocked --force", status=3, err="cannot remove blocked/history.csv")
    if os.geteuid() != 0:  # root may write everywhere
        os.mkdir("locked", 0o500)
        vbond("run good.toml -o locked/out", status=3)
        vbond("run good.toml -o locked", status=3)


def test_files_that_are_missing():
    vbond("run missing.toml", status=3, err="missing.toml")
    vbond("resume missing", status=3, err="missing: is not an output folder of vbond run")


def copy(name):
    shutil.rmtree(name, ignore_errors=True)
    shutil.copytree("good.out", name)
    return Path(name)


def test_damaged_checkpoints():
    vbond("resume good.out")
    whole = Path("good.out/checkpoint.h5").read_bytes()
    damaged = copy("damaged") / "checkpoint.h5"
    # one bit: in the first line, the checksum, HDF5's own data, a number, the last byte
    for at in (3, whole.index(b"fnv1a64") + 10, 700, len(whole) // 2, len(whole) - 1):
        damaged.write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1:])
        vbond("resume damaged", status=3, err="damaged/checkpoint.h5")
    damaged.write_bytes(whole[:len(whole) // 2])
    vbond("resume damaged", status=3)
    damaged.unlink()
    vbond("resume damaged", status=3, err=["damaged/checkpoint.h5", "stopped before its first checkpoint",
                                           "output.checkpoint = {every = "])


def test_a_checkpoint_of_another_body():
    edit(copy("other") / "resolved.toml", ("^spacing = .*", "spacing = 1.01"))
    vbond("resume other", status=3, err="belongs to another case")
    with open("other/resolved.toml", "a") as case:
        case.write("nonsense = 1\n")
    vbond("resume other", status=2, err=["other/resolved.toml:", "nonsense"])


def test_what_may_be_edited_before_going_on():
    edit(copy("longer") / "resolved.toml", ("^duration = .*", 'duration = "21 T0"'))
    vbond("resume longer")
    assert number("longer", "steps") == 2100
    edit(copy("stiffer") / "resolved.toml", ("^nu = .*", "nu = 0.3"))
    vbond("resume stiffer", status=2, err=["stiffer/resolved.toml", "its bonds are not those of the checkpoint", "undo the edit"])
    # Nor may a stage that has begun be left out.
    write("two_stages.toml", GOOD + '\n[[stage]]\nname = "more"\nduration = "1 T0"\n')
    vbond("run two_stages.toml")
    edit("two_stages.out/resolved.toml", (r'^\[\[stage\]\]\nname = "more"\n(?:[^\[].*\n|\n)*', ""))
    vbond("resume two_stages.out", status=2, err=["it has 1 stages, and the checkpoint is in stage 2", "undo the edit"])

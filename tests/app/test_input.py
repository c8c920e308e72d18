"""What the program says of its input: words of the command line, times and steps, loads on groups, bodies that are free
to move, intervals of output, files of other programs."""
from pathlib import Path

import pytest
from program import CLAMP, STATICS, column, edited, refused, vbond, write

STIFFNESS = "stiffness = { c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002 }"


# ---- the command line -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("command, status, out, err", [
    ("simulate case.toml", 2, [], ['"simulate" is no command of vbond', "the commands are run check resume"]),
    ("chekc case.toml", 2, [], ["did you mean check?"]),
    ("check case.toml --thread 4", 2, [], ["--thread is no option of vbond check", "did you mean --threads?"]),
    ("run --thread=4 case.toml", 2, [], ["--thread is no option of vbond run"]),
    ("run case.toml -t 4", 2, [], ["-t is no option of vbond run", "--threads"]),
    ("--threads 4 run case.toml", 2, [], ["--threads is no option of vbond before its command"]),
    ("run --help", 0, [], []), ("--version", 0, [], []),
    # the reference in the terminal
    ("reference stage[0].stop", 0, ["stage.stop.rest.during"], []),
    ("reference groups.NAME.box", 0, ["groups.box.min"], []),
    ("reference fix", 0, ["stage.supports.fix", "required"], []),
    ("reference supports.fix", 0, ["stage.supports.fix", "required"], []),
    ("reference rod", 0, ["specimen.kind", 'with kind = "rod"', "specimen.direction"], []),
    ("reference suports.fix", 2, [], ["did you mean supports.fix?"]),
    ("reference hemispere", 2, [], ["did you mean hemisphere?"]),
    ("reference", 0, ["title", "watch.overlap", "output.frames.precision", 'default "float64"'], []),
    ("reference thery", 2, [], ["key thery", "no case file has it", "did you mean theory?"]),
    ("reference completely_else", 2, [], ["the tables are title, units, cell, specimen"]),
    # units of the command line
    ("calibrate --E 1 --nu '20 deg' --length '10 deg' --diameter 0.1", 2, [],
     ["--nu 20 deg", "must be a number", "--length 10 deg", "must be a length"]),
    ("calibrate --E 1 --nu 0.2 --length '10 %' --diameter 0.1", 2, [], ["--length 10 %"]),
    ("calibrate --E 1 --nu '20 %' --length 1 --diameter 0.1", 0, [], [])])
def test_words(command, status, out, err):
    said = vbond(command, status=status, out=out, err=err)
    assert not any("not expected" in line and word in line.split("not expected")[1] for line in said.err.splitlines()
                   for word in ("case.toml", "4")), f"the wrong word is blamed: {said}"


def test_reference_of_one_key():
    said = vbond("reference bonds.theory", out=["bonds.theory", "stiffnesses from material and section", '"timoshenko"',
                                                "exactly one of coefficients, stiffness, theory"]).out
    assert said.count("\n") == 4, f"more than one key: {said}"
    vbond("reference rod", no_out='with kind = "ring"')


# ---- times and steps ------------------------------------------------------------------------------------------------
ROD = f"""[[specimen]]
kind = "rod"
particles = 16
radius = 0.4
mass = 1
[[bonds]]
distance = 1.1
{STIFFNESS}
[time]
step = 0.3
[[stage]]
name = "pull"
duration = 1.0
loads = [{{ group = "all", force = [0, 6, 8] }}, {{ group = "last", force = [1, 0, 0] }}]
[output]
history = {{ every = 0.25 }}
"""


def test_times_that_are_met():
    vbond("check", write("rod.toml", ROD), no_out="particles of last",  # the load of one particle is not added up
          out=["time step        0.25, ", "below the 0.3 of the case", "at most 4 steps",
               "load             stage pull: force of 10 on each of 16 particles of all, total 160"])
    vbond("run rod.toml", no_out="\nnote ")
    assert column("rod.out", "time")[-1] == 1
    vbond("run", write("short.toml", ROD, ("^duration = .*", "duration = 0.8")))
    assert column("short.out", "time")[-1] == pytest.approx(0.8, abs=1e-14)


def test_times_that_have_no_common_step():
    # A strain of every 1.41421356 and a duration of 5: the strain is met, the other told.
    both = edited(ROD, ("^duration = .*", "duration = 5.0\nstrain = { increment = 1e-3, every = 1.41421356 }"))
    write("both.toml", both)
    for command in ("check", "run"):
        vbond(command, "both.toml", out="note             stage pull: duration = 5 becomes 5.09117, 18 steps of 0.282843")
    later = both + '[[stage]]\nname = "later"\nduration = 4.0\nstrain = { increment = 1e-3, every = 1.41421356 }\n'
    told = "stage later: duration = 4 becomes 3.9598, 14 steps of 0.282843"
    vbond("check", write("later.toml", later), out=f"note             {told}")
    vbond("run later.toml", err=told)


def test_times_that_are_none():
    refused(write("endless.toml", ROD, ("^duration = .*", "duration = 1e60")),
            'endless.toml:11:1: stage "pull": duration = 1e+60', "steps of 0.3", "1e+15 are the most")
    write("weak.toml", ROD, ("^stiffness.*", 'theory = "bernoulli-euler"\nE = 1e-320\nnu = 0.2\nsection = {shape = "circle", diameter = 0.2}'))
    vbond("check weak.toml", status=2, err=["weak.toml:6:1: T0 = ", "must lie between 1e-60 and 1e60", "c_A ="])


def test_output_that_never_comes():
    vbond("check", write("seldom.toml", ROD, ("^history = .*", "history = { every = 20 }\nframes = { every = 0.5 }")), no_out="frames.every",
          out="output           history.every = 20 is longer than the run, 1: is a unit missing, such as T0?")


def test_files_of_lammps():
    write("rod.data", """LAMMPS data file via write_data

2 atoms
1 atom types
1 bonds
1 bond types
0 2 xlo xhi
0 1 ylo yhi
0 1 zlo zhi

Masses

1 1

Bond Coeffs # harmonic

1 80 1

Atoms # bond

1 1 1 0 0 0
2 1 1 1 0 0

Bonds

1 1 1 2
""")
    write("lammps.toml", f"""specimen = [{{kind = "lammps", file = "rod.data", radius = 0.4}}]
bonds = [{{from_specimen = true, bond_type = 1, {STIFFNESS}}}]
stage = [{{duration = "1 T0", loads = [{{group = "type-1", force = [0, 1, 0]}}]}}]
""")
    for command in ("check", "run"):
        vbond(command, "lammps.toml", out="rod.data:15: section Bond Coeffs is passed over")
    assert "\nbond_type = 1\n" in Path("lammps.out/resolved.toml").read_text()


# ---- mistakes of later stages ---------------------------------------------------------------------------------------
BODY = ROD[:ROD.index("[time]")].replace("16", "5")


@pytest.mark.skipif(not STATICS, reason="built without statics")
def test_bodies_that_are_free_to_move():
    loose = BODY + f"""[[stage]]
name = "held"
kind = "equilibrium"
supports = [{{ group = "first", {CLAMP} }}]
loads = [{{ group = "last", force = [0, 1e-5, 0] }}]
[[stage]]
name = "free"
kind = "equilibrium"
supports = [{{ group = "first", fix = ["x", "y", "z"] }}]
loads = [{{ group = "last", force = [1e-5, 0, 0] }}]
"""
    vbond("check", write("loose.toml", loose), status=2, err=[
        'loose.toml:14:1: stage "free": parts of the body can move freely: rotation about x of particles 0 to 4',
        "run will refuse the stage as it begins", "a support may be missing"])
    # All stages are looked at before the first begins: nothing is computed, nothing written.
    vbond("run loose.toml", status=1, err='stage "free": parts of the body can move freely')
    assert not Path("loose.out").exists()
    vbond("check", write("first.toml", loose, (r'name = "held"(.*\n)*\[\[stage\]\]\n', "")), status=2,
          err='first.toml:9:1: stage "free": parts of the body can move freely')
    # Modes take free bodies, and what a contact holds is known only when the stage begins.
    vbond("check", write("modes.toml", loose[:loose.index('name = "free"')] + 'name = "ring"\nkind = "modes"\n'))
    vbond("check", write("touching.toml", loose + '[contact]\nlaw = "paper-hertz"\nc_H = 1\n'))


def test_mistakes_of_later_stages():
    # What run would refuse as a later stage begins is told before the first one does, all at once.
    glue = f"""[[bonds]]
name = "glue"
when = "stage"
stages = ["third"]
pairs = [[0, 1]]
{STIFFNESS}
"""
    stages = BODY + glue + """[time]
step = 0.1
[[stage]]
name = "first"
duration = "100 T0"
[[stage]]
name = "second"
duration = 1.0
stop = { peak = { group = "last", average_over = 0.5 } }
[[stage]]
name = "third"
duration = 5.0
"""
    refused(write("stages.toml", stages), 'stages.toml:23:10: group "last" has no bonds', 'stages.toml:13:1: bonds "glue": pair 0, 1',
            "is bonded already")
    write("brief.toml", stages.replace(glue, ""), ("^stop.*\n", ""), ("^duration = 5.0", "duration = 1e-3"))
    vbond("check brief.toml", status=2, err=["brief.toml:17:1: duration = 0.001", "the time step is 0.1"])


def test_a_cell_of_a_data_file():
    atoms = "title\n\n2 atoms\n\n0 4 xlo xhi\n0 4 ylo yhi\n0 4 zlo zhi\nTILT\nMasses\n\n1 1\n\nAtoms # bond\n\n1 1 1 0.5 1 1 0 0 0\n2 1 1 1.5 1 1 0 1 0\n"
    write("grains.data", atoms.replace("TILT", "1 0 0.5 xy xz yz"))
    case = f"""[cell]
from_specimen = "grains"
[[specimen]]
name = "grains"
kind = "lammps"
file = "grains.data"
radius = 0.4
[[bonds]]
distance = 1.1
{STIFFNESS}
[[stage]]
duration = 5.0
"""
    vbond("check", write("of_file.toml", case), out=["cell", "64"])
    vbond("run of_file.toml")
    resolved = Path("of_file.out/resolved.toml").read_text()
    assert '[cell]\nfrom_specimen = "grains"\nopen' in resolved and "a = [" not in resolved, resolved
    write("grains.data", atoms.replace("TILT", "4 0 0 avec"))
    refused("of_file.toml", "grains.data:8:1: the box is given by its ends and by vectors")
    write("grains.data", atoms.replace("TILT", "").replace("0 4 ylo yhi\n", ""))
    refused("of_file.toml", "grains.data:15:1: an image flag along y, and no box", 'add the line "low high ylo yhi" above')
    write("grains.data", atoms.replace("TILT", ""))
    refused(write("no_such.toml", case.replace('"grains"', '"grain"', 1)), 'no_such.toml:2:1: cell.from_specimen = "grain"', "there is no such specimen")
    refused(write("both.toml", case.replace('"grains"\n', '"grains"\na = [4, 0, 0]\n', 1)), "both.toml:3:1: cell.a", "is used only with no from_specimen")

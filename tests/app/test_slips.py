"""What check compares and notes as a likely slip, and files of other programs: columns, units, styles, periodic boxes."""
import json
import math
from pathlib import Path

import pytest

from program import STATICS, edited, refused, same_bytes, vbond, write

STIFFNESS = "stiffness = { c_A = 1, c_D = 0.03, c_B = 0.0025, c_T = 0.002 }"


NOTE = "\nnote "


def check(name, text, *changes, **expected):
    return vbond("check", write(name, text, *changes), **expected)


def test_bonds():  # bodies, particles without any, pairs from 1, one that is long
    case = f"""specimen = [{{kind = "csv", file = "four.csv", mass = 1}}]
bonds = [{{file = "pairs.csv", {STIFFNESS}}}]
stage = [{{duration = "20 T0"}}]
"""
    write("four.csv", "x,y,z,radius\n0,0,0,0.4\n1,0,0,0.4\n2,0,0,0.4\n3,0,0,0.4\n")
    write("pairs.csv", "i,j\n1,2\n2,3\n")
    check("pairs.toml", case, out=[
        "separate bodies  1, of 3 particles; 1 bonded to none", 'specimen "body": 1 of its 4 particles have no bond, the first is 0',
        "no pair names particle 0, the first, and it has no bond: do the pairs count from 1?"])
    write("pairs.csv", "i,j\n0,1\n2,3\n")
    check("pairs.toml", case, out="separate bodies  2, of 2 particles each", no_out=NOTE)
    write("pairs.csv", "i,j\n0,1\n1,2\n2,3\n3,4\n4,5\n5,6\n6,7\n")
    check("two.toml", case, ("mass = 1", "mass = 1, array = [{ count = 2, step = [50, 0, 0] }]"), no_out="separate bodies",
          out='bonds "bonds-1": the longest, of particles 3 and 4, joins centres 47 apart, 47 times the median 1')


BEAM = """units = {system = "SI"}
[[specimen]]
name = "beam"
kind = "rod"
particles = 21
spacing = "0.25 m"
radius = "0.2 m"
density = "1000 kg/m^3"
[[bonds]]
distance = "0.26 m"
theory = "bernoulli-euler"
E = "1 GPa"
nu = 0.3
section = {shape = "circle", diameter = "0.4 m"}
[[stage]]
duration = "1 s"
"""


def test_masses():
    # 21 spheres of 33.51 kg; 5 m of a bar of 125.66 kg/m
    check("beam.toml", BEAM, out=['specimen "beam": its overlapping spheres weigh 703.717 kg, the bars of its bonds 628.319 kg',
                                  "+12 %; mass = 29.9199"])
    check("light.toml", BEAM, ("^density.*", "mass = 29.9199"), no_out=NOTE)
    # touching beads of radius 0.5 m on a thin bar: 21 * 523.6 kg, and 20 m of a bar of 7.854 kg/m
    beads = edited(BEAM, ("^spacing.*", 'spacing = "1 m"'), ("^radius.*", 'radius = "0.5 m"'), ("^distance.*", 'distance = "1.1 m"'),
                   ('diameter = "0.4 m"', 'diameter = "0.1 m"'))
    check("beads.toml", beads, out=['specimen "beam": its spheres weigh 10995.6 kg, the bars of its bonds 157.08 kg',
                                    "+6900 %; mass = 7.47998"])
    check("rods.toml", beads, ('diameter = "0.1 m"', 'diameter = "0.9 m"'), no_out=NOTE)  # lighter than their bars by 14 %


@pytest.mark.skipif(not STATICS, reason="built without statics")
def test_free_ends_of_rods():
    modes = edited(BEAM, ("^density.*", "mass = 29.9199"), ("^duration.*", 'kind = "modes"\ncount = 8'))
    words = "{} of its 20 bonds, a bar half of one: the lowest frequencies are some {} % too low"
    check("free.toml", modes, out='specimen "beam": its free ends carry ' + words.format("whole beads", 10))
    clamped = edited(modes, ("^count.*", 'count = 8\nsupports = [{group = "first", fix = ["x", "y", "z", "rx", "ry", "rz"]}]'))
    check("clamped.toml", clamped, out='specimen "beam": its free end carries a ' + words.format("whole bead", 5))
    check("pinned.toml", clamped, (r"\}\]$", '}, {group = "last", fix = ["z"]}]'), no_out="whole bead")
    check("fine.toml", modes, ("^particles.*", "particles = 301"), no_out="whole bead")
    check("half.toml", modes, ("^kind = .rod.", 'kind = "rod"\\nhalf_ends = true'), no_out="whole bead")
    check("moving.toml", BEAM, no_out="whole bead")
    # of the weight of the bars 20 whole beads and two halves
    check("light.toml", BEAM, ("^kind = .rod.", 'kind = "rod"\\nhalf_ends = true'), ('"0.2 m"', '"0.25 m"'), out="mass = 31.4159 in place of density")


@pytest.mark.skipif(not STATICS, reason="built without statics")
def test_half_ends_are_those_of_a_bar():
    def first(*changes):
        vbond("run", write("bar.toml", """units = {system = "SI"}
specimen = [{kind = "rod", particles = 41, spacing = "12.5 mm", radius = "5 mm", mass = "7.70673801 g", half_ends = true}]
bonds = [{distance = "13 mm", theory = "bernoulli-euler", E = "210 GPa", nu = 0.3, section = {shape = "circle", diameter = "10 mm"}}]
stage = [{kind = "modes", count = 1}]
""", *changes), "-o", "bar", "--force")
        return next(f for f in json.loads(Path("bar/run.json").read_text())["stages"][0]["frequencies"] if f > 1)
    bar = 4.73004074486**2 / (2 * math.pi * 0.5**2) * math.sqrt(210e9 * 0.01**2 / 16 / 7850)
    assert bar == pytest.approx(184.17, abs=0.01)
    # of order 1/N^2 with half masses: 0.3 % with 40 bonds; of order 1/N without
    assert abs(first() / bar - 1) < 0.004
    assert first((", half_ends = true", "")) / bar - 1 == pytest.approx(-2 / 40, rel=0.1)


@pytest.mark.skipif(not STATICS, reason="built without statics")
def test_free_edges_of_strips():
    strip = """units = {system = "SI"}
specimen = [{name = "strip", kind = "sheet", particles = [21, 9], spacing = "5 mm", thickness = "1 mm", density = "7850 kg/m^3"}]
bonds = [{distance = "5.1 mm", theory = "shell", E = "200 GPa", nu = 0.3, thickness = "1 mm"}]
stage = [{kind = "modes", count = 3}]
"""
    check("strip.toml", strip, out='specimen "strip": bonds of a free edge have their whole stiffness, which makes a strip of 9 rows 12 % too stiff')
    check("wide.toml", strip, (r"\[21, 9\]", "[9, 61]"), no_out="free edge")
    half = 'bonds = [{between = ["edge", "edge"], stiffness_factors = {c_A = 0.5, c_D = 0.5, c_B = 0.5, c_T = 0.5}, '
    edge = '\ngroups = {edge = {half_space = {point = [0, "1 mm", 0], normal = [0, 1, 0]}}}'
    check("half.toml", strip, (r"^bonds = \[\{(.*)\}\]$", half + r"\1}, {\1}]" + edge), no_out="free edge")


def test_meshes():
    write("plate.obj", "v 0 0 0\nv 1000 0 0\nv 0 1000 0\nf 1 2 3\n")
    plate = BEAM + """[contact]
law = "linear"
k = 1e6
[[wall]]
name = "plate"
shape = "mesh"
file = "plate.obj"
shift = [0, 0, -2]
"""
    check("plate.toml", plate, out=['wall "plate": its mesh is 1.41e+03 from corner to corner, the body 5.43', "scale = 1: is that right?"])
    check("scaled.toml", plate, ("^shift", "scale = 0.001\nshift"), no_out="its mesh is")


UNITS = f"""[units]
system = "SI"
[[specimen]]
kind = "csv"
file = "units.csv"
columns = {{ x = "x_mm", y = "y_mm", z = "z_mm" }}
units = {{ x = "mm", y = "mm", z = "mm" }}
bonds_file = "rows.csv"
mass = 1
radius = 1e-4
[[bonds]]
from_specimen = true
{STIFFNESS}
[[stage]]
duration = "1 T0"
"""


def test_csv_files_of_others():
    Path("units.csv").write_bytes(b'"id","x_mm","y_mm","z_mm"\r\n"1",0,0,0\r\n"2",1,0,0\r\n')
    write("rows.csv", "i,j\n0,1\n")
    check("units.toml", UNITS, out=['units.csv: not read are the columns "id"', "extent           x 0 to 0.001"])
    vbond("run units.toml")
    for file in ("units.csv", "rows.csv"):
        assert same_bytes(file, f"units.out/inputs/{file}"), f"{file} is not kept with the run"
    vbond("run units.out/resolved.toml -o again.out")
    assert same_bytes("units.out/history.csv", "again.out/history.csv"), "resolved.toml means another run"
    # a title that would write to the terminal
    write("red.csv", "x,y,z,\033[31m\n0,0,0,1\n1,0,0,1\n")
    check("red.toml", UNITS, ("units.csv", "red.csv"), ("^units = .*\n", ""), ("^columns.*", 'columns = { x = "x", y = "y", z = "z" }'),
          no_out="\033")


def test_mistakes_without_number():
    write("short.csv", "x,y,z\n" + "1,2\n" * 3000)
    said = vbond("check", write("short.toml", UNITS, ("units.csv", "short.csv"), ("^(columns|units = |bonds_file).*\n", "")), status=2,
                 err=["short.csv:21:1: 2 fields", "and 2980 more of this kind"]).err
    assert said.count("\n") < 100


DATA = """a chain of four

4 atoms
1 atom types
3 bonds
1 bond types
0 4 xlo xhi
0 1 ylo yhi
0 1 zlo zhi

Masses

1 1

Atoms # molecular

1 1 1 0.5 0 0
2 1 1 1.5 0 0
3 1 1 2.5 0 0
4 1 1 3.5 0 0

Bonds

1 1 1 2
2 1 2 3
3 1 3 4
"""
CHAIN = f"""[[specimen]]
kind = "lammps"
file = "chain.data"
radius = 0.4
[[bonds]]
from_specimen = true
{STIFFNESS}
[[stage]]
duration = "1 T0"
"""


def test_lammps_data_files():
    write("chain.data", DATA)
    vbond("run", write("chain.toml", CHAIN))
    assert "atom_style" not in Path("chain.out/resolved.toml").read_text(), "a style that the case does not name"
    write("unnamed.data", DATA, ("^Atoms.*", "Atoms # by hand"))
    unnamed = edited(CHAIN, ("chain.data", "unnamed.data"))
    vbond("check", write("unnamed.toml", unnamed), status=2, err=[
        "unnamed.data:15:1: the style of the atoms is named neither by the file nor by the case", "charge, bond, angle, molecular"])
    vbond("check", write("named.toml", unnamed, ("^kind.*", r'\g<0>\natom_style = "bond"')))
    write("ring.data", DATA, ("^3 bonds", "4 bonds"), ("^3 1 3 4", r"\g<0>\n4 1 4 1"))
    refused(write("ring.toml", CHAIN, ("chain.data", "ring.data")),
            'ring.toml:6:1: bonds "bonds-1": 1 bonds of the file go through a boundary of its periodic box',
            "particles 3 and 0, would be 3 long and is 1 through the boundary", "write the file with image flags")

"""Static stages as a user meets them: in one run with dynamics, stopped and resumed, failing, and what they leave behind."""
import json
import os
import re
import shutil
from math import cos
from pathlib import Path

import pytest
from program import (CLAMP, HERE, PROGRAM, column, contents, edit, edited, expect_same, frames, number, read,
                     stop_at, table, values, vbond, write)

CASE = (HERE / "statics.toml").read_text()
HELD = f'supports = [{{group = "first", {CLAMP}}}]'
# A bond carries a torque of B4 / 2 = 0.05 and no more: of 0.1 that is load factor 0.5.
TWIST = f"""specimen = [{{kind = "rod", particles = 2, radius = 0.3, mass = 1.0}}]
bonds = [{{distance = 1.1, coefficients = {{B1 = 1.0, B2 = 0.1, B3 = 0.1, B4 = 0.1}}}}]
output = {{frames = {{}}}}
[[stage]]
name = "twist"
kind = "equilibrium"
{HELD}
loads = [{{group = "last", moment = [0.1, 0, 0]}}]
steps = 16
"""


@pytest.fixture(scope="module")
def whole(work):
    """Balance, modes and dynamics in one run."""
    before = os.listdir()
    vbond("check", HERE / "statics.toml", out=["solver           direct, with a factor of ", "stage bend       equilibrium, 60 unknowns",
                                               "stage ring       modes, 60 unknowns", "at most about"])
    assert os.listdir() == before, "check writes files"
    vbond("run", HERE / "statics.toml", "-o", "whole", out=["stable, smallest eigenvalue", "frequency           period",
                                                            "exact; bound 1, from", "error of the energy balance: "]).silent()
    return "whole"


BLOCK = """[[specimen]]
kind = "block"
cells = [{0}, {0}, {0}]
radius = 0.5
mass = 1.0
[[bonds]]
distance = 1.1
stiffness = {{ c_A = 1.0, c_D = 0.4, c_B = 0.05, c_T = 0.05 }}
[groups]
low = {{ plane = {{ point = [0, 0, 0], normal = [0, 0, 1], within = 0.1 }} }}
[[stage]]
kind = "equilibrium"
gravity = [0, 0, -1e-6]
supports = [{{group = "low", fix = ["x", "y", "z", "rx", "ry", "rz"]}}]
"""


def test_check_says_where_multigrid_is_much_quicker(work):
    """docs/decisions/statics.md: of blocks it is from 20 particles along an edge on, and not at 8."""
    for cells, quicker in ((20, True), (8, False)):
        Path("block.toml").write_text(BLOCK.format(cells), encoding="utf-8")
        said = vbond("check", "block.toml").out
        assert "solver           direct, with a factor of " in said and ("vbond-petsc" in said) == quicker


PRESSED = """[[specimen]]
name = "block"
kind = "block"
cells = [4, 4, 3]
origin = [0, 0, 1]
mass = 1.0
radius = 0.5
[[specimen]]
name = "slab"
kind = "block"
cells = [4, 4, 1]
mass = 1.0
radius = 0.5
[[bonds]]
between = ["block", "block"]
distance = 1.1
stiffness = {c_A = 1.0, c_D = 0.3, c_B = 0.1, c_T = 0.1}
strength = {criterion = "linear", axial_force = 5e-4, shear_force = 1.0, bending_moment = 1.0, torque = 1.0}
[contact]
law = "paper-hertz"
c_H = 0.1
[groups.top]
plane = {point = [0, 0, 3], normal = [0, 0, 1], within = 0.1}
[[stage]]
kind = "fracture"
steps = 10
supports = [{group = "slab", rigid = true}, {group = "top", rigid = true, displacement = [0, 0, -5e-5]}]
"""


def test_books_close_where_bounds_of_rounding_are_large(work):
    """Energies are small beside their bounds of rounding. A trapezium of each of ten steps leaves 2.1e-3 of the work."""
    Path("pressed.toml").write_text(PRESSED, encoding="utf-8")
    vbond("run", "pressed.toml", "-o", "pressed")
    assert abs(json.loads(Path("pressed/run.json").read_text(encoding="utf-8"))["stages"][0]["fracture"]["energy"]["balance_error"]) < 5e-4


# Springs in a row between two walls: of a load on the last but one particle three springs carry a quarter, and one the rest.
ROW = """specimen = [{kind = "rod", particles = 5, spacing = "1 mm", radius = "0.3 mm", mass = "1 g"}]
units = {system = "SI"}
groups = {mid = {indices = [3]}}
output = {history = {reactions = ["GROUP"]}}
[[bonds]]
distance = "1.1 mm"
stiffness = {c_A = "1 N/mm", c_D = "0.5 N/mm", c_B = "0.1 N*mm", c_T = "0.1 N*mm"}
strength = {criterion = "linear", axial_force = "0.05 N", shear_force = "1 N", bending_moment = "1 N*m", torque = "1 N*m"}
[[stage]]
kind = "fracture"
steps = 7
supports = [{group = "ends", fix = ["x", "y", "z", "rx", "ry", "rz"]}]
loads = [{group = "mid", force = ["0.2 N", 0, 0]}]
"""


def test_loads_of_breaks_at_rest_are_forces_of_supports(work):
    """Also where the body is driven by loads: no support moves, and the load of the stage's own table is its factor."""
    for group, at_break, largest in ("first", 0.05, 0.05), ("last", 0.15, 0.2):
        write("row.toml", ROW, ("GROUP", group))
        vbond("run", "row.toml", "-o", f"row_{group}", out="1 bond broke")
        folder = f"row_{group}"
        told, (broken,), (of_stage,) = read(folder), table(f"{folder}/breaks.csv"), table(f"{folder}/fracture.csv")
        (row,) = [row for row in table(folder) if row["step"] == broken["step"]]
        assert broken["load"] == abs(row[f"reaction.{group}.fx"]) == told["first_break_load"]
        assert broken["load"] == pytest.approx(at_break, rel=1e-8)
        assert told["peak_load"] == pytest.approx(largest, rel=1e-8)
        assert of_stage["load"] == of_stage["load_factor"] == pytest.approx(1, rel=1e-8)
    write("row.toml", ROW, ('reactions = ."GROUP".', ""))
    vbond("run", "row.toml", "-o", "row_alone", out="1 bond broke")
    told = read("row_alone")
    assert table("row_alone/breaks.csv")[0]["load"] is None and told["broken"] == 1
    assert "first_break_load" not in told and "peak_load" not in told
    # `time` says nothing of a break at rest
    step = int(table("row_alone/breaks.csv")[0]["step"])
    vbond("breaks row_alone", out="broke at load factor 1 in ")
    Path("row_alone/fracture.csv").unlink()
    vbond("breaks row_alone", out=f"broke at point {step} in ")


def test_a_cantilever_is_bent_and_let_go(whole):
    rows = table(whole)
    count = sum(row["unstable"] is not None for row in rows)
    bent, begin, end = rows[count - 2], rows[count - 1], rows[-1]
    # P L^3 / (3 E J) = 0.13333; geometric nonlinearity is -1.09 (0.013)^2 of it.
    assert 0.13333 * 0.9996 < bent["displacement.10.y"] < 0.13334
    assert bent["load_factor"] == 1, "the last balance is not at load factor 1"
    assert begin["reaction.first.fy"] < -0.999999e-6, "the support does not carry the load"
    assert begin["reaction.first.mz"] < -0.999e-5, "the support does not carry the moment"
    assert rows[count]["load_factor"] is None, "a row of dynamics has a load factor"
    # Let go, the tip swings in the lowest modes: those of a cantilever that its tip was pulled at have the shares
    # 12 / (beta L)^4 = 0.971 and 0.025 of the deflection.
    swing = end["displacement.10.y"] / bent["displacement.10.y"]
    assert abs(swing - cos(values(whole, "omega")[0][0] * (end["time"] - begin["time"]))) < 0.06 and swing < -0.8
    assert number(whole, "energy_balance_error") < 1e-3, "the energy books do not close after statics"


def test_every_point_has_a_frame_and_each_mode_its_swing(whole):
    assert len(frames("whole/particles.pvd")) == number(whole, "points") + 1 + 5
    for swing in (f"ring_mode_{mode}{kind}" for mode in (1, 2, 3) for kind in ("", "_bonds")):
        assert len(frames(f"whole/modes/{swing}.pvd")) == 8, swing
    last = max(Path("whole/frames").glob("bonds_*"))
    assert b'Name="load_factor"' not in last.read_bytes(), "a frame of dynamics has a load factor"


# ---- stopped and resumed --------------------------------------------------------------------------------------------
def test_stopped_in_statics_and_in_dynamics():
    write("long.toml", CASE, ("^particles = .*", "particles = 60"), (r"1e-6, 0\]", "1e-8, 0]"), ("^steps = .*", "steps = 300"),
          (r", displacements = \[10\]", ""), ("^duration = .*", 'duration = "5000 T0"'))
    vbond("run long.toml -o long")
    stop_at(20, "in_statics", "run long.toml -o in_statics").expect(
        143, err=f"a static stage begins from its start; go on with: {PROGRAM} resume in_statics")
    assert "interrupted" in values("in_statics", "ended")
    vbond("resume in_statics", out="resumed at step 0 of stage bend")
    expect_same("long", "in_statics")
    stop_at(320, "in_dynamics", "run long.toml -o in_dynamics")
    vbond("resume in_dynamics")
    expect_same("long", "in_dynamics")


def test_stopped_between_modes():
    # Modes ask for no signal: it is seen between two of these stages, or never.
    modes = (f'[[stage]]\nname = "m{k}"\nkind = "modes"\ncount = 3\nframes_per_mode = 0\n{HELD}\n' for k in range(150))
    write("many.toml", CASE.split("[time]")[0] + "".join(modes) + "[output]\nhistory = {}\n", ("^particles = .*", "particles = 60"))
    vbond("run many.toml -o many")
    stop_at(20, "between", "run many.toml -o between").expect(143, err=f"go on with: {PROGRAM} resume between")
    vbond("resume between")
    expect_same("many", "between")


def test_a_run_whose_last_stage_is_static():
    static = edited(CASE, (r'\[\[stage\]\]\nname = "let_go"(.*\n)*?(?=\[output\])', ""), ('{every = "50 T0"}', "{}"))
    write("static.toml", static)
    vbond("run static.toml -o static")
    before = contents("static")
    vbond("resume static", out="the run is complete, results in static")
    assert contents("static") == before, "resume touched a run that was complete"
    # --force takes its files away, and nothing else.
    for name in ("static/modes/mine.txt", "static/last_balance.h5"):
        Path(name).touch()
    write("bare.toml", static, ("^frames_per_mode = .*", "frames_per_mode = 0"))
    vbond("run bare.toml -o static --force")
    assert os.listdir("static/modes") == ["mine.txt"] and not Path("static/last_balance.h5").exists()
    # A body that moves is told to come to rest, once.
    write("moving.toml", static + '[[velocities]]\ngroup = "last"\nvelocity = [1e-3, 0, 0]\n')
    said = vbond("run moving.toml", err='stage "bend": the body was moving').err
    assert sum("moving" in line for line in said.splitlines()) == 1, said


# ---- failures -------------------------------------------------------------------------------------------------------
def test_a_twist_beyond_what_the_bond_carries():
    write("twist.toml", TWIST)
    vbond("run twist.toml -o twist", status=1, err='stage "twist": no balance found beyond load factor 0.',
          out=["results up to there in twist", "twist/last_balance.h5"])
    assert "failed" in values("twist", "ended") and values("twist", "failure")[0].startswith("stage")
    reached = column("twist", "load_factor")[-1]
    assert 0.43 < reached < 0.500001
    assert number("twist", "load_factor") == reached, "run.json and history.csv do not agree"
    assert len(frames("twist/particles.pvd")) == len(table("twist")), "not every point has its frame"
    # Resumed it fails in the same way; with a load that it carries it comes to its end, and the last balance goes.
    shutil.copytree("twist", "again")
    vbond("resume again", status=1)
    assert contents("again", "run.json", "status.json") == contents("twist", "run.json", "status.json")
    edit("again/resolved.toml", (r"moment = \[0\.1,", "moment = [0.04,"))
    vbond("resume again")
    assert not Path("again/last_balance.h5").exists(), "the last balance of the failure is still there"
    assert column("again", "load_factor")[-1] == 1


def test_a_bond_is_pushed_together():  # until it has no direction any more
    write("close.toml", TWIST, ("^loads = .*", ""), ("^steps = .*", "steps = 4"), ("^supports = .*", (
        f'supports = [{{group = "first", {CLAMP}}}, {{group = "last", fix = ["x", "y", "z"], displacement = [-1, 0, 0]}}]')))
    vbond("run close.toml -o close", status=1, err=["bond 0 (particles 0, 1)", "is shorter than half its length at rest"])
    assert "failed" in values("close", "ended")
    assert not re.search("nan|inf", Path("close/history.csv").read_text()), "an unphysical point was written"


def test_buckling_that_fails_keeps_the_critical_load():
    # It finds a critical load and fails after it: the tip's turn is held about one axis, so that a moment from outside
    # comes up once the rod has bent (the load is 1e-10 off its axis).
    press = f"""specimen = [{{kind = "rod", particles = 4, radius = 0.3, mass = 1.0}}]
bonds = [{{distance = 1.1, coefficients = {{B1 = 1.0, B2 = 0.01, B3 = 0.1, B4 = 0.1}}}}]
[[stage]]
name = "press"
kind = "buckling"
count = 9
supports = [{{group = "first", {CLAMP}}}, {{group = "last", fix = ["ry"]}}]
loads = [{{group = "last", force = [-1, 0, 1e-10]}}]
"""
    write("press.toml", press)
    vbond("run press.toml -o press", status=1, out=["bifurcation", "ended: failed", "results up to there in press", "press/last_balance.h5"],
          err=['stage "press": at load factor 0.0', "a moment from outside acts on particles that are free to turn"])
    assert "failed" in values("press", "ended") and values("press", "failure")[0].startswith("stage")
    assert '"bifurcation"' in Path("press/run.json").read_text()
    # the softer plane of a cantilever of three bonds: 0.016334 by linear theory, found on the path within 2 %
    critical, reached = values("press", "critical_load_factors")[0][0], column("press", "load_factor")[-1]
    assert 0.016 < critical < 0.01634
    assert reached == pytest.approx(number("press", "load_factor"), abs=1e-15) and reached > critical
    # Dynamics after buckling: the energy books begin with the body that buckling leaves, not with the last point of its
    # path.
    write("after.toml", press + f"""[[stage]]
name = "swing"
duration = "10 T0"
{HELD}
loads = [{{group = "last", force = [0, 1e-6, 0]}}]
""", ("^count = 9", "count = 1"), (r', \{group = "last", fix = \["ry"\]\}', ""), ("1e-10", "0"))
    vbond("run after.toml -o after")
    assert number("after", "energy_balance_error") < 1e-2


@pytest.mark.parametrize("diameter, k_s", [(1.0855575525102696, 6.25354177435492e-05), (1.2040522820538568, 0.005060375836164954),
                                           (1.7686717018003444, 0.00358815022161535)])
def test_a_saddle_where_a_moment_leaves_no_tangent(diameter, k_s):  # once a crash
    vbond("run", write("saddle.toml", f"""units = {{system = "SI"}}
specimen = [{{kind = "rod", particles = 6, spacing = "2 mm", radius = "0.5 mm", density = 1000}}]
[[bonds]]
gap = "2 mm"
theory = "parallel"
k_n = "763516248853.158 N/m^3"
k_s = {k_s!r}
section = {{shape = "circle", diameter = "{diameter!r} mm"}}
[[stage]]
kind = "equilibrium"
steps = 12
loads = [{{group = "last", force = [0.03, 0.02, 0.01], moment = [1e-5, 0, 0]}}]
supports = [{{group = "first", fix = ["x", "y", "z", "rx", "ry", "rz"]}}]
"""), *"-o saddle --force".split(), status=1, err="no balance found beyond load factor")


def test_points_are_numbered():
    # The first point is the body at load factor 0; without dynamics time is the number of the point, and the load factor
    # stands in the frames, those of dynamics apart.
    numbered = edited(TWIST, ("0.1, 0, 0", "0.04, 0, 0"), ("^steps = .*", "steps = 4"))
    write("numbered.toml", numbered)
    vbond("run numbered.toml -o numbered")
    assert column("numbered", "load_factor") == [0, 0.25, 0.5, 0.75, 1]
    assert column("numbered", "time") == [1, 2, 3, 4, 5]
    assert [time for time, _ in frames("numbered/particles.pvd")] == ["1", "2", "3", "4", "5"]
    for kind in ("particles", "bonds"):
        frame = Path(f"numbered/frames/{kind}_000000000004.vtp").read_bytes()
        assert re.search(b'Name="load_factor".*>0.75<', frame), f"no load factor in the frame of {kind}"
    write("path.toml", numbered, ('kind = "equilibrium"', 'kind = "path"\nfirst_step = 0.3\nstop = {load_factor = {above = 0.9}}'),
          ("^steps.*", ""))
    vbond("run path.toml -o path", no_out="energy balance")
    vbond("plot path load_factor --x step", out="step")
    vbond("plot path U_L", out=" load_factor ", no_out=" time ")  # points of a path are no times
    assert column("path", "load_factor")[0] == 0, "a path does not begin at load factor 0"


def test_bodies_that_only_a_contact_joins():
    # Two balls in SI units have no T0, and static stages need none.
    write("balls.toml", f"""units = {{system = "SI"}}
specimen = [{{kind = "list", positions = [[0.0, 0.0, 0.0], ["1.98 mm", 0.0, 0.0]], radius = "1 mm", mass = "1 g"}}]
groups = {{left = {{indices = [0]}}, right = {{indices = [1]}}}}
contact = {{law = "hertz", E = "1 GPa", nu = 0.3}}
output = {{frames = {{}}}}
[[stage]]
name = "press"
kind = "equilibrium"
supports = [{{group = "left", {CLAMP}}}, {{group = "right", fix = ["y", "z", "rx", "ry", "rz"]}}]
loads = [{{group = "right", force = ["-100 N", 0.0, 0.0]}}]
""")
    vbond("run balls.toml -o balls")
    assert frames("balls/particles.pvd")[0][0] == "1"


def test_rods_that_are_pushed_through_one_another():  # and are not bonded to each other
    write("crossing.toml", f"""specimen = [
  {{name = "lower", kind = "rod", particles = 5, radius = 0.5, mass = 1.0}},
  {{name = "upper", kind = "rod", particles = 5, origin = [2.0, -2.0, 1.2], direction = [0.0, 1.0, 0.0], radius = 0.5, mass = 1.0}},
]
bonds = [{{distance = 1.05, theory = "bernoulli-euler", E = 31.830988618379067, nu = 0.2, section = {{shape = "circle", diameter = 0.2}}}}]
output = {{history = {{every = "1 T0"}}}}
[[stage]]
name = "through"
kind = "equilibrium"
steps = 6
supports = [{{group = "lower", {CLAMP}}}, {{group = "upper", {CLAMP}, displacement = [0.0, 0.0, -2.4]}}]
""")
    vbond("run crossing.toml -o crossing", out="1 pair of particles without a bond overlapped",
          err="load factor 0.166667: particles 2 and 7 are not bonded and overlap by 0.2, 0.4 of the smaller radius")
    assert number("crossing", "ever_overlapping") == 1
    vbond("run crossing.toml -o unwatched --set watch.overlap=0").silent()
    assert number("unwatched", "ever_overlapping") == 0, "overlap = 0 is no way to switch it off"


def test_nothing_holds_the_body():  # said at once, with nothing computed
    write("loose.toml", TWIST, ("^supports.*", ""))
    vbond("run loose.toml", status=1, err="can move freely")


WEAK = f"""specimen = [{{kind = "rod", particles = 11, radius = 0.4, mass = 1.0, inertia = 0.064}}]
[[bonds]]
distance = 1.1
theory = "bernoulli-euler"
E = 31.830988618379067
nu = 0.2
section = {{shape = "circle", diameter = 0.2}}
strength = {{criterion = "stress", tension = 1e-3, shear = 1e-3, compression = 1e-3}}
[[stage]]
name = "mo"
kind = "modes"
count = 2
{HELD}
loads = [{{group = "last", force = [1e-3, 0, 0]}}]
[[stage]]
name = "bu"
kind = "buckling"
count = 1
{HELD}
loads = [{{group = "last", force = [-1, 0, 0]}}]
[[stage]]
name = "eq"
kind = "equilibrium"
{HELD}
loads = [{{group = "last", force = [1e-3, 0, 0]}}]
[[stage]]
name = "pa"
kind = "path"
stop = {{load_factor = {{above = 5e-5}}}}
{HELD}
loads = [{{group = "last", force = [-1, 0, 0]}}]
"""


def test_modes_and_critical_loads_past_the_strength_are_told(work):
    write("weak.toml", WEAK)
    ended = vbond("run weak.toml -o weak")
    said = ended.out + ended.err
    area = 3.14159265358979 * 0.1**2
    of_modes = 1e-3 / area / 1e-3
    modes, buckling = values("weak", "most_used_bond")[:2]
    assert modes["utilisation"] == pytest.approx(of_modes, rel=1e-9) and modes["load_factor"] == 1
    critical = values("weak", "critical_load_factors")[0][0]
    assert buckling["utilisation"] == pytest.approx(critical / area / 1e-3, rel=1e-6) and buckling["utilisation"] > 1.9
    assert 'stage "mo": load factor 1: bond 0 (particles 0, 1) is past its strength, at 31.83 of it' in said
    assert said.count('stage "bu": load factor') == 1 and said.count("BEYOND STRENGTH") == 4
    # each stage once, and no loads came on before the path
    assert said.count("is past its strength") == 4 and "come on" not in said


def test_modes_of_a_free_body_under_loads_say_what_is_meant(work):
    write("free.toml", WEAK[:WEAK.index("[[stage]]")] + """[[stage]]
kind = "modes"
count = 2
loads = [{group = "last", force = [1e-3, 0, 0]}]
""")
    vbond("run free.toml", status=1, err=["can move freely", "modes of a body that is free are about where it stands, without loads"],
          no_err="takes free bodies")

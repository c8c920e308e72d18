"""`vbond calibrate CASE --tensile --compressive`: limits of bonds for the strengths of a body."""
import json
import re
from pathlib import Path

import pytest
from program import STATICS, line_of, vbond, write

pytestmark = pytest.mark.skipif(not STATICS, reason="tests at rest need statics")

ROCK = """title = "A small body"
[units]
system = "SI"
[[specimen]]
name = "rock"
kind = "packing"
density = "2600 kg/m^3"
vessel = [{box = {min = [0, 0, 0], max = [0.01, 0.01, 0.018]}}]
grains = [{radii = ["1.2 mm", "1.7 mm"]}]
porosity = 0.53
[[bonds]]
name = "cement"
gap_factor = 1.4
neighbours = "voronoi"
attach = "neck"
theory = "parallel"
E = "70 GPa"
stiffness_ratio = 2.5
section = {shape = "circle", factor = 0.9}
strength = {criterion = "mohr-coulomb", tension_limit = "40 MPa", cohesion = "100 MPa", friction_angle = "35 deg", moment_share = 0.1}
[[stage]]
duration = "1 ms"
"""
# Columns of a cubic lattice: in tension all bonds of a plane break at once, at the limit in tension.
BAR = """
[[specimen]]
name = "bar"
kind = "block"
cells = [3, 3, 8]
spacing = 1.0
radius = 0.5
mass = 1.0
[[bonds]]
distance = 1.1
theory = "bernoulli-euler"
E = 1.0
nu = 0.0
section = {shape = "square", side = 1.0}
strength = {criterion = "stress", tension = 1e-3, shear = 1e-2}
[[stage]]
duration = 1
"""


def result(folder, file="result.json"):
    return json.loads(Path(folder, file).read_text())


def keys(said):
    """{key: number} of the lines to paste."""
    return {key: float(number) for key, number in re.findall(r"^strength\.(\w+) = (\S+)$", said, re.M)}


def calibrate(text, *options, name="body.toml", **more):
    return vbond("calibrate", write(name, text), *options, **more)


def test_both_strengths_are_hit_and_the_case_has_them(work):
    said = calibrate(ROCK, "--tensile", "9 MPa", "--compressive", "70 MPa", "-o", "both").silent()
    assert set(keys(said.out)) == {"tension_limit", "cohesion"} and "[[bonds]]  # cement" in said.out
    # what is printed, put into the case, is what vbond test finds there
    text = ROCK.replace('"40 MPa"', str(keys(said.out)["tension_limit"])).replace('"100 MPa"', str(keys(said.out)["cohesion"]))
    write("found.toml", text)
    found = result("both")
    last = found["evaluations"][-1]
    assert found["end"] == "reached" and found["nearest"]["evaluation"] == len(found["evaluations"]) - 1
    for kind, name, asked in (("tension", "tensile", 9e6), ("compression", "compressive", 70e6)):
        vbond("test", kind, "found.toml", "-o", f"found.{kind}")
        test = result(f"found.{kind}")
        assert test["strength"] == last[name] and abs(test["strength"] / asked - 1) <= 0.01
        assert found["nearest"][kind]["E"] == test["E"] and f"E {test['E']:.6g} Pa" in said.out
    # the folder of a test is one of vbond test, whose command stands in it
    command = Path("both", last["folders"][0], "test.toml").read_text().splitlines()[0]
    assert command.startswith("# Made by vbond test tension body.toml --set bonds[0].strength.tension_limit=") or \
        command.startswith("# Made by vbond test tension body.toml --set 'bonds[0].strength.tension_limit=")
    assert found["tests"] == sum(len(e["folders"]) for e in found["evaluations"]) == 2 * len(found["evaluations"])
    assert f"{found['tests']} tests, in both" in said.out
    # the same command takes over what is there; a test that was not complete is made again
    before = {path: path.stat().st_mtime_ns for path in Path("both").glob("*/run/run.json")}
    status = Path("both", last["folders"][1], "run/status.json")
    status.write_text(status.read_text().replace('"complete"', '"interrupted"'))
    again = calibrate(ROCK, "--tensile", "9 MPa", "--compressive", "70 MPa", "-o", "both")
    after = {path: path.stat().st_mtime_ns for path in Path("both").glob("*/run/run.json")}
    assert again.out == said.out and {path.parts[1] for path in before if before[path] != after[path]} == {last["folders"][1]}


def test_going_on_is_for_the_same_command_and_case(work):
    asked = ("--tensile", "9 MPa", "-o", "once")
    calibrate(ROCK, *asked)
    kept = {path: path.read_bytes() for path in Path("once").rglob("*") if path.is_file()}
    calibrate(ROCK, "--tensile", "8 MPa", "-o", "once", status=2, err=["once already exists", "this one is of: vbond calibrate body.toml", "--tensile '9 MPa'"])
    calibrate(ROCK.replace("35 deg", "30 deg"), *asked, status=2, err=["the test in once/01-tension is of another case", "body.toml"])
    assert {path: path.read_bytes() for path in Path("once").rglob("*") if path.is_file()}.keys() == kept.keys()
    Path("other").mkdir()
    Path("other/mine").write_text("")
    calibrate(ROCK, "--tensile", "9 MPa", "-o", "other", status=2, err=["other already exists and is not empty"])


@pytest.mark.parametrize("option, name, asked", [("--tensile", "tensile", "9.3 MPa"), ("--compressive", "compressive", "110 MPa")])
def test_one_strength_is_one_common_factor_and_few_tests(work, option, name, asked):
    said = calibrate(ROCK, option, asked, "-o", name)
    found = result(name)
    last = found["evaluations"][-1]
    assert last["factors"]["tension"] == last["factors"]["shear"] and found["ratios"] is None
    assert abs(last[name] / (float(asked.split()[0]) * 1e6) - 1) <= 0.01
    # similarity is good to the strains at the peak: 7e-4 in tension, 5e-3 in compression, where a third test may be needed
    assert found["tests"] == 2 if name == "tensile" else 2 <= found["tests"] <= 3
    limits = keys(said.out)
    assert limits["cohesion"] == pytest.approx(2.5 * limits["tension_limit"], rel=1e-5)  # each has 6 digits
    assert [folder[3:] for folder in last["folders"]] == ["tension" if name == "tensile" else "compression"]


def test_a_ratio_beyond_reach_is_refused_with_the_nearest(work):
    said = calibrate(ROCK.replace("moment_share = 0.1", "moment_share = 0.5"), "--tensile", "9 MPa", "--compressive", "900 MPa", "-o", "beyond", status=1,
                     err=["compressive over tensile strength = 100 cannot be had", "ratios from", "moment_share (now 0.5)", "gap_factor",
                          "flat_joint", "the nearest that was found takes"])
    found = result("beyond")
    ratios = [e["ratio"] for e in found["evaluations"] if e["ratio"]]
    assert found["end"] in ("out of reach", "no strength") and found["ratios"] == [min(ratios), max(ratios)]
    assert found["evaluations"][found["nearest"]["evaluation"]]["ratio"] == max(ratios)
    assert f"ratio {max(ratios):.4g}" in said.out and keys(said.out)
    assert "cannot be had" in found["failure"]


def test_a_lattice_by_its_formula(work):
    # Strength in tension: the limit of all bonds along the axis, E = 1, whole section. 6 digits of limits, and balances to 1e-9.
    said = calibrate(BAR, "--tensile", "2.5e-3", "-o", "bar", "--within", "1e-4")
    limits = keys(said.out)
    assert limits["tension"] == pytest.approx(2.5e-3, rel=1e-4) and limits["shear"] == pytest.approx(2.5e-2, rel=1e-4)
    assert "Pa" not in said.out


def test_compression_goes_with_shear(work):
    said = calibrate(BAR.replace("shear = 1e-2", "shear = 1e-2, compression = 4e-3"), "--tensile", "2e-3", "--compressive", "4e-3", "-o", "crushed")
    limits = keys(said.out)
    assert limits["compression"] == pytest.approx(0.4 * limits["shear"], rel=1e-5)
    # columns bear their own limit: 2e-3 in tension, 4e-3 in compression
    assert limits["tension"] == pytest.approx(2e-3, rel=0.01) and limits["compression"] == pytest.approx(4e-3, rel=0.02)


def test_in_motion_each_test_finds_its_strain(work):
    # the peak is at a strain of some 5e-3: less than a tenth of 0.08, while the ends set in
    calibrate(ROCK, "--compressive", "120 MPa", "--motion", "--strain", "0.08", "-o", "moving", "--within", "0.02")
    found = result("moving")
    assert found["end"] == "reached" and not found["at_rest"]
    assert found["evaluations"][0]["folders"] == ["01-compression", "01-compression-2"]
    first, last = result("moving/01-compression"), result(Path("moving", found["evaluations"][-1]["folders"][-1]))
    assert first["end_strain"] == 0.08 and first["strength"] is None
    assert last["inertia"]["quasi_static"] and 0.2 < last["peak"]["strain"] / last["end_strain"] < 0.7
    assert last["strength"] == found["evaluations"][-1]["compressive"]


def test_tests_without_a_strength_are_never_used(work):
    # limits that no strain of 0.02 reaches
    strong = ROCK.replace('"40 MPa"', '"40 GPa"').replace('"100 MPa"', '"100 GPa"')
    said = calibrate(strong, "--tensile", "9 MPa", "-o", "strong", status=1,
                     err=["a test has no strength", "tension: no peak within the strain of 0.02", "--strain"])
    found = result("strong")
    assert found["end"] == "no strength" and found["nearest"] is None and not keys(said.out)
    assert found["evaluations"][0]["tensile"] is None
    # far too fast, by order and by itself
    calibrate(ROCK, "--tensile", "9 MPa", "--motion", "--rate", "20", "--strain", "0.001", "-o", "fast", status=1, err=["not quasi-static", "--rate"])
    assert result("fast")["evaluations"][0]["folders"] == ["01-tension"] and result("fast/01-tension")["strength"] > 0


def test_in_motion_what_is_too_fast_is_made_slower(work):
    # in so small a body the first bonds that break set waves free: whether slower is slow enough is a matter of chance
    calibrate(ROCK, "--tensile", "9 MPa", "--motion", "--strain", "0.001", "-o", "waves", "--within", "0.05", status=(0, 1))
    found = result("waves")
    tests = [result(f"waves/{folder}") for folder in found["evaluations"][0]["folders"]]
    assert len(tests) > 1 and not tests[0]["inertia"]["quasi_static"]
    by_default, slower = tests[0], tests[-1]  # by default the rate goes with the strain at the end
    assert round(by_default["strain_rate"] / slower["strain_rate"] * slower["end_strain"] / by_default["end_strain"], 1) in (3, 9, 27)
    assert (found["evaluations"][0]["tensile"] is not None) == slower["inertia"]["quasi_static"]


@pytest.mark.parametrize("changes, options, told", [
    ([("strength = .*\n", "")], [], ["body.toml:LINE:", "no bonds have a strength", "criterion"]),
    ([("strength = .*\n", 'strength = {criterion = "elongation", elongation = 1e-3}\n')], [],
     ["body.toml:LINE:", 'the strength of bonds "cement" has no limits of stress', "mohr-coulomb"]),
    ([(r"\[\[specimen\]\]", "[cell]\na = [0.02, 0, 0]\nb = [0, 0.02, 0]\nc = [0, 0, 0.02]\n[[specimen]]"), ("vessel = .*\n", "")], [],
     ["body.toml", "the body has a periodic cell", "leave [cell] out"]),
    ([], ["--tensile=-9 MPa"], ["--tensile -9 MPa", "must be > 0"]),
    ([], ["--compressive", "0"], ["--compressive 0", "must be > 0"]),
    ([], ["--compressive", "nan"], ["--compressive nan"]),
    ([], ["--compressive", "200 mm"], ["--compressive 200 mm", "force/length^2"]),
    ([], ["--within", "0"], ["--within 0", "1e-4 to 0.5"]),
    ([], ["--axis", "y", "--depth", "1 m"], ["--depth"]),
])
def test_wrong_input_is_told_and_writes_nothing(work, changes, options, told):
    text = ROCK
    for pattern, new in changes:
        text, n = re.subn(pattern, new, text)
        assert n
    write("body.toml", text)
    asked = [] if any("tensile" in word for word in options) else ["--tensile", "9 MPa"]
    vbond("calibrate", "body.toml", *asked, *options, "-o", "refused", status=2,
          err=[word.replace("LINE", str(line_of("body.toml", "[[bonds]]"))) for word in told])
    assert not Path("refused").exists()


def test_options_that_do_not_go_together(work):
    write("body.toml", ROCK)
    for options in (["--tensile", "9 MPa", "--E", "70 GPa"], ["--tensile", "9 MPa", "--bending", "area"], ["--compressive", "1 MPa", "--nu", "0.2"]):
        vbond("calibrate", "body.toml", *options, status=2, err=["excludes"])
    vbond("calibrate --tensile 9", status=2, err=["CASE"])
    for options in (["--motion"], ["-o", "there"], ["--within", "0.1"], ["--threads", "1"]):
        vbond("calibrate", "body.toml", "--E", "70 GPa", "--nu", "0.2", *options, status=2, err=["give --tensile or --compressive or --toughness"])
    vbond("calibrate", "body.toml", "--E", "70 GPa", "--nu", "0.2", status=2, err=["no periodic cell", "a cell of the same grains", "vbond homogenise"])
    reduced = write("reduced.toml", BAR)
    vbond("calibrate", reduced, "--tensile", "9 MPa", status=2, err=["reduced units", "bare number"])
    assert not Path("reduced.calibrate").exists()

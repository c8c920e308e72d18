"""`vbond test bend3 --notch`: what the notch leaves out, K by its formula against energies, work of fracture, what is refused."""
import json
import math
import re
from pathlib import Path

import pytest
from program import STATICS, expect_same, line_of, table, vbond, write

pytestmark = pytest.mark.skipif(not STATICS, reason="tests at rest need statics")


# Bonds are square rods that fill the lattice, so that it is an isotropic body with E = 1, nu = 0 and G = E/2: c_A = E a, and of
# shear c_D = 12 E J/a^3 = E a, of which particles that turn freely leave half.
def beam(n, strength="", more=""):
    return f"""
[[specimen]]
name = "beam"
kind = "block"
cells = [{4 * n + 5}, 1, {n}]
spacing = 1.0
radius = 0.5
mass = 1.0
[[bonds]]
name = "rods"
distance = 1.1
theory = "bernoulli-euler"
E = 1.0
nu = 0.0
section = {{shape = "square", side = 1.0}}
{strength}
{more}[[stage]]
duration = 1
"""


BRITTLE = 'strength = {criterion = "stress", tension = 1e-4, shear = 1e-3}'
BONDS = 8 * 36 + 7 * 37  # of the beam with n = 8: along and across


def notched(text, folder, *more, notch="50 %"):
    write("beam.toml", text)
    said = vbond("test bend3 beam.toml --axis x --notch", notch, "-o", folder, *more)
    return said, json.loads(Path(folder, "result.json").read_text())


def shape(x):
    return math.sqrt(x) * (1.99 - x * (1 - x) * (2.15 - 3.93 * x + 2.7 * x * x)) / ((1 + 2 * x) * (1 - x)**1.5)


def energy_over_formula(n):
    """G of two depths that are a bond apart, by the energies of both bodies, over the mean of K^2/E between them."""
    shallow, deep = (notched(beam(n), f"grid_{n}_{k}", notch=str(k))[1]["notch"] for k in (n // 2 - 1, n // 2))
    assert (shallow["depth"], deep["depth"], deep["left_out"]) == (n // 2 - 1, n // 2, n // 2)
    # at a given force G = F^2/(2 B) dC/da with the compliance C: the change of the potential energy
    G = (deep["compliance"] - shallow["compliance"]) / 2
    K2 = [(shallow["K_per_force"] * shape((shallow["depth"] + x) / n) / shape(shallow["share"]))**2 for x in (0, 0.5, 1)]
    return 6 * G / (K2[0] + 4 * K2[1] + K2[2])  # the mean over the bond, by Simpson's rule


def test_formula_and_depth_are_those_of_the_energy(work):
    # A lattice is a continuum to the order of spacing over depth: errors are 0.106, 0.049, 0.019 and 0.003 with 8, 16, 32 and 64
    # rows. They tend to -0.013, so that the formula is 0.7 % above at half of the height. The next order is 0.4/n of the error: 0.006 of what 8 and 16 rows tend to. A depth that is off by
    # half a bond would be 17 % of G with 16 rows.
    coarse, fine = energy_over_formula(8) - 1, energy_over_formula(16) - 1
    assert 0 < fine < 0.9 / 16 and 1.8 < coarse / fine < 2.4  # first order
    assert abs(2 * fine - coarse + 0.013) < 0.01


def test_notch_leaves_out_bonds_and_nothing_else(work):
    said, r = notched(beam(8), "plain")
    n = r["notch"]
    assert (n["left_out"], n["stay"], n["depth"], n["ligament"], n["plane"]) == (4, 4, 4, 4, 17.5)
    assert r["length"] == 32 and r["strength"] is None and r["E"] is None and r["K_Ic"] is None
    # the load is above 18, the moment there F S/4: at the plane of the notch it is smaller by half a spacing of 16
    assert n["K_per_force"] == pytest.approx(6 * 8 * (15.5 / 16) / 64 * math.sqrt(8) * shape(0.5), rel=1e-12)
    assert table("plain/run")[0]["bonds"] == BONDS - 4
    said.expect(out=["notch", "depth 4, 0.5 of the height; 4 bonds left out, 4 stay"])
    # a depth between two rows is that of the notch itself; the case of the test gives the same tables by itself
    assert notched(beam(8), "between", notch="4.4")[1]["notch"] == n
    vbond("run plain/test.toml -o again")
    expect_same("plain/run", "again")


def test_no_later_set_bonds_what_is_left_out(work):
    # a set that reaches farther takes all pairs that those before it have left; diagonals cross the plane halfway between rows
    second = '[[bonds]]\nname = "diagonals"\ndistance = 1.5\nstiffness = {c_A = 0.1, c_D = 1e-3, c_B = 1e-3, c_T = 1e-3}\n'
    _, r = notched(beam(8, more=second), "two_sets", notch="4.2")
    assert (r["notch"]["left_out"], r["notch"]["stay"], r["notch"]["depth"]) == (4 + 2 * 4, 4 + 2 * 3, 4.25)
    assert table("two_sets/run")[0]["bonds"] == BONDS + 2 * 7 * 36 - 12
    # a part of the pairs, chosen by chance: the same but for the notch
    some = beam(8).replace("distance = 1.1", "distance = 1.1\nshare = 0.97")
    _, r = notched(some, "some")
    vbond("check beam.toml")
    whole = vbond("test bend3 beam.toml --axis x --span 32 -o whole")
    assert table("some/run")[0]["bonds"] == table("whole/run")[0]["bonds"] - r["notch"]["left_out"], whole


def test_flat_joints_are_left_out_whole(work):
    joint = beam(8).replace('theory = "bernoulli-euler"\nE = 1.0\nnu = 0.0\nsection = {shape = "square", side = 1.0}',
                            'theory = "parallel"\nk_n = 1.0\nk_s = 0.4\nsection = {shape = "circle", diameter = 1.0}\n'
                            'flat_joint = {radial = 1, around = 4}\n'
                            'strength = {criterion = "mohr-coulomb", tension_limit = 1e-4, cohesion = 1e-3, friction_angle = 0.5}')
    _, r = notched(joint, "joints")
    assert (r["notch"]["left_out"], r["notch"]["stay"]) == (4, 4) and table("joints/run")[0]["bonds"] == 4 * (BONDS - 4)
    assert r["K_Ic"] > 0


def test_toughness_and_work_of_fracture(work):
    said, r = notched(beam(8, BRITTLE), "broken", "--drop", "0.95", "--E", "1")
    assert r["K_Ic"] == pytest.approx(r["peak"]["force"] * r["notch"]["K_per_force"], rel=1e-12)
    assert r["G_Ic"] == pytest.approx(r["K_Ic"]**2, rel=1e-12) and r["strength"] is None
    assert r["first_break_at"]["place"][0] == pytest.approx(17.5, abs=0.05) and r["fragments"] == 2
    # nothing is left at the end: what breaks took out of the body, by energies, is the work, by forces. Strains are 1e-4, and
    # the force between two balances is straight to some of these.
    last = table("broken/run")[-1]
    assert r["work_of_fracture"] * r["notch"]["ligament"] == pytest.approx(last["released"], rel=1e-4)
    said.expect(out=["fracture toughness K_Ic", "G_Ic = K_Ic^2/E", "work of fracture", "2 fragments"])
    # a test that ends before has a toughness, and no work
    _, early = notched(beam(8, BRITTLE), "early", "--drop", "0.3")
    assert early["K_Ic"] == pytest.approx(r["K_Ic"], rel=1e-9) and early["work_of_fracture"] is None and early["G_Ic"] is None
    assert any("give --drop 0.95" in note for note in early["notes"])
    # E is for the evaluation alone: the same run with another one
    said, again = notched(beam(8, BRITTLE), "broken", "--drop", "0.95", "--E", "2")
    assert again["G_Ic"] == pytest.approx(r["G_Ic"] / 2, rel=1e-12) and again["K_Ic"] == r["K_Ic"]
    said.expect(out="is evaluated")


def test_toughness_goes_with_all_limits(work):
    # linear as the body is: with limits three times as large K is three times as large, to the strains at the peak, some 1e-4 and less
    text = beam(8, 'strength = {criterion = "stress", tension = 1e-5, shear = 1e-4}')
    (_, low), (_, high) = notched(text, "low"), notched(text.replace("1e-5", "3e-5").replace("1e-4", "3e-4"), "high")
    assert high["K_Ic"] / low["K_Ic"] == pytest.approx(3, rel=1e-4)


@pytest.mark.parametrize("change, options, told", [
    (None, ["--notch", "8"], ["--notch 8 of a beam 8 high", "ends in the beam"]),
    (None, ["--notch", "7.9"], ["parts the beam"]),
    (None, ["--notch", "0.3"], ["no bond crosses it", "0.5 from the stretched side", "give a deeper notch"]),
    (None, ["--notch", "1"], ["0.125 of the height", "from 0.2 to 0.8 of the height"]),
    (None, ["--notch", "120 %"], ["--notch 120 %", "must be > 0 % and < 100 %"]),
    (None, ["--notch", "3 mm"], ["--notch 3 mm", "reduced units"]),
    (None, ["--notch=-2"], ["--notch -2", "must be > 0"]),
    (None, ["--notch", "50 %", "--span", "26"], ["3.25 heights", "a span of 4 heights"]),
    (None, ["--E", "1"], ["--notch"]),
    (("cells = .*", "cells = [28, 1, 8]"), ["--notch", "50 %"], ["the span of a notched beam is 4 heights, 32", "28 long along x"]),
    (("distance = 1.1", "distance = 1.1\nwhen = \"approach\""), ["--notch", "50 %"], ["beam.toml:"]),
    ((r"\[\[stage\]\]", '[[bonds]]\nname = "later"\nwhen = "approach"\ndistance = 1.05\nstiffness = {c_A = 1, c_D = 1, c_B = 1, c_T = 1}\n[[stage]]'),
     ["--notch", "50 %"], ["beam.toml:LINE:", 'bonds "later" are made on approach', "bonded again"]),
])
def test_refused(work, change, options, told):
    write("beam.toml", beam(8), *([change] if change else []))
    line = str(line_of("beam.toml", 'name = "later"') - 1) if change and "later" in change[1] else ""
    vbond("test bend3 beam.toml --axis x -o nothing", *options, status=2, err=[text.replace("LINE", line) for text in told])
    assert not Path("nothing").exists()


def test_other_tests_take_no_notch(work):
    write("beam.toml", beam(8))
    vbond("test tension beam.toml --axis x --notch 4 -o nothing", status=2, err=["--notch 4", "is for bend3"])
    write("si.toml", beam(8).replace("\n[[specimen]]", '\n[units]\nsystem = "SI"\n[[specimen]]', 1))
    vbond("test bend3 si.toml --axis x --notch", "4 MPa", "-o nothing", status=2, err=["--notch 4 MPa", "must be a length"])
    assert not Path("nothing").exists()


# ---- limits for a toughness -----------------------------------------------------------------------------------------
def calibrate(folder, *options, text=None, **more):
    write("beam.toml", text or beam(8, BRITTLE))
    said = vbond("calibrate beam.toml --axis x -o", folder, *options, **more)
    return said, json.loads(Path(folder, "result.json").read_text()) if Path(folder).exists() else None


def test_limits_for_a_toughness(work):
    said, found = calibrate("alone", "--toughness", "5e-4", "--within", "1e-3")
    last = found["evaluations"][-1]
    assert found["end"] == "reached" and last["toughness"] == pytest.approx(5e-4, rel=1e-3) and last["tensile"] is None
    assert last["factors"]["tension"] == last["factors"]["shear"] and found["tests"] == 2
    assert [folder[3:] for folder in last["folders"]] == ["bend3"]
    said.expect(out=["fracture toughness 0.0005", "toughness\n", "strength.tension = "])
    # what is printed, put into the case, has it
    limit = re.search(r"strength.tension = (\S+)", said.out)[1]
    shear = re.search(r"strength.shear = (\S+)", said.out)[1]
    _, r = notched(beam(8, f'strength = {{criterion = "stress", tension = {limit}, shear = {shear}}}'), "found")
    assert r["K_Ic"] == last["toughness"]
    again, _ = calibrate("alone", "--toughness", "5e-4", "--within", "1e-3")
    assert again.out == said.out


def test_toughness_and_strength_go_together_or_are_refused_by_grains(work):
    # A lattice bears the limit of its bonds in tension over the whole section: T = 1e-4. Its K is that of the test.
    text = beam(8, BRITTLE).replace(", 1, 8]", ", 2, 8]")  # ends are faces
    K = notched(text, "as_it_is")[1]["K_Ic"]
    _, both = calibrate("both", "--tensile", "2e-4", "--toughness", str(2 * K), text=text)
    last = both["evaluations"][-1]
    assert both["end"] == "reached" and last["tensile"] == pytest.approx(2e-4, rel=0.01) and last["toughness"] == pytest.approx(2 * K, rel=0.01)
    # three times the ratio: grains nine times as large
    said, refused = calibrate("refused", "--tensile", "2e-4", "--toughness", str(6 * K), text=text, status=1)
    assert refused["end"] == "grains" and [e["toughness"] is None for e in refused["evaluations"]] == [True, True, False]
    assert refused["nearest"]["evaluation"] == 2 and refused["evaluations"][2]["folders"] == ["03-bend3"]
    told = re.search(r"grains (\S+) times as large", said.err)
    assert float(told[1]) == pytest.approx(9, rel=0.01)
    said.expect(status=1, err=["does not go with the tensile strength", "root of the grain size", "the nearest that was found takes"])


def test_larger_grains_are_as_told(work):
    # The same lattice with everything twice as large, its bonds being of the same material: K goes with the root, T not at all.
    large = beam(8, BRITTLE).replace("spacing = 1.0", "spacing = 2.0").replace("radius = 0.5", "radius = 1.0").replace("distance = 1.1", "distance = 2.2")
    large = large.replace("side = 1.0", "side = 2.0")
    (_, one), (_, two) = notched(beam(8, BRITTLE), "one"), notched(large, "two")
    assert two["K_Ic"] / one["K_Ic"] == pytest.approx(math.sqrt(2), rel=1e-6)


@pytest.mark.parametrize("options, told", [
    (["--toughness=-1"], ["--toughness -1", "must be > 0"]),
    (["--toughness", "1 MPa m^0.5"], ["reduced units", "bare number"]),
    (["--toughness", "1e-3", "--notch", "9"], ["--notch 9 of a beam 8 high"]),
    (["--notch", "3"], ["--toughness"]),
    (["--toughness", "1e-3", "--E", "1"], ["excludes"]),
])
def test_wrong_toughness_writes_nothing(work, options, told):
    calibrate("nothing", *options, status=2, err=told)
    assert not Path("nothing").exists()


def test_toughness_has_its_unit(work):
    text = beam(8, BRITTLE).replace("\n[[specimen]]", '\n[units]\nsystem = "SI"\n[[specimen]]', 1)
    for wrong in ("2 MPa", "2 MPa m", "2 m^0.5"):
        calibrate("nothing", "--toughness", wrong, text=text, status=2, err=[f"--toughness {wrong}", "must be a fracture toughness", "MPa m^0.5"])
    assert not Path("nothing").exists()

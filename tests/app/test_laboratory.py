"""`vbond test` as a user meets it: moduli and strengths against formulas, the case it makes, what is refused, motion."""
import json
import math
import re
import subprocess
import sys
from pathlib import Path

import pytest
from program import EXAMPLES, HERE, PROGRAM, expect_same, table, vbond, write

BAR = """
[[specimen]]
name = "bar"
kind = "block"
cells = [4, 4, 10]
spacing = 1.0
radius = 0.5
mass = 1.0
[[bonds]]
distance = 1.1
stiffness = {c_A = 1.0, c_D = 0.3, c_B = 0.08, c_T = 0.05}
strength = {criterion = "linear", axial_force = 1e-3, shear_force = 1, bending_moment = 1, torque = 1}
[[stage]]
duration = 1
"""
# Bonds are square rods that fill the lattice: c_A = E, c_B = E/12 with a = 1. A beam of such rods has exactly the second
# moment of the whole section: n^2 rods at their distances and each about its own axis.
BEAM = BAR.replace("cells = [4, 4, 10]", "cells = [42, 3, 4]").replace(
    "stiffness = {c_A = 1.0, c_D = 0.3, c_B = 0.08, c_T = 0.05}",
    'theory = "bernoulli-euler"\nE = 1.0\nnu = 0.0\nsection = {shape = "square", side = 1.0}')
DISC = BAR.replace("cells = [4, 4, 10]", """cells = [13, 3, 13]
cut = [{cylinder = {from = [6, -1, 6], to = [6, 9, 6], radius = 6.2}, keep = "inside"}]""")


def test_case(kind, text, *more, folder="out", **options):
    write("body.toml", text)
    said = vbond("test", kind, "body.toml", "-o", folder, *more, **options)
    return said, json.loads(Path(folder, "result.json").read_text())


test_case.__test__ = False


def near(x, y, tolerance):
    return abs(x / y - 1) <= tolerance


def test_tension_of_a_cubic_lattice(work):
    # Bonds along the axis bear all: E = c_A/a; they break together where N = c_A (D - a) is the strength, 1e-3. The
    # strain of the stage is 1e-7, and V-model and EVM are linear along a bond: nothing but rounding, 1e-16/1e-7, is left.
    said, r = test_case("tension", BAR)
    assert near(r["E"], 1, 1e-7) and near(r["E_by_ends"], 1, 1e-7) and abs(r["nu"]) < 1e-6
    assert near(r["strength"], 1e-3, 1e-9) and near(r["first_break"]["stress"], 1e-3, 1e-9) and near(r["peak"]["strain"], 1e-3, 1e-9)
    assert r["breaks_before_peak"] == 0 and r["section"]["area"] == 16 and r["length"] == 9
    said.expect(out=["tensile strength", "section box 4 x 4", "case in out/test.toml"])


def test_poissons_ratio_of_a_lattice(work):
    # face-centred along its axes, bonds of c_A alone but for a little: C11 = 2 C12 (Cauchy), so nu = C12/(C11 + C12) = 1/3
    # and E = C11 - 2 C12^2/(C11 + C12), with C11 = sqrt(2) c_A/a. Area and length are those of the lattice: no surface
    # layer is complete, so that a body of n cells has E too small by some 1/n; the gauge's nu hangs on it too.
    text = BAR.replace("strength", "# strength").replace("cells = [4, 4, 10]", 'lattice = "fcc"\ncells = [6, 6, 9]')
    text = text.replace("c_D = 0.3, c_B = 0.08, c_T = 0.05", "c_D = 1e-4, c_B = 1e-4, c_T = 1e-4")
    _, r = test_case("tension", text, "--area", str((6 * math.sqrt(2)) ** 2), folder="fcc")
    assert near(r["E"], math.sqrt(2) * (1 - 1 / 3), 0.12) and near(r["nu"], 1 / 3, 0.12)


def test_compression_is_tension_backwards(work):
    _, r = test_case("compression", BAR, "--strain", "1e-4", folder="pressed")
    assert near(r["E"], 1, 1e-7) and r["strength"] is None and r["breaks"] == 0
    assert "no peak within the strain of 0.0001" in r["notes"][-1] and near(r["largest"]["stress"], 1e-4, 1e-3)


def test_bending_of_a_beam(work):
    # E of the slender formula lacks shear: 12 E I/(kappa G A S^2) = 12 h^2/(12 S^2) E/(kappa G); for a row of bonds c_D = 12 E J/a^3
    # and all of it is E: between 0 and 3 h^2/S^2 of nu = 0.25, which the note tells.
    said, r = test_case("bend3", BEAM, "--axis", "x", folder="bent")
    span, height = r["length"], r["height"]
    assert span == 39 and height == 4 and 1 - 3 * (height / span) ** 2 < r["E"] < 1
    # the outermost rods bear c/h' of the outer fibre's stress: their middles are at 1.5 of 2; the rod's own bending adds
    # nothing to its axial force. Where the load is put in, forces are off by some percent.
    assert near(r["strength"], 1e-3 * 2 / 1.5, 0.05)
    said.expect(out=["modulus of rupture", "span 39", "span over height"])


def test_disc_splits_along_its_diameter(work):
    said, r = test_case("brazilian", DISC, "--axis", "y", "--drop", "0.3", folder="split")
    assert 12 < r["length"] < 14 and r["thickness"] == 3
    assert near(r["stress_per_force"], 2 / (math.pi * r["length"] * r["thickness"]), 1e-12)
    assert r["splitting"]["mean_from_plane"] < 0.36 and r["splitting"]["in_tension"] == 1
    # All 22 bonds of the diameter break at the load of the first, and take more than a tenth of it. Later the halves bear more.
    assert near(r["strength"], r["first_break"]["stress"], 1e-9) and r["breaks_before_peak"] == 0
    assert r["first_break_at"]["mode"] == "tension" and r["largest"]["stress"] > 1.3 * r["strength"]
    assert any("its parts are pressed on" in note for note in r["notes"])
    said.expect(out=["Brazilian tensile strength", "splitting", "platens hold the disc over"])
    assert not any("no tensile strength" in note for note in r["notes"])


def test_the_peak_of_a_disc_that_cracks_before_it_is_no_strength(work):
    # Strengths of Weibull's modulus 2: bonds break all over the disc from a third of the peak on, and it bears on.
    text = DISC.replace("torque = 1}", "torque = 1, weibull = {modulus = 2, seed = 1}}")
    said, r = test_case("brazilian", text, "--axis", "y", "--drop", "0.3", folder="cracked")
    assert r["strength"] == r["peak"]["stress"] > 2 * r["first_break"]["stress"]
    note = next(note for note in r["notes"] if "the peak is no tensile strength" in note)
    assert "come below 0.8 of it, the first at" in note and "its largest fragment has" in note
    said.expect(out=["2 P/(pi D L) at the peak", ": no tensile strength, see the notes"])
    assert "Brazilian tensile strength" not in said.out


def cylinder(n, radius, more=""):
    c = (n - 1) / 2
    cut = f'{{cylinder = {{from = [{c}, {c}, -1], to = [{c}, {c}, 20], radius = {radius}}}, keep = "inside"}}'
    return BAR.replace("cells = [4, 4, 10]", f"cells = [{n}, {n}, 10]\ncut = [{cut}{more}]")


@pytest.mark.parametrize("n, radius, columns", [(5, 2.3, 21), (7, 3.3, 37), (11, 5.3, 89)])
def test_section_of_a_round_lattice(work, n, radius, columns):
    # Each column bears 1 a^2, and all of them are the true section. Its rim goes in steps of a spacing: half of one at each
    # side of a circle is the most that its diameter can be off.
    _, r = test_case("tension", cylinder(n, radius), folder=f"round_{n}")
    true = math.sqrt(4 * columns / math.pi)
    assert abs(r["section"]["extent"][0] - true) < 0.5
    assert near(r["E"] * r["section"]["area"], columns, 1e-6)
    assert any("the circle has steps" in note for note in r["notes"])


@pytest.mark.parametrize("radius, told", [(0.35, "longer than the radii"), (0.55, "shorter than the radii")])
def test_radii_that_are_not_half_of_the_spacing(work, radius, told):
    _, r = test_case("tension", BAR.replace("radius = 0.5", f"radius = {radius}"), folder=f"other_{radius}")
    assert near(r["section"]["area"], 16, 1e-9) and near(r["E"], 1, 1e-7) and near(r["strength"], 1e-3, 1e-9)
    assert any(told in note for note in r["notes"])
    _, beam = test_case("bend3", BEAM.replace("radius = 0.5", f"radius = {radius}").replace("strength", "# strength"), "--axis", "x",
                        folder=f"beam_{radius}")
    assert near(beam["height"], 4, 1e-9) and near(beam["section"]["area"], 12, 1e-9)


def test_deep_ends(work):
    # two layers at each end are held: what strains is between the inner ones, 9 of 11 bonds, each by 1e-3
    _, r = test_case("tension", BAR.replace("[4, 4, 10]", "[4, 4, 12]"), "--depth", "1.6", folder="deep")
    assert r["length"] == 9 and near(r["E_by_ends"], 1, 1e-7) and near(r["peak"]["strain"], 1e-3, 1e-6)


def test_ends_that_cover_little(work):
    stud = '[[specimen]]\nname = "stud"\nkind = "block"\ncells = [2, 2, 1]\nspacing = 1.0\nradius = 0.5\nmass = 1.0\norigin = [1, 1, 10]\n'
    _, r = test_case("tension", BAR.replace("[[bonds]]", stud + "[[bonds]]"), folder="stud")
    assert any("the upper end covers 0.5 x 0.5" in note for note in r["notes"])


def test_a_box_that_the_body_does_not_fill(work):
    # Four particles at a corner are missing: those left are at least sqrt(4.75) = 2.18 away from it, and the mean distance is 1.
    bar = BAR.replace("cells = [4, 4, 10]", "cells = [6, 6, 12]").replace("strength", "# strength")
    corner = "\ncut = [{sphere = {centre = [-0.5, -0.5, -0.5], radius = 2}}]"
    for folder, kind, more, told in (("corner", "tension", [], True), ("pressed_corner", "compression", [], True),
                                     ("given_corner", "tension", ["--area", "36"], False)):
        _, r = test_case(kind, bar.replace("[6, 6, 12]", "[6, 6, 12]" + corner), *more, folder=folder)
        notes = [note for note in r["notes"] if "does not fill the box around it" in note]
        assert len(notes) == told and all("--area" in note and "box 6 x 6" in note for note in notes)
    _, r = test_case("tension", bar, folder="no_corner")
    assert not any("fill the box" in note for note in r["notes"])


def test_stress_before_the_test_is_told(work):
    _, r = test_case("tension", BAR.replace("[[stage]]", "prestrain = 5e-4\n[[stage]]"), folder="before")
    assert near(r["stress_before"], 5e-4, 1e-3) and any("bears a stress of 0.00049975 between" in note for note in r["notes"])


def test_buckling_is_no_strength(work):
    # Two particles across and 40 long: it buckles, though its bonds are under prestress first: row 0 is no balance, and bears twice
    # the load at which the column gives way.
    text = BAR.replace("cells = [4, 4, 10]", "cells = [2, 2, 40]").replace("axial_force = 1e-3", "axial_force = 4e-3")
    said, r = test_case("compression", text, "--strain", "0.2", folder="column")
    assert r["strength"] is None and r["peak"] is None and any("it has buckled" in note for note in r["notes"])
    _, pre = test_case("compression", text.replace("[[stage]]", "prestrain = -4e-3\n[[stage]]"), "--strain", "0.2", folder="pre")
    assert pre["largest"]["stress"] < 0.75 * 4e-3
    said.expect(out=["largest stress", "no strength"])


def test_first_break_of_a_beam_in_shear(work):
    _, r = test_case("bend3", BEAM.replace("cells = [42, 3, 4]", "cells = [20, 3, 4]").replace("shear_force = 1,", "shear_force = 5e-5,"),
                     "--axis", "x", folder="weak_in_shear")
    assert r["first_break_at"]["mode"] == "shear" and any("the first bond breaks in shear" in note for note in r["notes"])


def test_what_is_left_out_is_told(work):
    _, r = test_case("tension", BAR.replace("[[stage]]", "[[stage]]\ngravity = [0, 0, -1e-4]"), "--strain", "1e-4", folder="heavy")
    assert any("left out: gravity" in note for note in r["notes"])


def test_too_soon_in_motion(work):
    # the strain at which it fails is 1/200 of that at which the test would end: rows are far apart, and the platens set in
    _, r = test_case("tension", BAR.replace("axial_force = 1e-3", "axial_force = 1e-4"), "--motion", folder="soon")
    assert r["strength"] is None and r["E"] is None
    told = next(note for note in r["notes"] if "give --strain" in note)
    strain = re.search(r"give --strain (\S+),", told)[1]
    assert 1e-4 < float(strain) < 4e-4
    _, again = test_case("tension", BAR.replace("axial_force = 1e-3", "axial_force = 1e-4"), "--motion", "--strain", strain, folder="shorter")
    assert near(again["strength"], 1e-4, 0.02) and near(again["E"], 1, 0.02)


def test_a_run_that_is_there_is_evaluated(work):
    _, first = test_case("tension", BAR, folder="kept")
    Path("kept/result.json").unlink()
    said, again = test_case("tension", BAR, folder="kept")
    assert again == first
    said.expect(out="is evaluated")
    vbond("test tension body.toml -o kept --drop 0.2", status=2, err="already exists")
    # nor is the run of another body that of this one
    write("body.toml", BAR.replace("axial_force = 1e-3", "axial_force = 2e-3"))
    vbond("test tension body.toml -o kept", status=2, err="already exists")
    write("body.toml", BAR)
    status = Path("kept/run/status.json")
    status.write_text(status.read_text().replace('"complete"', '"interrupted"'))
    vbond("test tension body.toml -o kept", status=2, err=["is not complete", "vbond resume kept/run"])


def test_shear_of_a_flat_block(work):
    # C of the lattice: particles turn freely, so that C44 = c_D/2 per a; between stiff ends of a flat body most of it shears
    text = BAR.replace("cells = [4, 4, 10]", "cells = [16, 4, 5]").replace("strength", "# strength")
    text = text.replace("c_B = 0.08, c_T = 0.05", "c_B = 1e-6, c_T = 1e-6")
    said, r = test_case("shear", text, folder="sheared")
    assert near(r["G"], 0.15, 0.15)
    said.expect(out=["sheared along x", "no bond has a strength"])


def test_triaxial_counts_from_the_confined_body(work):
    # The upper end moves along the axis as the pressure comes on: no force as the ends begin to slide, and hardly any after
    # it. Bonds between inner layers bear the pressure over the width of the section, 1e-5 on 4: their strain is 1e-5 c_A/a^2;
    # end layers differ, which the gauge sees by some percent. The skin is 3 wide and 9 high, so it gets 4/3 of it, and
    # 4/3 * 9/16 along the axis.
    said, r = test_case("triaxial", BAR, "--pressure", "1e-5", "--strain", "1e-4", folder="confined")
    rows = table("confined/run")
    begin = next(k for k in range(1, len(rows)) if rows[k]["load_factor"] < rows[k - 1]["load_factor"])
    assert abs(rows[begin]["reaction.test_upper.fz"]) < 1e-9 * 16e-5
    assert near(r["E"], 1, 1e-4) and abs(r["nu"]) < 1e-4
    assert near(r["pressure_on_skin"], 4e-5 / 3, 1e-9) and near(r["pressure_along_axis"], 0.75e-5, 1e-9)
    assert near(r["largest"]["stress"], 1e-4 - 0.25e-5, 2e-3)  # up to the strain of the elastic stage, 1e-7
    assert near(-rows[begin - 1]["strain.test_gauge.xx"], 1e-5, 0.02)
    assert near(-rows[begin - 1]["strain.test_gauge.zz"], 0.75e-5, 0.02)
    said.expect(out=["pressure", "on the sides of the section"])


# Grains of the skin hang by few bonds, and come off first.
ROCK = """
[units]
system = "SI"
[[specimen]]
kind = "packing"
vessel = [{box = {min = [0, 0, 0], max = ["9 mm", "9 mm", "18 mm"]}}]
grains = [{radii = ["0.8 mm", "1.2 mm"]}]
jammed = true
density = "2600 kg/m^3"
seed = 3
[[bonds]]
gap_factor = 1.1
theory = "parallel"
k_n = "5e13 Pa/m"
k_s = "2e13 Pa/m"
section = {shape = "circle", factor = 1.0}
[bonds.strength]
criterion = "mohr-coulomb"
tension_limit = "10 MPa"
cohesion = "40 MPa"
friction_angle = "40 deg"
moment_share = 0.2
[[stage]]
duration = 1e-6
"""


def test_a_grain_that_comes_off_the_skin_is_no_failure(work):
    said, result = test_case("triaxial", ROCK, "--pressure", "30 MPa", folder="skin")
    assert "and bears what pressure drives it: translation along x of particle 167," in said.err
    # it came off at 99.8 MPa; the body bears half as much again, with several breaks before
    assert result["peak"]["stress"] > 1.4 * 99.8e6
    assert result["breaks_before_peak"] > 10
    # another piece comes off at last
    assert result["ended"] == "parted"
    assert any("the strength may be larger" in note for note in result["notes"]), result["notes"]


def test_columns_under_pressure_fail_together(work):
    # 25 columns that fail at a stress of 100: a deviator of 80 under a pressure of 20. Layers at the ends get half of the
    # pressure on the sides, which costs less than 2 %. Pressed one by one, columns of the rim would bear half of it, those at
    # edges a quarter, and the inner ones 25 + d when the mean is 16 + d: a deviator of 71 to 75 (72.7 it was).
    text = BAR.replace("cells = [4, 4, 10]", "cells = [5, 5, 11]").replace(
        'criterion = "linear", axial_force = 1e-3, shear_force = 1, bending_moment = 1, torque = 1',
        'criterion = "stress", tension = 1, shear = 1, compression = 1e-3, moment_share = 0').replace(
        "stiffness = {c_A = 1.0, c_D = 0.3, c_B = 0.08, c_T = 0.05}",
        'theory = "parallel"\nk_n = 1.0\nk_s = 0.4\nsection = {shape = "square", side = 1}')
    _, rest = test_case("triaxial", text, "--pressure", "2e-4", folder="columns")
    assert near(rest["strength"], 8e-4, 0.02), rest["strength"]
    _, motion = test_case("triaxial", text, "--pressure", "2e-4", "--motion", "--strain", "3e-3", folder="columns_in_motion")
    # waves and rows of 2 per mille of the way: one percent
    assert near(motion["strength"], rest["strength"], 0.01), motion["strength"]


def test_drop_under_pressure_is_of_the_force(work):
    # The run ends once an eighth of the force is lost. The deviator is that force over the area and a constant, 4 MPa: of it less
    # is lost, and the peak is one all the same.
    body = (EXAMPLES / "rock_core.toml").read_text()
    _, r = test_case("triaxial", body, "--drop", "0.12", "--pressure", "20 MPa", folder="drop")
    assert r["ended"] == "load drop" and r["strength"] == r["largest"]["stress"]
    lost = 1 - table("drop/run")[-1]["reaction.test_lower.fz"] / r["peak"]["force"]
    assert 0.119 < lost and lost * r["peak"]["force"] * r["stress_per_force"] < 0.12 * r["strength"]


def test_envelope_of_two_pressures(work):
    text = BEAM.replace("cells = [42, 3, 4]", "cells = [3, 3, 6]").replace("distance = 1.1", "distance = 1.5")
    text = re.sub("strength = .*",
                  'strength = {criterion = "mohr-coulomb", tension_limit = 1e-4, cohesion = 1e-4, friction_angle = 0.7}', text)
    write("body.toml", text)
    said = vbond("test triaxial body.toml -o both --pressure 0 --pressure 2e-5 --drop 0.2")
    envelope = json.loads(Path("both/result.json").read_text())
    peaks = envelope["peaks"]
    assert [p["s3"] for p in peaks] == [0, 2e-5] and envelope["tests"] == 2
    alone = [json.loads(Path(f"both/pressure-{k}/result.json").read_text()) for k in (1, 2)]
    assert [p["s1"] for p in peaks] == [r["strength"] + r["pressure"] for r in alone]
    N = (peaks[1]["s1"] - peaks[0]["s1"]) / 2e-5  # of a line through two points
    assert N > 1, "pressure makes it stronger"
    line, curve, q = envelope["mohr_coulomb"], envelope["hoek_brown"], [r["strength"] for r in alone]
    assert near(line["slope"], N, 1e-9) and near(line["cohesion"], peaks[0]["s1"] / (2 * math.sqrt(N)), 1e-9)
    assert near(math.sin(math.radians(line["friction_angle_deg"])), (N - 1) / (N + 1), 1e-9)
    assert near(curve["m_i"], (q[1] ** 2 - q[0] ** 2) / 2e-5 / q[0], 1e-9) and near(curve["s_ci"], q[0], 1e-9)
    said.expect(out=["Mohr-Coulomb", "Hoek-Brown", "through two points"])
    _, pressed = test_case("compression", text, "--drop", "0.2", folder="unconfined")
    assert pressed["strength"] == alone[0]["strength"], "without pressure it is a compression"


def test_made_case_runs_by_itself(work):
    test_case("tension", BAR, folder="made")
    made = Path("made/test.toml").read_text()
    assert "[groups.test_upper]" in made and "# bonds break one by one" in made and "duration" not in made
    vbond("check made/test.toml", out="no mistakes found")
    vbond("run made/test.toml -o again")
    expect_same("made/run", "again")


def test_motion_agrees_with_rest(work):
    _, rest = test_case("tension", BAR, "--strain", "2e-3", folder="rest")
    said, motion = test_case("tension", BAR, "--strain", "2e-3", "--motion", folder="motion")
    # waves and rows of 2 per mille of the way: some percent
    assert near(motion["E"], rest["E"], 0.01) and near(motion["strength"], rest["strength"], 0.02)
    assert motion["inertia"]["quasi_static"] and motion["inertia"]["at_peak"] < 0.01
    assert near(motion["first_break"]["stress"], 1e-3, 0.02), "the row before the break"
    _, fast = test_case("tension", BAR, "--strain", "2e-3", "--motion", "--rate", "2e-5", folder="fast")
    assert not fast["inertia"]["quasi_static"] and any("not quasi-static" in note for note in fast["notes"])
    said.expect(out="kinetic energy over work")


def test_moduli_of_a_body_that_cracks_early(work):
    # Strengths of Weibull's modulus 1: half of the bonds that break before the peak do so below half of it, and the slope
    # there is far below E = 1. The strain that is advised has rows of the whole body.
    text = BAR.replace("torque = 1}", "torque = 1, weibull = {modulus = 1, seed = 1}}")
    said, r = test_case("tension", text, "--strain", "2e-3", "--motion", folder="early")
    note = next(n for n in r["notes"] if "a body that cracks" in n)
    assert r["E"] < 0.8 and 0.4 < float(re.search(r"cracks: (\S+) of the breaks", note)[1]) < 0.6
    said.expect(out="E and nu are slopes of a body that cracks")
    _, whole = test_case("tension", text, "--motion", "--strain", re.search(r"--strain (\S+?)\)", note)[1], folder="whole")
    assert near(whole["E"], 1, 0.01) and whole["breaks"] == 0
    _, strong = test_case("tension", BAR, "--strain", "2e-3", "--motion", folder="strong")
    assert not any("cracks" in n for n in strong["notes"])


# c_A = 1 and a = 1: stresses are forces of bonds.
@pytest.mark.parametrize("folder, rule, strength, strain, broken", [
    # the force is u - 20 u^2, and still grows where bonds break: there is no balance after the first
    ("cubic", 'stretching = {form = "cubic", k3 = -20.0, k4 = 0.0}\nstrength = {criterion = "elongation", elongation = 0.02}', 0.012, 0.02, True),
    # 9 bonds in a row let go more energy than softening takes: 2 E G_f / s^2 = 5
    ("softens", 'softening = {tension = 0.002, fracture_energy = 1e-5, section = {shape = "square", side = 1.0}}', 0.002, 0.002, False),
    # Morse: c_A / (4 alpha) at ln 2 / alpha
    ("morse", 'stretching = {form = "morse", alpha = 60.0}\nstrength = {criterion = "elongation", elongation = 0.1}', 1 / 240, math.log(2) / 60, False)])
def test_a_strength_without_a_balance_after_it(work, folder, rule, strength, strain, broken):
    _, r = test_case("tension", re.sub("strength = .*", lambda _: rule, BAR), folder=folder)
    assert near(r["strength"], strength, 1e-6) and near(r["peak"]["strain"], strain, 1e-3)
    assert (r["breaks"] > 0) == broken and (r["first_break"] is not None) == broken
    assert any("lost stability" in n for n in r["notes"]) and not any("it has buckled, and" in n for n in r["notes"])


def test_motion_of_bonds_that_yield_or_creep(work):
    # Beyond 0.002 the slope is that of the bond and its hardening in series, 0.25/1.25: the curve bends where E is measured.
    text = BAR.replace("strength =", "yield = {axial_force = 0.002, isotropic = {axial = 0.25}}\nstrength =").replace("axial_force = 1e-3", "axial_force = 6e-3")
    _, r = test_case("tension", text, "--motion", folder="yields")
    bend = next(n for n in r["notes"] if "a curve that bends" in n)
    first, second = (float(x) for x in re.search(r"from (\S+) to (\S+) between", bend).groups())
    assert near(first, 1, 0.05) and near(second, 0.2, 0.2)
    # A Maxwell bond bears no more than its viscosity times the rate, which the test has chosen.
    text = BAR.replace("strength =", "creep = {viscosity = 200}\nstrength =").replace("axial_force = 1e-3", "axial_force = 0.1")
    said, r = test_case("tension", text, "--motion", "--strain", "0.02", folder="creeps")
    assert near(r["largest"]["stress"], 200 * float(re.search(r"in motion, (\S+) of", said.out)[1]), 0.01)
    assert any("bonds creep" in n and "--rate" in n for n in r["notes"])
    _, r = test_case("tension", BAR, "--motion", "--strain", "2e-3", folder="plain")
    assert not any("bends" in n or "creep" in n for n in r["notes"])


def test_files_of_the_case_go_along(work):
    rows = [f"{x},{y},{z}" for x in range(3) for y in range(3) for z in range(5)]
    write("points.csv", "x,y,z\n" + "\n".join(rows) + "\n")
    text = re.sub('kind = "block"\ncells = .*\nspacing = 1.0', 'kind = "csv"\nfile = "points.csv"', BAR)
    _, r = test_case("tension", text, folder="copied")
    assert near(r["E"], 1, 1e-7)
    vbond("test tension body.toml -o copied", out="is evaluated")
    write("points.csv", "x,y,z\n" + "\n".join(rows[:-1] + ["2,2,4.001"]) + "\n")
    vbond("test tension body.toml -o copied", status=2, err="already exists")
    Path("points.csv").unlink()
    Path("copied").rename("moved")
    vbond("run moved/test.toml -o again_moved")


BOTH = '[[specimen]]\nkind = "rod"\nparticles = 2\norigin = [20, 0, 0]\nmass = 1.0\nradius = 0.5\n'


@pytest.mark.parametrize("kind, change, more, told", [
    ("brazilian", None, [], ["section normal to z is a box", "needs a disc", "--axis"]),
    ("bend3", None, [], ["no beam"]),
    ("bend3", None, ["--axis", "x"], ["no beam"]),
    ("tension", ("cells = .*", "cells = [1, 1, 10]"), [], ["in a row", "--depth"]),
    ("tension", ("cells = .*", "cells = [4, 4, 3]"), [], ["are in one plane, normal to z"]),
    ("tension", ("cells = .*", "cells = [4, 4, 1]"), [], ["the ends meet"]),
    ("tension", ("radius = 0.5", "inertia = 1.0"), [], ["no radius", "--area"]),
    ("tension", (r"^\[\[bonds\]\]", BOTH + "[[bonds]]"), [], ["2 of 162 particles", "floats in parts"]),
    ("tension", (r"^\[\[bonds\]\](.|\n)*(?=\[\[stage)", ""), [], ["no bonds at the start"]),
    ("tension", ("cells = .*", 'cells = [4, 4, 10]\ncut = [{box = {min = [-1, -1, 2.5], max = [1.5, 9, 6.5]}}]'), [],
     ["but not all along the body"]),
    ("tension", (r"^\[\[bonds\]\]", "[groups.test_upper]\nindices = [1]\n[[bonds]]"), [], ["body.toml:", "begin with test_"]),
    ("tension", (r"^\[\[bonds\]\]", "[cell]\na = [4, 0, 0]\nb = [0, 4, 0]\nc = [0, 0, 10]\n[[bonds]]"), [],
     ["periodic cell", "homogenise"]),
    ("tension", None, ["--across", "x"], ["--across x", "leave it out"]),
    ("shear", None, ["--across", "z"], ["is along the axis"]),
    ("tension", None, ["--strain", "1 mm"], ["--strain 1 mm", "bare number"]),
    ("tension", None, ["--drop", "1"], ["must be > 0 and < 1"]),
    ("tension", None, ["--depth", "6"], ["the ends meet"]),
    ("tension", None, ["--depth", "3"], ["the lower end reaches into the middle half"]),
    ("bend3", ("cells = .*", "cells = [42, 3, 4]"), ["--axis", "x", "--depth", "1.6"], ["--depth 1.6 of a beam 4 high"]),
    ("brazilian", ("cells = .*", "cells = [9, 3, 9]\nturn = {axis = [0, 1, 0], angle = 0.7853981633974483}"), ["--axis", "y"],
     ["neither a box nor a circle", "between 9 and 12.3137 across"]),
    ("compression", ("cells = .*", 'cells = [11, 11, 11]\ncut = [{sphere = {centre = [5, 5, 5], radius = 5.3}, keep = "inside"}]'), [],
     ["a circle of diameter 10.7", "but not all along the body", "--area"]),
    ("brazilian", ("cells = .*", 'cells = [11, 11, 11]\ncut = [{sphere = {centre = [5, 5, 5], radius = 5.3}, keep = "inside"}]'),
     ["--axis", "y"], ["but not all along the body", "--axis"]),
    ("tension", ("cells = .*", "cells = [4, 4, 20]\nturn = {axis = [0, 1, 0], angle = 0.0349}"), [],
     ["box 4.66", "but not all along the body", "turn the body along it"]),
    ("tension", ("cells = .*", "cells = [7, 7, 10]\ncut = [{box = {min = [0.5, 0.5, -1], max = [5.5, 5.5, 20]}}]"), [],
     ["box 7 x 7 with a hole", "--area"]),
    ("tension", ('name = "bar"', 'name = "test_upper"'), [], ["body.toml:", "specimen test_upper", "begin with test_"]),
    ("tension", None, ["--strain", "1e-8"], ["--strain 1e-8", "must be > 1e-07"]),
    ("tension", None, ["--span", "6"], ["is for bend3"]),
    ("tension", None, ["--motion", "--rate", "1e-2"], ["no longer than waves", "--rate"]),
    ("tension", (r"^\[\[stage\]\]", "[time]\nstep = 1\n[[stage]]"), ["--motion"], ["body.toml: in the case of the test, "]),
    ("bend3", ("cells = .*", "cells = [42, 3, 4]"), ["--axis", "x", "--span", "50"], ["42 long along x"]),
    ("triaxial", None, [], ["vbond test triaxial", "needs the pressure"]),
    ("triaxial", None, ["--pressure", "-1"], ["--pressure -1", "must be >= 0"]),
    ("triaxial", None, ["--pressure", "1", "--pressure", "1.0"], ["is given already"]),
    ("tension", None, ["--pressure", "1"], ["is for triaxial"]),
])
def test_refused(work, kind, change, more, told):
    write("wrong.toml", BAR, *([change] if change else []))
    vbond("test", kind, "wrong.toml", "-o", "nothing", *more, status=2, err=[text.replace("body.toml", "wrong.toml") for text in told])
    assert not Path("nothing").exists()


def test_folder_is_not_overwritten(work):
    Path("full").mkdir()
    Path("full/mine").write_text("x")
    write("body.toml", BAR)
    vbond("test tension body.toml -o full", status=2, err="already exists and is not empty")
    assert [path.name for path in Path("full").iterdir()] == ["mine"]


def test_random_bodies_against_linear_algebra():
    pytest.importorskip("numpy")
    done = subprocess.run([sys.executable, HERE / "labtest_campaign", PROGRAM, "5", "100"], capture_output=True, text=True)
    assert done.returncode == 0 and ", 0 wrong" in done.stdout.splitlines()[-1], done.stdout + done.stderr
    assert int(re.search(r"(\d+) right", done.stdout.splitlines()[-1])[1]) >= 4, done.stdout

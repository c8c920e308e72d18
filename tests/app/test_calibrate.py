"""`vbond calibrate` against the closed forms of [KA12] eqs. (19), (20), (33) and of the enhanced vector model."""
import re
from math import pi, sqrt

import pytest
from program import vbond


def printed(said):
    """{(theory, line, name): number} of all that calibrate prints."""
    found, theory = {}, None
    for line in said.splitlines():
        cells = line.split()
        if line[:1].isalpha():
            theory = cells[0]
        for name, value in zip(cells[1::2], cells[2::2]):
            found.setdefault((theory, cells[0], name), value)
    return found


def near(said, theory, expected):
    """Eight digits are printed, so that rounding is at most 5e-8 of a number."""
    found = printed(said)
    for line, numbers in expected.items():
        for name, value in numbers.items():
            key = (theory, line, name)
            assert key in found and abs(float(found[key]) / value - 1) < 6e-8, f"{key}: expected {value} in\n{said}"


def test_the_rod_of_the_paper():
    # E a / c_A = 4 / pi (a / d)^2, a = 1, d = 0.2, nu = 0.2. EVM: B2 = a^2 c_D, B3 = c_B - a^2 c_D / 4 - c_T / 2
    near(vbond("calibrate --E 31.830988618379067 --length 1 --diameter 0.2").out, "bernoulli-euler", {
        "v-model": {"B1": 1, "B2": -0.005, "B3": 0.015, "B4": 0.0025 / 1.2},
        "stiffness": {"c_A": 1, "c_D": 0.03, "c_B": 0.0025, "c_T": 0.0025 / 1.2},
        "evm": {"B2": 0.03, "B3": 0.0025 - 0.03 / 4 - 0.0025 / 2.4}})


def test_a_thick_bond_of_steel_by_all_theories():
    # G = E / 2.6, kappa = 6 1.3^2 / (7 + 12 0.3 + 4 0.3^2)
    said = vbond("calibrate --E '200 GPa' --nu 0.3 --length '3 mm' --diameter '2 mm'").out
    A, J, E, a, k = pi * 1e-6, pi / 4 * 1e-12, 2e11, 3e-3, 6 * 1.69 / (7 + 3.6 + 0.36)
    near(said, "bernoulli-euler", {"stiffness": {"c_A": E * A / a, "c_D": 12 * E * J / a**3, "c_B": E * J / a,
                                                 "c_T": E / 2.6 * 2 * J / a}})
    near(said, "timoshenko", {"stiffness": {"c_A": E * A / a, "c_B": E * J / a,
                                            "c_D": 12 * k * A * E * J / (a * (k * A * a**2 + 24 * J * 1.3))}})
    near(said, "short-cylinder", {"v-model": {"B3": E / 2.6 * A * a / 2}, "stiffness": {
        "c_A": 0.7 / (1.3 * 0.4) * E * A / a, "c_D": E / 2.6 * A / a, "c_B": 0.7 / (1.3 * 0.4) * E * J / a}})


def test_a_shell():
    # The triangular sheet of [docs/choosing.md], window glass of 1 mm. Its stiffnesses do not depend on the length,
    # B2 and B3 do: B3 = c_D a^2 / 2.
    said = vbond("calibrate --E '70 GPa' --nu 0.22 --thickness '1 mm' --length '2.5 mm'").out
    glass, across = 70e9 * 1e-3 / (sqrt(3) * 0.78), 0.34 / 1.22
    near(said, "shell", {"v-model": {"B3": glass * across * 2.5e-3**2 / 2}, "stiffness": {
        "c_A": glass, "c_D": glass * across, "c_B": glass * 1e-6 / 12, "c_T": glass * 1e-6 / 12 * across}})
    assert said.count("  stiffness ") == 1, f"with a thickness there is another theory than the shell: {said}"


def test_an_annulus_without_a_hole_is_a_circle():  # also for its shear coefficient
    circle = "calibrate --E 1 --length 1 --diameter 0.2"
    assert vbond(circle).out == vbond(circle, "--inner-diameter", 0).out


def test_a_theory_that_does_not_hold_is_left_out():
    vbond("calibrate --E 1 --nu 0.5 --length 1 --side 0.2", out=["timoshenko  left out", "short-cylinder  left out"])


@pytest.mark.parametrize("options, texts", [
    # a theory that does not hold and was asked for
    ("--E 1 --nu 0.5 --length 1 --side 0.2 --theory short-cylinder", ["--nu 0.5", "1 - 2 nu"]),
    ("--E 1 --length 1 --side 0.2 --theory timoshenko", ["--kappa"]),
    ("--E 1 --nu 0.34 --thickness 1 --length 1", ["--nu 0.34", "1/3"]),
    ("--E 1 --length 1 --theory shell", ["needs --thickness"]),
    # options of another section are refused, not ignored
    ("--E 1 --length 1 --side 0.2 --inner-diameter 0.1 --J 1 --J_p 2",
     ["--inner-diameter 0.1", "given by --diameter", "--J 1", "--J_p 2", "given by --A"]),
    ("--E 1 --length 1 --diameter 0.2 --J 1", ["--J 1"]),
    ("--E 1 --length 1 --diameter 0.2 --inner-diameter -0.1", ["--inner-diameter -0.1", "must be >= 0"]),
    ("--E 1 --length 1 --diameter 0.2 --inner-diameter 0.2", ["must be below --diameter"]),
    ("--E 1 --thickness 1 --diameter 1 --length 1", ["--diameter 1", "theory shell has a thickness"]),
    ("--E 1 --thickness 1 --diameter 1 --length 1 --theory timoshenko", ["--thickness 1", "belongs to --theory shell"])])
def test_refused(options, texts):
    vbond(f"calibrate {options}", status=2, err=texts)


def test_all_mistakes_are_told_at_once_and_each_once():
    vbond("calibrate --E '2 mm' --length -1 --nu 0.7 --diameter 0.2 --side 0.1", status=2,
          err=["--E 2 mm", "force/length^2", "--length -1", "--nu 0.7", "exactly one of --diameter, --side, --A"])
    # a mistake of a unit not again as a wrong value
    said = vbond("calibrate --E '2 mm' --nu '0.3 mm' --length '-1 kg' --diameter '1 parsec'", status=2).err
    assert sorted(re.findall("^(--[a-zE]+) ", said, re.M)) == ["--E", "--diameter", "--length", "--nu"], said


def bonds_from(tmp_path, options, more=""):
    """The section that calibrate prints, as part of a case that is checked."""
    said = vbond(f"calibrate {options}").out
    (tmp_path / "case.toml").write_text(
        '[units]\nsystem = "SI"\n[[specimen]]\nkind = "rod"\nparticles = 3\nspacing = "2 mm"\nradius = "1 mm"\nmass = "1 g"\n'
        + more + said + '[[stage]]\nduration = "1 ms"\n')
    vbond(f"check {tmp_path / 'case.toml'}")
    return said


def test_bonds_of_pfc(tmp_path):
    said = bonds_from(tmp_path, "--from pfc --pb_emod '72 GPa' --pb_kratio 2.5 --pb_ten '175 MPa' --pb_coh 175e6")
    for line in ("E = 72000000000.0", "stiffness_ratio = 2.5", 'section = { shape = "circle", factor = 1.0 }',
                 'strength = { criterion = "stress", tension = 175000000.0, shear = 175000000.0, moment_share = 1.0 }'):
        assert line in said, f"{line} is not in\n{said}"
    said = bonds_from(tmp_path, "--from pfc --pb_kn 4e10 --pb_ks 3e10 --pb_rmul 0.5 --pb_ten 1e6 --pb_coh 2e6 --pb_fa 30"
                                " --pb_mcf 0.2 --gap '0.01 mm'")
    for line in ("gap = 1e-05", "k_n = 40000000000.0", "k_s = 30000000000.0", "factor = 0.5", "mohr-coulomb",
                 "cohesion = 2000000.0", f"friction_angle = {pi / 6}", "tension_limit = 1000000.0", "moment_share = 0.2"):
        assert line in said, f"{line} is not in\n{said}"


def test_bonds_of_edem(tmp_path):
    # What a source does not give is said, and not made up.
    said = bonds_from(tmp_path, "--from edem --normal-stiffness 3.67e10 --shear-stiffness 3.42e10 --normal-stress 6.57e8"
                                " --disk-radius '0.78 mm'")
    assert "diameter = 0.00156" in said and "\nk_n = 36700000000.0" in said and "\nk_s = 34200000000.0" in said
    assert "only the one of tension is given (657000000.0)" in said and "\nstrength" not in said
    said = bonds_from(tmp_path, "--from edem --normal-stiffness 6.13e10 --shear-stiffness 3.96e10 --normal-stress 3.5e7"
                                " --shear-stress 4e7 --disk-radius '0.5 mm'")
    assert 'strength = { criterion = "stress", tension = 35000000.0, shear = 40000000.0 }' in said


def test_what_is_missing_for_published_bonds_is_told_at_once():
    wrong = vbond("calibrate --from edem --normal-stiffness 1e10 --pb_kn 3", status=2).err
    for part in ("--pb_kn 3", "belongs to --from pfc", "needs --shear-stiffness", "needs --disk-radius"):
        assert part in wrong, f"{part} is not in\n{wrong}"
    assert "needs either --pb_kn and --pb_ks" in vbond("calibrate --from pfc --pb_kn 3", status=2).err
    assert "--pb_fa 90" in vbond("calibrate --from pfc --pb_kn 3 --pb_ks 3 --pb_fa 90", status=2).err
    assert "--E" in vbond("calibrate --length 1 --diameter 1", status=2).err
    assert "--from" in vbond("calibrate --pb_kn 3", status=2).err
    assert vbond("calibrate --from pfc --pb_kn 1 --pb_ks 1 --E 3", status=2).err

"""Figures that the examples are there to show, from the program's own files. shown("NAME") is the example as it is;
.ci/run reads these names, and leaves those examples to this test."""
from itertools import pairwise
from math import hypot, log, pi

from program import EXAMPLES, column, number, run_example as shown, table, values, vbond, write


def with_step(name, step):
    """The example with another time step."""
    return write(f"{name}.toml", (EXAMPLES / f"{name}.toml").read_text(), ('^step = "[^"]*"', f'step = "{step}"'))


def test_rod_quasistatic():
    # The whole quasi-static rod with a step ten times the shipped one, which gives the same peak to 1e-5. Many seeds give
    # 3.180e-4 +- 0.010e-4: the range is four and six standard deviations away, and above the static value, 3.078e-4.
    run = vbond("run", with_step("rod_quasistatic", "0.1 T0"))
    critical = number("rod_quasistatic.out", "critical_force")
    assert 3.14e-4 < critical < 3.24e-4
    assert "peak" in values("rod_quasistatic.out", "stop"), "the rod did not buckle"
    run.expect(out=f'peak force of stage "compress": {critical:.6g}')
    # That its peak is the largest of the averages, and the last average the first that is 1.5 % below it.
    averages = column("rod_quasistatic.out", "peak_average")
    assert max(averages) <= critical * (1 + 1e-12) and averages[-1] < 0.985 * critical


def test_leap_frog_is_of_second_order():
    # Half the step, a quarter of the energy error. The next term is (omega dt)^2 = 0.008 of the first, and the rows of the
    # history, the same times in both runs, hardly move on the swing.
    for dt in ("0.01", "0.005"):
        vbond("run", with_step("two_particles", f"{dt} T0"), "-o", f"two_{dt}")
    assert 3.9 < number("two_0.01", "energy_balance_error") / number("two_0.005", "energy_balance_error") < 4.1


def test_bond_on_contact():
    # The ring sticks to the rod: bonds come to be, touching pairs give up their contact energy, no bond is overstrained. A
    # bond made with the wrong rest angle, for a ring turned by 83 degrees, would bring an energy of about c_B = 0.02 from
    # nowhere, a third of all that there is.
    shown("bond_on_contact")
    assert number("bond_on_contact.out", "bonds") > 18, "18 bonds were there from the start"
    assert number("bond_on_contact.out", "energy_balance_error") < 1e-3
    assert number("bond_on_contact.out", "ever_strained") == 0
    rows = table("bond_on_contact.out")
    for before, row in pairwise(rows):
        assert (row["bonds"] > before["bonds"]) == (row["dissipated"] > before["dissipated"]), \
            f"contact energy is not given up where bonds are made, and only there: step {row['step']}"
    assert rows[-1]["dissipated"] > 0


def test_fibre_bundle():
    # Daniels' load of a bundle of very many fibres; four deviations of one bundle of 1,000, sqrt(p (1 - p) N) e = 0.9.
    shown("fibre_bundle")
    loads = column("fibre_bundle.out", "reaction.upper.fz")
    assert abs(max(loads) - 55.07) < 3.6
    assert loads[-1] == 0, "the bundle does not part"
    assert number("fibre_bundle.out", "energy_balance_error") < 1e-9


def test_triaxial_packing():
    # In the last third of the second stage each stress is what the servo was asked for; grains have rubbed, and no energy
    # goes astray as the stage begins (a body that forgot its slip through the faces would lose 4e-4 of it).
    shown("triaxial_packing")
    rows = table("triaxial_packing.out")
    press = [row for row in rows if row["time"] > 600]
    for row in press:
        for component, asked in (("xx", -0.05), ("yy", -0.05), ("zz", -0.0625)):
            assert abs(row[f"cell_stress_{component}"] / asked - 1) < (1e-3 if row["time"] < 660 else 1e-4), row["time"]
    assert rows[-1]["dissipated.friction"] > 0.1
    assert abs(rows[-1]["balance_error"] - rows[40]["balance_error"]) < 1e-6 and abs(rows[40]["balance_error"]) < 1e-4


def test_damped_bell():
    # Two maxima 10,000 time units apart, when only the lowest mode is left: 1 % below 12 omega^2/2, as damped_bell.md says.
    shown("damped_bell")
    swing = [(row["time"], row["displacement.0.x"] - row["displacement.20.x"]) for row in table("damped_bell.out")]
    maxima = [b for (a, b, c) in zip(swing, swing[1:], swing[2:]) if b[0] > 6000 and a[1] < b[1] >= c[1]]
    (t0, x0), (t1, x1) = maxima[0], maxima[-1]
    assert 6.45e-5 < log(x0 / x1) / (t1 - t0) < 6.585e-5


def test_plastic_beam():
    # The collapse load of the chain by limit analysis, and 1 % for damping.
    shown("plastic_beam")
    forces = [-row["reaction.middle.fy"] for row in table("plastic_beam.out") if row["time"] > 8000]
    assert 4.444e-6 <= sum(forces) / len(forces) < 4.49e-6


def test_brazilian():
    # The first crack of the Brazilian test is near the axis, breaks under the plates come after it (brazilian.md). If bonds
    # broke anywhere, |x| would be 4.2 on average, and 18 % of the breaks would have |z| > 7.
    shown("brazilian")
    breaks = [(row["x"] - 10.25, row["z"] - 10.25) for row in table("brazilian.out/breaks.csv")]
    assert len(breaks) > 1000
    assert sum(abs(x) for x, _ in breaks[:200]) / 200 < 2.5, "the first crack is not near the axis"
    assert sum(abs(z) > 7 for _, z in breaks[:200]) / 200 < 0.1, "it breaks under the plates first"
    assert sum(abs(z) > 7 for _, z in breaks[600:1000]) / 400 > 0.3, "it does not break under the plates then"


def test_crushed_sphere():
    # The crushed sphere cracks along meridians: of the breaks outside of the cones of fines until the peak load, the
    # normals squared along the circumference are 0.53 to 0.59 on average (crushed_sphere.md), 1/3 without a direction.
    shown("crushed_sphere").expect(no_out=["may slip through", "may come through"], no_err=["may slip through", "may come through"])
    peak = max(table("crushed_sphere.out"), key=lambda row: row["wall.upper.Fz"])
    assert 0.7 < peak["wall.upper.Fz"] < 0.9
    around = []
    for row in table("crushed_sphere.out/breaks.csv"):
        r = hypot(row["x"], row["y"])
        if row["time"] <= peak["time"] and r > 3.5 * (1 - (7 - abs(row["z"])) / 4.5):
            around.append(((row["dy"] * row["x"] - row["dx"] * row["y"]) / r) ** 2)
    assert sum(around) / len(around) > 0.45, "cracks of the sphere do not follow meridians"


def test_fibre_mat():
    # What fibre_mat.md says: the force on the plate grows faster than its way, glue breaks and no fibre, and the mat parts.
    # Where it parts and when is by chance, and differs where sums are rounded in another way.
    shown("fibre_mat")
    press = [row for row in table("fibre_mat.out") if row["time"] <= 10]
    force = [row["wall.upper.Fz"] for row in press]
    assert 4.5 < force[-1] < 5.5, "4.96 in the run of the page"
    assert force[-1] > 3 * force[len(force) // 2] > 0, "fibres that lie on each other are stiffer than those between them"
    assert press[-1]["bonds"] == 1000 and press[-1]["broken"] == 0
    tear = [row for row in table("fibre_mat.out") if row["time"] > 10.01]
    assert tear[0]["bonds"] > 1300, "398 bonds at crossings"
    assert tear[-1]["fragments"] >= 2 and tear[0]["fragments"] < 5, "the mat does not part"
    assert 2 < max(row["reaction.right.fx"] for row in tear) < 4
    assert abs(tear[-1]["reaction.right.fx"]) < 1, "it still bears"
    assert {row["set"] for row in table("fibre_mat.out/breaks.csv")} == {1}, "bonds at crossings, and no others"


def test_concrete():
    # What concrete.md says: both platens feel the same force until the peak, the weak layer around stones breaks before mortar
    # does, and the cylinder falls to pieces after the peak.
    shown("concrete")
    rows = table("concrete.out")
    peak = max(rows, key=lambda row: row["wall.upper.Fz"])
    assert 40e6 < peak["wall.upper.Fz"] / (pi * 0.025**2) < 54e6
    for row in rows:
        if 0.3e-3 < row["time"] < peak["time"] - 0.1e-3:
            assert abs(row["wall.upper.Fz"] + row["wall.lower.Fz"]) < 0.06 * row["wall.upper.Fz"], row["time"]
    half = next(row["time"] for row in rows if row["wall.upper.Fz"] > 0.5 * peak["wall.upper.Fz"])
    early = [row["set"] for row in table("concrete.out/breaks.csv") if row["time"] <= half]
    assert early.count(1) > 2 * early.count(2) > 0, "the interface does not break first"
    assert rows[-1]["wall.upper.Fz"] < 0.5 * peak["wall.upper.Fz"] and rows[-1]["fragments"] > 3 * peak["fragments"]

"""Figures that the examples of static stages are there to show, from the program's own files. shown("NAME") is the
example as it is; .ci/run reads these names, and leaves those examples to this test."""
from math import hypot, pi, sqrt

import pytest
from program import at_load, column, number, run_example as shown, table, values, vbond


def near(value, expected, relative):
    assert abs(value - expected) <= relative * abs(expected), f"{value!r} is not {expected} to {relative} of it"


def test_rod_buckling():
    # Closed form for the pinned chain. A zero of an eigenvalue is met to 1e-8 of its step, and the line through the two
    # nearest looks leaves the square of that; positions are rounded to some 1e-12 of the load. 1e-9 leaves three digits.
    shown("rod_buckling").expect(out="bifurcation")
    forces = values("rod_buckling.out", "critical_forces")[0]
    for force, exact in zip(forces[:4], [3.07817634631e-4, 1.270332822625e-3, 3.009054408433e-3, 5.735417372007e-3], strict=True):
        near(force, exact, 1e-9)


def test_elastica():
    # The same nine bonds at an end distance of a, by another program; residuals of 1e-10 there and here.
    shown("elastica")
    near(at_load("elastica.out", "total")[0], 3.95243875636e-3, 1e-9)
    near(-at_load("elastica.out", "reaction.last.fx")[0], 8.11946278905e-4, 1e-9)
    # shortening: f / c_A = 9 times the strain: 3.07817634631e-4 * 9 / 8
    near(values("elastica.out", "bifurcations")[0][0]["load_factor"], 3.46294839e-4, 1e-8)
    assert number("elastica.out", "unstable") == 0, "the buckled rod is not stable"


def test_cantilever_tip_load():
    # The exact tips of a chain of 40 bonds at 1, 5 and 10 EI/L^2, by another program; residuals of 1e-9 there, see
    # tests/statics/equilibrium_test.cpp.
    shown("cantilever_tip_load")
    for factor, down, towards_clamp in ((0.1, 0.301652668101, 0.0563928771099), (0.5, 0.713290736004, 0.386851685961),
                                        (1, 0.810011367243, 0.553716075795)):
        near(at_load("cantilever_tip_load.out", "displacement.last.y", factor)[0], down, 1e-8)
        near(-at_load("cantilever_tip_load.out", "displacement.last.x", factor)[0], towards_clamp, 1e-8)


def test_cantilever_end_moment():
    # Closed: the tip is back at the clamp, as well as 1e-10 of unbalanced force, times a compliance of 1, leaves it.
    shown("cantilever_end_moment")
    x, y = (at_load("cantilever_end_moment.out", f"displacement.last.{axis}")[0] for axis in "xy")
    assert hypot(x + 1, y) < 1e-9, "the ring is open"


def test_rod_modes():
    # The closed form of the free rod; under half the critical force 1/sqrt(2) but for the shortening, 1.7e-4 of the length.
    shown("rod_modes").expect(out="UNSTABLE")
    omegas = values("rod_modes.out", "omega")
    near(omegas[0][0], 6.06345642e-3, 1e-8)
    near(omegas[0][1], 2.3913493243e-2, 1e-9)
    near(omegas[1][0], 6.06345642e-3 * sqrt(0.5), 3e-4)


def test_shallow_arch():
    # Both limit points, and a stable hanging shape; to the six digits the page quotes.
    shown("shallow_arch").expect(out=["0.59952831", "0 -> 1", "1 -> 0"])
    assert number("shallow_arch.out", "unstable") == 0, "the hanging arch is not stable"


def test_portal_frame():
    # Frame theory: 269.385 kN, approached from above as 1 / 12^2 (0.3 %); 6.0120 mm but for the columns' shortening.
    shown("portal_frame")
    near(values("portal_frame.out", "critical_forces")[0][0], 269385, 5e-3)
    near(at_load("portal_frame.out", "displacement.left.last.x")[0], 6.0120e-3, 1e-3)
    # The swing is that of the first mode but for a small part of others: its period from the crossings downwards.
    swing = [(row["time"], row["displacement.left.last.x"]) for row in table("portal_frame.out") if row["load_factor"] is None]
    down = [t0 + (t1 - t0) * x0 / (x0 - x1) for (t0, x0), (t1, x1) in zip(swing, swing[1:]) if x0 > 0 >= x1]
    near(down[1] - down[0], 2 * pi / values("portal_frame.out", "omega")[0][0], 1e-3)
    assert number("portal_frame.out", "energy_balance_error") < 1e-6


def test_fene_net():
    # Eight straight chains: eight times the force of one FENE bond at 0.95 of its limit, where an error of the elongation
    # counts 20 times as much.
    shown("fene_net")
    near(at_load("fene_net.out", "reaction.right.fx")[0], 38.97435897435896, 1e-10)


def test_twisted_bar():
    # The torque of the lattice at a small angle, by its linear theory (twisted_bar.md): the least energy over the twist of
    # each ring and the turns of its particles about axis and radius. What the angle of 0.001 leaves of it is its square.
    shown("twisted_bar")
    upper, lower = (at_load("twisted_bar.out", f"grip.{grip}.Mz") for grip in ("upper", "lower"))
    near(upper[0], 1.83775492596e-3, 1e-7)
    near(upper[-1], -lower[-1], 1e-9)
    near(max(angle for angle in column("twisted_bar.out", "grip.upper.angle") if angle is not None), 2, 1e-12)
    assert number("twisted_bar.out", "energy_balance_error") < 1e-6, "the books of the grip do not close"


def test_thin_tube():
    # The thin tube against Hooke, Saint-Venant and Rayleigh (thin_tube.md): E A strain, of which triangles 0.24 % too high
    # make 0.36 % more; G J theta / L; and the lowest mode of a ring that does not stretch, which the whole bonds around its
    # ends raise by half of (1 + nu)/sqrt(3)/29 = 2.6 %. What is left is of the order of (spacing/R)^2 = 1 %.
    shown("thin_tube")
    near(at_load("thin_tube.out", "reaction.last.fz")[0], 26389.378290154, 8e-3)
    near(at_load("thin_tube.out", "grip.last.Mz")[-1], 338.32536269, 2e-3)
    near(values("thin_tube.out", "omega")[0][0], 839.9622026 * 1.013, 5e-3)


def test_double_cantilever():
    # DB1 of tests/data/materials.json: openings at its first four breaks, and what these release.
    shown("double_cantilever")
    breaks = table("double_cantilever.out/fracture.csv")
    for row, (opening, load, released) in zip(breaks[:4], [
            (0.153377344195, 0.01573621961, 2.676473123e-4), (0.181711133015, 0.01450845632, 2.728360741e-4),
            (0.212551974914, 0.01345829376, 2.774047280e-4), (0.245892203730, 0.01254970744, 2.814490581e-4)], strict=True):
        near(0.4 * row["load_factor"], opening, 1e-6)
        near(row["load"], load, 1e-6)
        near(row["released"], released, 1e-6)
    near(column("double_cantilever.out", "released")[-1], sum(row["released"] for row in breaks), 1e-9)
    assert abs(number("double_cantilever.out", "balance_error")) < 1e-9, "the books of fracture do not close"


def test_notched_beam_in_motion_and_at_rest():
    # The same two bonds break first, the second at the peak, at loads within 2 %.
    shown("notched_beam")
    shown("notched_beam_at_rest")
    assert number("notched_beam.out", "energy_balance_error") < 1e-3
    moving, breaks, fracture = (table(file) for file in (
        "notched_beam.out/breaks.csv", "notched_beam_at_rest.out/breaks.csv", "notched_beam_at_rest.out/fracture.csv"))
    told = [line for line in vbond("breaks notched_beam_at_rest.out").out.splitlines() if line.startswith("bond ")]
    assert len(told) == len(fracture), "vbond breaks does not tell of every bond that broke at rest"
    assert [row["bond"] for row in breaks] == [row["bond"] for row in fracture]
    for one, other in zip(moving[:2], fracture[:2], strict=True):
        assert one["bond"] == other["bond"]
        assert one["load"] == pytest.approx(other["load"], rel=0.02)

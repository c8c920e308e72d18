"""Where stages of fracture at rest end, and what they say of it."""
import pytest
from program import column, read, vbond, write

COLUMN = """
[[specimen]]
kind = "rod"
particles = 6
radius = 0.3
mass = 1.0
inertia = 0.1
[[bonds]]
distance = 1.1
stiffness = {c_A = 1.0, c_D = 0.12, c_B = 0.01, c_T = 0.01}
strength = {criterion = "stress", tension = 1.0, shear = 1.0, compression = 0.005, section = {shape = "given", A = 1.0, J = 0.01, J_p = 0.02, radius = 0.2}}
[[stage]]
kind = "fracture"
steps = 20
supports = [{group = "first", fix = ["x", "y", "z", "rx", "ry", "rz"]}]
loads = [{group = "last", force = [-0.006, 0, 0], moment = [1e-9, 0, 0]}]
"""


def test_fracture_loses_stability_beside_moments(work):
    # A moment that does nothing leaves the column the load under which it buckles: 0.166016 of its force.
    for moment in ("1e-9", "0"):
        folder = f"column_{moment}"
        vbond("run", write("column.toml", COLUMN, ("1e-9", moment)), "-o", folder)
        stage = read(folder, "run.json")["stages"][0]
        assert stage["ended"] == "lost stability"
        assert abs(stage["load_factor"] - 0.166016) < 2e-6


LATTICE = """
[cell]
a = [3, 0, 0]
b = [0, 3, 0]
c = [0, 0, 3]
[[specimen]]
kind = "block"
cells = [3, 3, 3]
spacing = 1.0
radius = 0.3
mass = 1.0
inertia = 0.1
[[bonds]]
distance = 1.1
stiffness = {c_A = 1.0, c_D = 0.5, c_B = 0.2, c_T = 0.2}
[bonds.strength]
criterion = "stress"
tension = 0.02
shear = 0.02
compression = 0.02
section = {shape = "given", A = 1.0, J = 0.05, J_p = 0.1, radius = 0.3}
weibull = {modulus = 3, seed = 4}
[[stage]]
kind = "fracture"
steps = 10
stop = {load_drop = 0.5}
[stage.cell]
xx = {strain = -0.06}
"""


@pytest.mark.parametrize("strain", ["-0.06", "0.06"])
def test_load_drop_is_of_the_peak_whatever_its_sign(work, strain):
    vbond("run", write("lattice.toml", LATTICE, ("strain = -0.06", f"strain = {strain}")), "--force", "-o", "lattice")
    stage = read("lattice", "run.json")["stages"][0]
    assert stage["ended"] == "load drop"
    after = [abs(x) for x in column("lattice/fracture.csv", "load_after")]
    peak = stage["fracture"]["peak_load"]
    assert len(after) > 3 and after[-1] <= 0.5 * peak < min(after[:-1])

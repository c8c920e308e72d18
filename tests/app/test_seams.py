"""Where features meet: the books close after bonds that are made when the last of those that remember has broken, with
contacts that hold all the energy there is, and with a grip that holds every particle."""
import pytest
from program import number, vbond, write

STIFFNESS = "stiffness = {c_A = 1, c_D = 1, c_B = 1, c_T = 1}"
MADE_LATER = f"""specimen = [{{kind = "list", positions = [[0, 0, 0], [1, 0, 0], [5, 0, 0], [7, 0, 0]], mass = 1, radius = 0.3}}]
groups = {{a = {{indices = [1]}}, b = {{indices = [2, 3]}}, c = {{indices = [3]}}}}
velocities = [{{group = "a", velocity = [0.5, 0, 0]}}, {{group = "c", velocity = [-0.2, 0, 0]}}]
stage = [{{duration = 8}}, {{duration = 1}}]
bonds = [{{distance = 1.05, when = "approach", between = ["b", "b"], {STIFFNESS}}},
         {{pairs = [[0, 1]], {STIFFNESS}, yield = {{axial_force = 0.05}}, strength = {{criterion = "elongation", elongation = 0.1}}}}]
"""
STICKY = """specimen = [{{kind = "rod", particles = 2, spacing = 0.54, radius = 0.3, mass = 1}}]
contact = {{law = "hertz", E = 28, nu = 0, adhesion = "{}", work_of_adhesion = 0.1}}
stage = [{{duration = 20}}]
"""
GRIPPED = f"""specimen = [{{kind = "rod", particles = 3, radius = 0.5, mass = 1}}]
bonds = [{{when = "approach", distance = 1.05, {STIFFNESS}}}]
stage = [{{duration = 10, supports = [{{group = "all", rigid = true, angular_velocity = [0, 0, 0.5]}}]}}]
"""


@pytest.mark.parametrize("name, case", [("made_later", MADE_LATER), ("jkr", STICKY.format("jkr")), ("dmt", STICKY.format("dmt")),
                                        ("gripped", GRIPPED)])
def test_books_close(name, case):
    vbond("run", write(f"{name}.toml", case), "-o", name)
    assert number(name, "energy_balance_error") < 1e-3

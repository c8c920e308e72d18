"""What a restitution gives a clump that falls flat on a wall: the damping of each of its n contacts is by its whole mass,
so that all together damp sqrt(n) times as much (docs/contacts.md, which mass counts)."""
from math import atan2, exp, pi, sqrt

import pytest
from program import column, vbond, write

CASE = """specimen = [{kind = "list", positions = PLACES, radius = 0.5, mass = 1.0}]
wall = [{name = "floor", shape = "plane", point = [0, 0, 0], normal = [0, 0, 1]}]
velocities = [{group = "all", velocity = [0, 0, -0.01]}]
time = {step = 5e-4}
output = {history = {every = 0.1, velocities = ["all"]}}
[contact]
LAW
restitution = E
[[stage]]
duration = 3
"""
CLUMP = 'supports = [{group = "all", rigid = true, fix = []}]\n'
LAWS = {"linear": 'law = "linear"\nk = 100.0', "hertz": 'law = "hertz"\nE = 1000.0\nnu = 0.2'}


def case(law, side, e, clump=CLUMP):
    places = [[x, y, 0.501] for x in range(side) for y in range(side)]
    return write(f"{law}{side}.toml", CASE + clump, ("PLACES", str(places)), ("LAW", LAWS[law].replace("\n", r"\n")),
                 ("E$", str(e)))


def restitution(b):
    """Of an impact with the damping b, which ends when the force is 0: Schwager and Poeschel, 2007."""
    w = sqrt(1 - b * b)
    return exp(-b / w * (pi - atan2(2 * b * w, 1 - 2 * b * b)))


def damping(e):
    low, high = 0.0, 0.999
    for _ in range(60):
        b = (low + high) / 2
        low, high = (b, high) if restitution(b) > e else (low, b)
    return b


def rebound(law, side, e):
    folder = f"{law}{side}_{e}"
    vbond("run", case(law, side, e), "-o", folder)
    fell, rose = (column(folder, "velocity.all.z")[k] for k in (0, -1))
    return -rose / fell


# the step leaves 2e-3 of e, of the linear force, which begins at once; 1e-3 of Hertz's
@pytest.mark.parametrize("law, side, e", [("linear", 1, 0.5), ("linear", 2, 0.5), ("linear", 3, 0.5), ("linear", 2, 0.69),
                                          ("hertz", 1, 0.5), ("hertz", 2, 0.5), ("hertz", 3, 0.5), ("hertz", 2, 0.69)])
def test_n_contacts_damp_sqrt_n_times_as_much(law, side, e):
    assert rebound(law, side, e) == pytest.approx(restitution(damping(e) * side), abs=2e-3)


def test_it_is_told():
    words = "at n places alike at once it is damped sqrt(n) times as much"
    vbond("check", case("linear", 2, 0.5), out=words)
    for quiet in (case("linear", 2, 1.0), case("hertz", 2, 0.5, "")):
        vbond("check", quiet, no_out=words)

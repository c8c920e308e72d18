"""What the tests share: small bodies as dicts of keys."""

from pathlib import Path

import pytest

import vbond

root = Path(__file__).parents[2]
clamp = {"group": "first", "fix": ["x", "y", "z", "rx", "ry", "rz"]}


def rod_keys(particles: int = 10) -> dict:
    """A rod of bonds with c_A = 1 that is given a random push."""
    return {
        "title": "rod",
        "specimen": [{"kind": "rod", "particles": particles, "radius": 0.4, "mass": 1.0, "inertia": 0.064}],
        "bonds": [{"name": "rod", "distance": 1.1, "theory": "bernoulli-euler", "E": 31.830988618379067, "nu": 0.2,
                   "section": {"shape": "circle", "diameter": 0.2}}],
        "velocities": [{"kind": "gaussian", "magnitude": 1e-2, "seed": 3}],
        "time": {"step": "0.02 T0"},
        "stage": [{"name": "fly", "duration": "4 T0"}],
        "output": {"history": {"every": "0.2 T0"}},
    }


@pytest.fixture
def keys() -> dict:
    return rod_keys()


@pytest.fixture
def case(keys) -> vbond.Case:
    return vbond.Case.from_dict(keys)


@pytest.fixture
def run(case) -> vbond.Run:
    return vbond.Run(case)

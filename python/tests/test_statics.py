"""Static stages as functions, against closed forms."""

import numpy as np
import pytest

import vbond
from conftest import clamp, rod_keys

EI, EA = 0.0025, 1.0  # of rod_keys: c_B a, c_A a
tip = {"group": "last", "force": [0, 1e-9, 0]}


@pytest.fixture
def rod() -> vbond.Case:
    return vbond.Case.from_dict(rod_keys(21))


def test_the_kernel_of_blas_is_told():
    assert vbond.blas_kernel() != ""
    assert vbond.better_blas_kernel() != vbond.blas_kernel()


def test_equilibrium_of_a_cantilever(rod):
    solution = vbond.equilibrium(rod, supports=[clamp], loads=[tip])
    assert solution.state.positions[-1, 1] == pytest.approx(1e-9 * 20**3 / (3 * EI), rel=1e-6)
    assert solution.result.ended == "converged" and solution.result.unstable == 0
    assert solution.load_factors[-1] == 1


def test_buckling_of_a_cantilever(rod):
    solution = vbond.buckling(rod, supports=[clamp], loads=[{"group": "last", "force": [-1, 0, 0]}], count=1)
    load = solution.critical_loads[0]
    # the paper's discrete rod: its last particle has no bond beyond it
    assert load.force == pytest.approx(np.pi**2 * EI / (4 * 20**2), rel=2e-2)
    assert load.kind == "bifurcation" and load.translation.shape == (21, 3)
    assert np.abs(load.translation).max() == pytest.approx(1, abs=1e-12)


def test_waves_of_a_periodic_chain():
    # one particle, bonded to its own images: omega = 2 sqrt(c_A/m) |sin(q a/2)|; a wave of one particle is in phase
    case = vbond.Case.from_text("""
[cell]
a = [1, 0, 0]
b = [0, 5, 0]
c = [0, 0, 5]
open = ["b", "c"]
[[specimen]]
kind = "list"
positions = [[0, 0, 0]]
radius = 0.4
mass = 2.0
[[bonds]]
distance = 1.1
stiffness = {c_A = 3.0, c_D = 1e-3, c_B = 1e-3, c_T = 1e-3}
[[stage]]
kind = "equilibrium"
""")
    q = [0.3, 1.0, 2.5]
    solution = vbond.modes(case, count=6, wave_vectors=[[x, 0, 0] for x in q])
    assert np.array_equal(solution.result.waves, [[x, 0, 0] for x in q])
    for k, x in enumerate(q, start=1):
        of_wave = [mode for mode in solution.modes if mode.wave == k]
        assert np.isclose(max(mode.omega for mode in of_wave if abs(mode.translation[0, 0]) > 0.99),
                          2 * np.sqrt(1.5) * np.sin(x / 2), rtol=1e-10)
        assert all(mode.translation_out_of_phase.shape == mode.translation.shape for mode in of_wave)


def test_modes_of_a_free_rod_have_six_rigid_motions(rod):
    solution = vbond.modes(rod, count=7)
    assert sum(mode.rigid for mode in solution.modes) == 6 and len(solution.frequencies) == 7
    # a free Euler beam of length 21, masses at its points: k L = 4.730 and the same again about the other axis
    omega = 4.730041**2 * np.sqrt(EI) / 20.5**2
    assert 2 * np.pi * solution.frequencies[:2] == pytest.approx([omega, omega], rel=5e-2)


def test_a_path_passes_its_points(rod):
    solution = vbond.path(rod, supports=[clamp], loads=[{"group": "last", "moment": [0, 0, 2 * np.pi * EI / 20]}],
                          stop={"load_factor": {"above": 0.5}})
    assert solution.result.load_factor == pytest.approx(0.5) and solution.result.points > 2
    assert np.all(np.diff(solution.load_factors) > 0)


def test_fracture_of_a_bar():
    keys = rod_keys(6)
    keys["bonds"][0]["strength"] = {"criterion": "stress", "tension": 0.01 / 0.031415926535897934, "shear": 1.0}
    case = vbond.Case.from_dict(keys)
    solution = vbond.fracture(case, supports=[clamp, {"group": "last", "fix": ["x", "y", "z"], "displacement": [0.1, 0, 0]}])
    result = solution.result.fracture
    assert result.peak_load == pytest.approx(0.01, rel=1e-6)
    assert len(result.breaks["bond"]) == 1 and result.breaks["middle"].shape == (1, 3)
    assert abs(result.energy.error) < 1e-9
    assert solution.state.bonds["broken"].sum() == 1


def test_what_cannot_be_in_equilibrium_is_told(rod):
    with pytest.raises(vbond.NoEquilibrium, match="move freely|free"):
        vbond.equilibrium(rod, loads=[tip])
    with pytest.raises(vbond.CaseError, match="supprts"):
        vbond.equilibrium(rod, supprts=[clamp])

"""Periodic bodies: the cell and images as arrays, of a run and of its files."""

import json
import re

import numpy as np
import pytest

import vbond


@pytest.fixture
def periodic() -> dict:
    """A lattice that is sheared and pressed, and moves through the faces of its cell."""
    return {
        "cell": {"a": [4, 0, 0], "b": [1, 4, 0], "c": [0, 0, 4], "rotation": "triangular"},
        "specimen": [{"kind": "block", "cells": [4, 4, 4], "radius": 0.45, "mass": 1.0}],
        "bonds": [{"distance": 1.1, "stiffness": {"c_A": 1.0, "c_D": 0.3, "c_B": 0.1, "c_T": 0.1}}],
        "contact": {"law": "linear", "k": 1.0, "pairs": "all"},
        "velocities": [{"velocity": [0.5, 0.2, -0.1]}],
        "time": {"step": 0.1},
        "stage": [{"duration": 20.0, "cell": {"xy": {"rate": 0.01}, "zz": {"rate": -0.01}}}],
        "output": {"history": {"every": 2.0}},
    }


def at(state, pairs):
    """From i to the image of j."""
    r = state.positions
    return r[pairs["j"]] + pairs["image_j"] @ state.cell - r[pairs["i"]]


def test_pictures_draw_bonds_to_the_images_that_they_join(periodic):
    pytest.importorskip("matplotlib").use("Agg")
    periodic["bonds"][0]["strength"] = {"criterion": "linear", "axial_force": 0.02, "shear_force": 1, "bending_moment": 1,
                                        "torque": 1}
    run = vbond.Run(vbond.Case.from_dict(periodic))
    lines = vbond.plots.body(run.state).collections[0]._segments3d
    assert len(lines) == len(run.state.bonds["i"]) and np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1).max() < 1.1
    run.run()
    state = run.state
    broken = state.bonds["broken"]
    points = np.array(vbond.plots.cracks(state).collections[-1]._offsets3d).T
    middles = state.positions[state.bonds["i"]] + 0.5 * at(state, state.bonds)
    assert broken.any() and points == pytest.approx(middles[broken])


def test_the_cell_is_that_of_the_run(periodic):
    run = vbond.Run(vbond.Case.from_dict(periodic))
    assert run.state.cell.tolist() == [[4, 0, 0], [1, 4, 0], [0, 0, 4]]
    run.run()
    state = run.state
    F = np.array([[1, 0.2, 0], [0, 1, 0], [0, 0, 0.8]])
    assert state.cell == pytest.approx(np.array([[4, 0, 0], [1, 4, 0], [0, 0, 4]]) @ F.T, abs=1e-12)
    L = np.array([[0, 0.01, 0], [0, 0, 0], [0, 0, -0.01]]) @ np.linalg.inv(F)
    assert state.cell_rates == pytest.approx(state.cell @ L.T, rel=2e-2, abs=1e-12)  # half a step ago
    stress = state.cell_stress
    for name, a, b in (("xx", 0, 0), ("zz", 2, 2), ("xy", 0, 1), ("yz", 1, 2)):
        assert 0.5 * (stress[a, b] + stress[b, a]) == pytest.approx(run.history[f"cell_stress_{name}"][-1], abs=1e-12)
    assert stress[2, 2] < -0.05


def test_images_tell_where_pairs_go(periodic):
    run = vbond.Run(vbond.Case.from_dict(periodic))
    run.run()
    state = run.state
    bonds, contacts = state.bonds, state.contacts
    assert bonds["image_j"].shape == (192, 3) and bonds["image_j"].dtype.kind == "i" and bonds["image_j"].any()
    length = np.linalg.norm(at(state, bonds), axis=1)
    assert length == pytest.approx(bonds["elongation"] + bonds["length_at_rest"], rel=1e-12)
    assert len(contacts["i"]) > 0 and contacts["image_j"].any()
    assert contacts["overlap"] == pytest.approx(0.9 - np.linalg.norm(at(state, contacts), axis=1), rel=1e-9)


def test_frames_have_the_cell_and_particles_in_it(periodic, tmp_path):
    periodic["output"]["frames"] = {"every": 10.0, "wrap": True}
    out = vbond.run(vbond.Case.from_dict(periodic), tmp_path / "out")
    last = out.frames[-1]
    particles, bonds = last.particles, last.bonds
    parts = (particles["position"] - particles["cell_corner"]) @ np.linalg.inv(particles["cell"])
    assert particles["cell"].shape == (3, 3) and parts.min() > -1e-9 and parts.max() < 1 + 1e-9
    assert particles["image"].any() and particles["image"].dtype.kind == "i"
    r = particles["position"]
    length = np.linalg.norm(r[bonds["j"]] + bonds["image_j"] @ particles["cell"] - r[bonds["i"]], axis=1)
    assert length == pytest.approx(bonds["elongation"] + bonds["length_at_rest"], rel=1e-12)
    cell = out.summary["cell"]
    assert [cell[edge] for edge in "abc"] == particles["cell"].tolist()
    assert cell["stress"]["zz"] == out.history["cell_stress_zz"][-1]
    assert cell["volume"] == pytest.approx(64 * 0.8, rel=1e-12)


def test_without_a_cell_there_is_none(run):
    assert run.state.cell is None and run.state.cell_rates is None and run.state.cell_stress is None
    assert "image_j" not in run.state.bonds and "image_j" not in run.state.contacts


def test_a_cell_is_homogenised(periodic):
    # The cubic lattice: rows of bonds that shear (docs/material.md): C11 = c_A, C44 = c_D/2 of a lattice with spacing 1.
    del periodic["contact"]
    periodic["cell"]["b"] = [0, 4, 0]
    case = vbond.Case.from_dict(periodic)
    found = vbond.homogenise(case, derivatives=True)
    C = np.diag([1.0, 1.0, 1.0, 0.15, 0.15, 0.15])
    assert found.C == pytest.approx(C, abs=1e-13)
    assert found.constants.youngs_modulus([0, 0, 2]) == pytest.approx(1.0)
    assert found.constants.hill.K == pytest.approx(1 / 3)
    assert found.particles == 64 and found.bonds == 192 and found.floating == 0 and found.density == pytest.approx(1.0)
    by = found.derivatives[0]
    assert by["c_A"] + by["c_D"] + by["c_B"] + by["c_T"] == pytest.approx(C, abs=1e-13)
    speed, along = found.constants.wave_speeds([1, 0, 0], found.density)[-1]
    assert speed == pytest.approx(1.0) and abs(along[0]) == pytest.approx(1.0)
    # along a diagonal of a face: shear of that face's edges against each other, (C11 - C12)/2, and C44
    (softest, m), (stiffest, other) = found.constants.shear_moduli([1, 1, 0])
    assert (softest, stiffest) == pytest.approx((0.15, 0.5)) and abs(m[2]) == pytest.approx(1.0) and abs(other[0]) == pytest.approx(0.5**0.5)
    (least, _), (largest, _) = found.constants.poissons_ratios([1, 0, 0])
    assert (least, largest) == pytest.approx((0.0, 0.0), abs=1e-13)
    # of a state: a stretched lattice has stress
    run = vbond.Run(case.with_stages([{"kind": "equilibrium", "cell": {"zz": {"strain": 0.01}}}]))
    run.run_stage()
    assert vbond.homogenise(run.state).stress[2] == pytest.approx(0.01, rel=1e-9)
    with pytest.raises(ValueError, match="periodic in all three directions"):
        vbond.homogenise(vbond.Case.from_dict({**periodic, "cell": {**periodic["cell"], "open": ["c"]}, "stage": [{"duration": 1.0}]}))


def test_a_material_has_a_page(periodic, tmp_path, monkeypatch):
    (tmp_path / "template.html").write_text("<!doctype html>\n<!-- run -->\n</html>\n")
    monkeypatch.setenv("VBOND_PAGE", str(tmp_path / "template.html"))
    del periodic["contact"]
    case, page = vbond.Case.from_dict({**periodic, "stage": [{"duration": 1.0}]}), tmp_path / "cell.html"
    found = vbond.homogenise(case, report=page)
    (shown,) = re.findall(r'^<script type="application/json" id="material">(.*)</script>$', page.read_text(), re.M)
    assert json.loads(shown)["found"]["C"][0][0] == pytest.approx(found.C[0, 0])
    with pytest.raises(vbond.ProgramError, match="is there already"):
        vbond.homogenise(case, report=page)
    with pytest.raises(ValueError, match="this is a state"):
        vbond.homogenise(vbond.Run(case).state, report=tmp_path / "other.html")
    body = vbond.Case.from_dict({key: value for key, value in {**periodic, "stage": [{"duration": 1.0}]}.items() if key != "cell"})
    vbond.homogenise_body(body, volume=20.0, report=tmp_path / "body.html")
    assert "volume 20 (as given)" in (tmp_path / "body.html").read_text()
    with pytest.raises(ValueError, match="--surface GROUP"):
        vbond.homogenise_body(body, surface=range(64), report=tmp_path / "other.html")
    assert not (tmp_path / "other.html").exists()


def test_a_sheet_is_homogenised(periodic):
    # One layer of a square lattice: A = c_A, c_D/2; D = c_B, c_T/2.
    del periodic["contact"]
    periodic["cell"] = {"a": [4, 0, 0], "b": [0, 4, 0], "c": [0, 0, 4], "open": ["c"]}
    periodic["specimen"][0]["cells"] = [4, 4, 1]
    bonds = periodic["bonds"][0]["stiffness"]
    case = vbond.Case.from_dict({**periodic, "stage": [{"duration": 1.0}]})
    found = vbond.homogenise_sheet(case)
    assert found.A == pytest.approx(np.diag([bonds["c_A"], bonds["c_A"], bonds["c_D"] / 2]), abs=1e-13)
    assert found.D == pytest.approx(np.diag([bonds["c_B"], bonds["c_B"], bonds["c_T"] / 2]), abs=1e-13)
    assert found.B == pytest.approx(np.zeros((3, 3)), abs=1e-13)
    assert found.area == 16 and list(found.axes[2]) == [0, 0, 1]
    with pytest.raises(ValueError, match="no surface"):
        vbond.homogenise_body(case)


def test_a_body_without_a_cell_is_homogenised(periodic):
    del periodic["contact"], periodic["cell"]
    case = vbond.Case.from_dict({**periodic, "stage": [{"duration": 1.0}]})
    found = vbond.homogenise_body(case)
    assert found.by_displacement.C[0, 0] == pytest.approx(found.by_traction.C[0, 0])  # chains of three bonds, four particles
    assert found.by_displacement.hill.G > found.by_traction.hill.G
    assert found.surface == 56 and found.particles == 64
    twice = vbond.homogenise_body(case, volume=2 * found.volume)
    assert 2 * twice.by_displacement.C == pytest.approx(found.by_displacement.C)
    assert vbond.homogenise_body(case, surface=range(64)).surface == 64
    with pytest.raises(ValueError, match="no such particle"):
        vbond.homogenise_body(case, surface=[64])
    with pytest.raises(ValueError, match="periodic in two directions"):
        vbond.homogenise_sheet(case)

"""Arrays: views that outlive everything, that nobody can write to, and that stay as they were."""

import gc

import numpy as np
import pytest

import vbond

views = ["positions", "velocities", "angular_velocities", "orientations", "masses", "radii"]


@pytest.mark.parametrize("name", views)
def test_views_outlive_state_and_run_and_stay_as_they_were(case, name):
    run = vbond.Run(case)
    run.step(20)
    array = getattr(run.state, name)
    assert not array.flags.owndata and not array.flags.writeable and array.dtype == np.float64
    kept = array.copy()
    run.step(20)
    run.run()
    assert np.array_equal(array, kept)
    del run
    gc.collect()
    assert np.array_equal(array, kept)
    filler = [np.full(array.shape, 7.0) for _ in range(100)]  # on memory that was freed, if any was
    assert np.array_equal(array, kept) and filler
    with pytest.raises(ValueError, match="read-only"):
        array[0] = 1.0
    with pytest.raises(ValueError):
        array.flags.writeable = True


def test_two_looks_at_one_step_share_their_memory_and_the_next_step_has_its_own(run):
    first, second = run.state.positions, run.state.positions
    assert np.shares_memory(first, second)
    run.step()
    assert not np.shares_memory(first, run.state.positions)


def test_shapes_and_values(run):
    state = run.state
    assert state.positions.shape == state.velocities.shape == (10, 3) and state.orientations.shape == (10, 4)
    assert state.masses.tolist() == [1.0] * 10 and state.radii.tolist() == [0.4] * 10
    assert state.orientations.tolist() == [[1, 0, 0, 0]] * 10
    assert len(state) == 10 and state.step == 0 and state.time == 0
    assert state.groups["all"].tolist() == list(range(10)) and state.groups["last"].tolist() == [9]
    bonds = state.bonds
    assert bonds["i"].tolist() == list(range(9)) and bonds["j"].tolist() == list(range(1, 10))
    assert bonds["broken"].dtype == bool and not bonds["broken"].any() and bonds["length_at_rest"].tolist() == [1.0] * 9
    run.step(50)
    moved = run.state
    strain = np.linalg.norm(np.diff(moved.positions, axis=0), axis=1) - 1
    assert moved.bonds["axial_force"] == pytest.approx(strain, rel=1e-9)  # c_A = 1
    assert moved.displacements == pytest.approx(moved.positions - state.positions)
    assert np.linalg.norm(moved.orientations, axis=1) == pytest.approx(1.0, abs=1e-14)


def test_contacts_are_the_pairs_that_overlap_and_are_not_bonded(keys):
    keys["specimen"] = [{"kind": "list", "positions": [[0, 0, 0], [1, 0, 0], [1, 0.75, 0]],
                         "radius": 0.4, "mass": 1.0}]
    keys["bonds"][0].update(pairs=[[0, 1]])
    del keys["bonds"][0]["distance"]
    keys["contact"] = {"law": "paper-hertz", "c_H": 1.0, "pairs": "unbonded"}
    contacts = vbond.Run(vbond.Case.from_dict(keys)).state.contacts
    assert contacts["i"].tolist() == [1] and contacts["j"].tolist() == [2]
    assert contacts["overlap"] == pytest.approx([0.05], rel=1e-14)  # 2 radius - 0.75
    del keys["contact"]
    assert vbond.Run(vbond.Case.from_dict(keys)).state.contacts["i"].shape == (0,)


def test_history_is_a_copy_of_its_own(run):
    run.step(30)
    history = run.history
    history["time"][:] = -1
    assert run.history["time"][0] == 0
    assert history["step"].dtype == np.int64


def test_temperatures_are_there_where_particles_are_heated(keys):
    assert vbond.Run(vbond.Case.from_dict(keys)).state.temperatures.shape == (0,)
    keys["bonds"][0]["expansion"] = 1e-6
    keys["stage"][0]["temperatures"] = [{"group": "all", "temperature": 2.0}]
    run = vbond.Run(vbond.Case.from_dict(keys))
    run.run()
    assert run.state.temperatures.tolist() == [2.0] * 10


def test_particles_that_have_not_come_in_or_are_gone_are_told():
    keys = {
        "specimen": [{"name": "ball", "kind": "list", "positions": [[0, 0, 9]], "radius": 0.4, "mass": 1.0},
                     {"name": "drop", "kind": "list", "positions": [[0, 0, 0], [0.9, 0, 0]], "radius": 0.4, "mass": 1.0}],
        "contact": {"law": "linear", "k": 100.0},
        "source": [{"name": "rain", "specimen": "drop", "count": 2, "rate": 20.0, "every": 0.1,
                    "box": {"min": [-2, -2, 5], "max": [2, 2, 7]}, "velocity": [0, 0, -10]}],
        "sink": [{"box": {"min": [-3, -3, -9], "max": [3, 3, 3]}, "every": 0.1}],
        "time": {"step": 0.01},
        "stage": [{"duration": 1.0}],
        "output": {"history": {"every": 0.1}},
    }
    run = vbond.Run(vbond.Case.from_dict(keys))
    counts = []
    run.on_step(10, lambda now: counts.append(now.state.there.sum()))
    run.step(0)
    assert run.state.there.tolist() == [True, *[False] * (len(run.state) - 1)]
    run.run()
    assert run.state.there.dtype == bool and max(counts) > 1
    assert run.state.there.tolist() == [True, *[False] * (len(run.state) - 1)]
    assert [1, *counts, 1] == run.history["particles"].tolist()

"""Mistakes: each is an exception that says what is wrong and how to mend it, and none harms the interpreter."""

import copy
import gc
import pickle

import numpy as np
import pytest

import vbond
from conftest import clamp, rod_keys

mistakes = {
    "a key that does not exist": (lambda: changed(bonds={"radios": 1}), vbond.CaseError, "bonds.*radios"),
    "a wrong unit": (lambda: changed(stage={"duration": "2 kg"}), vbond.CaseError, "a time is a bare number"),
    "a value out of its range": (lambda: changed(bonds={"nu": 0.7}), vbond.CaseError, "nu.* 0.5"),
    "None for a value": (lambda: changed(bonds={"nu": None}), TypeError, r"bonds\[0\].nu: NoneType.*leave the key out"),
    "an object for a value": (lambda: changed(bonds={"nu": object()}), TypeError, r"bonds\[0\].nu: object has no place"),
    "a complex number for a value": (lambda: changed(bonds={"nu": 1j}), TypeError, "complex has no place"),
    "NaN for a value": (lambda: changed(bonds={"E": float("nan")}), vbond.CaseError, r"bonds\[0\].E"),
    "a key that is no text": (lambda: vbond.Case.from_dict({1: 2}), TypeError, "keys are texts, not 1"),
    "a list for a case": (lambda: vbond.Case.from_dict([1]), TypeError, "a case is a dict"),
    "an empty case": (lambda: vbond.Case.from_dict({}), vbond.CaseError, "specimen"),
    "a file that is not there": (lambda: vbond.Case.from_file("nowhere.toml"), vbond.IoError, "nowhere.toml"),
    "a change of what is not there": (lambda: case().changed({"bonds[7].E": 1}), vbond.CaseError, r"bonds\[7\]"),
    "a change without a key": (lambda: case().changed({3: 1}), TypeError, "a key is a text"),
    "a dict in place of a case": (lambda: vbond.Run(rod_keys()), TypeError, "takes a vbond.Case, not dict"),
    "no threads": (lambda: vbond.Run(case(), threads=0), ValueError, "threads = 0: it must be >= 1"),
    "steps back": (lambda: run().step(-1), ValueError, r"step\(-1\).*>= 0"),
    "half a step": (lambda: run().step(1.5), TypeError, "step"),
    "steps of a static stage": (lambda: static().step(), ValueError, "is static: run_stage"),
    "on after the end": (lambda: ended().step(), ValueError, "all its stages are behind it"),
    "velocities of another shape": (lambda: run().set_velocities(np.zeros((10, 2))), ValueError, r"shape \(10, 3\) is wanted, not \(10, 2\)"),
    "velocities of other particles": (lambda: run().set_velocities(np.zeros((9, 3))), ValueError, r"\(10, 3\) is wanted, not \(9, 3\)"),
    "velocities of text": (lambda: run().set_velocities([["a"] * 3] * 10), TypeError, "numbers is wanted, not of dtype <U1"),
    "velocities of complex numbers": (lambda: run().set_velocities(np.zeros((10, 3), complex)), TypeError, "complex128"),
    "velocities that are ragged": (lambda: run().set_velocities([[1], [1, 2]]), (TypeError, ValueError), "velocities|inhomogeneous"),
    "infinite velocities": (lambda: run().set_velocities(np.full((10, 3), np.inf)), ValueError, "must be finite"),
    "a force of two numbers": (lambda: run().add_load("all", force=[1, 2]), ValueError, r"three numbers are wanted, not shape \(2,\)"),
    "a load on nobody": (lambda: run().add_load([]), ValueError, "must be given"),
    "a load on one twice": (lambda: run().add_load([1, 1]), ValueError, "each once"),
    "a load on no particle": (lambda: run().add_load([10]), IndexError, "particle 10 of 10, counted from 0"),
    "a load on a group that is not there": (lambda: run().add_load("tail"), ValueError, 'no group "tail"; the groups are all'),
    "loads before there are any": (lambda: run().loads, ValueError, r"step\(0\)"),
    "callbacks at no interval": (lambda: run().on_step(0, print), ValueError, "every must be >= 1, not 0"),
    "a callback that cannot be called": (lambda: run().on_step(1, 7), TypeError, "on_step"),
    "a callback that answers something": (lambda: calls(lambda now: 7), TypeError, "returns None, True .* not 7"),
    "a callback that steps": (lambda: calls(lambda now: now.step()), ValueError, "a callback of this run may look at it"),
    "a callback that ends the stage itself": (lambda: calls(lambda now: now.end_stage()), ValueError, "may look at it"),
    "writing to what a run shows": (lambda: run().state.positions.__setitem__(0, 1), ValueError, "read-only"),
    "setting what a run shows": (lambda: setattr(run(), "time", 3), AttributeError, ""),
    "an unknown option of calibrate": (lambda: vbond.calibrate(1, 1, radius=2), TypeError, "radius.*diameter"),
    "a wrong unit for calibrate": (lambda: vbond.calibrate("2 mm", 1, diameter=0.1), vbond.CaseError, "force/length"),
    "a theory that is none": (lambda: vbond.calibrate(1, 1, diameter=0.1, theory="mine"), ValueError, "mine.*timoshenko"),
    "a sweep of nothing": (lambda: vbond.sweep(case(), "nowhere", {}), ValueError, "no key to sweep"),
    "an unknown option of a test": (lambda: vbond.laboratory_test(case(), "tension", "nowhere", length=2), ValueError, "length.*axis"),
    "an unknown option of strengths": (lambda: vbond.calibrate_strengths(case(), "nowhere", tensile=1, span=2), ValueError, "span.*axis"),
    "no strengths to calibrate": (lambda: vbond.calibrate_strengths(case(), "nowhere"), ValueError, "tensile, compressive or toughness"),
    "a fit of nothing": (lambda: vbond.fit(case(), "data.csv", "nowhere.toml", [], "time", {}), ValueError, "vary is a list"),
}


def case(**sections) -> vbond.Case:
    keys = rod_keys()
    for section, values in sections.items():
        keys[section][0].update(values)
    return vbond.Case.from_dict(keys)


changed = case


def run() -> vbond.Run:
    return vbond.Run(case())


def static() -> vbond.Run:
    return vbond.Run(case().with_stages([{"kind": "equilibrium", "name": "hang", "supports": [clamp]}]))


def ended() -> vbond.Run:
    done = run()
    done.run()
    return done


def calls(callback):
    called = run()
    called.on_step(5, callback)
    called.run()


@pytest.mark.parametrize("name", mistakes)
def test_each_mistake_is_told(name):
    attempt, kind, words = mistakes[name]
    with pytest.raises(kind, match=words):
        attempt()


def test_objects_that_were_never_made_are_refused():
    for kind in (vbond.State, vbond.StageResult, vbond.StaticResult, vbond.CriticalLoad):
        with pytest.raises(TypeError):
            kind()

    class Mine(vbond.Run):
        def __init__(self):
            pass

    with pytest.raises(TypeError, match="__init__"):
        Mine()


def test_a_run_whose_case_was_refused_can_be_shown():
    seen = []

    class Kept(vbond.Run):
        def __init__(self, *given):
            seen.append(self)
            super().__init__(*given)

    keys = rod_keys()
    keys["bonds"][0]["distance"] = 0.5
    with pytest.raises(vbond.CaseError):
        Kept(vbond.Case.from_dict(keys))
    for look in (lambda: seen[0].step(), lambda: seen[0].state, lambda: seen[0].complete):
        with pytest.raises(ValueError, match="could not be made"):
            look()
    assert "could not be made" in repr(seen[0])


def test_runs_are_neither_copied_nor_pickled():
    for attempt in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError):
            attempt(run())


def test_a_run_that_is_made_again_is_refused():
    made = run()
    with pytest.raises(ValueError, match="made before"):
        made.__init__(case())
    assert made.step() == 1


def test_memory_of_many_runs_is_given_back():
    for _ in range(50):
        some = run()
        some.step(3)
        some.state.positions
    gc.collect()

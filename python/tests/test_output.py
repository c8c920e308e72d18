"""Output folders: written by the program, read back; sweeps; pictures."""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest

import vbond
from conftest import clamp, rod_keys
from vbond import plots


@pytest.fixture(scope="module")
def out(tmp_path_factory) -> vbond.Output:
    keys = rod_keys(8)
    keys["output"]["frames"] = {"every": "2 T0"}
    keys["bonds"][0]["strength"] = {"criterion": "stress", "tension": 0.3, "shear": 0.3}
    return vbond.run(vbond.Case.from_dict(keys), tmp_path_factory.mktemp("runs") / "out")


def test_history_summary_and_status(out):
    assert out.history["time"][0] == 0 and len(out.history["total"]) == 21
    assert out.summary["particles"] == 8 and out.status["state"] == "complete"
    assert out.dataframe()["time"].iloc[-1] == out.history["time"][-1]


def test_frames_are_read_when_they_are_asked_for(out):
    frames = out.frames
    assert len(frames) == 3 and frames[0].time == 0 and [frame.time for frame in frames][-1] == frames[-1].time
    assert frames[1].particles["position"].shape == (8, 3) and frames[1].particles["velocity"].shape == (8, 3)
    assert len(frames[1].bonds["i"]) == 7 and "axial_force" in frames[1].bonds
    assert np.array_equal(frames[-1].particles["position"] - frames[0].particles["position"],
                          frames[-1].particles["displacement"])


def test_breaks_are_columns(out):
    breaks = out.breaks
    assert len(breaks["bond"]) == out.summary["broken"] > 0
    assert set(breaks["mode"]) <= {"tension", "shear", "bending", "torsion", "compression", "other"}
    assert np.all(np.diff(breaks["time"]) >= 0)
    assert out.fragments["particles"].sum() == 8


def test_a_folder_that_is_none_and_damaged_files_are_told(tmp_path, out):
    with pytest.raises(vbond.IoError, match="not an output folder"):
        vbond.open(tmp_path)
    (tmp_path / "resolved.toml").write_text("")
    empty = vbond.open(tmp_path)
    assert empty.history == {} and empty.breaks == {} and len(empty.frames) == 0
    with pytest.raises(vbond.IoError, match="run.json"):
        empty.summary
    (tmp_path / "run.json").write_text("{")
    with pytest.raises(vbond.IoError, match="damaged"):
        empty.summary
    frame = out.frames[0]
    frame._files[0].with_suffix(".bak").write_bytes(frame._files[0].read_bytes()[:-40])
    with pytest.raises(vbond.IoError):
        vbond.Frame(0, frame._files[0].with_suffix(".bak"), None).particles


def test_a_notebook_shows_the_page(out):
    assert "report() writes the page" in out._repr_html_()
    (out.folder / "report.html").write_text('<p title="x">&</p>')
    assert 'srcdoc="&lt;p title=&quot;x&quot;&gt;&amp;amp;' in out._repr_html_().replace("&amp;&lt;", "&amp;amp;&lt;")


def test_a_run_is_not_replaced_unasked_and_failures_are_told(tmp_path):
    case = vbond.Case.from_dict(rod_keys(3))
    vbond.run(case, tmp_path / "out")
    with pytest.raises(vbond.ProgramError, match="out") as told:
        vbond.run(case, tmp_path / "out")
    assert told.value.status in (2, 3)
    vbond.run(case, tmp_path / "out", force=True, threads=1)


def test_a_sweep_is_a_table_with_failures_and_is_not_done_twice(tmp_path):
    case = vbond.Case.from_dict(rod_keys(3))
    wanted = {"velocities[0].seed": [1, 2], "bonds[0].nu": [0.1, 0.9]}
    rows = vbond.sweep(case, tmp_path / "sweep", wanted, jobs=2)
    assert [row["ended"] for row in rows] == ["done", "failed", "done", "failed"]
    assert any("nu" in str(value) for value in rows[1].values())
    journal = (tmp_path / "sweep/sweep.journal").read_bytes()
    assert vbond.sweep(case, tmp_path / "sweep", wanted, jobs=2) == rows
    assert (tmp_path / "sweep/sweep.journal").read_bytes() == journal


def test_keys_of_a_sweep_go_together(tmp_path):
    case = vbond.Case.from_dict(rod_keys(3))
    rows = vbond.sweep(case, tmp_path / "sweep", {"bonds[0].nu,title": [(0.1, "a:b, c"), (0.2, 'd"')]})
    assert [(row["bonds[0].nu"], row["title"], row["ended"]) for row in rows] == [
        (0.1, '"a:b, c"', "done"), (0.2, '"d\\""', "done")]
    with pytest.raises(ValueError, match="2 keys go together"):
        vbond.sweep(case, tmp_path / "other", {"bonds[0].nu,title": [0.1, 0.2]})


def test_a_case_is_changed_again_and_again():
    case = vbond.Case.from_dict(rod_keys(3)).changed({"bonds[0]": rod_keys(3)["bonds"][0]})
    assert case.changed({"bonds[0].nu": 0.3}).changed({"bonds[0].nu": 0.4}).text.count("nu = 0.4")
    whole = {"bonds[0]": rod_keys(3)["bonds"][0]}
    assert "\nnu = 0.2" in case.changed({"bonds[0].nu": 0.3}).changed(whole).text


def test_what_is_varied_is_the_case_as_given_and_not_defaults_that_follow_from_it(tmp_path):
    keys = rod_keys(3)
    keys["bonds"][0]["theory"] = "timoshenko"  # its shear factor follows from nu
    (tmp_path / "rod.csv").write_text("x,y,z\n0,0,0\n1,0,0\n2,0,0\n")
    keys["specimen"] = [{"kind": "csv", "file": "rod.csv", "radius": 0.4, "mass": 1.0}]
    keys["groups"] = {"root": {"indices": [0]}, "tip": {"indices": [2]}}
    case = vbond.Case.from_dict(keys, tmp_path).changed({"stage[fly].duration": "1 T0", "stage[0].damping.translation": 0.1})
    points = [(0.1, 0.2), (0.4, 0.3)]

    def energy_at(case, nu, diameter):
        run = vbond.Run(case.changed({"bonds[0].nu": nu, "bonds[0].section.diameter": diameter}))
        run.run()
        return run.history["U_B"][-1]

    rows = vbond.sweep(case, tmp_path / "sweep", {"bonds[0].nu,bonds[0].section.diameter": points})
    of_same_stages = case.with_stages(vbond.Case.from_text(case.text).keys["stage"])
    for row, point in zip(rows, points, strict=True):
        assert row["history.U_B"] == energy_at(case, *point) == energy_at(of_same_stages, *point) > 0

    bend = case.with_stages([{"kind": "equilibrium", "name": "bend", "steps": 2, "supports": [{**clamp, "group": "root"}],
                              "loads": [{"group": "tip", "force": [0, 1e-6, 0]}]}])
    bend = bend.changed({"output.history.displacements": ["tip"]})
    (tmp_path / "bent.csv").write_text("load_factor,w\n0,0\n0.5,1e-4\n1,2e-4\n")
    found = vbond.fit(bend, tmp_path / "bent.csv", tmp_path / "fitted.toml", ["bonds[0].section.diameter"], "load_factor",
                      {"displacement.tip.y": "w"})
    again = vbond.Run(vbond.Case.from_file(tmp_path / "fitted.toml"))
    again.run()
    assert found["values"][0]["value"] != 0.2 and again.history["displacement.tip.y"][-1] == pytest.approx(2e-4, rel=1e-3)


def test_pictures(out, run):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = plots.curves(out.history, "total", "U_L")
    assert len(axes.lines) == 2 and axes.get_xlabel() == "time"
    with pytest.raises(KeyError, match="there is no column"):
        plots.curves(out.history, "nothing")
    assert plots.body(run.state).collections and plots.cracks(run.state).collections
    solution = vbond.modes(run.case, count=7)
    assert plots.mode(solution.state, solution.modes[-1]).collections


def test_the_program_is_found(monkeypatch):
    program = vbond.find_program()
    said = subprocess.run([program, "--version"], capture_output=True, text=True).stdout
    assert vbond.__version__ in said
    assert json.loads(json.dumps(vbond.__version__)) == vbond.__version__


def test_a_laboratory_test_is_the_result_as_a_dict(tmp_path):
    # a cubic lattice: E = c_A/a, and the strength of its bonds over a^2
    case = vbond.Case.from_dict({"specimen": [{"kind": "block", "cells": [3, 3, 8], "mass": 1.0, "radius": 0.5}],
                                 "bonds": [{"distance": 1.1, "stiffness": {"c_A": 1.0, "c_D": 0.3, "c_B": 0.1, "c_T": 0.1},
                                            "strength": {"criterion": "linear", "axial_force": 1e-3, "shear_force": 1, "bending_moment": 1,
                                                         "torque": 1}}],
                                 "stage": [{"duration": 1}]})
    found = vbond.laboratory_test(case, "tension", tmp_path / "pulled", strain=0.01)
    assert found["E"] == pytest.approx(1, rel=1e-7) and found["strength"] == pytest.approx(1e-3, rel=1e-9) and found["axis"] == "z"
    assert (tmp_path / "pulled/test.toml").exists()
    with pytest.raises(vbond.ProgramError, match="needs a disc"):
        vbond.laboratory_test(case, "brazilian", tmp_path / "pressed")


def test_strengths_are_calibrated(tmp_path):
    # the columns of a cubic lattice bear the limit of their bonds over all of the section
    case = vbond.Case.from_dict({"specimen": [{"kind": "block", "cells": [3, 3, 8], "mass": 1.0, "radius": 0.5}],
                                 "bonds": [{"distance": 1.1, "theory": "bernoulli-euler", "E": 1.0, "nu": 0.0,
                                            "section": {"shape": "square", "side": 1.0},
                                            "strength": {"criterion": "stress", "tension": 1e-3, "shear": 1e-2}}],
                                 "stage": [{"duration": 1}]})
    found = vbond.calibrate_strengths(case, tmp_path / "found", tensile=2e-3)
    assert found["end"] == "reached" and found["nearest"]["changes"][0].startswith("bonds[0].strength.tension=0.002")
    none = vbond.calibrate_strengths(case, tmp_path / "none", compressive=1e-3, strain=1e-3)  # columns do not break
    assert none["end"] == "no strength" and none["nearest"] is None and "no peak" in none["failure"]


def test_toughness_of_a_notched_beam(tmp_path):
    beam = vbond.Case.from_dict({"specimen": [{"kind": "block", "cells": [37, 1, 8], "mass": 1.0, "radius": 0.5}],
                                 "bonds": [{"distance": 1.1, "theory": "bernoulli-euler", "E": 1.0, "nu": 0.0,
                                            "section": {"shape": "square", "side": 1.0},
                                            "strength": {"criterion": "stress", "tension": 1e-4, "shear": 1e-3}}],
                                 "stage": [{"duration": 1}]})
    found = vbond.laboratory_test(beam, "bend3", tmp_path / "notched", axis="x", notch="50 %", E=1)
    assert found["notch"]["depth"] == 4 and found["G_Ic"] == pytest.approx(found["K_Ic"]**2)
    twice = vbond.calibrate_strengths(beam, tmp_path / "twice", toughness=2 * found["K_Ic"], axis="x")
    assert twice["end"] == "reached" and twice["evaluations"][-1]["factors"]["tension"] == pytest.approx(2, rel=1e-2)


def test_a_fit_is_the_result_as_a_dict(tmp_path):
    examples = Path(__file__).resolve().parents[2] / "examples"
    case = vbond.Case.from_file(examples / "stem_bending.toml")
    asked = (case, examples / "stem_bending.csv", tmp_path / "fitted.toml", ["bonds[fibre].k_n=log"], "load_factor",
             {"displacement.last.z": "deflection [mm]"})
    found = vbond.fit(*asked, sigma=5e-5)
    assert found["end"] == "converged" and found["sigma_known"]
    low, high = found["values"][0]["interval_95"]
    assert low < 3.67e10 < high
    assert vbond.fit(*asked, sigma=[5e-5]) == found
    k_n, unit = vbond.Case.from_file(tmp_path / "fitted.toml").keys["bonds"][0]["k_n"].split()
    assert float(k_n) == pytest.approx(found["values"][0]["value"]) and unit == "N/m^3"
    with pytest.raises(vbond.ProgramError, match="no column"):
        vbond.fit(*asked[:2], tmp_path / "other.toml", asked[3], "load_factor", {"displacement.last.z": "z"})

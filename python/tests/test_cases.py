"""Cases from files, texts and dicts are the same case; mistakes are told with their places."""

import csv
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import vbond
from conftest import clamp, rod_keys, root

example = root / "examples/two_particles.toml"


def bits(history: dict) -> dict:
    return {name: column.tobytes() for name, column in history.items()}


def history(case: vbond.Case, threads: int = 1) -> dict:
    run = vbond.Run(case, threads)
    run.run()
    return bits(run.history)


def test_the_same_case_from_file_text_and_dict_gives_the_same_bits_as_the_program(tmp_path):
    changes = {"stage[0].duration": "3 T0"}
    from_file = vbond.Case.from_file(example, changes)
    from_text = vbond.Case.from_text(example.read_text(), root / "examples").changed(changes)
    from_dict = vbond.Case.from_dict(from_file.keys, root / "examples").changed(changes)
    from_defaults = vbond.Case.from_text(from_file.text)
    wanted = history(from_file)
    assert len(wanted["time"]) > 8 * 10
    for case in (from_text, from_dict, from_defaults):
        assert history(case) == wanted
    written = vbond.run(from_dict, tmp_path / "out").history
    run = vbond.Run(from_file)
    run.run()
    for name, column in run.history.items():  # 17 digits give back every double
        assert np.array_equal(column, written[name], equal_nan=True), name


def test_a_c_plus_plus_program_gives_the_same_bits(tmp_path):
    if "VBOND_ROD" not in os.environ:
        pytest.skip("VBOND_ROD names the program that rod.cpp makes: ctest does")
    keys = rod_keys()
    keys["velocities"] = [{"group": "first", "velocity": [0.01, 0.002, 0], "angular_velocity": [0.02, 0, 0.03]}]
    keys["time"] = {"step": 0.125}
    keys["stage"] = [{"name": "fly", "duration": 250.0}]
    keys["output"] = {"history": {"every": 1.25}}
    case = vbond.Case.from_dict(keys)
    (tmp_path / "rod.toml").write_text(case.text)
    subprocess.run([os.environ["VBOND_ROD"], tmp_path], check=True)
    with open(tmp_path / "history.csv") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 201
    for same in (case, vbond.Case.from_file(tmp_path / "rod.toml")):
        run = vbond.Run(same)
        run.run()
        assert list(run.history) == list(rows[0])
        for name, column in run.history.items():
            written = np.array([float(row[name] or "nan") for row in rows])
            assert np.array_equal(column, written, equal_nan=True), name


def test_every_example_reads_the_same_from_its_dict():
    for file in sorted((root / "examples").glob("*.toml")):
        case = vbond.Case.from_file(file)
        assert vbond.Case.from_dict(case.keys, file.parent).text == case.text, file.name


def test_changes_are_those_of_the_command_line(case):
    assert 'law = "evm"' in case.changed({"bonds[rod].law": "evm"}).text
    assert case.changed({"title": 'a "b" \\ \n c'}).title == 'a "b" \\ \n c'
    assert case.title == "rod"
    assert case.changed({"title": "x"}).changed({"stage[0].duration": "1 T0"}).title == "x"
    with pytest.raises(vbond.CaseError, match=r"bonds\[0\].E"):
        case.changed({"bonds[0].E": -1.0})


def test_a_dict_takes_numbers_and_arrays_of_numpy(keys):
    keys["specimen"] = [{"kind": "list", "positions": np.outer(np.arange(3.0), [0, 1, 0]), "radius": np.float64(0.4), "mass": np.int64(1)}]
    run = vbond.Run(vbond.Case.from_dict(keys))
    assert run.state.positions.tolist() == [[0, 0, 0], [0, 1, 0], [0, 2, 0]]


def test_mistakes_have_places_in_files_and_keys_in_dicts(tmp_path, keys):
    file = tmp_path / "bad.toml"
    file.write_text(example.read_text().replace("radius =", "radios ="))
    with pytest.raises(vbond.CaseError) as told:
        vbond.Case.from_file(file)
    first = told.value.problems[0]
    assert first["file"] == str(file) and first["line"] > 1 and first["column"] == 1
    assert "radios" in first["what"] and "radius" in first["way_out"]
    assert f"{file}:{first['line']}:1" in str(told.value)
    keys["bonds"][0]["nu"] = 0.7
    keys["stage"][0]["duration"] = "4 parsec"
    with pytest.raises(vbond.CaseError) as told:
        vbond.Case.from_dict(keys)
    whats = [problem["what"] for problem in told.value.problems]
    assert len(whats) == 2 and any("bonds[0].nu" in what for what in whats)
    assert all(problem["line"] is None for problem in told.value.problems)
    keys = rod_keys()
    keys["bonds"][0]["distance"] = 0.5  # which is seen only as the body is built
    with pytest.raises(vbond.CaseError, match="^bonds") as told:
        vbond.Run(vbond.Case.from_dict(keys))
    assert told.value.problems[0]["line"] is None


def test_stages_can_be_replaced(case):
    held = case.with_stages([{"kind": "equilibrium", "name": "hang", "supports": [clamp],
                              "loads": [{"group": "last", "force": [0, 1e-4, 0]}]}])
    run = vbond.Run(held)
    assert run.stage == "hang"
    assert run.run()[0].kind == "equilibrium"


def test_files_that_a_case_names_are_looked_for_in_its_folder(tmp_path):
    (tmp_path / "points.csv").write_text("x,y,z\n0,0,0\n1,0,0\n")
    keys = rod_keys()
    keys["specimen"] = [{"kind": "csv", "file": Path("points.csv"), "radius": 0.4, "mass": 1.0}]
    assert len(vbond.Run(vbond.Case.from_dict(keys, tmp_path)).state) == 2
    with pytest.raises(vbond.Error):
        vbond.Run(vbond.Case.from_dict(keys, tmp_path / "elsewhere"))


def test_keys_are_listed():
    keys = {key["path"]: key for key in vbond.list_keys()}
    assert keys["bonds.nu"]["meaning"] and keys["bonds.nu"]["type"]


def test_calibrate_gives_the_closed_forms():
    rod = vbond.calibrate(31.830988618379067, 1, diameter=0.2)["bernoulli-euler"]
    assert rod["c_A"] == pytest.approx(1, rel=1e-14) and rod["c_D"] == pytest.approx(0.03, rel=1e-14)
    assert rod["c_B"] == pytest.approx(0.0025, rel=1e-14) and rod["v-model"]["B2"] == pytest.approx(-0.005, rel=1e-14)
    assert rod["evm"]["B2"] == pytest.approx(0.03, rel=1e-14)
    shell = vbond.calibrate(3.0, 1, nu=0.0, thickness=0.5)
    assert list(shell) == ["shell"]
    assert shell["shell"]["c_A"] == pytest.approx(1.5 / 3**0.5) and shell["shell"]["c_B"] == pytest.approx(1.5 / 3**0.5 / 48)
    assert list(vbond.calibrate("2 GPa", "1 mm", side="0.1 mm", theory="bernoulli-euler")) == ["bernoulli-euler"]

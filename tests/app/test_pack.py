"""Packed grains through the program: what is told, what is written, and that it is read again."""
import csv
import json
from pathlib import Path

from program import vbond

PACKED = """[cell]
a = [12, 0, 0]
b = [0, 12, 0]
c = [3, 0, 12]
[[specimen]]
name = "rock"
kind = "packing"
density = 2.0
grains = [{radii = [0.7, 1.1]}]
porosity = 0.5
"""
STAGE = """[time]
step = 0.5
[[stage]]
name = "wait"
duration = 1
"""
READ = """[cell]
CELL
[[specimen]]
name = "rock"
kind = "KIND"
file = "FILE"
"""


def positions(file):
    with open(file, encoding="utf-8") as rows:
        return [tuple(map(float, row.values())) for row in csv.DictReader(rows)]


def test_a_packing_is_written_and_read_again():
    Path("packed.toml").write_text(PACKED + STAGE, encoding="utf-8")
    vbond("pack packed.toml -o grains.csv", out=["porosity 0.5", "neighbours", "particles in grains.csv"])
    vbond("pack packed.toml -o grains.data", out="particles in grains.data")
    vbond("pack packed.toml -o grains.csv", status=3, err="is there already")
    grains = positions("grains.csv")
    assert len(grains) > 100 and min(row[3] for row in grains) < 0.75 < 1.05 < max(row[3] for row in grains)
    data = Path("grains.data").read_text(encoding="utf-8")
    assert f"{len(grains)} atoms" in data and "3 0 12 cvec" in data
    for kind, file, cell in (("csv", "grains.csv", "a = [12, 0, 0]\nb = [0, 12, 0]\nc = [3, 0, 12]"),
                             ("lammps", "grains.data", 'from_specimen = "rock"')):
        text = READ.replace("KIND", kind).replace("FILE", file).replace("CELL", cell)
        Path("read.toml").write_text(text + STAGE, encoding="utf-8")
        vbond("check read.toml", out=[f"particles        {len(grains)}\n", "volume 1728"])
    vbond("pack read.toml -o more.csv", status=2, err="packs no grains")


def test_run_json_tells_of_packings():
    Path("packed.toml").write_text(PACKED + STAGE, encoding="utf-8")
    vbond("check packed.toml", out=["porosity 0.5", "contacts of a grain, largest"], no_out="rattlers")  # nothing holds them
    vbond("run packed.toml -o out", out="porosity 0.5")
    packing = json.loads(Path("out/run.json").read_text(encoding="utf-8"))["packings"][0]
    assert packing["name"] == "rock" and abs(packing["porosity"] - 0.5) < 1e-9
    assert packing["overlap"] <= 1e-3 and len(packing["rdf"]) == 150
    assert abs(sum(packing["rdf"][-25:]) / 25 - 1) < 0.1, "far away grains are not as frequent as on the mean"
    cells = [packing[f"{which}_cell_volume"] for which in ("least", "mean", "largest")]
    assert abs(cells[1] * packing["grains"] / 1728 - 1) < 1e-12, "cells do not fill the vessel"
    assert 0.2 * cells[1] < cells[0] < 0.9 * cells[1] and 1.1 * cells[1] < cells[2] < 4 * cells[1]
    local = [packing[f"{which}_local_porosity"] for which in ("least", "mean", "largest")]
    assert 0.2 < local[0] < local[1] - 0.05 and local[1] + 0.05 < local[2] < 0.8
    assert 12 < packing["cell_faces"] < 16


def test_cells_are_not_told_of_vessels_that_planes_do_not_bound():
    text = PACKED.replace('name = "rock"', 'name = "rock"\nvessel = [{sphere = {centre = [6, 6, 6], radius = 2}, keep = "outside"}]')
    Path("hollow.toml").write_text(text.replace("c = [3, 0, 12]", "c = [0, 0, 12]") + STAGE, encoding="utf-8")
    vbond("run hollow.toml -o hollow", out="porosity 0.5", no_out="faces")
    packing = json.loads(Path("hollow/run.json").read_text(encoding="utf-8"))["packings"][0]
    assert packing["least_cell_volume"] == packing["cell_faces"] == packing["largest_local_porosity"] == -1


def test_what_cannot_be_packed_is_refused():
    Path("dense.toml").write_text(PACKED.replace("0.5", "0.2") + STAGE, encoding="utf-8")
    vbond("run dense.toml -o none", status=2, err=["dense.toml:5:1", "porosity = 0.2", "can be had"])
    assert not Path("none").exists()

"""Every frame is read by VTK, the library of ParaView, by itself: compressed, plain and in single precision, with its units;
the folders of one run in three formats are held against another, and against the reader in tools/. Skipped where Python
has no VTK; Debian: apt-get install python3-vtk9."""
import os
import struct
import sys
from pathlib import Path

import pytest
from program import ROOT, page, same_bytes, vbond, write

pytest.importorskip("vtkmodules.vtkIOXML")
from vtkmodules.vtkCommonCore import vtkDataArray  # noqa: E402
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader  # noqa: E402

sys.path.insert(0, str(ROOT / "tools"))
from vbond_output import read_vtp  # noqa: E402

# a block of several blocks of numbers, with nothing but zeros in some arrays; in SI
CASE = """units = {system = "SI"}
specimen = [{kind = "block", cells = [12, 10, 10], spacing = 1.0, radius = 0.4, mass = 1.0}]
bonds = [{distance = 1.1, stiffness = {c_A = 1.0, c_D = 0.03, c_B = 0.0025, c_T = 0.002}}]
velocities = [{kind = "gaussian", magnitude = 1e-3}]
time = {step = 0.1}
contact = {law = "linear", k = 1.0}
wall = [{name = "table", shape = "plane", point = [0, 0, -2], normal = [0, 0, 1]},
        {name = "ball", shape = "sphere", centre = [5, 5, 30], radius = 3, side = "outside"}]
stage = [{duration = 2.0, walls = [{wall = "ball", velocity = [0, 0, -1.0]}]}]
output = {history = {every = 1.0}, frames = {every = 1.0 FORMAT}}
"""
FORMATS = {"zlib": "", "none": ', compression = "none"', "single": ', precision = "float32"'}


@pytest.fixture(scope="module", autouse=True)
def runs(work):
    for name, frames in FORMATS.items():
        vbond("run", write(f"{name}.toml", CASE.replace(" FORMAT", frames)), "-o", name)
        vbond("report", name)


def test_formats_change_nothing_but_bytes():
    assert 'precision = "float64", compression = "zlib"' in Path("zlib/resolved.toml").read_text()
    assert same_bytes("zlib/history.csv", "single/history.csv"), "the format of frames changes the run"
    assert page("zlib", "data") and page("zlib", "data") == page("none", "data"), "compression changes the page, which is made of them"
    frames = {name: list(Path(name, "frames").glob("*.vtp")) for name in FORMATS}
    size = {name: sum(frame.stat().st_size for frame in frames[name]) for name in FORMATS}
    # less than half of the bytes, as single precision promises
    assert size["zlib"] < size["none"] and 2 * size["single"] < size["none"] + 8192 * len(frames["none"])


def read(path):
    complaints = []  # VTK only prints them otherwise
    reader = vtkXMLPolyDataReader()
    for event in ("ErrorEvent", "WarningEvent"):
        reader.AddObserver(event, lambda *_: complaints.append(event))
    reader.SetFileName(str(path))
    reader.Update()
    assert not complaints, f"{path}: VTK complains"
    return reader.GetOutput()


def values(array):
    return [array.GetComponent(k, c) for k in range(array.GetNumberOfTuples()) for c in range(array.GetNumberOfComponents())]


def arrays(body):
    named = {"Points": body.GetPoints().GetData()}
    for data in (body.GetPointData(), body.GetCellData(), body.GetFieldData()):
        named.update({data.GetArrayName(k): data.GetArray(k) for k in range(data.GetNumberOfArrays())})
    return named


def cells(body):
    of = body.GetLines() if body.GetNumberOfLines() else body.GetPolys() if body.GetNumberOfPolys() else body.GetVerts()
    return values(of.GetConnectivityArray()) + values(of.GetOffsetsArray())


def as_float32(x):
    return struct.unpack("f", struct.pack("f", x))[0]


def unit(array):
    return array.GetInformation().Get(vtkDataArray.UNITS_LABEL())


def test_frames_are_read():
    names = sorted(os.path.relpath(path, "zlib") for path in Path("zlib").glob("*/*.vtp"))
    assert len(names) > 4
    for name in names:
        one, plain, narrow = bodies = [read(Path(folder, name)) for folder in FORMATS]
        assert one.GetNumberOfPoints() > 1 and one.GetNumberOfCells() > 0, name
        assert cells(one) == cells(plain) == cells(narrow), name
        a, b, c = seen = [arrays(body) for body in bodies]
        assert a.keys() == b.keys() == c.keys() and {"TimeValue", "Step"} < a.keys(), name
        for key in a:
            assert unit(a[key]) == unit(b[key]) == unit(c[key]), f"{name}: {key}"
            assert values(a[key]) == values(b[key]), f"{name}: {key}"
            rounds = a[key].GetDataTypeAsString() == "double" and c[key].GetDataTypeAsString() == "float"
            assert [as_float32(x) if rounds else x for x in values(a[key])] == values(c[key]), f"{name}: {key}"
        for folder, by_vtk in zip(FORMATS, seen):
            ours = read_vtp(os.path.join(folder, name))
            for key in a.keys() - {"TimeValue", "Step"}:
                flat = [x for row in ours[key] for x in row] if a[key].GetNumberOfComponents() > 1 else list(ours[key])
                assert flat == values(by_vtk[key]), f"{name}: {key} of tools/vbond_output.py"
        assert unit(a["Points"]) == "m" and unit(a["id"]) is None, name
        assert unit(a["axial_force" if "bonds" in name else "velocity"]) in ("N", "m/s"), name
        assert a["Points"].GetDataTypeAsString() == "double" and c["Points"].GetDataTypeAsString() == "float", name

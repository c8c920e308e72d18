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
# a lattice that is sheared while it falls apart to all sides, so that particles go through faces
PERIODIC = """cell = {a = [4, 0, 0], b = [1, 4, 0], c = [0, 0, 4], corner = [-1, 0, 0.5], rotation = "triangular"}
specimen = [{kind = "block", cells = [4, 4, 4], spacing = 1.0, radius = 0.4, mass = 1.0}]
bonds = [{distance = 1.1, stiffness = {c_A = 1.0, c_D = 0.03, c_B = 0.0025, c_T = 0.002}}]
velocities = [{kind = "given", velocity = [0.6, -0.3, 0.2]}]
time = {step = 0.1}
stage = [{duration = 10.0, cell = {xy = {rate = 0.03}, zz = {rate = -0.01}}}]
output = {frames = {every = 5.0, wrap = true}, lammps_dump = true}
"""
FORMATS = {"zlib": "", "none": ', compression = "none"', "single": ', precision = "float32"'}


@pytest.fixture(scope="module", autouse=True)
def runs(work):
    for name, frames in FORMATS.items():
        vbond("run", write(f"{name}.toml", CASE.replace(" FORMAT", frames)), "-o", name)
        vbond("report", name)
    vbond("run", write("periodic.toml", PERIODIC), "-o", "periodic")


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


def rows(array):
    n = array.GetNumberOfComponents()
    flat = values(array)
    return [flat[k:k + n] for k in range(0, len(flat), n)]


def plus(x, *terms):
    return [x[c] + sum(n * y[c] for n, y in terms) for c in range(3)]


def close(x, y):
    return all(abs(a - b) < 1e-9 for a, b in zip(x, y))


def test_a_periodic_body_is_read_with_its_cell():
    shear, last = 0.03 * 10, "000000000100"
    edges = [[4, 0, 0], [1 + 4 * shear, 4, 0], [0, 0, 4 * (1 - 0.1)]]
    corner = [-1, 0, 0.5 * (1 - 0.1)]
    particles, bonds, cell = (arrays(read(f"periodic/frames/{kind}_{last}.vtp")) for kind in ("particles", "bonds", "cell"))
    for frame in (particles, cell):
        assert all(close(*pair) for pair in zip(rows(frame["cell"]), edges)), rows(frame["cell"])
        assert close(rows(frame["cell_corner"])[0], corner) and values(frame["cell_periodic"]) == [1, 1, 1]
    box = read(f"periodic/frames/cell_{last}.vtp")
    assert box.GetNumberOfLines() == 12
    ends, points = values(box.GetLines().GetConnectivityArray()), rows(cell["Points"])
    for k, which in enumerate(values(cell["edge"])):
        along = plus(points[int(ends[2 * k + 1])], (-1, points[int(ends[2 * k])]))
        assert close(along, edges[int(which)]), (k, along)
    shown, image = rows(particles["Points"]), [[int(n) for n in row] for row in rows(particles["image"])]
    assert len({tuple(n) for n in image}) > 3, "particles have gone through several faces"
    for x, n, u in zip(shown, image, rows(particles["displacement"])):
        parts = [x[c] - corner[c] for c in range(3)]  # in edges: the cell is a triangle of numbers
        z = parts[2] / edges[2][2]
        y = parts[1] / edges[1][1]
        assert all(-1e-9 <= part < 1 + 1e-9 for part in ((parts[0] - y * edges[1][0]) / edges[0][0], y, z)), x
        start = plus(plus(x, *zip(n, edges)), (-1, u))
        assert close([round(c) for c in start], start), "Points + image less displacement is no place of the lattice"
    ours = read_vtp(f"periodic/frames/particles_{last}.vtp")
    assert [list(row) for row in ours["image"]] == image and all(close(*pair) for pair in zip(ours["cell"], edges))
    ends, points = values(read(f"periodic/frames/bonds_{last}.vtp").GetLines().GetConnectivityArray()), rows(bonds["Points"])
    for i, j in zip(ends[::2], ends[1::2]):
        assert sum(x * x for x in plus(points[int(j)], (-1, points[int(i)]))) < 1.5 ** 2, "a line across the picture"
    assert len(points) > len(shown)
    dump = Path("periodic/dump.lammpstrj").read_text().splitlines()
    assert dump.count("ITEM: BOX BOUNDS xy xz yz pp pp pp") == 3 and dump.count("ITEM: TIMESTEP") == 3
    assert dump[8] == "ITEM: ATOMS id type x y z vx vy vz radius quatw quati quatj quatk ix iy iz"
    row = dump[-1].split()
    assert close([float(x) for x in row[2:5]], shown[-1]) and [int(n) for n in row[-3:]] == image[-1]

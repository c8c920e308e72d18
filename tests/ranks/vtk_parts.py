"""vtk_parts ONE PARTS: VTK, the library of ParaView, reads frames in parts, and finds in them what a run on one machine
has written whole, to 1e-7. Exit status 77 if there is no VTK."""
import re
import sys
from pathlib import Path

try:
    from vtkmodules.vtkCommonCore import vtkDataArray
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPPolyDataReader
except ImportError:
    sys.exit(77)


def read(path):
    reader = (vtkXMLPPolyDataReader if path.suffix == ".pvtp" else vtkXMLPolyDataReader)()
    complaints = []
    for event in ("ErrorEvent", "WarningEvent"):
        reader.AddObserver(event, lambda *what: complaints.append(what))
    reader.SetFileName(str(path))
    reader.Update()
    assert not complaints, f"{path}: VTK complains"
    return reader.GetOutput()


def tuples(data, name):
    array = data.GetArray(name)
    return [array.GetTuple(k) for k in range(array.GetNumberOfTuples())]


def arrays(data):
    """By name, in the order of ids."""
    order = sorted(range(data.GetNumberOfTuples()), key=lambda k: data.GetArray("id").GetTuple1(k))
    return {data.GetArrayName(a): [tuples(data, data.GetArrayName(a))[k] for k in order]
            for a in range(data.GetNumberOfArrays())}


def lines(body):
    """Both ends of each bond, in the order of ids."""
    ends = []
    for k in range(body.GetNumberOfCells()):
        points = body.GetCell(k).GetPoints()
        ends.append((body.GetCellData().GetArray("id").GetTuple1(k), points.GetPoint(0) + points.GetPoint(1)))
    return [places for _, places in sorted(ends)]


def frames(folder, kind):
    return [folder / name for name in re.findall('file="([^"]*)"', (folder / f"{kind}.pvd").read_text())]


def units(data):
    return {data.GetArrayName(a): data.GetArray(a).GetInformation().Get(vtkDataArray.UNITS_LABEL())
            for a in range(data.GetNumberOfArrays())}


def same(a, b, what):
    """Angles and what all particles share may be zero but for rounding: their scale is 1 at least."""
    assert len(a) == len(b), f"{what}: {len(a)} and {len(b)} values"
    at_least = 1.0 if what.endswith(("bend", "twist", "rotation")) else 1e-6
    scale = max([at_least] + [abs(x) for values in a for x in values])
    for of_a, of_b in zip(a, b):
        assert all(abs(x - y) <= 1e-7 * scale for x, y in zip(of_a, of_b)), f"{what}: {of_a} and {of_b}"


one, parts = Path(sys.argv[1]), Path(sys.argv[2])
in_parts = 0
for kind in ("particles", "bonds"):
    whole, others = frames(one, kind), frames(parts, kind)
    assert len(whole) == len(others) > 1
    for path, other in zip(whole, others):
        a, b = read(path), read(other)
        data = (a.GetPointData(), b.GetPointData()) if kind == "particles" else (a.GetCellData(), b.GetCellData())
        of_a, of_b = arrays(data[0]), arrays(data[1])
        assert of_a.keys() == of_b.keys(), f"{other}: {sorted(of_b)}"
        assert units(data[0]) == units(data[1]), f"{other}: {units(data[1])}"
        for name in of_a:
            same(of_a[name], of_b[name], f"{other}: {name}")
        if kind == "bonds":
            same(lines(a), lines(b), f"{other}: ends")
        in_parts += other.suffix == ".pvtp"
assert in_parts > 2

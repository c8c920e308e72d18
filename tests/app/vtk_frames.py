"""Reads frames of vbond with VTK, as ParaView does, and holds the folders of one run in three formats against another,
and against the reader in tools/: vtk_frames.py TOOLS ZLIB NONE FLOAT32. Exit status 77 if there is no VTK."""
import glob
import os
import struct
import sys

try:
    from vtkmodules.vtkCommonCore import vtkDataArray, vtkVersion
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
except ImportError:
    sys.exit(77)
sys.path.insert(0, sys.argv[1])
from vbond_output import read_vtp  # noqa: E402


class Errors:
    """Counts what VTK complains about: it only prints it otherwise."""

    def __init__(self, reader):
        self.count = 0
        for event in ("ErrorEvent", "WarningEvent"):
            reader.AddObserver(event, self.add)

    def add(self, *_):
        self.count += 1


def read(path):
    reader = vtkXMLPolyDataReader()
    errors = Errors(reader)
    reader.SetFileName(path)
    reader.Update()
    assert errors.count == 0, f"{path}: VTK complains"
    return reader.GetOutput()


def values(array):
    return [array.GetComponent(k, c) for k in range(array.GetNumberOfTuples()) for c in range(array.GetNumberOfComponents())]


def arrays(body):
    all = {"Points": body.GetPoints().GetData()}
    for data in (body.GetPointData(), body.GetCellData(), body.GetFieldData()):
        all.update({data.GetArrayName(k): data.GetArray(k) for k in range(data.GetNumberOfArrays())})
    return all


def cells(body):
    of = body.GetLines() if body.GetNumberOfLines() else body.GetPolys() if body.GetNumberOfPolys() else body.GetVerts()
    return values(of.GetConnectivityArray()) + values(of.GetOffsetsArray())


def as_float32(x):
    return struct.unpack("f", struct.pack("f", x))[0]


def compare(zlib, none, single):
    names = sorted(os.path.relpath(p, zlib) for p in glob.glob(zlib + "/*/*.vtp"))
    assert len(names) > 4, f"only {names}"
    for name in names:
        one, plain, narrow = (read(os.path.join(folder, name)) for folder in (zlib, none, single))
        assert one.GetNumberOfPoints() > 1 and one.GetNumberOfCells() > 0, name
        assert cells(one) == cells(plain) == cells(narrow), name
        a, b, c = arrays(one), arrays(plain), arrays(narrow)
        assert a.keys() == b.keys() == c.keys(), name
        assert {"TimeValue", "Step"} < a.keys(), name
        for key in a:
            label = vtkDataArray.UNITS_LABEL()
            unit = [x[key].GetInformation().Get(label) for x in (a, b, c)]
            assert unit[0] == unit[1] == unit[2], f"{name}: {key} has units {unit}"
            assert values(a[key]) == values(b[key]), f"{name}: {key}"
            if a[key].GetDataTypeAsString() == "double" and c[key].GetDataTypeAsString() == "float":
                assert [as_float32(x) for x in values(a[key])] == values(c[key]), f"{name}: {key} is not rounded"
            else:
                assert values(a[key]) == values(c[key]), f"{name}: {key}"
        for folder, seen in ((zlib, a), (none, b), (single, c)):
            ours = read_vtp(os.path.join(folder, name))
            for key in a.keys() - {"TimeValue", "Step"}:
                flat = [x for row in ours[key] for x in row] if a[key].GetNumberOfComponents() > 1 else list(ours[key])
                assert flat == values(seen[key]), f"{name}: {key} of tools/vbond_output.py"
        unit = lambda key: a[key].GetInformation().Get(vtkDataArray.UNITS_LABEL())
        assert unit("Points") == "m" and unit("id") is None, f"{name}: {unit('Points')}, {unit('id')}"
        assert unit("axial_force" if "bonds" in name else "velocity") in ("N", "m/s"), name
        assert a["Points"].GetDataTypeAsString() == "double" and c["Points"].GetDataTypeAsString() == "float", name
    print(f"VTK {vtkVersion.GetVTKVersion()} reads {len(names)} frames in each of three formats")


compare(*sys.argv[2:])

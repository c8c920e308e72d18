"""Reads the output folder of a run: frames (.vtp), history.csv, run.json. Python's own library only.

A reader of its own, after docs/output.md, so that what it shows does not rest on the code that wrote it.
"""
import array
import csv
import json
import math
import pathlib
import re
import struct
import sys
import zlib

T_0 = 2 * math.pi  # in the reduced units of all examples

_DECLARED = re.compile(r'<DataArray type="(\w+)" Name="(\w+)" NumberOfComponents="(\d+)" '
                       r'format="appended" offset="(\d+)"/?>')
_IN_TEXT = re.compile(r'<DataArray type="(\w+)" Name="(\w+)" NumberOfComponents="(\d+)" '
                      r'NumberOfTuples="\d+" format="ascii">([^<]*)<')
_CODES = {"Float64": "d", "Float32": "f", "Int64": "q", "Int32": "i", "UInt8": "B"}


def _plain(data, at):
    size, = struct.unpack_from("<Q", data, at)
    return data[at + 8:at + 8 + size]


def _from_blocks(data, at):
    """Numbers of blocks, of bytes in each and in a last one; the compressed size of each; the blocks."""
    blocks, = struct.unpack_from("<Q", data, at)
    sizes = struct.unpack_from(f"<{blocks}Q", data, at + 24)
    content, at = bytearray(), at + 24 + 8 * blocks
    for size in sizes:
        content += zlib.decompress(data[at:at + size])
        at += size
    return bytes(content)


def read_vtp(path):
    """Arrays of a .vtp file by name: rows for vectors, numbers for scalars; and "time"."""
    if pathlib.Path(path).suffix != ".vtp":
        sys.exit(f"{path}: only whole frames are read here; the Python module reads frames in parts, too")
    if sys.byteorder != "little":
        sys.exit("frames are little-endian, and this machine is not")
    data = pathlib.Path(path).read_bytes()
    start = data.index(b"_", data.index(b"<AppendedData")) + 1
    head = data[:start].decode("ascii")
    arrays = {"time": float(re.search(r'Name="TimeValue"[^>]*>([^<]+)<', head)[1])}
    content = _from_blocks if 'compressor="vtkZLibDataCompressor"' in head else _plain
    for kind, name, components, offset in _DECLARED.findall(head):
        n = int(components)
        values = array.array(_CODES[kind], content(data, start + int(offset)))
        arrays[name] = [values[k:k + n] for k in range(0, len(values), n)] if n > 1 else values
    for kind, name, components, text in _IN_TEXT.findall(head):  # of the cell of a periodic body
        n, number = int(components), float if kind.startswith("Float") else int
        values = [number(word) for word in text.split()]
        arrays[name] = [values[k:k + n] for k in range(0, len(values), n)]
    return arrays


class Run:
    """A finished run; times are in T_0."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.summary = json.loads((self.folder / "run.json").read_text())
        self.files, self.times = {}, []
        for what in ("particles", "bonds", "contacts"):
            if not (self.folder / f"{what}.pvd").exists():  # no frames, or none of contacts
                continue
            listed = re.findall(r'timestep="([^"]+)".*file="([^"]+)"', (self.folder / f"{what}.pvd").read_text())
            self.times = [float(time) / T_0 for time, _ in listed]
            self.files[what] = [self.folder / name for _, name in listed]

    def frames(self, what="particles"):
        return map(read_vtp, self.files[what])

    def frame(self, time, what="particles"):
        """The frame nearest to a time."""
        nearest = min(range(len(self.times)), key=lambda k: abs(self.times[k] - time))
        return read_vtp(self.files[what][nearest])

    def history(self):
        """Columns of history.csv by name; an empty cell is NaN."""
        return {name: [float(cell or "nan") for cell in column]
                for name, column in self._columns("history.csv").items()}

    def breaks(self):
        """Columns of breaks.csv by name, `mode` and `criterion` as text; an empty cell is NaN."""
        return {name: column if name in ("mode", "criterion") else [float(cell or "nan") for cell in column]
                for name, column in self._columns("breaks.csv").items()}

    def last_fragments(self):
        """Columns of fragments.csv by name, as text, at the end of the last stage."""
        columns = self._columns("fragments.csv")
        kept = [k for k, stage in enumerate(columns["stage"]) if stage == columns["stage"][-1]]
        return {name: [column[k] for k in kept] for name, column in columns.items()}

    def _columns(self, name):
        with open(self.folder / name, newline="") as file:
            head, *rows = csv.reader(file)
        return {title: [row[k] for row in rows] for k, title in enumerate(head)}


def peak_of(history):
    """The row of the largest force on the wall "upper"."""
    force = history["wall.upper.Fz"]
    return max(range(len(force)), key=lambda k: force[k])


def sizes_and_places(run):
    """Of each particle: how many hold together with it in the last frame, and where it was at the start."""
    last = read_vtp(run.files["particles"][-1])
    count = {}
    for fragment in last["fragment"]:
        count[fragment] = count.get(fragment, 0) + 1
    places = [[p - u for p, u in zip(*pair)] for pair in zip(last["Points"], last["displacement"])]
    return [count[fragment] for fragment in last["fragment"]], places


def cone_of_fines(balls):
    """The two equal cones about z, bases under the plates and tips inwards, that hold the fines of balls about the
    origin best. balls: for each, what sizes_and_places gives; fines are in fragments of less than 1 % of the particles.
    Best has the largest 2 x / (fines + particles in the cones), where x is the number of fines in the cones; base
    radius and depth go in steps of a quarter.
    """
    where = [found for sizes, places in balls for found in fines_by_depth(sizes, places)]
    fines = sum(is_fine for is_fine, _, _ in where)
    best = (-1.0,)
    for base in (0.25 * k for k in range(4, 25)):
        for depth in (0.25 * k for k in range(4, 29)):
            inside = [is_fine for is_fine, r, down in where if r <= base * (1 - down / depth)]
            best = max(best, (2 * sum(inside) / (fines + len(inside)), base, depth))
    return best[1:]


def fines_by_depth(sizes, places):
    """Of each particle of a ball about the origin: is it of the fines, distance from the axis z, depth below its pole.
    """
    radius = max(math.hypot(*p) for p in places)
    return [(n < 0.01 * len(sizes), math.hypot(p[0], p[1]), radius - abs(p[2])) for n, p in zip(sizes, places)]

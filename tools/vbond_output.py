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
    return arrays


class Run:
    """A finished run; times are in T_0."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.summary = json.loads((self.folder / "run.json").read_text())
        self.files, self.times = {}, []
        for what in ("particles", "bonds"):
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
        with open(self.folder / "history.csv", newline="") as file:
            rows = list(csv.reader(file))
        return {name: [float(row[k] or "nan") for row in rows[1:]] for k, name in enumerate(rows[0])}

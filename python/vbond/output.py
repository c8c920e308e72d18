"""What a run has written: its output folder."""

from __future__ import annotations

import csv
import html
import json
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from . import _vbond
from .command import run_program


class Frame:
    """One frame of a run: `particles` and `bonds` are dicts of arrays, read when they are asked for first."""

    def __init__(self, time: float, particles: Path, bonds: Path | None):
        self.time = time  #: of the run [time]
        self._files = (particles, bonds)
        self._read: list[dict[str, np.ndarray] | None] = [None, None]

    @property
    def particles(self) -> dict[str, np.ndarray]:
        """position, velocity, displacement, rotation (n, 3), ...: the arrays of docs/output.md."""
        if self._read[0] is None:
            self._read[0] = _vbond.read_particles(self._files[0])
        return self._read[0]

    @property
    def bonds(self) -> dict[str, np.ndarray]:
        """i, j, axial_force, bending_moment, U_L (m,), ...: the arrays of docs/output.md."""
        if self._read[1] is None:
            self._read[1] = _vbond.read_bonds(self._files[1]) if self._files[1] else {}
        return self._read[1]

    def __repr__(self) -> str:
        return f"<vbond.Frame: time {self.time:.6g}>"


class Frames(Sequence):
    """The frames of a run, in order of time."""

    def __init__(self, folder: Path):
        listed = {name: _vbond.read_pvd(folder / f"{name}.pvd") if (folder / f"{name}.pvd").exists() else []
                  for name in ("particles", "bonds")}
        bonds = [file for _, file in listed["bonds"]]
        self._frames = [Frame(time, file, bonds[k] if k < len(bonds) else None)
                        for k, (time, file) in enumerate(listed["particles"])]

    def __len__(self) -> int:
        return len(self._frames)

    def __getitem__(self, k):
        return self._frames[k]

    def __iter__(self) -> Iterator[Frame]:
        return iter(self._frames)


def _column(texts: list[str]) -> np.ndarray:
    """Whole numbers, numbers (NaN where a cell is empty), or words."""
    for kind in (int, float):
        try:
            return np.array([kind(text) if text or kind is int else np.nan for text in texts])
        except ValueError:
            continue
    return np.array(texts)


class Output:
    """An output folder of vbond. Files are read when they are asked for."""

    def __init__(self, folder: str | os.PathLike):
        self.folder = Path(folder)
        if not (self.folder / "resolved.toml").exists():
            raise _vbond.IoError(f"{self.folder}: is not an output folder of vbond: it has no resolved.toml")

    @property
    def history(self) -> dict[str, np.ndarray]:
        """Columns of history.csv by name (docs/output.md); empty if there is none yet."""
        file = self.folder / "history.csv"
        return _vbond.read_history(file) if file.exists() else {}

    def dataframe(self):
        """The history as a pandas DataFrame."""
        import pandas

        return pandas.DataFrame(self.history)

    @property
    def summary(self) -> dict[str, Any]:
        """run.json (docs/output.md). IoError if no stage has ended."""
        return self._json("run.json", "no stage of the run has ended yet")

    @property
    def status(self) -> dict[str, Any]:
        """status.json: how the run stands, or how it has ended."""
        return self._json("status.json", "it was not run with a version that writes it")

    @property
    def breaks(self) -> dict[str, np.ndarray]:
        """Columns of breaks.csv, a row per bond that broke; empty where no bond may break."""
        return self._table("breaks.csv")

    @property
    def fragments(self) -> dict[str, np.ndarray]:
        """Columns of fragments.csv; empty where no bond may break."""
        return self._table("fragments.csv")

    @property
    def frames(self) -> Frames:
        """The frames, which are read one by one; none if the case asks for none."""
        return Frames(self.folder)

    def report(self) -> Path:
        """Writes report.html, as `vbond report`."""
        run_program(["report", os.fspath(self.folder)], quiet=True)
        return self.folder / "report.html"

    def _json(self, name: str, why_not: str) -> dict[str, Any]:
        try:
            return json.loads((self.folder / name).read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise _vbond.IoError(f"{self.folder / name}: there is none: {why_not}") from None
        except ValueError as e:
            raise _vbond.IoError(f"{self.folder / name}: is damaged: {e}") from None

    def _table(self, name: str) -> dict[str, np.ndarray]:
        file = self.folder / name
        if not file.exists():
            return {}
        with file.open(newline="", encoding="utf-8") as lines:
            rows = list(csv.reader(lines))
        if not rows:
            return {}
        whole = [row for row in rows[1:] if len(row) == len(rows[0])]  # the last line may be under way
        return {column: _column([row[k] for row in whole]) for k, column in enumerate(rows[0])}

    def _repr_html_(self) -> str:
        """The report page in a notebook, if it was written."""
        file = self.folder / "report.html"
        if not file.exists():
            return f"<p>{html.escape(repr(self))}: report() writes the page</p>"
        page = html.escape(file.read_text(encoding="utf-8"))
        return f'<iframe srcdoc="{page}" style="width: 100%; height: 800px; border: 0"></iframe>'

    def __repr__(self) -> str:
        return f"<vbond.Output: {self.folder}>"


def open(folder: str | os.PathLike) -> Output:
    """The output folder of a run, ended or not. IoError if it is none."""
    return Output(folder)

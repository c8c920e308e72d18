"""The program vbond, for what writes files: whole runs and sweeps."""

from __future__ import annotations

import csv
import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from .cases import Case, _plain, _toml
from .command import ProgramError, run_program
from .output import Output, open as open_output


@contextmanager
def _as_file(case: Case) -> Iterator[str]:
    """The case as a file, for so long as the program needs it."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "case.toml"
        file.write_text(case.text, encoding="utf-8")
        yield str(file)


def run(case: Case, folder: str | os.PathLike, *, threads: int | None = None, force: bool = False,
        report: bool = False, quiet: bool = True) -> Output:
    """Computes the case with the program, into `folder`: history, frames, checkpoints, run.json; returns them.
    force: replace an earlier output there. ProgramError if the run fails; what was written until then stays."""
    options = ["-o", os.fspath(folder)]
    options += ["--force"] if force else []
    options += ["--report"] if report else []
    options += [] if threads is None else ["--threads", str(threads)]
    with _as_file(case) as file:
        run_program(["run", file, *options], quiet)
    return open_output(folder)


def _values(key: str, values: Any) -> str:
    if isinstance(values, str):  # as on the command line: "range(1, 5, 9) T0"
        return f"{key}={values}"
    together = key.count(",") + 1
    if together > 1:
        values = list(values)
        if any(not isinstance(value, (list, tuple)) or len(value) != together for value in values):
            raise ValueError(f"sweep: {key!r}: {together} keys go together: each of the values is a tuple of {together}")
        return f"{key}=" + ",".join(":".join(_toml(_plain(part, key)) for part in value) for value in values)
    return f"{key}=" + ",".join(_toml(_plain(value, key)) for value in values)


def sweep(case: Case, folder: str | os.PathLike, values: Mapping[str, Any], *, jobs: int | None = None,
          quiet: bool = True) -> list[dict[str, Any]]:
    """Computes the case for all combinations of values of some keys, {"bonds[0].E": [1e9, 2e9]}, in processes, and
    returns the rows of sweep.csv (docs/sweeps.md): numbers as float, empty cells as None. The same call goes on with
    a sweep that was stopped. Points that fail are rows with ended = "failed" and their reason. Keys that go through
    their values together: {"bonds[0].E,bonds[0].nu": [(1e9, 0.2), (2e9, 0.3)]}. ProgramError if not all points have
    ended, as on a full disk or where a run was killed."""
    if not values:
        raise ValueError("sweep: no key to sweep was given")
    folder = Path(folder)
    options = ["-o", str(folder)]
    for key, some in values.items():
        options += ["--set", _values(key, some)]
    options += [] if jobs is None else ["--jobs", str(jobs)]
    try:
        with _as_file(case) as file:
            run_program(["sweep", file, *options], quiet)
    except ProgramError as e:
        if e.status != 1:  # 1: some points have failed, which the table says
            raise
    with (folder / "sweep.csv").open(newline="", encoding="utf-8") as table:
        return [{name: _cell(text) for name, text in row.items()} for row in csv.DictReader(table)]


def _cell(text: str) -> Any:
    try:
        return float(text) if text else None
    except ValueError:
        return text

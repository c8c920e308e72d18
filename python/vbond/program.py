"""The program vbond, for what writes files: whole runs, sweeps, fits and laboratory tests."""

from __future__ import annotations

import csv
import json
import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from .cases import Case, _plain, _toml
from .command import ProgramError, run_program
from .output import Output, open as open_output


@contextmanager
def _as_file(case: Case, to_vary: bool = False) -> Iterator[str]:
    """The case as a file, for so long as the program needs it. to_vary: the program computes it for other values, too."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "case.toml"
        file.write_text(case._to_vary() if to_vary else case.text, encoding="utf-8")
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
        with _as_file(case, to_vary=True) as file:
            run_program(["sweep", file, *options], quiet)
    except ProgramError as e:
        if e.status != 1:  # 1: some points have failed, which the table says
            raise
    with (folder / "sweep.csv").open(newline="", encoding="utf-8") as table:
        return [{name: _cell(text) for name, text in row.items()} for row in csv.DictReader(table)]


def fit(case: Case, data: str | os.PathLike, output: str | os.PathLike, vary: Sequence[str], x: str,
        compare: Mapping[str, str], *, sigma: float | str | Sequence[float | str] | None = None, stage: str | None = None,
        iterations: int = 50, difference: float = 1e-3, derivatives: str = "automatic", report: bool = False,
        threads: int | None = None, quiet: bool = True) -> dict[str, Any]:
    """Varies values of the case until columns of its history follow the points of a CSV file, and returns what
    NAME.json has but for the name of the case (docs/fit.md), with None where there is no number. output: NAME.toml, the
    fitted case; vary: texts as behind --vary; x: a column of the history, or "COLUMN=HEADING"; compare: {column of the
    history: heading of the data}; sigma: a number or a heading, one for each column; derivatives: "automatic" or "differences"; report: NAME.html is
    written too. The same call goes on with a fit that was stopped. One that did not converge says so as "end". ProgramError if there is no result."""
    if isinstance(vary, str) or not vary:
        raise ValueError("fit: vary is a list of keys, with at least one")
    sigmas = [] if sigma is None else [sigma] if isinstance(sigma, (int, float, str)) else list(sigma)
    options = ["-o", os.fspath(output), "--x", x, "--iterations", str(iterations), "--difference", str(difference),
               "--derivatives", derivatives, *(["--report"] if report else [])]
    for option, texts in (("--vary", vary), ("--compare", [f"{column}={heading}" for column, heading in compare.items()]),
                          ("--sigma", map(str, sigmas)), ("--stage", [] if stage is None else [stage]),
                          ("--threads", [] if threads is None else [str(threads)])):
        for text in texts:
            options += [option, text]
    try:
        with _as_file(case, to_vary=True) as file:
            run_program(["fit", file, os.fspath(data), *options], quiet)
    except ProgramError as e:
        if e.status != 1 or not Path(output).exists():  # 1 with files: it did not converge, which the result says
            raise
    found = json.loads(Path(output).with_suffix(".json").read_text(encoding="utf-8"))
    del found["case"]  # a file that was there for this call alone
    return found


def write_material_page(body: Any, report: str | os.PathLike | None, *options: str) -> None:
    """The page of `vbond homogenise --report`, if one is asked for."""
    if report is None:
        return
    if not isinstance(body, Case):
        raise ValueError("report: the page is that of a case as it begins, and this is a state")
    with _as_file(body) as file:
        run_program(["homogenise", file, "--report", os.fspath(report), *options], quiet=True)


def laboratory_test(case: Case, kind: str, folder: str | os.PathLike, *, pressures: Sequence[float | str] = (), motion: bool = False,
                    frames: bool = False, threads: int | None = None, quiet: bool = True,
                    **options: float | str) -> dict[str, Any]:
    """Makes a laboratory test of the body of the case, runs it, and returns what result.json has but for the name of the case
    (docs/laboratory-tests.md). kind: "tension", "compression", "brazilian", "triaxial", "bend3" or "shear"; folder: new, holds
    the case of the test and its run; pressures: of triaxial; options: axis, across, ends, strain, drop, area, depth, span,
    notch, E, rate, damping, as behind their names on the command line. ProgramError if there is no result."""
    known = ("axis", "across", "ends", "strain", "drop", "area", "depth", "span", "notch", "E", "rate", "damping")
    if wrong := sorted(set(options) - set(known)):
        raise ValueError(f"laboratory_test: {wrong[0]!r} is no option; they are {', '.join(known)}")
    words = ["-o", os.fspath(folder)] + ["--motion"] * motion + ["--frames"] * frames
    for option, value in [*options.items(), *(("pressure", p) for p in pressures), *([] if threads is None else [("threads", threads)])]:
        words += [f"--{option}", str(value)]
    with _as_file(case) as file:
        run_program(["test", kind, file, *words], quiet)
    found = json.loads((Path(folder) / "result.json").read_text(encoding="utf-8"))
    del found["case"]  # a file that was there for this call alone
    return found


def calibrate_strengths(case: Case, folder: str | os.PathLike, *, tensile: float | str | None = None, compressive: float | str | None = None,
                        toughness: float | str | None = None, within: float = 0.01, motion: bool = False,
                        threads: int | None = None, quiet: bool = True,
                        **options: float | str) -> dict[str, Any]:
    """Finds limits of bonds with which the body of the case has these strengths in laboratory tests, and returns what
    result.json has but for the name of the case (docs/material.md). One that has not reached them says so as "end" and
    "failure". folder: new, holds the tests; within: relative; options: notch, axis, ends, strain, drop, area, depth, rate, damping, as
    behind their names on the command line. ProgramError if there is no result."""
    known = ("notch", "axis", "ends", "strain", "drop", "area", "depth", "rate", "damping")
    if wrong := sorted(set(options) - set(known)):
        raise ValueError(f"calibrate_strengths: {wrong[0]!r} is no option; they are {', '.join(known)}")
    if tensile is None and compressive is None and toughness is None:
        raise ValueError("calibrate_strengths: give tensile, compressive or toughness, or more than one")
    words = ["-o", os.fspath(folder), "--within", str(within)] + ["--motion"] * motion
    asked = [("tensile", tensile), ("compressive", compressive), ("toughness", toughness)]
    for option, value in [*options.items(), *asked, ("threads", threads)]:
        words += [] if value is None else [f"--{option}={value}"]
    try:
        with _as_file(case) as file:
            run_program(["calibrate", file, *words], quiet)
    except ProgramError as e:
        if e.status != 1 or not Path(folder, "result.json").exists():  # 1 with a result: not reached, which it says
            raise
    found = json.loads(Path(folder, "result.json").read_text(encoding="utf-8"))
    del found["case"], found["command"]  # of a file that was there for this call alone
    return found


def _cell(text: str) -> Any:
    try:
        return float(text) if text else None
    except ValueError:
        return text

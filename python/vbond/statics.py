"""Static stages as functions: the body of a case in equilibrium, on a path, at its critical loads, in its modes."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _vbond
from .cases import Case
from .program import write_material_page
from .runs import Run


@dataclass(frozen=True)
class StaticSolution:
    """What a static stage has found."""

    result: _vbond.StaticResult  #: all of it
    state: _vbond.State  #: the body at the end
    history: dict[str, np.ndarray]  #: a row per point of equilibrium, columns as in history.csv
    run: Run

    @property
    def critical_loads(self) -> list[_vbond.CriticalLoad]:
        return self.result.critical_loads

    @property
    def modes(self) -> list[_vbond.NaturalMode]:
        return self.result.modes

    @property
    def frequencies(self) -> np.ndarray:
        """Of the modes [1/time], without motions that nothing holds."""
        return np.array([mode.frequency for mode in self.result.modes if not mode.rigid])

    @property
    def load_factors(self) -> np.ndarray:
        return self.history["load_factor"]


def homogenise(body: Case | _vbond.State, *, derivatives: bool = False,
               report: str | os.PathLike | None = None) -> _vbond.Homogenised:
    """The elastic material that a periodic cell of particles and bonds is a piece of, about the balance that it comes to
    with its cell held: of a case as it begins, or of a state that a run has brought it to (Run.state). With derivatives:
    also how C follows from the stiffnesses of each set of bonds, of a body whose bonds are at rest. report: NAME.html, a page
    that the program writes, of a case (docs/material.md). Raises ValueError if the cell is open in some direction,
    NoEquilibrium if some particles can move at no cost, ProgramError if the page cannot be written.

        vbond.homogenise(case).constants.hill.E
    """
    if not hasattr(_vbond, "homogenise"):
        raise RuntimeError("homogenise: this vbond was built without statics")
    write_material_page(body, report)
    return _vbond.homogenise(Run(body).state if isinstance(body, Case) else body, derivatives)


def homogenise_sheet(body: Case | _vbond.State, *, report: str | os.PathLike | None = None) -> _vbond.HomogenisedSheet:
    """The plate that a sheet of bonds is: A, B and D, per width. The cell is periodic in two directions, open in the third.

        vbond.homogenise_sheet(case).D[0, 0]

    report: as of homogenise. ValueError for what is no sheet, is strained, or whose particles press on each other; NoEquilibrium if particles can
    move at no cost.
    """
    if not hasattr(_vbond, "homogenise_sheet"):
        raise RuntimeError("homogenise_sheet: this vbond was built without statics")
    write_material_page(body, report)
    return _vbond.homogenise_sheet(Run(body).state if isinstance(body, Case) else body)


def homogenise_body(body: Case | _vbond.State, *, surface: Sequence[int] | None = None,
                    volume: float | None = None, report: str | os.PathLike | None = None) -> _vbond.HomogenisedBody:
    """Elastic constants of a body without a cell: by displacement of its surface, and by traction on it.

        vbond.homogenise_body(case).by_displacement.hill.E

    surface: numbers of particles; without it those at the faces of the box along the axes around the body, which it must
    fill. volume: without it that of this box. report: as of homogenise, without surface. ValueError for what has no such constants; NoEquilibrium if particles can
    move at no cost.
    """
    if not hasattr(_vbond, "homogenise_body"):
        raise RuntimeError("homogenise_body: this vbond was built without statics")
    if report is not None and surface is not None:
        raise ValueError("homogenise_body: the page knows surfaces as groups of the case: use vbond homogenise --surface GROUP --report")
    write_material_page(body, report, *([] if volume is None else ["--volume", repr(float(volume))]))
    return _vbond.homogenise_body(Run(body).state if isinstance(body, Case) else body,
                                  None if surface is None else sorted({int(p) for p in surface}), volume)


def _solve(kind: str, case: Case, keys: dict[str, Any]) -> StaticSolution:
    run = Run(case.with_stages([{"kind": kind, "name": kind, **keys}]))
    result = run.run_stage()
    return StaticSolution(result.statics, run.state, run.history, run)


def equilibrium(case: Case, **keys: Any) -> StaticSolution:
    """Equilibrium of the body at its loads and held degrees of freedom, by Newton's method. keys: those of such a
    stage in case files (supports, loads, load_factor, steps, ...); the case's own stages are left out. Raises
    CaseError, NoEquilibrium.

        vbond.equilibrium(case, supports=[{"group": "first", "fix": ["x", "y", "z", "rx", "ry", "rz"]}],
                          loads=[{"group": "last", "force": [0, 1e-3, 0]}])
    """
    return _solve("equilibrium", case, keys)


def path(case: Case, **keys: Any) -> StaticSolution:
    """The path of equilibria beyond limit points, by arc length. keys: see equilibrium."""
    return _solve("path", case, keys)


def buckling(case: Case, **keys: Any) -> StaticSolution:
    """Critical loads on the nonlinear path, with their modes. keys: see equilibrium; `count` loads are looked for."""
    return _solve("buckling", case, keys)


def modes(case: Case, **keys: Any) -> StaticSolution:
    """Modes of vibration about the equilibrium, slowest first. keys: see equilibrium; `count` modes."""
    return _solve("modes", case, keys)


def fracture(case: Case, **keys: Any) -> StaticSolution:
    """Fracture at rest: bond after bond as it reaches its strength. keys: see equilibrium."""
    return _solve("fracture", case, keys)

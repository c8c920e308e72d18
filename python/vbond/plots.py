"""Pictures by matplotlib, which is imported when one is asked for. Each function draws into `axes`, or into new ones,
and returns them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np


def _axes(axes: Any, **how: Any) -> Any:
    if axes is not None:
        return axes
    import matplotlib.pyplot as pyplot

    return pyplot.figure().add_subplot(**how)


def curves(history: Mapping[str, np.ndarray], *columns: str, x: str = "time", axes: Any = None) -> Any:
    """Columns of a history against another one."""
    for name in (x, *columns):
        if name not in history:
            raise KeyError(f"there is no column {name!r}; there are {', '.join(history)}")
    axes = _axes(axes)
    for name in columns:
        axes.plot(history[x], history[name], label=name)
    axes.set_xlabel(x)
    axes.legend()
    return axes


def body(state: Any, displacements: np.ndarray | None = None, axes: Any = None) -> Any:
    """The bonds that hold, as lines in space; displaced by (n, 3) if given."""
    at = state.positions if displacements is None else state.positions + displacements
    bonds = state.bonds
    holds = ~bonds["broken"]
    from mpl_toolkits.mplot3d.art3d import Line3DCollection

    axes = _axes(axes, projection="3d")
    axes.add_collection3d(Line3DCollection(np.stack([at[bonds["i"][holds]], at[bonds["j"][holds]]], axis=1)))
    axes.auto_scale_xyz(*at.T)
    return axes


def mode(state: Any, mode: Any, size: float | None = None, axes: Any = None) -> Any:
    """A mode of vibration or buckling as the displaced body; size: of its largest translation [length], by default a
    tenth of the body."""
    if size is None:
        size = 0.1 * float(np.ptp(state.positions, axis=0).max())
    return body(state, size * mode.translation, axes)


def cracks(state: Any, axes: Any = None) -> Any:
    """The middles of bonds that broke, as points on top of the bonds that hold."""
    axes = body(state, axes=axes)
    bonds, at = state.bonds, state.positions
    broken = bonds["broken"]
    middles = 0.5 * (at[bonds["i"][broken]] + at[bonds["j"][broken]])
    axes.scatter(*middles.T, color="tab:red")
    return axes

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


def _ends(state: Any, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of each bond; the second one at the image that it joins, if the body is periodic."""
    bonds = state.bonds
    of_j = at[bonds["j"]]
    return at[bonds["i"]], of_j if state.cell is None else of_j + bonds["image_j"] @ state.cell


def body(state: Any, displacements: np.ndarray | None = None, axes: Any = None) -> Any:
    """The bonds that hold, as lines in space; displaced by (n, 3) if given."""
    at = state.positions if displacements is None else state.positions + displacements
    holds = ~state.bonds["broken"]
    from mpl_toolkits.mplot3d.art3d import Line3DCollection

    axes = _axes(axes, projection="3d")
    axes.add_collection3d(Line3DCollection(np.stack(_ends(state, at), axis=1)[holds]))
    axes.auto_scale_xyz(*at[state.there].T)
    return axes


def mode(state: Any, mode: Any, size: float | None = None, axes: Any = None) -> Any:
    """A mode of vibration or buckling as the displaced body; size: of its largest translation [length], by default a
    tenth of the body."""
    if size is None:
        size = 0.1 * float(np.ptp(state.positions[state.there], axis=0).max())
    return body(state, size * mode.translation, axes)


def cracks(state: Any, axes: Any = None) -> Any:
    """The middles of bonds that broke, as points on top of the bonds that hold."""
    axes = body(state, axes=axes)
    middles = 0.5 * sum(_ends(state, state.positions))
    axes.scatter(*middles[state.bonds["broken"]].T, color="tab:red")
    return axes

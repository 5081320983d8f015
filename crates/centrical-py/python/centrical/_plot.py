"""Figures: on the axes of Matplotlib where it is installed, else as the report draws them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import _native

if TYPE_CHECKING:
    from ._types import Array

MICRO_G = 9.80665e-6


class Drawing:
    """A figure of the report: a notebook shows its SVG, ``drawings`` has the text of each panel."""

    def __init__(self, title: str, caption: str, drawings: list[str]) -> None:
        self.title, self.caption, self.drawings = title, caption, drawings

    def _repr_html_(self) -> str:
        return f"<div style='max-width: 36em'>{''.join(self.drawings)}</div>"

    def _repr_svg_(self) -> str | None:
        return self.drawings[0] if len(self.drawings) == 1 else None

    def __repr__(self) -> str:
        return f"<Drawing {self.title!r}>"


class Curve(NamedTuple):
    """A curve of a double logarithmic plot, with the interval of each value."""

    label: str
    x: Array
    y: Array
    lower: Array
    upper: Array


def plot_figure(
    figures: Iterable[tuple[str, str, str, list[str]]], name: str, ax: Any, on_axes: Mapping[str, Callable[[Any], None]]
) -> Any:
    """Draws one of the report's ``figures``: name, title, caption, panels; those of ``on_axes`` with Matplotlib."""
    drawn = {figure[0]: figure[1:] for figure in figures}
    if name not in drawn:
        raise ValueError(f"name: found {name!r}, expected one of {', '.join(drawn)}")
    draw = on_axes.get(name)
    axes = ax if ax is not None else (_new_axes() if draw else None)
    if draw is None and ax is not None:
        raise ValueError(f"ax: found axes for {name!r}, expected none: Matplotlib draws {', '.join(on_axes)}")
    if draw is None or axes is None:
        return Drawing(*drawn[name])
    axes.set_title(drawn[name][0])
    draw(axes)
    return axes


def plot_curves(title: str, x_label: str, y_label: str, curves: Sequence[Curve], ax: Any) -> Any:
    """Draws curves on logarithmic axes: those of Matplotlib, else as the report draws them."""
    axes = ax if ax is not None else _new_axes()
    if axes is None:
        return Drawing(title, "", [_native.draw_curves(title, x_label, y_label, list(curves))])
    for curve in curves:
        (line,) = axes.loglog(curve.x, curve.y, label=curve.label)
        axes.fill_between(curve.x, curve.lower, curve.upper, alpha=0.2, color=line.get_color(), linewidth=0)
    axes.set_xlabel(x_label)
    axes.set_ylabel(y_label)
    axes.legend()
    return axes


def draw_residuals(rows: Sequence[Any], axes: Any) -> None:
    """Draws the residuals [m/s^2] of each plateau; None where there are none."""
    residuals = np.array([[np.nan] * 3 if row is None else row for row in rows], dtype=np.float64) / MICRO_G
    for axis, column in enumerate(residuals.T, start=1):
        axes.plot(np.arange(1, len(column) + 1), column, "o", markersize=3, label=f"newtonometer {axis}")
    axes.axhline(0.0, color="0.5", linewidth=0.8)
    axes.set_xlabel("plateau")
    axes.set_ylabel("residual, micro-g")
    axes.legend()


def draw_correlation(names: Sequence[str], covariance: Array, uncertainties: Array, axes: Any) -> None:
    """Draws the correlations of named parameters."""
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = covariance / np.outer(uncertainties, uncertainties)
    image = axes.imshow(correlation, vmin=-1.0, vmax=1.0, cmap="RdBu_r", interpolation="nearest")
    axes.figure.colorbar(image, ax=axes)
    axes.set_xticks(range(len(names)), names, rotation=90, fontsize=5)
    axes.set_yticks(range(len(names)), names, fontsize=5)


def _new_axes() -> Any:
    """Axes of a new figure; nothing without Matplotlib."""
    try:
        from matplotlib import pyplot  # type: ignore[import-not-found, import-untyped, unused-ignore]
    except ImportError:
        return None
    return pyplot.subplots()[1]

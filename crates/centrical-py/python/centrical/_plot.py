"""Figures: on the axes of Matplotlib where it is installed, else as the report draws them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ._noise import Noise
    from ._result import Result

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


def plot_result(result: Result, name: str, ax: Any) -> Any:
    """See :meth:`Result.plot`."""
    drawn = {title[0]: title[1:] for title in result.native.figures()}
    if name not in drawn:
        raise ValueError(f"name: found {name!r}, expected one of {', '.join(drawn)}")
    draw = ON_AXES.get(name)
    axes = ax if ax is not None else (_new_axes() if draw else None)
    if draw is None and ax is not None:
        raise ValueError(f"ax: found axes for {name!r}, expected none: Matplotlib draws {', '.join(ON_AXES)}")
    if draw is None or axes is None:
        return Drawing(*drawn[name])
    axes.set_title(drawn[name][0])
    draw(result, axes)
    return axes


def plot_noise(noise: Noise, ax: Any) -> Any:
    """See :meth:`Noise.plot`."""
    axes = ax if ax is not None else _new_axes()
    if axes is None:
        raise ImportError("found no package 'matplotlib', expected it, or noise(..., out=folder) for the plots as SVG")
    units = {reading.unit for reading in noise.readings}
    for reading in noise.readings:
        for curve in reading.deviations:
            rows = curve.deviations
            tau, value, lower, upper = (
                np.array([np.nan if row[key] is None else row[key] for row in rows], dtype=np.float64)
                for key in ("tau", "value", "lower", "upper")
            )
            (line,) = axes.loglog(tau, value, label=f"{reading.name}, {curve.estimator}")
            axes.fill_between(tau, lower, upper, alpha=0.2, color=line.get_color(), linewidth=0)
    axes.set_xlabel("averaging time, s")
    axes.set_ylabel(f"deviation, {', '.join(sorted(units))}")
    axes.legend()
    return axes


def _residuals(result: Result, axes: Any) -> None:
    rows = [plateau.residual for plateau in result.document.plateaus]
    residuals = np.array([[np.nan] * 3 if row is None else row for row in rows], dtype=np.float64) / MICRO_G
    for axis, column in enumerate(residuals.T, start=1):
        axes.plot(np.arange(1, len(column) + 1), column, "o", markersize=3, label=f"newtonometer {axis}")
    axes.axhline(0.0, color="0.5", linewidth=0.8)
    axes.set_xlabel("plateau")
    axes.set_ylabel("residual, micro-g")
    axes.legend()


def _correlation(result: Result, axes: Any) -> None:
    u = result.uncertainties
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = result.covariance / np.outer(u, u)
    image = axes.imshow(correlation, vmin=-1.0, vmax=1.0, cmap="RdBu_r", interpolation="nearest")
    axes.figure.colorbar(image, ax=axes)
    axes.set_xticks(range(len(u)), result.names, rotation=90, fontsize=5)
    axes.set_yticks(range(len(u)), result.names, fontsize=5)


#: The figures that are drawn on axes.
ON_AXES: dict[str, Callable[[Any, Any], None]] = {"residuals": _residuals, "correlation": _correlation}


def _new_axes() -> Any:
    """Axes of a new figure; nothing without Matplotlib."""
    try:
        from matplotlib import pyplot  # type: ignore[import-not-found, import-untyped, unused-ignore]
    except ImportError:
        return None
    return pyplot.subplots()[1]

"""The noise of readings: the document of the command, and its curves as arrays."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._document import Document
from ._progress import Shown
from ._table import numbers

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: The names that others give to the estimators.
SHORT = {
    "adev": "allan",
    "oadev": "overlapping-allan",
    "mdev": "modified-allan",
    "tdev": "time",
    "hdev": "hadamard",
    "ohdev": "overlapping-hadamard",
    "totdev": "total",
}


class Noise(Document):
    """An analysis of noise, ``centrical-noise/1``: spectrum, deviations and noise terms of each reading."""

    def deviation(self, estimator: str = "overlapping-allan", reading: int = 0) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Averaging times [s] and deviations of the reading itself, never of its integral.

        ``estimator`` is a name of the command, or ``"adev"``, ``"oadev"``, ``"mdev"``, ``"hdev"``, ``"ohdev"``; ``reading``
        the place of the reading in ``readings``.
        """
        count = len(self.readings)
        if not -count <= reading < count:
            raise ValueError(f"reading: found {reading}, expected 0 to {count - 1}")
        curves = self.readings[reading].deviations
        wanted = SHORT.get(estimator, estimator)
        for curve in curves:
            if curve.estimator == wanted:
                rows = curve.deviations
                return np.array([row.tau for row in rows]), np.array([row.value for row in rows])
        raise ValueError(f"estimator: found {estimator!r}, expected one of {', '.join(c.estimator for c in curves)}")

    def plot(self, ax: Any = None) -> Any:
        """Draws the deviations with their intervals on ``ax``, or on new axes of Matplotlib, which are given.

        Without Matplotlib an object that a notebook shows as SVG.
        """
        from ._plot import Curve, plot_curves

        curves = []
        for reading in self.readings:
            for curve in reading.deviations:
                tau, value, lower, upper = (
                    np.array([np.nan if row[key] is None else row[key] for row in curve.deviations], dtype=np.float64)
                    for key in ("tau", "value", "lower", "upper")
                )
                curves.append(Curve(f"{reading.name}, {curve.estimator}", tau, value, lower, upper))
        units = ", ".join(sorted({reading.unit for reading in self.readings}))
        return plot_curves("Stability", "averaging time, s", f"deviation, {units}", curves, ax)


def noise_of_array(
    array: Any,
    rate: float | str | None,
    unit: str,
    window: tuple[float, float],
    estimators: Sequence[str],
    out: Any,
    shown: Shown | None,
) -> Noise:
    """Analyses an array, as the file that NumPy would save of it."""
    if rate is None:
        raise ValueError("rate: found nothing, expected the sampling rate of the array in Hz")
    values = numbers("source", array)
    values = values[:, np.newaxis] if values.ndim == 1 else values
    if values.ndim != 2 or values.size == 0:
        raise ValueError(f"source: found shape {np.shape(array)}, expected (n,) or (n, k)")
    columns: list[str | int] = list(range(1, values.shape[1] + 1))
    file = io.BytesIO()
    np.save(file, np.ascontiguousarray(values))
    given = ("readings.npy", file.getvalue())
    return Noise(_native.noise(given, None, None, "t", rate, columns, unit, window, list(estimators), out, shown))

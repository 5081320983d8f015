"""The result of a calibration."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import _native
from ._columns import columns_of_rows
from ._document import Document, Record, escape
from ._documents import check_documents
from ._numbers import natural
from ._paths import paths
from ._table import columns_of, is_table, numbers

if TYPE_CHECKING:
    from typing import Literal, overload

    from ._types import Array, Language, Path, Quantity


class Parameter(NamedTuple):
    """An estimate, SI. ``value`` and ``u``, its standard uncertainty, are NaN where the data do not determine it."""

    name: str
    value: float
    u: float
    unit: str
    group: str

    @property
    def is_estimable(self) -> bool:
        """Whether the data determine it."""
        return not np.isnan(self.value)


class Objection(NamedTuple):
    """A reason against a result: its name in ``centrical-documents/1``, and a sentence."""

    name: str
    text: str

    def __str__(self) -> str:
        return self.text


class Observability(NamedTuple):
    """What the experiment determines. ``lost`` has the undetermined combinations: parameter to component."""

    rank: int
    columns: int
    tolerance: float
    singular_values: Array
    lost: tuple[dict[str, float], ...]


class Result:
    """The result of a calibration, ``centrical-result/1``. All values in SI.

    >>> result = ct.calibrate(example)
    >>> result.names.index("df_1"), result["df_1"].unit, result["df_1"].group
    (28, 'm/s^2', 'bias')
    >>> result.covariance.shape
    (49, 49)
    """

    def __init__(self, native: _native.CalibrationResult) -> None:
        self.native = native

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, in the order of ``values`` and ``covariance``."""
        return tuple(self.native.names)

    @cached_property
    def values(self) -> Array:
        """Estimates, shape ``(p,)``, read-only; NaN where the data do not determine them."""
        return _fixed(self.native.values)

    @cached_property
    def uncertainties(self) -> Array:
        """Standard uncertainties, shape ``(p,)``, read-only; NaN where the data do not determine the parameter."""
        return _fixed(self.native.uncertainties)

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the estimates, shape ``(p, p)``, read-only; NaN where the data do not determine them."""
        return _fixed(self.native.covariance)

    @cached_property
    def parameters(self) -> dict[str, Parameter]:
        """The parameters by name."""
        native = self.native
        rows = zip(self.names, self.values.tolist(), self.uncertainties.tolist(), native.units, native.groups)
        return {row[0]: Parameter(*row) for row in rows}

    def __getitem__(self, name: str) -> Parameter:
        try:
            return self.parameters[name]
        except KeyError:
            near = ", ".join([known for known in self.names if known[:2] == str(name)[:2]] or self.names)
            raise KeyError(f"found no parameter {name!r}, expected one of {near}") from None

    def __contains__(self, name: object) -> bool:
        return name in self.parameters

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    @cached_property
    def objections(self) -> tuple[Objection, ...]:
        """The reasons against the result; empty if it is acceptable."""
        return tuple(Objection(name, text) for name, text in self.native.objections)

    @property
    def acceptable(self) -> bool:
        """Whether no check raised an objection.

        >>> ct.calibrate(example).acceptable
        True
        """
        return not self.objections

    @property
    def within_limits(self) -> bool | None:
        """Whether the unit keeps the limits of the ``laboratory`` that it was calibrated with; ``None`` without limits, and of a result
        that was read."""
        return self.native.within_limits

    @cached_property
    def document(self) -> Document:
        """All that ``result.json`` holds, by attribute and key."""
        return Document(self.to_json())

    @property
    def rests_on(self) -> list[Record]:
        """The effects whose absence the result rests on, the worst first; empty where this was not asked."""
        return list(self.document.content.get("rests_on", []))

    @property
    def budget(self) -> Record | None:
        """The uncertainties by their sources (GUM), if a budget was made."""
        return self.document.content.get("budget")

    @cached_property
    def observability(self) -> Observability:
        """What the experiment determines, and what is lost."""
        seen = self.document.observability
        lost = tuple(dict(direction) for direction in seen.null_directions)
        return Observability(seen.rank, seen.columns, seen.tolerance, _fixed(np.array(seen.singular_values)), lost)

    @property
    def range(self) -> float:
        """Largest specific force on each axis that :meth:`compensate` gives [m/s^2]."""
        return self.native.range

    @property
    def output_unit(self) -> str:
        """Unit of the readings that :meth:`compensate` takes: that of the records of the calibration."""
        return self.native.output_unit

    if TYPE_CHECKING:

        @overload
        def compensate(
            self, readings: Array, out: Array | None = None, uncertainty: Literal[False] = False
        ) -> Array: ...
        @overload
        def compensate(
            self, readings: Array, out: Array | None = None, *, uncertainty: Literal[True]
        ) -> tuple[Array, Array]: ...
        @overload
        def compensate(self, readings: Any, out: Array | None = None, uncertainty: bool = False) -> Any: ...

    def compensate(self, readings: Any, out: Any = None, uncertainty: bool = False) -> Any:
        """From readings to specific force [m/s^2], exact to rounding.

        Readings are those of a record, in :attr:`output_unit`: counts and volts are taken to m/s^2 by the scale and bias of the session.

        Parameters
        ----------
        readings
            float64 in the byte order of the machine, shape ``(n, 3)``. An array in C order is read in place; one in
            any other order or with other strides is copied first. Or a table with columns f1, f2, f3: a mapping, a
            data frame, or anything with ``__arrow_c_stream__``; of a table the columns are copied.
        out
            Takes the forces: float64, shape ``(n, 3)``, C order, writable. It may be ``readings`` itself, and shares
            no other memory with it.
        uncertainty
            Whether the standard uncertainties [m/s^2] are given too, ``(n, 3)``: those of the coefficients, at each force.

        Returns
        -------
        The forces, shape ``(n, 3)``; of a table :class:`Columns` f1, f2, f3, a table again. With ``uncertainty`` a pair.
        Readings with a NaN stay NaN. Those that no force in :attr:`range` gives become NaN, with a warning.

        Raises
        ------
        TypeError, ValueError
            For another type, shape or order, with what was found and what was expected.
        InputError
            If the calibration does not determine a coefficient of the error model.

        >>> result = ct.calibrate(example)
        >>> f, u = result.compensate(np.array([[9.8, 0.1, 0.2]]), uncertainty=True)
        >>> f.shape, bool((u < 1e-3).all())
        ((1, 3), True)
        """
        if type(readings) is np.ndarray and readings.dtype.names is None and not uncertainty:
            forces, outside = self.native.compensate(readings, out)
            if outside:
                _warn(outside, self.native.range)
            return forces
        return self._compensate_any(readings, out, uncertainty)

    def _compensate_any(self, readings: Any, out: Any, uncertainty: bool) -> Any:
        is_columns = is_table(readings)
        rows = columns_of(readings) if is_columns else readings
        if isinstance(rows, np.ma.MaskedArray):
            rows = numbers("readings", rows)
        forces, outside = self.native.compensate(rows, out)
        if outside:
            _warn(outside, self.native.range)
        given = columns_of_rows(forces) if is_columns else forces
        if not uncertainty:
            return given
        deviations = self.native.uncertainty(forces)
        return given, columns_of_rows(deviations) if is_columns else deviations

    def in_axes(self, axes: Path) -> Result:
        """The result with its error model stated in other axes too; :meth:`compensate` gives specific forces there then.

        Parameters
        ----------
        axes
            ``"lower"``, ``"upper"``, ``"symmetric"``: those in which the scale matrix has this form; ``"case"``: those of the case, by the turns of
            the instrument in its positions; anything else is a file with a table ``[axes]``.

        Raises
        ------
        InputError
            If the calibration does not determine them.

        >>> case = ct.calibrate(example).in_axes("case")
        >>> case.document.axes.name, len(case.document.axes.parameters)
        ('case', 27)
        """
        return Result(self.native.in_axes(os.fspath(axes)))

    def report(
        self,
        *,
        html: Path | None = None,
        history: Path | None = None,
        past: Path | Iterable[Path] = (),
        pdf: Path | None = None,
        before: Path | None = None,
        dcc: Path | None = None,
        code: Path | None = None,
        range: Quantity | None = None,
        laboratory: Path | None = None,
        language: Language = "en",
    ) -> Document:
        """Writes documents of the result, as :func:`centrical.report` does of its file.

        >>> written = ct.calibrate(example).report(html=folder / "report.html")
        >>> [document.kind for document in written.written]
        ['report']
        """
        check_documents(html, history, pdf, before, dcc, code, range, laboratory)
        # Imported late: it costs as much as all else.
        import tempfile

        with tempfile.TemporaryDirectory() as place:
            file = os.path.join(place, "result.json")
            self.native.write(file)
            text = _native.report(
                file, "result.json", html, history, paths(past), pdf, before, dcc, code, range, laboratory, None, language
            )
        return Document(text)

    def plot(self, name: str = "residuals", ax: Any = None) -> Any:
        """Draws a figure of the report.

        ``"residuals"`` and ``"correlation"`` are drawn on ``ax``, or on new axes, where Matplotlib is installed; those axes are
        given. Else, and for the other figures, an object that a notebook shows as SVG.

        >>> ct.calibrate(example).plot("convergence")
        <Drawing 'Uncertainty as the session goes on'>
        """
        from ._plot import draw_correlation, draw_residuals, plot_figure

        on_axes = {
            "residuals": lambda axes: draw_residuals([row.residual for row in self.document.plateaus], axes),
            "correlation": lambda axes: draw_correlation(self.names, self.covariance, self.uncertainties, axes),
        }
        return plot_figure(self.native.figures(), name, ax, on_axes)

    def to_json(self, path: Path | None = None) -> str:
        """The text of ``result.json``, byte for byte; written to ``path`` if one is given, whole or not at all."""
        if path is not None:
            self.native.write(path)
        return self.native.to_json().decode()

    def ufloats(self) -> dict[str, Any]:
        """The parameters as correlated numbers of the package ``uncertainties``, which has to be there.

        Parameters that the data do not determine are left out.
        """
        uncertainties = _needed("uncertainties")
        there = ~np.isnan(self.values)
        numbers = uncertainties.correlated_values(self.values[there], self.covariance[np.ix_(there, there)])
        return dict(zip(np.array(self.names)[there].tolist(), numbers))

    def to_xarray(self) -> Any:
        """Values, uncertainties and covariance as an ``xarray.Dataset``; the package has to be there."""
        xarray = _needed("xarray")
        native = self.native
        return xarray.Dataset(
            {
                "value": ("parameter", self.values),
                "standard_uncertainty": ("parameter", self.uncertainties),
                "covariance": (("parameter", "other"), self.covariance),
            },
            coords={
                "parameter": list(self.names),
                "other": list(self.names),
                "unit": ("parameter", native.units),
                "group": ("parameter", native.groups),
            },
            attrs=dict(self.document.session),
        )

    def summary(self, width: int = 100) -> str:
        """The verdict and the tables as the command shows them, in lines of ``width`` characters."""
        return self.native.text(natural("width", width, "a number of characters"))

    def __str__(self) -> str:
        return self.summary()

    def __repr__(self) -> str:
        verdict = "acceptable" if self.acceptable else f"not acceptable, {len(self.objections)} objections"
        session = self.document.session
        unit = f"{session.unit_model} {session.unit_serial}".strip() or "a unit without a name"
        return f"<Result of {unit}, {len(self)} parameters, {verdict}>"

    def _repr_html_(self) -> str:
        figures = "".join(
            f"<details><summary>{escape(title)}</summary><div style='max-width: 36em'>{''.join(drawings)}"
            f"<p>{escape(caption)}</p></div></details>"
            for _, title, caption, drawings in self.native.figures()
        )
        # Jupyter gives a block of preformatted text the letters of its surroundings, which are not of one width.
        return f"<pre style='font-family: monospace; line-height: 1.3'>{escape(self.summary())}</pre>{figures}"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Result) and self.to_json() == other.to_json()

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return _from_json, (self.native.to_json(),)


def read_result(path: Path) -> Result:
    """Reads a ``result.json``.

    >>> ct.calibrate(example).to_json(folder / "result.json") == ct.read_result(folder / "result.json").to_json()
    True
    """
    return Result(_native.CalibrationResult.read(path))


def _from_json(text: bytes) -> Result:
    return Result(_native.CalibrationResult.from_json(text))


def _fixed(array: Array) -> Array:
    array.setflags(write=False)
    return array


def _warn(outside: int, range: float) -> None:
    readings = "reading" if outside == 1 else "readings"
    message = f"{outside} {readings} that no force within {range:.6g} m/s^2 gives: NaN"
    warnings.warn(message, RuntimeWarning, stacklevel=3)


def _needed(package: str) -> Any:
    try:
        return __import__(package)
    except ImportError as missing:
        raise ImportError(f"found no package {package!r}, expected it: pip install {package}") from missing

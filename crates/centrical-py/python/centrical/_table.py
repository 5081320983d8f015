"""Tables with named columns as rows of three."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

NAMES = ("f1", "f2", "f3")


def is_table(thing: Any) -> bool:
    """Whether something has named columns."""
    if isinstance(thing, np.ndarray):
        return thing.dtype.names is not None
    return isinstance(thing, Mapping) or hasattr(thing, "__arrow_c_stream__") or hasattr(thing, "columns")


def columns_of(table: Any) -> NDArray[np.float64]:
    """The columns f1, f2, f3 as an array of shape ``(n, 3)``: always a copy.

    >>> from centrical._table import columns_of
    >>> columns_of({"t": [0.0], "f1": [1.0], "f2": [2.0], "f3": [3.0]})
    array([[1., 2., 3.]])
    """
    columns = equal_columns(table, NAMES, "readings")
    rows = np.empty((len(columns[0]), 3))
    for axis, column in enumerate(columns):
        rows[:, axis] = column
    return rows


def numbers(argument: str, values: Any) -> NDArray[np.float64]:
    """An array of numbers as float64, copied only if it is none yet; what is masked becomes NaN. Instants are no numbers."""
    masked = isinstance(values, np.ma.MaskedArray)
    array = np.ma.asarray(values) if masked else np.asarray(values)
    if array.dtype.kind == "O":
        # Numbers that may be missing, of pandas.
        try:
            array = np.asarray(values, dtype=np.float64)
        except (TypeError, ValueError) as wrong:
            raise TypeError(f"{argument}: found objects ({wrong}), expected numbers") from None
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{argument}: found {array.dtype}, expected numbers")
    floats = array.astype(np.float64, copy=False)
    return np.ma.filled(floats, np.nan) if masked else floats


def columns_named(table: Any, names: Sequence[str], argument: str) -> list[NDArray[np.float64]]:
    """The columns of these names, of numbers."""
    readable = _readable(table, argument)
    return [_column(readable, name, names, argument) for name in names]


def equal_columns(table: Any, names: Sequence[str], argument: str) -> list[NDArray[np.float64]]:
    """The columns of these names, of numbers, which have equally many rows."""
    columns = columns_named(table, names, argument)
    lengths = [len(column) for column in columns]
    if len(set(lengths)) > 1:
        raise ValueError(f"{argument}: found columns of {lengths} rows, expected as many of each")
    return columns


def names_of(table: Any) -> list[str]:
    """The names of the columns of a table."""
    readable = _readable(table, "table")
    if isinstance(readable, np.ndarray):
        return list(readable.dtype.names or ())
    return list(readable.column_names if hasattr(readable, "column_names") else getattr(readable, "columns", readable))


def _readable(table: Any, argument: str) -> Any:
    """Something whose columns are found by name."""
    if isinstance(table, Mapping) or hasattr(table, "__getitem__"):
        return table
    try:
        import pyarrow  # type: ignore[import-not-found, import-untyped, unused-ignore]
    except ImportError:
        name = type(table).__name__
        raise TypeError(
            f"{argument}: found {name}, an Arrow stream without columns by name, expected a table, or pyarrow to read it"
        ) from None
    return pyarrow.table(table)


def _column(table: Any, name: str, names: Sequence[str], argument: str) -> NDArray[np.float64]:
    try:
        column = table[name]
    except (KeyError, IndexError) as missing:
        raise ValueError(f"{argument}: found no column {name!r}, expected {', '.join(names)}") from missing
    except Exception as other:
        # Every library has its own exception for a column that is not there.
        raise ValueError(f"{argument}: column {name!r} cannot be read ({other}), expected {', '.join(names)}") from other
    column = numbers(f"{argument}, column {name}", column)
    if column.ndim != 1:
        raise TypeError(f"{argument}, column {name}: found shape {column.shape}, expected (n,)")
    return column

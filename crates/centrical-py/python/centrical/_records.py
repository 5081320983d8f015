"""Records in memory, as the files that NumPy would save of them."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ._given import given_file
from ._paths import paths
from ._table import equal_columns, is_table, numbers

if TYPE_CHECKING:
    from numpy.typing import NDArray


def given_records(records: Any, names: Sequence[str | int]) -> list[Any]:
    """Files of one record or several: paths, files in memory, tables, and arrays whose columns have
    ``names`` in this order, or are found by number."""
    listed = [records] if is_table(records) or isinstance(records, np.ndarray) else paths(records)
    return [_file(f"records[{n}]", record, names) for n, record in enumerate(listed, 1)]


def _file(argument: str, record: Any, names: Sequence[str | int]) -> Any:
    if is_table(record):
        return argument, _saved(names, equal_columns(record, [str(name) for name in names], argument))
    if not isinstance(record, np.ndarray):
        return given_file(argument, record)
    values = numbers(argument, record)
    by_number = all(isinstance(name, int) for name in names)
    if values.ndim != 2 or not by_number and values.shape[1] != len(names):
        raise ValueError(f"{argument}: found an array of shape {values.shape}, expected (n, {len(names)}): {', '.join(map(str, names))}")
    # By number a column is one of the array, in whatever order.
    return argument, _saved(range(1, values.shape[1] + 1) if by_number else names, list(values.T))


def _saved(names: Sequence[str | int], columns: Sequence[NDArray[np.float64]]) -> bytes:
    rows = np.empty(len(columns[0]), dtype=[(str(name), np.float64) for name in names])
    for name, column in zip(names, columns):
        rows[str(name)] = column
    file = io.BytesIO()
    np.save(file, rows)
    return file.getvalue()


def directions(attitudes: Any) -> list[list[float]]:
    """Directions of up: of an array of shape ``(n, 3)``, or of a table with the columns up_1, up_2, up_3."""
    if is_table(attitudes):
        up = np.column_stack(equal_columns(attitudes, ("up_1", "up_2", "up_3"), "attitudes"))
    else:
        up = numbers("attitudes", attitudes if isinstance(attitudes, np.ndarray) else list(attitudes))
    if up.ndim != 2 or up.shape[1] != 3:
        raise ValueError(f"attitudes: found shape {up.shape}, expected (n, 3)")
    rows: list[list[float]] = up.tolist()
    return rows

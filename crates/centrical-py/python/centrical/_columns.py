"""Columns that came of a table: a table again, for whoever takes one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Float = NDArray[np.float64]
else:
    Float = np.ndarray


class Columns(dict[str, Float]):
    """Columns of a table by name, shape ``(n,)`` each, which do not change.

    ``pandas.DataFrame(x)``, ``polars.DataFrame(x)`` and ``pyarrow.table(x)`` take it as the dict that it is. With pyarrow
    installed it is an Arrow stream too, over the same memory.

    >>> columns = ct.calibrate(example).compensate({"f1": [9.8], "f2": [0.1], "f3": [0.2]})
    >>> columns, columns["f1"].shape
    (<Columns f1, f2, f3 of 1 row>, (1,))
    """

    def __init__(self, columns: Mapping[str, Float]) -> None:
        super().__init__({name: _fixed(column) for name, column in columns.items()})

    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any:
        """The columns as an Arrow stream; pyarrow has to be there."""
        try:
            import pyarrow  # type: ignore[import-not-found, import-untyped, unused-ignore]
        except ImportError as missing:
            raise ImportError("found no package 'pyarrow', expected it: pip install pyarrow") from missing
        # Of one array each: without a copy, and a NaN stays a NaN.
        arrays = [pyarrow.array(column) for column in self.values()]
        return pyarrow.table(arrays, names=list(self)).__arrow_c_stream__(requested_schema)

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        """Not of these columns: ``dict(columns)`` can be changed, and a copy of an array."""
        raise TypeError("found a change of Columns, expected none: dict(columns) can be changed")

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (dict(self),)

    def __repr__(self) -> str:
        n = len(next(iter(self.values()), ()))
        return f"<Columns {', '.join(self)} of {n} row{'' if n == 1 else 's'}>"


def _fixed(column: Float) -> Float:
    """The same memory, not to be written."""
    view = column.view()
    view.flags.writeable = False
    return view


def columns_of_rows(rows: Float) -> Columns:
    """The columns f1, f2, f3 of rows ``(n, 3)``, each in memory of its own."""
    return Columns({name: np.ascontiguousarray(rows[:, axis]) for axis, name in enumerate(("f1", "f2", "f3"))})

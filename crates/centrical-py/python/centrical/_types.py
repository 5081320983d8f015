"""Types of arguments, for type checkers and readers: nothing imports this at run time."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import IO, Any, Literal, Protocol, Union

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Path = Union[str, "os.PathLike[str]"]
#: The bytes of a file, or a file that is open.
File = Union[bytes, bytearray, memoryview, IO[Any]]


class Columned(Protocol):
    """A table whose columns have names: of pandas, polars or Arrow."""

    @property
    def columns(self) -> Any:
        """The columns, or their names."""


Table = Union[Mapping[str, Any], Columned]
#: A number in SI, or a text with a unit such as "120 g".
Quantity = Union[float, str]
Format = Literal["csv", "parquet"]
Form = Literal["experiment", "plan", "truth", "laboratory"]
Language = Literal["en", "ru"]
Method = Literal["exact", "recursive", "linear", "recursive-linear"]


class Session(Protocol):
    """A :class:`centrical.Session`: what the native functions take stands for it."""

    _given: Any

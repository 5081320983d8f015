"""Numbers that the native functions take, refused in their words where Python would not get as far."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ._types import Quantity

LARGEST = 1e6
"""Of a quantity in its unit, as for the commands."""


def natural(argument: str, value: int, expected: str) -> int:
    """An integer that is not negative, of 64 bits.

    >>> from centrical._numbers import natural
    >>> natural("runs", -5, "2 to 10,000,000 calibrations")
    Traceback (most recent call last):
    ...
    ValueError: runs: found -5, expected 2 to 10,000,000 calibrations
    """
    if not 0 <= value < 1 << 64:
        raise ValueError(f"{argument}: found {value}, expected {expected}")
    return value


def above_zero(argument: str, value: Quantity | None, unit: float = 1.0, symbol: str = "") -> None:
    """Refuses a quantity that is not above zero, and a number beyond a million of a ``unit`` [SI] with its ``symbol``.

    >>> from centrical._numbers import above_zero
    >>> above_zero("range", "-3 g", 9.80665, " g")
    Traceback (most recent call last):
    ...
    ValueError: range: found '-3 g', expected a number above 0 and up to 1e6 g
    """
    if isinstance(value, str):
        written = re.match(r"\s*[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)(e[-+]?[0-9]+)?", value, re.IGNORECASE)
        is_one = written is None or float(written[0]) > 0.0
    else:
        is_one = value is None or 0.0 < value <= LARGEST * unit
    if not is_one:
        raise ValueError(f"{argument}: found {value!r}, expected a number above 0 and up to 1e6{symbol}")

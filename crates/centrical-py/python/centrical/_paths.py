"""One path, or file in memory, or several."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING

from ._given import is_file

if TYPE_CHECKING:
    from ._types import Path


def paths(given: Path | Iterable[Path]) -> list[Path]:
    """A list of one path or file in memory, or of those given.

    >>> from centrical._paths import paths
    >>> paths("a.json"), paths(["a.json", "b.json"])
    (['a.json'], ['a.json', 'b.json'])
    """
    return [given] if isinstance(given, (str, os.PathLike)) or is_file(given) else list(given)

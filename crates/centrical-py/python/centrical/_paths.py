"""One path, or file in memory, or several."""

from __future__ import annotations

import os
from typing import Any

from ._given import is_file


def paths(given: Any) -> list[Any]:
    """A list of one path or file in memory, or of those given.

    >>> from centrical._paths import paths
    >>> paths("a.json"), paths(["a.json", "b.json"])
    (['a.json'], ['a.json', 'b.json'])
    """
    return [given] if isinstance(given, (str, os.PathLike)) or is_file(given) else list(given)

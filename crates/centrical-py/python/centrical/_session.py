"""A session: a folder with ``experiment.toml`` and records."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from . import _commands
from ._document import Document
from ._errors import NoSuchFileError
from ._noise import Noise
from ._result import Result
from ._watch import Watch, watch

if TYPE_CHECKING:
    from ._types import Method, Path


class Session:
    """A session by its folder, or its ``experiment.toml``. Nothing is read before a method asks for it.

    Each method is the function of the same name, with its arguments.

    >>> session = ct.Session(example)
    >>> session.calibrate(hold_out=["1:1"]).document.plateaus[0].held_out
    True
    """

    def __init__(self, path: Path) -> None:
        self.path = os.fspath(path)
        if not os.path.exists(self.path):
            message = f"{self.path}: found no such file, expected an experiment file, or the folder with its experiment.toml"
            expected = "an experiment file, or the folder with its experiment.toml"
            error = NoSuchFileError(message, self.path, None, "no such file", expected)
            error.errno, error.filename = 2, self.path
            raise error

    def calibrate(self, method: Method = "exact", hold_out: Any = (), **options: Any) -> Result:
        """See :func:`centrical.calibrate`."""
        return _commands.calibrate(self.path, method=method, hold_out=hold_out, **options)

    def reduce(self, out: Path, **options: Any) -> Document:
        """See :func:`centrical.reduce`."""
        return _commands.reduce(self.path, out, **options)

    def observe(self, combinations: Any = ()) -> Document:
        """See :func:`centrical.observe`."""
        return _commands.observe(self.path, combinations)

    def assess(self, **options: Any) -> Document:
        """See :func:`centrical.assess`."""
        return _commands.assess(self.path, **options)

    def montecarlo(self, **options: Any) -> Document:
        """See :func:`centrical.montecarlo`."""
        return _commands.montecarlo(self.path, **options)

    def models(self) -> Document:
        """See :func:`centrical.models`."""
        return _commands.models(self.path)

    def noise(self, plateau: str | None = None, **options: Any) -> Noise:
        """See :func:`centrical.noise`."""
        return _commands.noise(self.path, plateau=plateau, **options)

    def watch(self, out: Path, **options: Any) -> Watch:
        """See :func:`centrical.watch`."""
        return watch(self.path, out, **options)

    def __repr__(self) -> str:
        return f"Session({self.path!r})"

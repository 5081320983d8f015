"""A session: a folder with ``experiment.toml`` and records."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from . import _commands
from ._array_session import ArraySession, from_arrays
from ._document import Document
from ._errors import no_session
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
            raise no_session(self.path)

    @staticmethod
    def from_arrays(
        experiment: Path,
        records: Any = None,
        *,
        telemetry: Any = None,
        pulses: Any = None,
        plateaus: Any = None,
    ) -> ArraySession:
        """A session whose records, or whose plateaus, are arrays.

        Parameters
        ----------
        experiment
            An experiment file, its folder, or its text. Files that it names for records are not read.
        records
            By the number of the mounting from 1, or in that order: ``(t, f)`` with times ``(n,)`` and readings ``(n, 3)``, in the
            units that the experiment states for its columns (s and m/s^2 unless it does).
        telemetry
            By the same numbers: ``(t, speed)``, ``(n,)`` each. A mounting may lack it.
        pulses
            By the same numbers: times ``(n,)`` of the pulses of an index mark or an encoder.
        plateaus
            In place of records: a table with the columns of ``plateaus.csv``; ``angle`` is NaN while spinning.

        All arrays are copied.

        >>> record = np.loadtxt(example / "records" / "m01.csv", delimiter=",", skiprows=1)
        >>> ct.Session.from_arrays(example, [(record[:, 0], record[:, 1:])]).calibrate()
        Traceback (most recent call last):
        ...
        centrical._errors.InputError: ...: found 1 records in memory, expected 12, one for each mounting
        """
        return from_arrays(experiment, records, telemetry, pulses, plateaus)

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

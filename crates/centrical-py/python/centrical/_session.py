"""A session: a folder with ``experiment.toml`` and records, or the same in memory."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from . import _commands
from ._array_session import ArraySession, are_files, from_arrays, from_files
from ._document import Document
from ._errors import no_session
from ._given import InMemory, named_files
from ._noise import Noise
from ._result import Result
from ._watch import Watch, watch

if TYPE_CHECKING:
    from ._types import File, Method, Path


class Session:
    """A session by its folder, or its ``experiment.toml``. Nothing is read before a method asks for it.

    Each method is the function of the same name, with its arguments. :meth:`parse` makes a session of what is in memory.

    >>> session = ct.Session(example)
    >>> session.calibrate(hold_out=["1:1"]).document.plateaus[0].held_out
    True
    """

    def __init__(self, path: Path) -> None:
        self.path = os.fspath(path)
        #: What the native functions take: the path, or files in memory.
        self._given: str | InMemory = self.path
        if not os.path.exists(self.path):
            raise no_session(self.path)

    @classmethod
    def parse(cls, text: str, folder: Path = "", files: Mapping[str, File] | None = None) -> Session:
        """The session of an experiment file with this ``text``, as if it stood in ``folder``.

        Parameters
        ----------
        text
            What ``experiment.toml`` would hold.
        folder
            Where the paths in it start; it need not exist if all files are in ``files``.
        files
            Files in memory by the names that the text has for them: bytes, not copied, or files that are open. The others are read
            from ``folder``.

        Results are those of the same files on disk, to the byte.

        >>> text = (example / "experiment.toml").read_text()
        >>> session = ct.Session.parse(text, example, {"records/m01.csv": (example / "records" / "m01.csv").read_bytes()})
        >>> session.calibrate().to_json() == ct.calibrate(example).to_json()
        True
        """
        return cls._in_memory(text, os.path.join(folder, "experiment.toml"), named_files(files), [])

    @classmethod
    def _in_memory(cls, text: str, file: str, files: list[tuple[str, bytes]], names: list[Any]) -> Session:
        session = cls.__new__(cls)
        session.path, session._given = file, (text, file, files, names)
        return session

    @staticmethod
    def from_arrays(
        experiment: Path,
        records: Any = None,
        *,
        telemetry: Any = None,
        pulses: Any = None,
        plateaus: Any = None,
    ) -> ArraySession | Session:
        """A session whose records, or whose plateaus, are arrays, or whose records are files in memory.

        Parameters
        ----------
        experiment
            An experiment file, its folder, or its text. Files that it names for records are not read.
        records
            By the number of the mounting from 1, or in that order: ``(t, f)`` with times ``(n,)`` and readings ``(n, 3)``, in the
            units that the experiment states for its columns (s and m/s^2 unless it does); or each a file of any format, as bytes or
            open, which makes a :class:`Session`.
        telemetry
            By the same numbers: ``(t, speed)``, ``(n,)`` each; beside files, files. A mounting may lack it.
        pulses
            By the same numbers: times ``(n,)`` of the pulses of an index mark or an encoder; beside files, files.
        plateaus
            In place of records: a table with the columns of ``plateaus.csv``; ``angle`` is NaN while spinning.

        Arrays of float64 are not copied before ``calibrate``, which converts a copy to SI: until then do not change them. Other types are
        copied at once, bytes never.

        >>> record = np.loadtxt(example / "records" / "m01.csv", delimiter=",", skiprows=1)
        >>> ct.Session.from_arrays(example, [(record[:, 0], record[:, 1:])]).calibrate()
        Traceback (most recent call last):
        ...
        centrical._errors.InputError: ...: found 1 records in memory, expected 12, one for each mounting
        """
        if plateaus is None and are_files(records):
            return Session._in_memory(*from_files(experiment, records, telemetry, pulses))
        return from_arrays(experiment, records, telemetry, pulses, plateaus)

    def calibrate(self, method: Method = "exact", hold_out: Any = (), **options: Any) -> Result:
        """See :func:`centrical.calibrate`."""
        return _commands.calibrate(self, method=method, hold_out=hold_out, **options)

    def reduce(self, out: Path, **options: Any) -> Document:
        """See :func:`centrical.reduce`."""
        return _commands.reduce(self, out, **options)

    def observe(self, combinations: Any = ()) -> Document:
        """See :func:`centrical.observe`."""
        return _commands.observe(self, combinations)

    def assess(self, **options: Any) -> Document:
        """See :func:`centrical.assess`."""
        return _commands.assess(self, **options)

    def montecarlo(self, **options: Any) -> Document:
        """See :func:`centrical.montecarlo`."""
        return _commands.montecarlo(self, **options)

    def models(self) -> Document:
        """See :func:`centrical.models`."""
        return _commands.models(self)

    def noise(self, plateau: str | None = None, **options: Any) -> Noise:
        """See :func:`centrical.noise`."""
        return _commands.noise(self, plateau=plateau, **options)

    def watch(self, out: Path, **options: Any) -> Watch:
        """See :func:`centrical.watch`; a session in memory does not grow."""
        if self._given != self.path:
            raise ValueError("session: found one in memory, expected one in a folder, whose files grow")
        return watch(self.path, out, **options)

    def __repr__(self) -> str:
        return f"Session({self.path!r})" if self._given == self.path else f"Session.parse(..., {os.path.dirname(self.path)!r})"

"""A session whose records, or whose plateaus, are arrays."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from . import _native
from ._errors import InputError, no_session
from ._given import InMemory, bytes_of, is_file
from ._progress import Bar
from ._result import Result
from ._table import columns_named, names_of, numbers


class ArraySession:
    """A session in memory, as :meth:`centrical.Session.from_arrays` makes it. It can be pickled."""

    def __init__(
        self,
        text: str,
        file: str,
        records: list[tuple[Any, ...]],
        plateaus: list[np.ndarray] | None,
    ) -> None:
        self._text, self._file, self._records, self._plateaus = text, file, records, plateaus

    def calibrate(self, method: str = "exact", hold_out: Sequence[str] = ()) -> Result:
        """The result, with the numbers of :func:`centrical.calibrate` for files with the same values.

        ``inputs`` of the result is empty: there is no file to take a hash of.
        """
        with Bar("reducing") as shown:
            given: InMemory = (self._text, self._file, [], [])
            native = _native.calibrate_arrays(given, self._records, self._plateaus, method, list(hold_out), shown)
        return Result(native)

    def __repr__(self) -> str:
        of = f"{len(self._records)} records" if self._plateaus is None else f"{len(self._plateaus[0])} plateaus"
        return f"ArraySession({self._file!r}, {of})"


def from_arrays(
    experiment: str | os.PathLike[str],
    records: Mapping[int, Any] | Sequence[Any] | None = None,
    telemetry: Mapping[int, Any] | Sequence[Any] | None = None,
    pulses: Mapping[int, Any] | Sequence[Any] | None = None,
    plateaus: Any = None,
) -> ArraySession:
    """A session from arrays; see :meth:`centrical.Session.from_arrays`."""
    if (records is None) == (plateaus is None):
        raise TypeError("found both or neither of records and plateaus, expected one of them")
    text, file = _experiment(experiment)
    if plateaus is not None:
        return ArraySession(text, file, [], _plateau_columns(plateaus))
    numbered = _by_mounting("records", records)
    traces = _by_mounting("telemetry", telemetry or {})
    counted = _by_mounting("pulses", pulses or {})
    _refuse_gaps(numbered)
    _refuse_strangers("telemetry", traces, numbered)
    _refuse_strangers("pulses", counted, numbered)
    mountings = [_mounting(m, numbered[m], traces.get(m), counted.get(m)) for m in sorted(numbered)]
    return ArraySession(text, file, mountings, None)


def are_files(records: Any) -> bool:
    """Whether records are files in memory, and not arrays."""
    values = list(records.values()) if isinstance(records, Mapping) else records
    return isinstance(values, (list, tuple)) and any(is_file(value) for value in values)


def from_files(experiment: str | os.PathLike[str], records: Any, telemetry: Any, pulses: Any) -> InMemory:
    """What the native functions take of a session whose records are files in memory."""
    of_mountings = [_by_mounting("records", records), _by_mounting("telemetry", telemetry), _by_mounting("pulses", pulses)]
    _refuse_gaps(of_mountings[0])
    files: list[tuple[str, bytes]] = []

    def name(kind: str, numbered: dict[int, Any], m: int) -> str | None:
        source = numbered.get(m)
        if source is None:
            return None
        found = bytes_of(source)
        if found is None:
            raise TypeError(f"{kind}[{m}]: found {type(source).__name__}, expected a file, as others of the session are")
        files.append((f"{kind}[{m}]", found))
        return files[-1][0]

    kinds = ("records", "telemetry", "pulses")
    names = [[name(kind, of, m) for kind, of in zip(kinds, of_mountings)] for m in sorted(of_mountings[0])]
    return (*_experiment(experiment), files, [(record or "", trace, counted) for record, trace, counted in names])


def _experiment(experiment: str | os.PathLike[str]) -> tuple[str, str]:
    """The text of an experiment file, and its path; a text with a line break is one itself."""
    if isinstance(experiment, str) and "\n" in experiment:
        return experiment, "experiment"
    path = os.fspath(experiment)
    if os.path.isdir(path):
        path = os.path.join(path, "experiment.toml")
    try:
        with open(path, encoding="utf-8") as file:
            return file.read(), path
    except FileNotFoundError:
        raise no_session(path) from None
    except UnicodeDecodeError as wrong:
        found, expected = f"bytes that are not UTF-8, at {wrong.start}", "text in UTF-8"
        raise InputError(f"{path}: found {found}, expected {expected}", path, None, found, expected) from None


def _by_mounting(argument: str, arrays: Mapping[int, Any] | Sequence[Any] | None) -> dict[int, Any]:
    if isinstance(arrays, Mapping):
        wrong = [m for m in arrays if not isinstance(m, (int, np.integer)) or m < 1]
        if wrong:
            raise ValueError(f"{argument}: found the key {wrong[0]!r}, expected numbers of mountings from 1")
        return {int(m): value for m, value in arrays.items()}
    return dict(enumerate(arrays or (), start=1))


def _refuse_gaps(records: dict[int, Any]) -> None:
    missing = sorted(set(range(1, max(records, default=0) + 1)) - set(records))
    if missing:
        raise ValueError(f"records: found no record of mounting {missing[0]}, expected one of each")


def _refuse_strangers(argument: str, of_mountings: dict[int, Any], records: dict[int, Any]) -> None:
    strange = sorted(set(of_mountings) - set(records))
    if strange:
        raise ValueError(f"{argument}: found mounting {strange[0]}, which has no record, expected mountings 1 to {len(records)}")


def _refuse_wrong(place: str, values: np.ndarray, wrong: np.ndarray, expected: str) -> None:
    rows = np.flatnonzero(wrong)
    if rows.size:
        raise ValueError(f"{place}, row {rows[0] + 1}: found {values[rows[0]]}, expected {expected}")


def _mounting(m: int, record: Any, trace: Any, pulses: Any) -> tuple[Any, ...]:
    place = f"records[{m}]"
    t, f = _pair(place, record, "(t, f)")
    readings = numbers(place, f)
    if readings.ndim != 2 or readings.shape[1] != 3:
        raise ValueError(f"{place}: found readings of shape {readings.shape}, expected (n, 3)")
    columns = [_column(place, readings[:, axis]) for axis in range(3)]
    for column in columns:
        _refuse_wrong(place, column, np.isinf(column), "a number, or NaN where a reading is missing")
    telemetry = None
    if trace is not None:
        times, speeds = _pair(f"telemetry[{m}]", trace, "(t, speed)")
        telemetry = [_column(f"telemetry[{m}]", times), _column(f"telemetry[{m}]", speeds)]
        lengths = [len(column) for column in telemetry]
        if lengths[0] != lengths[1]:
            raise ValueError(f"telemetry[{m}]: columns of different lengths: {lengths[0]} times, {lengths[1]} speeds")
        for column in telemetry:
            _refuse_wrong(f"telemetry[{m}]", column, ~np.isfinite(column), "a number")
    return (_column(place, t), columns, telemetry, None if pulses is None else _column(f"pulses[{m}]", pulses))


def _pair(place: str, value: Any, expected: str) -> tuple[Any, Any]:
    try:
        first, second = value
    except (TypeError, ValueError):
        raise TypeError(f"{place}: found {type(value).__name__}, expected a pair {expected}") from None
    return first, second


def _column(place: str, values: Any) -> np.ndarray:
    # Views of any stride stay views; the core takes them as long as they are aligned.
    column = np.require(numbers(place, values), requirements=["A"])
    if column.ndim != 1:
        raise ValueError(f"{place}: found shape {column.shape}, expected (n,)")
    return column


def _plateau_columns(plateaus: Any) -> list[np.ndarray]:
    *names, optional = _native.plateau_columns()
    wanted = [*names, optional] if optional in names_of(plateaus) else names
    columns = columns_named(plateaus, wanted, "plateaus")
    return [_column("plateaus", column) for column in columns]

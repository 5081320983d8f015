"""A session that is watched while its records arrive."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

from . import _native
from ._document import Document
from ._result import Result

if TYPE_CHECKING:
    from ._types import Path


class Watch(Iterator[Document]):
    """The plateaus of a session as they come: a document each, a line of ``watch-history.jsonl``.

    ``waiting`` says what is waited for; ``result`` is the calibration once the schedule is complete; ``url`` is the address of the live
    page, which stays as long as this object. Ctrl-C, the end of a ``with`` block and :meth:`close` end the watch; the same call goes on
    from its state.
    """

    def __init__(self, native: _native.Watcher, on_alarm: Callable[[str, str], object] | None = None) -> None:
        self._native, self._on_alarm = native, on_alarm
        self.url: str | None = native.url
        self.waiting: str | None = None
        self.result: Result | None = None

    def __next__(self) -> Document:
        for event, content in self._native:
            if isinstance(content, _native.CalibrationResult):
                self.result = Result(content)
            elif isinstance(content, tuple):
                if self._on_alarm is not None:
                    self._on_alarm(*content)
            elif event == "plateau" and content is not None:
                return Document(content)
            elif event == "waiting":
                self.waiting = content
        raise StopIteration

    def close(self) -> None:
        """Ends the watch."""
        self._native.close()

    def __enter__(self) -> Watch:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def watch(
    session: Path,
    out: Path,
    *,
    targets: Iterable[str] | Mapping[str, float] = (),
    false_alarm: float = 0.01,
    hold_out: Iterable[str] = (),
    hold_out_alarms: bool = False,
    interval: float = 2.0,
    quiet: float = 60.0,
    frozen: float = 10.0,
    once: bool = False,
    live: bool = False,
    serve: str | bool = False,
    serve_names: Iterable[str] = (),
    on_alarm: Callable[[str, str], object] | str | None = None,
) -> Watch:
    """Watches a session folder: after each plateau rank, estimates and uncertainties.

    Parameters
    ----------
    out
        Folder for the state, the history, its plot and ``result.json``.
    targets
        Groups of parameters that have to be there: ``["bias"]``; or with target standard uncertainties in the unit of the table, which
        the live page shows: ``{"bias": 0.01}``.
    false_alarm
        Probability that a good session raises an alarm.
    interval, quiet
        Seconds between two looks, and without change after which a record counts as finished.
    frozen
        Seconds without a sample after which a record counts as frozen in the midst of its schedule.
    once
        Whether one look is enough.
    live
        Whether ``watch-live.json`` is written, of which ``centrical view OUT`` makes the live page.
    serve, serve_names
        Whether this process shows the live page itself: ``True`` for this machine, port 8080, or an address such as ``"127.0.0.1:0"``;
        other names of this machine by which browsers may call it. There is no password. It needs a package that was built with the
        feature ``serve``, which wheels have not.
    on_alarm
        A function of ``"plateau"``, ``"frozen"`` or ``"failed"`` and of what was found: it is called while the plateaus are iterated. Or a command of
        the shell, which is started and not waited for, with ``CENTRICAL_ALARM``, ``CENTRICAL_MESSAGE`` and ``CENTRICAL_SESSION``.

    >>> watched = ct.watch(example, folder / "watched", once=True, quiet=0.0)
    >>> len(list(watched)), watched.result.acceptable
    (108, True)
    """
    address = (USUAL if serve is True else serve) or None
    shown = [(group, float(value)) for group, value in targets.items()] if isinstance(targets, Mapping) else []
    live_targets = shown if live or address else None
    native = _native.Watcher(
        session,
        out,
        list(targets),
        false_alarm,
        list(hold_out),
        hold_out_alarms,
        interval,
        quiet,
        frozen,
        once,
        address,
        list(serve_names),
        live_targets,
    )
    return Watch(native, _command(on_alarm, session) if isinstance(on_alarm, str) else on_alarm)


#: The usual address of the live page.
USUAL = "127.0.0.1:8080"


def _command(command: str, session: Path) -> Callable[[str, str], object]:
    """A function that starts a command of the shell. What files say is in its environment and never in its text."""
    # Imported late: a watch without a command needs none.
    import subprocess

    def start(kind: str, found: str) -> object:
        alarm = {"CENTRICAL_ALARM": kind, "CENTRICAL_MESSAGE": found, "CENTRICAL_SESSION": os.fspath(session)}
        nothing = subprocess.DEVNULL
        return subprocess.Popen(command, shell=True, env={**os.environ, **alarm}, stdin=nothing, stdout=nothing)

    return start

"""A session that is watched while its records arrive."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from . import _native
from ._document import Document
from ._result import Result

if TYPE_CHECKING:
    from ._types import Path


class Watch(Iterator[Document]):
    """The plateaus of a session as they come: a document each, a line of ``watch-history.jsonl``.

    ``waiting`` says what is waited for; ``result`` is the calibration once the schedule is complete. Ctrl-C, the end of a
    ``with`` block and :meth:`close` end the watch; the same call goes on from its state.
    """

    def __init__(self, native: _native.Watcher) -> None:
        self._native = native
        self.waiting: str | None = None
        self.result: Result | None = None

    def __next__(self) -> Document:
        for event, content in self._native:
            if isinstance(content, _native.CalibrationResult):
                self.result = Result(content)
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
    targets: Iterable[str] = (),
    false_alarm: float = 0.01,
    hold_out: Iterable[str] = (),
    hold_out_alarms: bool = False,
    interval: float = 2.0,
    quiet: float = 60.0,
    once: bool = False,
) -> Watch:
    """Watches a session folder: after each plateau rank, estimates and uncertainties.

    Parameters
    ----------
    out
        Folder for the state, the history, its plot and ``result.json``.
    targets
        Groups of parameters that have to be there: ``["bias"]``.
    false_alarm
        Probability that a good session raises an alarm.
    interval, quiet
        Seconds between two looks, and without change after which a record counts as finished.
    once
        Whether one look is enough.

    >>> watched = ct.watch(example, folder / "watched", once=True, quiet=0.0)
    >>> len(list(watched)), watched.result.acceptable
    (108, True)
    """
    return Watch(
        _native.Watcher(
            session, out, list(targets), false_alarm, list(hold_out), hold_out_alarms, interval, quiet, once
        )
    )

"""Progress of long work: a bar on a terminal or in a notebook, nothing anywhere else."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

Shown = Callable[[int, int], None]

_is_wanted = True


def set_progress(wanted: bool) -> None:
    """Whether long functions show a bar: on standard error where that is a terminal, and in notebooks.

    >>> ct.set_progress(False)
    """
    global _is_wanted
    _is_wanted = bool(wanted)


class Bar:
    """A bar that the native core moves every 50 ms; it appears when the work takes longer than half a second."""

    def __init__(self, doing: str) -> None:
        self._doing = doing
        self._begun = time.monotonic()
        self._show = _display()
        self._is_shown = False

    def __enter__(self) -> Shown | None:
        return self._move if self._show else None

    def __exit__(self, *_: object) -> None:
        if self._show and self._is_shown:
            self._show("")

    def _move(self, done: int, everything: int) -> None:
        patience = 0.5
        elapsed = time.monotonic() - self._begun
        if self._show and elapsed > patience:
            self._is_shown = True
            self._show(text(self._doing, done, everything, elapsed))


def text(doing: str, done: int, everything: int, elapsed: float) -> str:
    """The bar in characters; only the time where nobody knows how much there is to do.

    >>> from centrical._progress import text
    >>> text("reading", 1, 4, 3.0)
    'reading [#######.....................]  25 %, 9 s left'
    """
    if everything <= 0:
        return f"{doing}, {elapsed:.0f} s"
    width = 28
    part = min(done / everything, 1.0)
    bar = "#" * int(width * part)
    left = f", {elapsed * (1 - part) / part:.0f} s left" if part > 0 else ""
    return f"{doing} [{bar:.<{width}}] {100 * part:3.0f} %{left}"


def _display() -> Callable[[str], None] | None:
    """What shows a line, in place of the one before; nothing if nobody looks."""
    if not _is_wanted:
        return None
    if _is_notebook():
        return _in_notebook()
    if sys.stderr is not None and sys.stderr.isatty():
        return lambda line: print(f"\r\x1b[K{line}", end="", file=sys.stderr, flush=True)
    return None


def _is_notebook() -> bool:
    # Only a program that has imported IPython runs in a notebook.
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return type(shell).__name__ == "ZMQInteractiveShell"


def _in_notebook() -> Callable[[str], None]:
    from IPython.display import display  # type: ignore[import-not-found, unused-ignore]

    handle = display({"text/plain": ""}, raw=True, display_id=True)  # type: ignore[no-untyped-call, unused-ignore]
    return lambda line: handle.update({"text/plain": line}, raw=True)

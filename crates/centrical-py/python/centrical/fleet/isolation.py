"""A long-lived process that calibrates, and what becomes of a session that ends it."""

from __future__ import annotations

import json
import os
import selectors
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import IO

from .settings import Settings

TRIES = 2
"""Attempts before a session is called crashed: the machine may be at fault once."""


class Crashed(Exception):
    """A session ended the process that calibrated it."""


class WorkerTrouble(RuntimeError):
    """The process cannot work here: the disk is full, or the program does not start."""


class Interrupted(RuntimeError):
    """The run was interrupted: nothing is said of the session at work."""


_running: set[Child] = set()
_is_ending = threading.Event()


def end_all() -> None:
    """Ends the processes of all threads; what they were at work on is as if it had not begun."""
    _is_ending.set()
    for child in list(_running):
        child.kill()


def begin() -> None:
    """Processes may start again, after :func:`end_all` and the end of the threads."""
    for child in list(_running):
        child.end()
    _is_ending.clear()


class Child:
    """The process; it starts with the first session, and again after it ended."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._process: subprocess.Popen[bytes] | None = None

    def calibrate(self, session: str, folder: Path, out: Path) -> None:
        """Calibrates a session, its path below ``folder``, into the store ``out``.

        Raises :class:`Crashed` when it ended the process, or passed the time limit, twice.
        """
        settings = self._settings
        request = {
            "session": session,
            "folder": str(folder),
            "out": str(out),
            "method": settings.method,
            "reduced": settings.reduced,
        }
        for attempt in range(1, TRIES + 1):
            if _is_ending.is_set():
                raise Interrupted(session)
            try:
                answer = self._ask(request)
                break
            except Crashed:
                self.end()
                if _is_ending.is_set():
                    raise Interrupted(session) from None
                if attempt == TRIES:
                    raise
        if "error" in answer:
            raise WorkerTrouble(answer["error"])

    def kill(self) -> None:
        """Kills the process, from any thread."""
        if self._process is not None:
            self._process.kill()

    def end(self) -> None:
        """Ends the process, from the thread that works with it."""
        self.kill()
        _running.discard(self)
        process, self._process = self._process, None
        if process is not None:
            process.wait()
            for pipe in (process.stdin, process.stdout):
                if pipe is not None:
                    pipe.close()

    def _ask(self, request: dict[str, object]) -> dict[str, str]:
        process = self._running()
        assert process.stdin is not None and process.stdout is not None
        try:
            process.stdin.write(json.dumps(request).encode() + b"\n")
            process.stdin.flush()
            line = self._line(process.stdout)
        except BrokenPipeError:
            line = b""
        if not line.endswith(b"\n"):
            raise Crashed(_ending(process.wait(), self._settings.memory))
        answer: dict[str, str] = json.loads(line)
        return answer

    def _running(self) -> subprocess.Popen[bytes]:
        if self._process is None:
            child = self._settings.child or ("-m", "centrical.fleet.child")
            command = [sys.executable, *child, str(self._settings.memory)]
            self._process = subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, bufsize=0
            )
            _running.add(self)
            # It may have started after all others were killed.
            if _is_ending.is_set():
                self.kill()
        return self._process

    def _line(self, pipe: IO[bytes]) -> bytes:
        """A line of the process, or what there was of one when it ended."""
        until = time.monotonic() + self._settings.seconds
        line = b""
        with selectors.DefaultSelector() as selector:
            selector.register(pipe, selectors.EVENT_READ)
            while not line.endswith(b"\n"):
                if not selector.select(max(0.0, until - time.monotonic())):
                    raise Crashed(f"took longer than {self._settings.seconds:g} s")
                piece = os.read(pipe.fileno(), 1 << 16)
                if not piece:
                    break
                line += piece
        return line


def _ending(code: int, memory: int) -> str:
    if code < 0:
        return f"ended by {signal.Signals(-code).name}"
    # It did not start, for want of memory as a rule.
    return f"ended with exit code {code} in {memory / 2**30:.3g} GiB of memory"

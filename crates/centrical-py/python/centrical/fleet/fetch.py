"""Sessions of an object store on the disk of a worker, one ahead of the one that is calibrated."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import obstore

from .places import GONE, Place, Session

PIECE = 16 << 20
"""Bytes of one request [bytes]: larger files come in several at once."""
AT_ONCE = 8
"""Requests at a time."""


@dataclass(frozen=True)
class Vanished:
    """A file that was listed and is not there."""

    file: str


def sessions_on_disk(
    place: Place, sessions: tuple[Session, ...], scratch: Path
) -> Iterator[tuple[Session, Path, Vanished | None]]:
    """Each session, the folder that its name is below, and what vanished. A folder of the file system is used where it is."""
    if place.folder is not None:
        for session in sessions:
            gone = next((file.path for file in session.files if not (place.folder / session.name / file.path).exists()), None)
            yield session, place.folder, Vanished(gone) if gone else None
        return
    store = place.open()
    with ThreadPoolExecutor(AT_ONCE) as requests, ThreadPoolExecutor(1) as ahead:
        waiting: list[Future[Vanished | None]] = []
        for number, session in enumerate(sessions):
            for next_one in sessions[number + len(waiting) : number + 2]:
                waiting.append(ahead.submit(_fetch, store, next_one, scratch / next_one.name, requests))
            yield session, scratch, waiting.pop(0).result()
            shutil.rmtree(scratch / session.name, ignore_errors=True)


def _fetch(store: Any, session: Session, folder: Path, requests: ThreadPoolExecutor) -> Vanished | None:
    pieces = []
    for file in session.files:
        target = folder / file.path
        target.parent.mkdir(parents=True, exist_ok=True)
        with open(target, "wb") as output:
            output.truncate(file.size)
        source = file.path if session.name == "." else f"{session.name}/{file.path}"
        starts = range(0, file.size, PIECE)
        pieces += [(file.path, source, target, start, min(PIECE, file.size - start)) for start in starts]
    gone = [piece[0] for piece, there in zip(pieces, requests.map(lambda piece: _piece(store, *piece[1:]), pieces)) if not there]
    return Vanished(gone[0]) if gone else None


def _piece(store: Any, source: str, target: Path, start: int, length: int) -> bool:
    """Writes a piece of a file to its place, unless the file vanished."""
    try:
        content = memoryview(obstore.get_range(store, source, start=start, length=length))
    except GONE:
        return False
    with open(target, "r+b") as output:
        output.seek(start)
        output.write(content)
    return True


def remove_leftovers(folder: Path) -> None:
    """Removes scratch folders of workers that were killed: each is named by the process that made it."""
    for leftover in folder.glob(f"{SCRATCH}*"):
        process = leftover.name.removeprefix(SCRATCH).split("-")[0]
        if process.isdigit() and not _is_running(int(process)):
            shutil.rmtree(leftover, ignore_errors=True)


SCRATCH = "centrical-fleet-"


def _is_running(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True

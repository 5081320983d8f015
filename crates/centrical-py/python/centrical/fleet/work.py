"""One task on a worker: the sessions of a part, calibrated and written."""

from __future__ import annotations

import json
import os
import tempfile
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import obstore

from .. import _native
from .fetch import SCRATCH, Vanished, remove_leftovers, sessions_on_disk
from .isolation import Child, Crashed
from .parts import Part
from .places import Place, Session, get, put_new
from .settings import Settings, check
from .tables import Outcome, counts_of, parameters_of, parquet, rows_of, sessions_of

MARKER = "centrical-part/1"

_here = threading.local()


@dataclass(frozen=True)
class Task:
    """A part and all that a worker needs for it."""

    part: Part
    source: Place
    out: Place
    settings: Settings
    environment: dict[str, str]


def make(task: Task) -> dict[str, Any]:
    """Calibrates the sessions of a part, writes its tables, and its marker last. Gives the counts that the marker has."""
    check(task.environment)
    out = task.out.open(make=True)
    place = Path(tempfile.gettempdir())
    remove_leftovers(place)
    with tempfile.TemporaryDirectory(prefix=f"{SCRATCH}{os.getpid()}-", dir=place) as folder:
        on_disk = sessions_on_disk(task.source, task.part.sessions, Path(folder, "sessions"))
        # A store for each session: one that grows takes longer with every row.
        outcomes = [
            _calibrated(session, root, vanished, Path(folder, "stores", str(number)), task.settings)
            for number, (session, root, vanished) in enumerate(on_disk)
        ]
        return _write(task, out, Path(folder, "stores"), outcomes)


def _calibrated(session: Session, root: Path, vanished: Vanished | None, store: Path, settings: Settings) -> Outcome:
    begun = time.perf_counter()
    if vanished:
        key = _failed(store, session.name, vanished.file, "no such file", "the file that was listed")
    else:
        try:
            _child(settings).calibrate(session.name, root, store)
            key = _key(store, session.name)
        except Crashed as crash:
            key = _failed(store, session.name, "", f"crashed: {crash}, twice", "a calibration")
    return Outcome(session.name, key, session.bytes, time.perf_counter() - begun)


def _child(settings: Settings) -> Child:
    """The process of this thread of the worker: it stays from part to part."""
    known = getattr(_here, "child", None)
    if known is None or known[0] != settings:
        if known is not None:
            known[1].end()
        _here.child = known = (settings, Child(settings))
    child: Child = known[1]
    return child


def _key(store: Path, session: str) -> str:
    """The key of the row of a session, by the last line that the series wrote of it."""
    lines = (json.loads(line) for line in (store / "series.jsonl").read_text().splitlines())
    return str([line["key"] for line in lines if line["session"] == session][-1])


def _failed(store: Path, session: str, file: str, found: str, expected: str) -> str:
    where = f"{session}/{file}" if file else session
    message = f"{where}: found {found}, expected {expected}"
    return _native.add_failure(store, session, message, where, found, expected)


def _write(task: Task, out: Any, stores: Path, outcomes: list[Outcome]) -> dict[str, Any]:
    """Tables and results first, the marker last: a part without it is not there."""
    name, rows = task.part.name, rows_of(stores)
    sessions = sessions_of(rows, outcomes, stores)
    if task.settings.results:
        _upload(out, stores, "results")
    _upload(out, stores, "reduced")
    for folder, table in (("rows", rows), ("sessions", sessions), ("parameters", parameters_of(rows, outcomes))):
        obstore.put(out, f"{folder}/{name}.parquet", parquet(table))
    marker: dict[str, Any] = {
        "schema": MARKER,
        "part": name,
        "source": task.source.url,
        "program": task.environment["version"],
        "settings": task.settings.of_result(),
        "sessions": [outcome.session for outcome in outcomes],
        "counts": counts_of(sessions),
        "bytes": sum(outcome.bytes for outcome in outcomes),
        "seconds": sum(outcome.seconds for outcome in outcomes),
    }
    if not put_new(out, f"parts/{name}.json", json.dumps(marker).encode()):
        # Another driver made the same part: what counts is what it wrote.
        marker = json.loads(get(out, f"parts/{name}.json"))
    counts: dict[str, Any] = marker["counts"]
    return counts


def _upload(out: Any, stores: Path, folder: str) -> None:
    """Results and reduced sessions, each by its key."""
    for store in sorted(stores.iterdir()):
        for file in sorted((store / folder).rglob("*")):
            if file.is_file():
                obstore.put(out, file.relative_to(store).as_posix(), file)

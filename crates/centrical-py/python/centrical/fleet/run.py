"""The driver: what is there, what is missing, and the one commit at the end."""

from __future__ import annotations

import hashlib
import json
import shutil
import sys
import time
from collections import Counter
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import obstore

from .engines import engine_of
from .parts import Part, parts_of
from .places import GONE, Place, Session, first_line, get, list_sessions, names, paths_below, read_manifest, remove
from .settings import EnvironmentMismatch, Settings, expected
from .tables import keys_of
from .work import Task, make

MANIFEST = "centrical-fleet/1"

FATAL = (EnvironmentMismatch, ImportError, PermissionError, obstore.exceptions.PermissionDeniedError, obstore.exceptions.UnauthenticatedError)
"""Errors that every part would meet: each ends the run at once."""

PER_PART = ("rows/{}.parquet", "sessions/{}.parquet", "parameters/{}.parquet", "parts/{}.json")


@dataclass(frozen=True)
class Done:
    """How a run ended."""

    sessions: int
    acceptable: int
    not_acceptable: int
    failed: int
    parts: int
    """Parts of the fleet."""
    made: int
    """Those that this run made; the others were there."""
    missing: tuple[str, ...] = ()
    """Why parts could not be made, a message each. The same command tries them again."""
    left_out: tuple[str, ...] = ()
    """Links and names below the place of the sessions that are not looked into, a message each."""

    @property
    def exit_code(self) -> int:
        """0: all acceptable; 1: some are not; 2: some failed, or parts are missing."""
        if self.failed or self.missing:
            return 2
        return 1 if self.not_acceptable else 0


def calibrate(
    sessions: str | Path,
    out: str | Path,
    engine: Any = None,
    *,
    settings: Settings | None = None,
    options: Mapping[str, str] | None = None,
    again: bool = False,
    progress: bool = True,
) -> Done:
    """Calibrates every session of a folder, a bucket's prefix or a manifest into ``out``, a folder or a prefix too.

    ``engine`` is the address of a Dask scheduler, its client, or an executor of :mod:`concurrent.futures`, whose processes
    are spawned, not forked; processes on this machine by default. The same call again makes only what is missing or changed; with ``again`` also the parts with sessions
    that failed, for other limits. ``options`` are those of obstore for both places; credentials come from the environment of
    each worker.
    """
    settings = settings or Settings()
    source, listed, left_out = _listed(sessions, options)
    place = Place.of(out, options)
    parts = parts_of(_not_in(place, source, listed), settings)
    store = place.open(make=True)
    there = names(store, "parts", ".json")
    if again:
        there -= _forgotten(store, [part for part in parts if part.name in there])
    due = [part for part in parts if part.name not in there]
    tasks = [Task(part, source, place, settings, expected()) for part in due]
    messages = _run(tasks, engine, progress) if tasks else []
    if messages:
        counts = _counts(store, [part for part in parts if part.name in names(store, "parts", ".json")])
    else:
        counts = _counts(store, parts)
        _commit(store, place, source, parts, counts)
    made = len(due) - len(messages)
    return Done(parts=len(parts), made=made, missing=tuple(messages), left_out=tuple(left_out), **_named(counts))


def _listed(sessions: str | Path, options: Mapping[str, str] | None) -> tuple[Place, list[Session], list[str]]:
    left_out: list[str] = []
    if "://" not in str(sessions) and Path(sessions).is_file():
        url, listed = read_manifest(Path(sessions))
        place = Place.of(url, options)
    else:
        place = Place.of(sessions, options)
        listed, left_out = list_sessions(place)
    if not listed:
        raise FileNotFoundError(f"{sessions}: found no experiment.toml in it or below, expected sessions")
    return place, listed, left_out


def _not_in(out: Place, source: Place, listed: list[Session]) -> list[Session]:
    """The sessions without those that an earlier run wrote into an output that lies among them."""
    if not f"{out.url}/".startswith(f"{source.url}/"):
        return listed
    below = out.url[len(source.url) + 1 :]
    if not below:
        raise ValueError(f"{out.url}: found the place of the sessions, expected another one for the output")
    return [session for session in listed if not f"{session.name}/".startswith(f"{below}/")]


def _run(tasks: list[Task], engine: Any, progress: bool) -> list[str]:
    """Makes the parts; messages of those that failed."""
    running = engine_of(engine)
    bar = _Bar(sum(task.part.work for task in tasks), progress)
    messages = []
    try:
        running.check(tasks[0].environment)
        for number, outcome in running.run(make, tasks, [f"centrical-{_run_key(task)}" for task in tasks]):
            if isinstance(outcome, FATAL):
                raise outcome
            if isinstance(outcome, BaseException):
                messages.append(f"part {tasks[number].part.name}: {type(outcome).__name__}: {first_line(outcome)}")
            bar.add(tasks[number].part.work)
    finally:
        bar.end()
        running.close()
    return messages


def _run_key(task: Task) -> str:
    """One name for one part and one place: two drivers on one scheduler share the task."""
    return hashlib.sha256(f"{task.part.name} {task.out.url}".encode()).hexdigest()[:32]


def _forgotten(store: Any, parts: list[Part]) -> set[str]:
    """Removes the markers of parts with sessions that failed; their names."""
    failed = {part.name for part, marker in zip(parts, _markers(store, parts)) if marker["counts"]["failed"]}
    for name in sorted(failed):
        obstore.delete(store, f"parts/{name}.json")
    return failed


def _markers(store: Any, parts: Iterable[Part]) -> list[dict[str, Any]]:
    with ThreadPoolExecutor(16) as requests:
        return list(requests.map(lambda part: json.loads(get(store, f"parts/{part.name}.json")), parts))


def _counts(store: Any, parts: Iterable[Part]) -> Counter[str]:
    """The sum of what the markers say."""
    total: Counter[str] = Counter()
    for marker in _markers(store, parts):
        total.update(marker["counts"])
    return total


def _named(counts: Counter[str]) -> dict[str, int]:
    return {name: counts[name] for name in ("sessions", "acceptable", "not_acceptable", "failed")}


def _commit(store: Any, out: Place, source: Place, parts: list[Part], counts: Counter[str]) -> None:
    """Removes parts of this source that its sessions have left, and says what the fleet is, in one object."""
    current = {part.name for part in parts}
    present = {session.name for part in parts for session in part.sessions}
    left = []
    for name in sorted(names(store, "parts", ".json") - current):
        marker = json.loads(get(store, f"parts/{name}.json"))
        if marker["source"] == source.url and present.intersection(marker["sessions"]):
            left.append(name)
    if left:
        _remove_results(store, out, left)
    for name in left:
        # The marker goes last: until then the same command finds what it has to remove.
        for pattern in PER_PART:
            remove(store, pattern.format(name))
    manifest = {
        "schema": MANIFEST,
        "source": source.url,
        "program": expected()["version"],
        "parts": sorted(current),
        "counts": _named(counts),
    }
    text = json.dumps(manifest, sort_keys=True).encode()
    name = hashlib.sha256(source.url.encode()).hexdigest()[:16]
    # One manifest a source. It replaces the one before, whole.
    obstore.put(store, f"manifests/{name}.json", text)


def _remove_results(store: Any, out: Place, left: list[str]) -> None:
    """Removes results and reduced sessions of parts that the sessions have left, unless rows of another part name them."""
    keys: set[str] = set()
    for name in left:
        try:
            keys |= keys_of(get(store, f"sessions/{name}.parquet"))
        except GONE:
            # An earlier run removed it, and was killed before it removed the marker.
            continue
    sessions = names(store, "sessions", ".parquet")
    # Rows that `history add` wrote have no table of sessions, which is the smaller one.
    others = [f"sessions/{name}.parquet" for name in sessions.difference(left)]
    others += [f"rows/{name}.parquet" for name in names(store, "rows", ".parquet") - sessions.union(left)]
    with ThreadPoolExecutor(16) as requests:
        for named in requests.map(lambda path: keys_of(get(store, path)), others):
            keys -= named
    for key in sorted(keys):
        remove(store, f"results/{key}.json")
        if out.folder is not None:
            shutil.rmtree(out.folder / "reduced" / key, ignore_errors=True)
        else:
            for path in paths_below(store, f"reduced/{key}"):
                remove(store, path)


class _Bar:
    """Progress with the time left, on standard error where that is a terminal."""

    def __init__(self, everything: float, wanted: bool) -> None:
        self._everything, self._done, self._begun = everything, 0.0, time.monotonic()
        self._shown = wanted and sys.stderr is not None and sys.stderr.isatty()

    def add(self, work: float) -> None:
        from .._progress import text

        self._done += work
        if self._shown:
            line = text("calibrating", int(1e3 * self._done), int(1e3 * self._everything), time.monotonic() - self._begun)
            print(f"\r\x1b[K{line}", end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        if self._shown:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)

"""Folders and buckets by one name, and the sessions in them."""

from __future__ import annotations

import json
import os
import posixpath
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import timedelta
from pathlib import Path
from typing import Any

import obstore

from .walk import walk

EXPERIMENT = "experiment.toml"

GONE = (FileNotFoundError, obstore.exceptions.NotFoundError)
"""What obstore raises for an object that is not there."""

RETRIES = {"max_retries": 12, "retry_timeout": timedelta(seconds=120)}
"""How long an object store may be unavailable; obstore backs off between attempts."""


_owner = 0
"""The process whose threads of obstore work; 0 before the first of them."""


def claim() -> None:
    """Refuses a forked child of a process that has used obstore: it has none of those threads, and would wait for ever."""
    global _owner
    here = os.getpid()
    _owner = _owner or here
    if _owner != here:
        raise RuntimeError(
            "found a process forked after centrical.fleet had started threads of obstore, expected one of its own: "
            'use mp_context=multiprocessing.get_context("spawn"), or fork before the first call'
        )


@dataclass(frozen=True)
class File:
    """A file of a session."""

    path: str
    """Path below the session."""
    size: int
    stamp: str
    """ETag, or what stands for one: it changes when the file does."""


@dataclass(frozen=True)
class Session:
    """A session as it was listed."""

    name: str
    """Path of its folder below the place."""
    files: tuple[File, ...]

    @property
    def bytes(self) -> int:
        """Size of its files."""
        return sum(file.size for file in self.files)


@dataclass(frozen=True)
class Place:
    """A folder, or a prefix of a bucket: ``s3://bucket/prefix``."""

    url: str
    options: tuple[tuple[str, str], ...] = ()

    @staticmethod
    def of(place: str | Path, options: Mapping[str, str] | None = None) -> Place:
        """By its path or URL; ``options`` are obstore's, such as ``endpoint``."""
        text = str(place)
        url = text.rstrip("/") if "://" in text else str(Path(text).resolve())
        return Place(url, tuple(sorted((options or {}).items())))

    @property
    def folder(self) -> Path | None:
        """The folder, if it is one of the file system."""
        return None if "://" in self.url else Path(self.url)

    def open(self, make: bool = False) -> Any:
        """The store of obstore, with this place as its root."""
        claim()
        if self.folder is not None:
            if make:
                self.folder.mkdir(parents=True, exist_ok=True)
            return obstore.store.LocalStore(self.url)
        options = dict(self.options)
        # Without TLS where the address of the store says so: in a laboratory's own network, and in tests.
        client = {"allow_http": True} if options.get("endpoint", "").startswith("http://") else None
        return obstore.store.from_url(self.url, config=options or None, client_options=client, retry_config=RETRIES)


def put_new(store: Any, path: str, content: bytes) -> bool:
    """Writes an object that is not there yet, whole or not at all; whether it was not there."""
    try:
        obstore.put(store, path, content, mode="create")
    except obstore.exceptions.AlreadyExistsError:
        return False
    return True


def get(store: Any, path: str) -> bytes:
    """The bytes of an object."""
    return bytes(obstore.get(store, path).bytes())


def remove(store: Any, path: str) -> None:
    """Removes an object, which another driver may have removed."""
    try:
        obstore.delete(store, path)
    except GONE:
        pass


def paths_below(store: Any, folder: str) -> list[str]:
    """The objects in a folder and below."""
    return [item["path"] for batch in obstore.list(store, f"{folder}/", chunk_size=1000) for item in batch]


def names(store: Any, folder: str, suffix: str) -> set[str]:
    """Names of the objects directly in a folder that end in a suffix, without both."""
    listed = paths_below(store, folder)
    return {posixpath.basename(path).removesuffix(suffix) for path in listed if path.endswith(suffix)}


def list_sessions(place: Place) -> tuple[list[Session], list[str]]:
    """The sessions in a place, by name: every folder with an ``experiment.toml``, and the files in it and below.

    And messages of what is left out. A bucket takes one listing of a thousand objects a request; no file is asked for alone.
    """
    if place.folder is not None and not place.folder.is_dir():
        raise FileNotFoundError(f"{place.url}: found no such folder, expected sessions")
    left_out: list[str] = []
    files = [File(*found) for found in walk(place.folder, left_out)] if place.folder is not None else _objects(place)
    roots = {posixpath.dirname(file.path) for file in files if posixpath.basename(file.path) == EXPERIMENT}
    return _grouped(files, roots), left_out


def _objects(place: Place) -> list[File]:
    listed = (item for batch in obstore.list(place.open(), chunk_size=1000) for item in batch)
    return [
        File(item["path"], item["size"], item["e_tag"] or f"{item['size']} {item['last_modified'].isoformat()}") for item in listed
    ]


def _grouped(files: list[File], roots: set[str]) -> list[Session]:
    sessions: dict[str, list[File]] = {root: [] for root in roots}
    for file in files:
        folder = posixpath.dirname(file.path)
        while folder and folder not in roots:
            folder = posixpath.dirname(folder)
        if folder in roots:
            below = file.path[len(folder) + 1 :] if folder else file.path
            sessions[folder].append(File(below, file.size, file.stamp))
    ordered = sorted(sessions.items())
    return [Session(name or ".", tuple(sorted(found, key=lambda file: file.path))) for name, found in ordered]


def read_manifest(file: Path) -> tuple[str, list[Session]]:
    """A place and its sessions from a file that lists them, so that nothing is listed.

    JSON lines: the first has ``{"place": URL}``, every other one ``{"name": ..., "files": [[path, size, stamp], ...]}``.
    """
    place, sessions = "", []
    for number, line in enumerate(file.read_text().splitlines(), start=1):
        try:
            entry = json.loads(line)
            if number == 1:
                place = str(entry["place"])
            else:
                found = tuple(File(str(path), int(size), str(stamp)) for path, size, stamp in entry["files"])
                sessions.append(Session(str(entry["name"]), found))
        except (ValueError, KeyError, TypeError) as error:
            wanted = '{"place": URL}' if number == 1 else '{"name": NAME, "files": [[PATH, SIZE, STAMP], ...]}'
            raise ValueError(f"{file}, line {number}: found {line[:60]!r}, expected {wanted}") from error
    return place, sorted(sessions, key=lambda session: session.name)


def first_line(error: BaseException) -> str:
    """The first line of an error: behind it obstore shows the store's answer and its own insides."""
    return str(error).split("\n")[0].split(": <?xml")[0]

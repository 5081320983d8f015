"""What stands for a session or a file: a path, or the thing itself in memory."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, Union

#: The text of an experiment file, the path that it stands for, files by name, and names of record, telemetry, pulses by mounting.
InMemory = tuple[str, str, list[tuple[str, bytes]], list[tuple[str, Union[str, None], Union[str, None]]]]


def given_session(session: Any) -> Any:
    """A path as it is; of a :class:`centrical.Session` its path, or its files in memory."""
    return getattr(session, "_given", session)


def given_file(name: str, source: Any) -> Any:
    """A path as it is; the bytes of a file, or a file that is open, with a name for messages."""
    found = bytes_of(source)
    return source if found is None else (name, found)


def is_file(thing: Any) -> bool:
    """Whether something is the bytes of a file, or a file that is open."""
    return isinstance(thing, (bytes, bytearray, memoryview)) or callable(getattr(thing, "read", None))


def bytes_of(source: Any) -> bytes | None:
    """The bytes of a file in memory, or of one that is open, from where it stands; nothing of other things.

    >>> import io
    >>> from centrical._given import bytes_of
    >>> bytes_of(io.BytesIO(b"t,f1")), bytes_of("record.csv")
    (b't,f1', None)
    """
    if callable(getattr(source, "read", None)):
        source = source.read()
        source = source.encode() if isinstance(source, str) else source
    return bytes(source) if isinstance(source, (bytes, bytearray, memoryview)) else None


def named_files(files: Mapping[str, Any] | None) -> list[tuple[str, bytes]]:
    """The bytes of files by the names that an experiment file has for them."""
    named = []
    for name, source in (files or {}).items():
        found = bytes_of(source)
        if found is None:
            raise TypeError(f"files[{name!r}]: found {type(source).__name__}, expected bytes or an open file")
        named.append((os.fspath(name), found))
    return named

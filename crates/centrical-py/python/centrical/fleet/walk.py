"""The files of a folder as obstore would list them, without a stop at what it cannot name."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from pathlib import Path

Found = tuple[str, int, str]
"""Path below the folder, size, and the ETag that obstore gives it."""


def walk(root: Path, left_out: list[str]) -> Iterator[Found]:
    """The files in a folder and below, links followed; what is left out is named in ``left_out``.

    These are links to a folder that contains them, and names that no object of a store can have: a line break or another control
    character, or bytes that are not UTF-8.
    """
    above = frozenset(_identity(folder) for folder in (root, *root.parents))
    waiting = [(root, "", above)]
    while waiting:
        folder, below, above = waiting.pop()
        try:
            entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
        except FileNotFoundError:
            # It vanished after its name was read.
            continue
        for entry in entries:
            path = f"{below}{entry.name}"
            if not _is_name(entry.name):
                left_out.append(_message(root, path, "a name with a control character, or one that is not UTF-8", "another name"))
                continue
            try:
                status = entry.stat()
                if entry.is_file():
                    yield path, status.st_size, f'"{status.st_ino:x}-{status.st_mtime_ns // 1000:x}-{status.st_size:x}"'
                elif entry.is_dir():
                    here = (status.st_dev, status.st_ino)
                    if here in above:
                        raise OSError(errno.ELOOP, "")
                    waiting.append((Path(entry.path), f"{path}/", above | {here}))
            except FileNotFoundError:
                # It vanished, or is a link to nothing.
                continue
            except OSError as error:
                if error.errno != errno.ELOOP:
                    raise
                left_out.append(_message(root, path, "a link that leads in a circle", "one that ends"))


def _identity(folder: Path) -> tuple[int, int]:
    status = folder.stat()
    return status.st_dev, status.st_ino


def _is_name(name: str) -> bool:
    """Whether an object of a store can have the name of a file or folder in its path."""
    try:
        return all(byte >= 0x20 and byte != 0x7F for byte in name.encode())
    except UnicodeEncodeError:
        return False


def _message(root: Path, path: str, found: str, expected: str) -> str:
    where = f"{root}/{path}"
    # A name with a line break stands in one line.
    return f"{where if where.isprintable() else repr(where)[1:-1]}: found {found}, expected {expected}: left out"

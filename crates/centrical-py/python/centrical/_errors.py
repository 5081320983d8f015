"""What is wrong with a file, as exceptions with file, place, found and expected."""

from __future__ import annotations

import errno
from typing import Any


class InputError(ValueError):
    """A file, or a value in it, is not what its place calls for.

    Attributes
    ----------
    file : str or None
        The file.
    place : str or None
        Where in the file: ``"line 3, f2"``, ``"[site], gravity"``.
    found, expected : str or None
        What stands there, and what should.

    >>> try:
    ...     ct.Session.parse("[site]\\ngravity = 9,81", example).calibrate()
    ... except ct.InputError as error:
    ...     error.place
    'line 2, column 12'
    """

    def __init__(
        self,
        message: str,
        file: str | None = None,
        place: str | None = None,
        found: str | None = None,
        expected: str | None = None,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.file = file
        self.place = place
        self.found = found
        self.expected = expected

    def __str__(self) -> str:
        return self.message

    def __reduce__(self) -> tuple[Any, ...]:
        arguments = (self.message, self.file, self.place, self.found, self.expected)
        return type(self), arguments, self.__dict__


class FileError(InputError, OSError):
    """The system refused to read or write a file; ``errno`` says why."""

    def __reduce__(self) -> tuple[Any, ...]:
        return input_error, (self.message, self.file, self.place, self.found, self.expected, self.errno)


class NoSuchFileError(FileError, FileNotFoundError):
    """There is no such file."""


def input_error(
    message: str,
    file: str | None,
    place: str | None,
    found: str | None,
    expected: str | None,
    code: int | None,
) -> InputError:
    """The exception for an error of the native core, which calls this; ``code`` is that of the system."""
    if code is None:
        return InputError(message, file, place, found, expected)
    kind = NoSuchFileError if code == errno.ENOENT else FileError
    error = kind(message, file, place, found, expected)
    error.errno = code
    error.filename = file
    return error


def no_session(path: str) -> InputError:
    """The exception for a session that is not there."""
    expected = "an experiment file, or the folder with its experiment.toml"
    message = f"{path}: found no such file, expected {expected}"
    return input_error(message, path, None, "no such file", expected, errno.ENOENT)

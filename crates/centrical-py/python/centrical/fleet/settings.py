"""Settings of a run, and the environment that its workers need."""

from __future__ import annotations

import hashlib
import platform
from dataclasses import asdict, dataclass, field
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from .. import _native
from .places import claim


METHODS = ("exact", "recursive", "linear")

MOST = 1e6
"""Seconds of a session and of a part, and GiB of memory, at most: a system refuses much more."""


class EnvironmentMismatch(RuntimeError):
    """A worker has another program than the driver, or none."""


@dataclass(frozen=True)
class Settings:
    """How every session is calibrated, what is kept of it, and its limits."""

    method: str = "exact"
    """How a fit is computed: ``"exact"``, ``"recursive"`` or ``"linear"``."""
    results: bool = True
    """Whether ``result.json`` is kept, some 600 kB a session, beside its row of 11 kB."""
    reduced: bool = True
    """Whether the session is kept reduced, some kB: a later model is fitted to it without the records."""
    part: float = 30.0
    """Work in a part [s]: long against what an engine adds to a task, short against what a killed worker loses."""
    memory: int = 4 << 30
    """Address space of the process that calibrates [bytes]."""
    seconds: float = 600.0
    """Time for one session [s]."""
    child: tuple[str, ...] = field(default=(), repr=False)
    """Arguments of the interpreter for the process that calibrates; ``-m centrical.fleet.child`` if empty."""

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise ValueError(f"method: found {self.method!r}, expected one of {', '.join(METHODS)}")
        for name, value, most in (("part", self.part, MOST), ("memory", self.memory, MOST * 2**30), ("seconds", self.seconds, MOST)):
            if not 0 < value <= most:
                raise ValueError(f"{name}: found {value}, expected a number above 0, at most {most:g}")

    def of_result(self) -> dict[str, Any]:
        """The settings that name a part: limits do not change a result."""
        return {"method": self.method, "results": self.results, "reduced": self.reduced}


@dataclass(frozen=True)
class Environment:
    """Version and build, the same on the driver and on every worker."""

    version: str
    build: str

    def __str__(self) -> str:
        return f"centrical {self.version}, build {self.build[:12]}"


@cache
def environment() -> Environment:
    """Version and build of the program here."""
    library = Path(_native.__file__).read_bytes()
    return Environment(metadata.version("centrical"), hashlib.sha256(library).hexdigest())


def check(expected: dict[str, str]) -> str:
    """Refuses to work where the environment is another than the driver's, or obstore has no threads; says where that is.

    Machines of another kind have another build: of them the version alone has to agree.
    """
    claim()
    here = environment()
    same_kind = expected["machine"] == machine()
    if here.version != expected["version"] or (same_kind and here.build != expected["build"]):
        raise EnvironmentMismatch(f"{platform.node()}: found {here}, expected {expected['version']}, {expected['build'][:12]}")
    return f"{platform.node()}: {here}"


def machine() -> str:
    """System and processor."""
    return f"{platform.system()} {platform.machine()}"


def expected() -> dict[str, str]:
    """What :func:`check` compares with."""
    return {**asdict(environment()), "machine": machine()}

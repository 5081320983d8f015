"""A fleet cut into parts, each named by what goes into it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass

from .places import Session
from .settings import Settings, environment

BYTES_PER_SECOND = 1e8
SECONDS_PER_SESSION = 0.1
"""What one core reads, and what a session takes beside that; measured in docs/fleet.md."""


@dataclass(frozen=True)
class Part:
    """Sessions that one task calibrates."""

    name: str
    sessions: tuple[Session, ...]

    @property
    def work(self) -> float:
        """Its expected time [s]."""
        return sum(work(session) for session in self.sessions)


def work(session: Session) -> float:
    """Expected time of a session [s]."""
    return SECONDS_PER_SESSION + session.bytes / BYTES_PER_SECOND


def parts_of(sessions: list[Session], settings: Settings) -> list[Part]:
    """The parts of sessions that are sorted by name, those with most work first.

    The same listing gives the same parts. A session that comes, goes or changes changes its own part and none but its neighbours.
    """
    parts = [Part(_name(group, settings), tuple(group)) for group in _groups(sessions, settings.part)]
    return sorted(parts, key=lambda part: (-part.work, part.name))


def _groups(sessions: list[Session], seconds: float) -> Iterator[list[Session]]:
    """Cuts behind a session by the hash of its name alone, so that cuts stay where they are when other sessions come or go."""
    group: list[Session] = []
    total = 0.0
    for session in sessions:
        group.append(session)
        total += work(session)
        if total >= 2 * seconds or _fraction(session.name) < work(session) / seconds:
            yield group
            group, total = [], 0.0
    if group:
        yield group


def _fraction(name: str) -> float:
    """A number from 0 to 1 that is the name's own."""
    return int.from_bytes(hashlib.sha256(name.encode()).digest()[:7], "big") / float(1 << 56)


def _name(sessions: list[Session], settings: Settings) -> str:
    listed = [[session.name, [[file.path, file.size, file.stamp] for file in session.files]] for session in sessions]
    content = {"version": environment().version, "settings": settings.of_result(), "sessions": listed}
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:32]

"""A fleet's result in a few lines."""

from __future__ import annotations

import html
import tempfile
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from .. import _history
from .._errors import InputError
from .places import Place, get, names
from .tables import counts_of

SHOWN = 20
"""Failures and units that are named."""


@dataclass(frozen=True)
class Summary:
    """A fleet's result."""

    sessions: int
    counts: dict[str, int]
    """acceptable, not acceptable, failed."""
    objections: dict[str, int]
    """How many sessions each is raised against."""
    messages: list[str]
    """Of sessions that failed, the first of them."""
    units: Any
    """Outlying and drifting units, as ``centrical history units`` finds them; None where there are too few."""
    seconds: float
    """Time of all calibrations together [s]."""

    def __str__(self) -> str:
        lines = [f"{self.sessions} sessions: " + ", ".join(f"{count} {name}" for name, count in self.counts.items())]
        lines += [f"  {name}: {count}" for name, count in sorted(self.objections.items())]
        lines += [f"FAILED  {message}" for message in self.messages]
        if self.units is not None:
            lines += [f"OUTLYING  unit {unit.unit_serial}, by {', '.join(unit.most)}" for unit in self.units.outlying[:SHOWN]]
            found = self.units.findings[:SHOWN]
            lines += [f"{finding.kind.upper()}  unit {finding.unit_serial}: {finding.parameter}" for finding in found]
            for station in self.units.content.get("untested", []):
                where = f" at {station.station}" if station.station else ""
                lines.append(f"NOT TESTED  {len(station.units)} units{where}: ten are needed to say which is outlying")
            if self.units.is_tested and not self.units.outlying and not found:
                lines.append("no unit is outlying, drifts or scatters more than the others")
        lines.append(f"{self.seconds:.0f} s of calibration")
        return "\n".join(lines)

    def to_html(self) -> str:
        """The same as a page."""
        return (
            '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><meta name="color-scheme" content="light dark">'
            f"<title>Fleet</title></head><body><main><h1>Fleet</h1><pre>{html.escape(str(self))}</pre></main></body></html>\n"
        )


def summary(results: str | Path, options: Mapping[str, str] | None = None) -> Summary:
    """What a fleet's result, a folder or a bucket's prefix, says."""
    place = Place.of(results, options)
    store = place.open()
    parts = sorted(names(store, "parts/", ".json"))
    if not parts:
        raise FileNotFoundError(f"{results}: found no part, expected the result of centrical-fleet calibrate")
    sessions = pa.concat_tables(
        [pq.read_table(pa.BufferReader(get(store, f"sessions/{part}.parquet"))) for part in parts]
    )
    counts = {name.replace("_", " "): count for name, count in counts_of(sessions).items()}
    objections = Counter(name for listed in sessions["objections"].to_pylist() for name in listed or [])
    messages = sorted(message for message in sessions["message"].to_pylist() if message)
    seconds = float(sum(sessions["seconds"].to_pylist()))
    return Summary(counts.pop("sessions"), counts, dict(objections), messages[:SHOWN], _units(place, parts, store), seconds)


def _units(place: Place, parts: list[str], store: Any) -> Any:
    with tempfile.TemporaryDirectory() as folder:
        rows = Path(folder, "rows")
        rows.mkdir()
        for part in parts:
            (rows / f"{part}.parquet").write_bytes(get(store, f"rows/{part}.parquet"))
        try:
            return _history.history(folder, "units")
        except InputError:
            # One unit, units of several models, or sessions without a date.
            return None

"""A fleet's result in a few lines."""

from __future__ import annotations

import html
import tempfile
import warnings
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc
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
    units: dict[str, Any]
    """By model: outlying and drifting units, as ``centrical history units`` finds them."""
    not_tested: dict[str, str]
    """By model: why its units could not be compared."""
    without_day: list[str]
    """Calibrations that are left out of the comparison, as their session has no day for a date."""
    seconds: float
    """Time of all calibrations together [s]."""

    def __str__(self) -> str:
        lines = [f"{self.sessions} sessions: " + ", ".join(f"{count} {name}" for name, count in self.counts.items())]
        lines += [f"  {name}: {count}" for name, count in sorted(self.objections.items())]
        lines += [f"FAILED  {message}" for message in self.messages]
        for model, units in self.units.items():
            lines += _lines(model, units)
        lines += [f"NOT TESTED  {model}: {why}" for model, why in self.not_tested.items()]
        lines += [f"NO DAY  {calibration}" for calibration in self.without_day[:SHOWN]]
        lines.append(f"{self.seconds:.0f} s of calibration")
        return "\n".join(lines)

    def to_html(self) -> str:
        """The same as a page."""
        return (
            '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><meta name="color-scheme" content="light dark">'
            f"<title>Fleet</title></head><body><main><h1>Fleet</h1><pre>{html.escape(str(self))}</pre></main></body></html>\n"
        )


def _lines(model: str, units: Any) -> list[str]:
    """What is said of the units of a model."""
    lines = []
    for unit in units.outlying[:SHOWN]:
        most = ", ".join(f"{name} {deviations:+.1f}" for name, deviations in unit.most)
        lines.append(f"OUTLYING  {model}, serial {unit.unit_serial}: farthest, in standard deviations: {most}")
    found = units.findings[:SHOWN]
    lines += [f"{finding.kind.upper()}  {model}, serial {finding.unit_serial}: {finding.parameter}" for finding in found]
    for station in units.content.get("untested", []):
        count = f"{len(station.units)} unit{'s' if len(station.units) > 1 else ''}"
        where = f" at {station.station}" if station.station else ""
        lines.append(f"NOT TESTED  {model}, {count}{where}: ten are needed to say which is outlying")
    if units.is_tested and not lines:
        lines.append(f"{model}: no unit is outlying, drifts or scatters more than the others")
    return lines


def summary(results: str | Path, options: Mapping[str, str] | None = None) -> Summary:
    """What a fleet's result, a folder or a bucket's prefix, says."""
    place = Place.of(results, options)
    store = place.open()
    parts = sorted(names(store, "parts", ".json"))
    if not parts:
        raise FileNotFoundError(f"{results}: found no part, expected the result of centrical-fleet calibrate")
    sessions = pa.concat_tables(
        [pq.read_table(pa.BufferReader(get(store, f"sessions/{part}.parquet"))) for part in parts]
    )
    counts = {name.replace("_", " "): count for name, count in counts_of(sessions).items()}
    objections = Counter(name for listed in sessions["objections"].to_pylist() for name in listed or [])
    messages = sorted(message for message in sessions["message"].to_pylist() if message)
    seconds = float(sum(sessions["seconds"].to_pylist()))
    models = sorted({model for model in sessions.filter(pc.equal(sessions["status"], "done"))["unit_model"].to_pylist()})
    return Summary(
        counts.pop("sessions"), counts, dict(objections), messages[:SHOWN], *_units(place, parts, store, models), seconds
    )


def _units(place: Place, parts: list[str], store: Any, models: list[str]) -> tuple[dict[str, Any], dict[str, str], list[str]]:
    """By model its units beside each other, or why they are not; and the calibrations without a day."""
    units: dict[str, Any] = {}
    not_tested: dict[str, str] = {}
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings(record=True) as without_day:
        warnings.simplefilter("always")
        rows = Path(folder, "rows")
        rows.mkdir()
        for part in parts:
            (rows / f"{part}.parquet").write_bytes(get(store, f"rows/{part}.parquet"))
        for model in models:
            try:
                units[model] = _history.history(folder, "units", model=model)
            except InputError as error:
                # One unit, units in two output units, or sessions without a day.
                not_tested[model] = str(error).replace(folder, place.url)
    return units, not_tested, [str(warning.message) for warning in without_day]

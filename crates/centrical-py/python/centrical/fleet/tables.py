"""The tables of a part, from the store in which its sessions were calibrated."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

ROW_GROUP = 128
"""Rows that a reader holds at a time."""


@dataclass(frozen=True)
class Outcome:
    """What became of one session."""

    session: str
    key: str
    bytes: int
    seconds: float


def rows_of(stores: Path) -> pa.Table:
    """The rows of the stores in a folder, every key once, sorted by key: the schema ``centrical-rows/2`` with its footer."""
    parts = [pq.read_table(file) for file in sorted(stores.glob("*/rows/*.parquet"))]
    # Those of an older program have fewer columns.
    table = pa.concat_tables(parts, promote_options="default")
    first: dict[str, int] = {}
    for index, key in enumerate(table["key"].to_pylist()):
        first.setdefault(key, index)
    table = table.take([first[key] for key in sorted(first)]).combine_chunks()
    # The checksums in the footers are of the columns of each part.
    footer = {key: value for key, value in (table.schema.metadata or {}).items() if key != b"centrical_crc32"}
    return table.replace_schema_metadata(footer)


def sessions_of(rows: pa.Table, outcomes: list[Outcome], stores: Path) -> pa.Table:
    """A row for each session: identity, verdict, how the fit went, what stood out, and what it cost."""
    kept = (
        "status message file place found expected unit_model unit_serial title date station program inputs termination "
        "chi_squared degrees_of_freedom rank columns acceptable objections"
    ).split()
    of_key = {row["key"]: row for row in rows.select(["key", *kept]).to_pylist()}
    results = {file.stem: file for file in stores.glob("*/results/*.json")}
    lines = [
        {
            "session": outcome.session,
            "key": outcome.key,
            **{name: of_key[outcome.key][name] for name in kept},
            **_shown(results.get(outcome.key)),
            "bytes": outcome.bytes,
            "seconds": outcome.seconds,
        }
        for outcome in sorted(outcomes, key=lambda outcome: outcome.session)
    ]
    types = {name: rows.schema.field(name).type for name in ["key", *kept]}
    schema = pa.schema(
        [
            ("session", pa.string()),
            *types.items(),
            ("outlying", pa.list_(pa.string())),
            ("speed_deviation", pa.float64()),
            ("bytes", pa.int64()),
            ("seconds", pa.float64()),
        ]
    )
    return pa.Table.from_pylist(lines, schema=schema)


def parameters_of(rows: pa.Table, outcomes: list[Outcome]) -> pa.Table:
    """The long table: session, key, parameter, value, standard uncertainty u, unit; SI."""
    of_key = {row["key"]: row for row in rows.select(["key", *_LISTS]).to_pylist()}
    columns: dict[str, list[Any]] = {name: [] for name in ("session", "key", "parameter", "value", "u", "unit")}
    for outcome in sorted(outcomes, key=lambda outcome: outcome.session):
        row = of_key[outcome.key]
        names = row["parameters"] or []
        columns["session"] += [outcome.session] * len(names)
        columns["key"] += [outcome.key] * len(names)
        columns["parameter"] += names
        columns["value"] += row["values"] or []
        columns["u"] += row["standard_uncertainties"] or []
        columns["unit"] += row["units"] or []
    types = [pa.string()] * 3 + [pa.float64()] * 2 + [pa.string()]
    return pa.table({name: pa.array(values, kind) for (name, values), kind in zip(columns.items(), types)})


def keys_of(table: bytes) -> set[str]:
    """The keys in a table of a part."""
    return set(pq.read_table(pa.BufferReader(table), columns=["key"])["key"].to_pylist())


def counts_of(sessions: pa.Table) -> dict[str, int]:
    """How many sessions there are, and how many of them are acceptable, not acceptable or failed."""
    status, acceptable = sessions["status"].to_pylist(), sessions["acceptable"].to_pylist()
    done = [accepted for state, accepted in zip(status, acceptable) if state == "done"]
    failed = len(status) - len(done)
    return {"sessions": len(status), "acceptable": sum(done), "not_acceptable": len(done) - sum(done), "failed": failed}


_LISTS = ["parameters", "values", "standard_uncertainties", "units"]


def _shown(result: Path | None) -> dict[str, Any]:
    """Plateaus that stand out, and the largest relative deviation of a measured from a set speed: a row has neither."""
    if result is None:
        return {"outlying": [], "speed_deviation": None}
    document = json.loads(result.read_bytes())
    outlying = (document.get("validity") or {}).get("outlying") or []
    spinning = [p for p in document["plateaus"] if p.get("measured_speed") and p["speed"]]
    deviations = [abs(abs(p["measured_speed"] / p["speed"]) - 1.0) for p in spinning]
    return {
        "outlying": [f"{plateau['mounting']}:{plateau['index'] + 1}" for plateau in outlying],
        "speed_deviation": max(deviations, default=None),
    }


def parquet(table: pa.Table) -> bytes:
    """The bytes of a table: the same table gives the same bytes."""
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, row_group_size=ROW_GROUP, compression="zstd")
    return bytes(sink.getvalue())

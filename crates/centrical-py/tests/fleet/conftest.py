"""A fleet of small sessions, and what its store holds."""

import shutil
import sys
from pathlib import Path

import pytest

for package in ("distributed", "obstore", "pyarrow"):
    pytest.importorskip(package)

import centrical as ct
import pyarrow as pa
import pyarrow.parquet as pq

HERE = Path(__file__).parent

#: The process that calibrates, but for sessions that end it.
CHILD = (str(HERE / "child_that_dies.py"),)


@pytest.fixture(scope="session")
def averaged(root, tmp_path_factory):
    folder = tmp_path_factory.mktemp("averaged")
    ct.reduce(root / "examples" / "ta-200", folder / "reduced")
    return folder / "reduced"


def make_fleet(averaged, plant, count):
    """Sessions of units of their own in a folder."""
    text = (averaged / "experiment.toml").read_text()
    assert 'serial = "0001"' in text
    for number in range(count):
        folder = plant / f"s{number:03}"
        folder.mkdir(parents=True)
        (folder / "experiment.toml").write_text(text.replace('serial = "0001"', f'serial = "{number:04}"'))
        shutil.copy(averaged / "plateaus.csv", folder)
    return plant


@pytest.fixture
def fleet_of(averaged, tmp_path):
    """Makes a folder of sessions."""
    return lambda count: make_fleet(averaged, tmp_path / "plant", count)


def rows(store):
    """The rows of a store, every key once, by key; and how many rows there are."""
    tables = [pq.read_table(file) for file in sorted((Path(store) / "rows").glob("*.parquet"))]
    table = pa.concat_tables(tables)
    keys = table["key"].to_pylist()
    first = {key: index for index, key in reversed(list(enumerate(keys)))}
    return table.take([first[key] for key in sorted(first)]).combine_chunks(), len(keys)


def of_session(out, session):
    """The row of the table of sessions."""
    tables = [pq.read_table(file) for file in sorted((Path(out) / "sessions").glob("*.parquet"))]
    found = [row for table in tables for row in table.to_pylist() if row["session"] == session]
    assert len(found) == 1, (session, len(found))
    return found[0]


def command(*arguments):
    """The command as a process would be started."""
    return [sys.executable, "-m", "centrical.fleet.command", *map(str, arguments)]

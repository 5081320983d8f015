"""Sessions of other laboratories, from files and from arrays: the bytes of the command."""

import json
import os
from pathlib import Path

import centrical as ct
import numpy as np
import pytest

shared = os.environ.get("CENTRICAL_SHARED")
pytestmark = pytest.mark.skipif(not shared, reason="needs the shared data: set CENTRICAL_SHARED")


def session(name):
    return Path(shared, "data", name)


@pytest.mark.parametrize("name", ["clean-csv", "printed-relation", "rough-parquet"])
def test_files(program, name):
    assert ct.calibrate(session(name)).to_json() == program("calibrate", session(name))


def test_arrays(program):
    folder = session("clean-csv")

    def columns(kind):
        files = sorted((folder / kind).glob("*.csv"))
        return [np.loadtxt(file, delimiter=",", skiprows=1) for file in files]

    records = [(rows[:, 0], rows[:, 1:]) for rows in columns("records")]
    telemetry = [(rows[:, 0], rows[:, 1]) for rows in columns("telemetry")]
    of_arrays = json.loads(ct.Session.from_arrays(folder, records, telemetry=telemetry).calibrate().to_json())
    of_files = json.loads(program("calibrate", folder))
    # Memory has no files to be known by.
    assert of_arrays.pop("inputs") == [] and of_files.pop("inputs")
    assert of_arrays == of_files

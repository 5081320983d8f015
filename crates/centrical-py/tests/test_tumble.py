"""Calibration by gravity alone: the numbers and files of the command."""

from __future__ import annotations

import centrical as ct
import pytest

RECORD = "examples/tumble/record.csv"


def test_tumble(program, tmp_path):
    given = ct.tumble(RECORD, gravity="9.81523 m/s^2", out=tmp_path / "python")
    said = program("tumble", RECORD, "--gravity", "9.81523 m/s^2", "--out", tmp_path / "command")
    assert given.to_json() == said
    for name in ("result.json", "rests.csv", "experiment.toml", "report.html"):
        assert (tmp_path / "command" / name).read_bytes() == (tmp_path / "python" / name).read_bytes()
    assert given.acceptable and abs(given["df_1"].value - 0.12) < 4 * given["df_1"].u
    # The folder is a session.
    again = ct.calibrate(tmp_path / "python")
    assert (again.values == given.values).all()


def test_what_is_no_record_of_rests():
    with pytest.raises(ct.InputError, match="found 1 stretch|found 0 stretches|expected"):
        ct.tumble("examples/tumble/truth.json")
    with pytest.raises(ValueError, match="found .* expected"):
        ct.tumble(RECORD, rate=-1.0)
    with pytest.raises((TypeError, ValueError)):
        ct.tumble(RECORD, readings=["f1", "f2"])

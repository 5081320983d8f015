"""Calibration by gravity alone: the numbers and files of the command."""

from __future__ import annotations

import json
import pathlib
import re

import centrical as ct
import numpy
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


def test_records_in_memory():
    file = ct.tumble(RECORD, gravity=9.81523).document
    rows = numpy.loadtxt(RECORD, delimiter=",", skiprows=1)
    columns = dict(zip(("t", "f1", "f2", "f3"), rows.T))
    turned = {"time": 4, "readings": (2, 1, 3)}
    for records, named in ((rows, {}), (columns, {}), ([columns], {}), (rows[:, [2, 1, 3, 0]], turned)):
        assert ct.tumble(records, gravity=9.81523, **named).document.parameters == file.parameters
    attitudes = numpy.loadtxt("examples/tumble/attitudes.csv", delimiter=",", skiprows=1)
    by_file = ct.tumble(RECORD, attitudes="examples/tumble/attitudes.csv", attitude_uncertainty=1e-3)
    by_array = ct.tumble(columns, attitudes=attitudes, attitude_uncertainty=1e-3)
    assert by_array["df_1"].value == pytest.approx(by_file["df_1"].value, rel=1e-9)
    for wrong, said in (
        ({"records": rows[:, :3]}, "records[1]: found an array of shape"),
        ({"records": columns, "readings": ("f1", "f2", "f4")}, "records[1]: found no column 'f4'"),
        ({"records": RECORD, "readings": ("f1", "f2")}, "readings: found 2 columns, expected three"),
        ({"records": RECORD, "attitudes": [0, 0, 1], "attitude_uncertainty": 1e-3}, "attitudes: found shape (3,), expected (n, 3)"),
    ):
        with pytest.raises(ValueError, match=re.escape(said)):
            ct.tumble(**wrong)


def test_known_attitudes(program, tmp_path):
    table = "examples/tumble/attitudes.csv"
    stated = {"gravity": "9.81523 m/s^2", "attitude_uncertainty": "1 mrad"}
    given = ct.tumble(RECORD, attitudes=table, out=tmp_path / "python", **stated)
    options = ["--gravity", "9.81523 m/s^2", "--attitudes", table, "--attitude-uncertainty", "1 mrad"]
    said = program("tumble", RECORD, *options, "--out", tmp_path / "command")
    assert given.to_json() == said
    for name in ("result.json", "attitudes.csv", "experiment.toml", "report.html"):
        assert (tmp_path / "command" / name).read_bytes() == (tmp_path / "python" / name).read_bytes()
    truth = json.loads(pathlib.Path("examples/tumble/truth.json").read_text())["case_turn"]
    for axis, turn in enumerate(truth, start=1):
        found = given[f"case_turn_{axis}"]
        assert abs(found.value - turn) < 4 * found.u
    # The same directions as numbers, of any length.
    rows = pathlib.Path(table).read_text().splitlines()
    directions = [[2.0 * float(cell) for cell in row.split(",")] for row in rows[1:]]
    by_rows = ct.tumble(RECORD, attitudes=directions, **stated)
    assert numpy.allclose(by_rows.values, given.values, rtol=1e-9, atol=1e-12, equal_nan=True)
    assert all((ct.calibrate(tmp_path / "python").values == given.values).tolist())


def test_attitudes_without_their_uncertainty():
    with pytest.raises(ValueError, match="found None beside attitudes"):
        ct.tumble(RECORD, attitudes="cube")
    with pytest.raises(ValueError, match="found one without attitudes"):
        ct.tumble(RECORD, attitude_uncertainty="0.1 deg")
    with pytest.raises(ValueError, match="attitude"):
        ct.tumble(RECORD, attitudes=[[0.0, 0.0, 0.0]], attitude_uncertainty="0.1 deg")


def test_slow_rotation(program, tmp_path):
    # A way through all attitudes at 2.8 deg/s and less, sampled at 20 Hz.
    random = numpy.random.default_rng(3)
    part = numpy.arange(12_000) / 12_000
    passage = (4 * part) % 2
    pole, round_ = numpy.pi * numpy.minimum(passage, 2 - passage), 8 * numpy.pi * part
    up = numpy.stack([numpy.sin(pole) * numpy.cos(round_), numpy.sin(pole) * numpy.sin(round_), numpy.cos(pole)], axis=1)
    readings = 9.81523 * up + [0.1, -0.2, 0.05] + 1e-3 * random.normal(size=up.shape)
    record = tmp_path / "turned.csv"
    numpy.savetxt(record, numpy.c_[600 * part, readings], "%.6f", ",", header="t,f1,f2,f3", comments="")
    given = ct.tumble(record, gravity="9.81523 m/s^2", turning_radius=0.01)
    said = program("tumble", record, "--gravity", "9.81523 m/s^2", "--turning-radius", "10 mm")
    assert given.to_json() == said
    assert json.loads(said)["turning"]["arcs"] > 50 and abs(given["df_2"].value + 0.2) < 4 * given["df_2"].u
    with pytest.raises(ct.InputError, match="turning-radius"):
        ct.tumble(record, gravity="9.81523 m/s^2")
    with pytest.raises(ValueError, match="expected a distance"):
        ct.tumble(record, turning_radius=-1.0)


def test_what_is_no_record_of_rests():
    with pytest.raises(ct.InputError, match="found 1 stretch|found 0 stretches|expected"):
        ct.tumble("examples/tumble/truth.json")
    with pytest.raises(ValueError, match="found .* expected"):
        ct.tumble(RECORD, rate=-1.0)
    with pytest.raises((TypeError, ValueError)):
        ct.tumble(RECORD, readings=["f1", "f2"])
    for unit in ("furlong", "mV", ""):
        with pytest.raises(ValueError, match="unit: found .* expected a unit of acceleration"):
            ct.tumble(RECORD, unit=unit)


def test_the_model_of_the_unit_is_stated(tmp_path):
    named = {"model": "TA-200", "serial": "0001", "date": "2026-11-23"}
    session = ct.tumble(RECORD, gravity="9.81523 m/s^2", **named).document.session
    assert (session.unit_model, session.unit_serial, session.date) == ("TA-200", "0001", "2026-11-23")


def test_a_draft_takes_a_tumble(program, tmp_path):
    ct.tumble(RECORD, gravity="9.81523 m/s^2", out=tmp_path / "tumbled")
    draft = ct.init("examples/ta-200/records", tumble=tmp_path / "tumbled")
    assert draft.to_json() == program("init", "examples/ta-200/records", "--tumble", tmp_path / "tumbled")
    assert "[[tumble]]" in draft.text and 'gravity = "9.81523 m/s^2"' in draft.text

"""A session from arrays is the session from files."""

import json
import pickle

import centrical as ct
import numpy as np
import pytest


def columns(file):
    return np.loadtxt(file, delimiter=",", skiprows=1)


@pytest.fixture(scope="module")
def arrays(example):
    """Records and telemetry of the example, by mounting."""
    records, telemetry = {}, {}
    for m in range(1, 13):
        record = columns(example / "records" / f"m{m:02}.csv")
        records[m] = (record[:, 0], record[:, 1:])
        trace = columns(example / "telemetry" / f"m{m:02}.csv")
        telemetry[m] = (trace[:, 0], trace[:, 1])
    return records, telemetry


def without_inputs(result):
    document = json.loads(result.to_json())
    del document["inputs"]
    return document


def test_the_bytes_of_the_result(example, arrays, result):
    records, telemetry = arrays
    session = ct.Session.from_arrays(example, records, telemetry=telemetry)
    ours = session.calibrate()
    assert ours.document.inputs == []
    assert without_inputs(ours) == without_inputs(result)
    # Neither the order of the mountings nor that of the memory matters.
    shuffled = {m: (t, np.asfortranarray(f)) for m, (t, f) in reversed(records.items())}
    again = pickle.loads(pickle.dumps(ct.Session.from_arrays(example, shuffled, telemetry=telemetry)))
    assert again.calibrate().to_json() == ours.to_json()
    in_order = ct.Session.from_arrays((example / "experiment.toml").read_text(), list(records.values()))
    assert in_order.calibrate().acceptable


def test_plateaus(example, tmp_path, result):
    ct.Session(example).reduce(tmp_path / "reduced")
    table = np.genfromtxt(tmp_path / "reduced" / "plateaus.csv", delimiter=",", names=True)
    plateaus = {name: table[name] for name in table.dtype.names}
    ours = ct.Session.from_arrays(example, plateaus=plateaus).calibrate()
    reduced = without_inputs(ct.Session(tmp_path / "reduced").calibrate())
    # The reduced session states what its records showed beside the means.
    assert {"drift", "tilt"} <= reduced.keys()
    assert without_inputs(ours) == {key: value for key, value in reduced.items() if key not in ("drift", "tilt")}
    np.testing.assert_allclose(ours.values, result.values, rtol=1e-9)
    held_out = ct.Session.from_arrays(example, plateaus=plateaus).calibrate(hold_out=["4:3"])
    assert sum(plateau.get("held_out", False) for plateau in held_out.document.plateaus) == 1


def test_arrays_are_not_copied_before_the_calibration(example, arrays, result):
    records, telemetry = arrays
    session = ct.Session.from_arrays(example, records, telemetry=telemetry)
    for m, (t, columns, *_) in enumerate(session._records, start=1):
        assert np.shares_memory(t, records[m][0])
        assert all(np.shares_memory(column, records[m][1]) for column in columns)
    backwards = {m: (t[::-1].copy()[::-1], f[::-1].copy()[::-1]) for m, (t, f) in records.items()}
    unaligned = {m: (t, unaligned_copy(f)) for m, (t, f) in records.items()}
    for others in (backwards, unaligned):
        again = ct.Session.from_arrays(example, others, telemetry=telemetry).calibrate()
        assert without_inputs(again) == without_inputs(result)


def unaligned_copy(array):
    copy = np.frombuffer(bytearray(array.nbytes + 1), np.uint8)[1:].view(array.dtype).reshape(array.shape)
    copy[...] = array
    assert not copy.flags.aligned
    return copy


def test_what_is_masked_is_missing(example, arrays):
    records, telemetry = arrays
    example = (example / "experiment.toml").read_text().replace("[columns]\n", '[columns]\nmissing_readings = "left out"\n')
    t, f = records[2]
    holes = np.zeros(f.shape, bool)
    holes[500:520, 1] = True
    by_mask = dict(records) | {2: (t, np.ma.masked_array(f, holes))}
    by_nan = dict(records) | {2: (t, np.where(holes, np.nan, f))}
    results = [ct.Session.from_arrays(example, given, telemetry=telemetry).calibrate() for given in (by_mask, by_nan)]
    assert results[0].to_json() == results[1].to_json()
    gaps = np.arange(len(t)) % 7 == 3
    by_mask, by_nan = (ct.noise(given, rate=100.0) for given in (np.ma.masked_array(f[:, 0], gaps), np.where(gaps, np.nan, f[:, 0])))
    assert by_mask.to_json() == by_nan.to_json()


def refused(kind, message, *arguments, **options):
    with pytest.raises(kind, match=message):
        ct.Session.from_arrays(*arguments, **options).calibrate()


def test_misuse(example, arrays, tmp_path):
    records, _ = arrays
    t, f = records[1]
    refused(TypeError, "both or neither", example)
    refused(TypeError, "both or neither", example, records, plateaus={})
    refused(ct.InputError, "found 2 records in memory, expected 12", example, [(t, f), (t, f)])
    refused(ValueError, "no record of mounting 2", example, {1: (t, f), 3: (t, f)})
    refused(ValueError, "the key 0", example, {0: (t, f)})
    refused(TypeError, r"records\[1\]: found ndarray, expected a pair", example, {1: t})
    refused(ValueError, r"readings of shape \(4, 2\), expected \(n, 3\)", example, {1: (t[:4], f[:4, :2])})
    refused(ValueError, r"found shape \(1, 4\), expected \(n,\)", example, {1: (t[None, :4], f[:4])})
    refused(TypeError, r"records\[1\]: found datetime64\[ns\], expected numbers", example, {1: (t[:4].astype("datetime64[ns]"), f[:4])})
    refused(TypeError, r"records\[1\]: found <U1, expected numbers", example, {1: (t[:4], np.full((4, 3), "1"))})
    refused(TypeError, r"records\[1\]: found objects", example, {1: (t[:4], np.full((4, 3), "x", object))})
    few = dict(records) | {3: (t[:-1], f)}
    refused(ct.InputError, "mounting 3: columns of different lengths", example, few)
    message = r"telemetry\[1\]: columns of different lengths: 4 times, 3 speeds"
    refused(ValueError, message, example, records, telemetry={1: (t[:4], t[:3])})
    empty = dict(records) | {5: (np.empty(0), np.empty((0, 3)))}
    refused(ct.InputError, "mounting 5: record too short", example, empty)
    nan = dict(records) | {2: (np.where(np.arange(len(t)) == 700, np.nan, t), f)}
    refused(ct.InputError, "mounting 2: sample 701: found time NaN", example, nan)
    missing = dict(records) | {2: (t, np.where(np.arange(len(t))[:, None] == 700, np.nan, f))}
    refused(ct.InputError, "found no reading f1 in sample 701, expected a number in m/s.2, or missing_readings", example, missing)
    infinite = f.copy()
    infinite[9, 1] = np.inf
    refused(ValueError, r"records\[1\], row 10: found inf, expected a number", example, {1: (t, infinite)})
    refused(ValueError, "telemetry: found mounting 13, which has no record", example, records, telemetry={13: (t, t)})
    refused(ValueError, r"telemetry\[1\], row 1: found nan", example, records, telemetry={1: (t[:3], np.full(3, np.nan))})
    refused(ValueError, "plateaus: found no column 'speed'", example, plateaus={"mounting": [1.0]})
    refused(ct.NoSuchFileError, "no such file", tmp_path / "no.toml", records)
    (tmp_path / "experiment.toml").write_bytes(b"\xff\xfe")
    refused(ct.InputError, "expected text in UTF-8", tmp_path, records)
    refused(ct.InputError, "experiment, line 1", "[site\n", records)

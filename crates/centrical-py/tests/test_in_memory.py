"""Files in memory: bytes and open files in place of paths."""

import gzip
import io
import json
import pickle

import centrical as ct
import numpy as np
import pytest


@pytest.fixture(scope="module")
def text(example):
    return (example / "experiment.toml").read_text()


@pytest.fixture(scope="module")
def files(example):
    """All files of the example, by the names that its experiment has for them."""
    names = [f"{kind}/m{m:02}.csv" for kind in ("records", "telemetry") for m in range(1, 13)]
    return {name: (example / name).read_bytes() for name in names}


def without(document, *keys):
    return {key: value for key, value in document.items() if key not in keys}


def test_a_session_in_memory_has_the_bytes_of_that_on_disk(example, text, files, result, tmp_path):
    session = ct.Session.parse(text, "nowhere", files)
    assert session.calibrate().to_json() == result.to_json()
    # Some in memory, the others in a folder; as bytes, as what stands for bytes, and open.
    names = list(files)
    some = {names[0]: io.BytesIO(files[names[0]]), names[1]: bytearray(files[names[1]]), names[2]: memoryview(files[names[2]])}
    assert ct.Session.parse(text, example, some).calibrate().to_json() == result.to_json()
    assert pickle.loads(pickle.dumps(session)).calibrate().to_json() == result.to_json()


def test_every_method_of_a_session_in_memory(example, text, files, tmp_path):
    memory, disk = ct.Session.parse(text, "nowhere", files), ct.Session(example)
    assert memory.assess().to_json() == disk.assess().to_json()
    assert memory.models().to_json() == disk.models().to_json()
    assert memory.montecarlo(runs=20).to_json() == disk.montecarlo(runs=20).to_json()
    assert without(memory.observe(), "file") == without(disk.observe(), "file")
    assert without(memory.noise("1:1"), "file") == without(disk.noise("1:1"), "file")
    for session, name in ((memory, "memory"), (disk, "disk")):
        session.reduce(tmp_path / name)
    assert (tmp_path / "memory/experiment.toml").read_text() == (tmp_path / "disk/experiment.toml").read_text()
    assert (tmp_path / "memory/plateaus.csv").read_bytes() == (tmp_path / "disk/plateaus.csv").read_bytes()
    assert ct.calibrate(memory).to_json() == ct.calibrate(disk).to_json()
    with pytest.raises(ValueError, match="found one in memory, expected one in a folder"):
        memory.watch(tmp_path / "watched")
    assert repr(memory) == "Session.parse(..., 'nowhere')"


def test_records_in_memory(example, files, result):
    records = {m: files[f"records/m{m:02}.csv"] for m in range(1, 13)}
    # Of any format, which shows itself.
    records[3] = gzip.compress(records[3])
    records[4] = open(example / "records/m04.csv", "rb")  # noqa: SIM115
    records[5] = open(example / "records/m05.csv", encoding="utf-8")  # noqa: SIM115
    telemetry = {m: files[f"telemetry/m{m:02}.csv"] for m in range(1, 13)}
    session = ct.Session.from_arrays(example, records, telemetry=telemetry)
    ours = session.calibrate()
    assert without(json.loads(ours.to_json()), "inputs") == without(json.loads(result.to_json()), "inputs")
    inputs = {entry["path"]: entry["sha256"] for entry in json.loads(ours.to_json())["inputs"]}
    of_disk = {entry["path"]: entry["sha256"] for entry in json.loads(result.to_json())["inputs"]}
    assert inputs["records[1]"] == of_disk["records/m01.csv"]
    assert inputs["experiment.toml"] == of_disk["experiment.toml"]
    assert session.assess()["schema"] == "centrical-assessment/1"


def test_noise_of_bytes(example, files):
    name = "records/m01.csv"
    ours, theirs = ct.noise(files[name]), ct.noise(example / name)
    assert (ours.file, without(ours, "file")) == ("record", without(theirs, "file"))
    assert without(ct.noise(io.BytesIO(files[name])), "file") == without(theirs, "file")
    array = np.loadtxt(example / name, delimiter=",", skiprows=1)[:, 1:]
    saved = io.BytesIO()
    np.save(saved, array)
    of_saved = ct.noise(saved.getvalue(), rate=100.0, readings=[1, 2, 3])
    assert without(of_saved, "file") == without(ct.noise(array, rate=100.0), "file")


def test_tumble_of_bytes(root):
    file = root / "examples/tumble/record.csv"
    ours, theirs = ct.tumble(file.read_bytes(), gravity=9.81523), ct.tumble(file, gravity=9.81523)
    np.testing.assert_array_equal(ours.values, theirs.values)
    inputs = [json.loads(result.to_json())["inputs"][0] for result in (ours, theirs)]
    assert inputs[0] == {"path": "records[1]", "sha256": inputs[1]["sha256"]}


def test_misuse(example, text, files):
    records = [files[f"records/m{m:02}.csv"] for m in range(1, 13)]
    t, f = np.arange(4.0), np.zeros((4, 3))
    with pytest.raises(ct.InputError, match="found 2 records in memory, expected 12, one for each mounting"):
        ct.Session.from_arrays(example, records[:2]).calibrate()
    with pytest.raises(TypeError, match=r"records\[2\]: found tuple, expected a file, as others"):
        ct.Session.from_arrays(example, [records[0], (t, f)])
    with pytest.raises(ValueError, match="no record of mounting 2"):
        ct.Session.from_arrays(example, {1: records[0], 3: records[2]})
    with pytest.raises(ct.InputError, match=r"records\[7\]: found an empty file, expected a record"):
        ct.Session.from_arrays(example, records[:6] + [b""] + records[7:]).calibrate()
    cut = records[6][: len(records[6]) // 2].rsplit(b",", 1)[0]
    with pytest.raises(ct.InputError, match=r"records\[7\], line \d+"):
        ct.Session.from_arrays(example, records[:6] + [cut] + records[7:]).calibrate()
    with pytest.raises(TypeError, match=r"files\['a'\]: found int, expected bytes"):
        ct.Session.parse(text, "nowhere", {"a": 1})
    with pytest.raises(ct.NoSuchFileError, match=r"nowhere.records.m01.csv: found no such file, expected a record"):
        ct.Session.parse(text, "nowhere").calibrate()
    with pytest.raises(ct.InputError, match=r"nowhere.experiment.toml, line 1"):
        ct.Session.parse("[site\n", "nowhere").calibrate()
    with pytest.raises(ct.InputError, match="record: found an empty file"):
        ct.noise(b"")
    with pytest.raises(TypeError):
        ct.calibrate(7)

"""Wrong files: the exception, its fields, and nothing worse than an exception."""

import json
import pickle
import shutil

import centrical as ct
import pytest


def test_a_file_that_is_not_there_is_both(tmp_path):
    for call in (
        lambda: ct.Session(tmp_path / "nothing"),
        lambda: ct.calibrate(tmp_path / "nothing"),
        lambda: ct.read_result(tmp_path / "nothing.json"),
        lambda: ct.plan(tmp_path / "nothing.toml"),
    ):
        with pytest.raises(FileNotFoundError) as as_file:
            call()
        with pytest.raises(ct.InputError) as as_input:
            call()
        error = as_input.value
        assert isinstance(error, ValueError) and isinstance(error, OSError) and isinstance(error, ct.NoSuchFileError)
        assert error.errno == 2 and "nothing" in error.filename and error.filename == error.file
        assert "no such file" in str(as_file.value) and error.expected


def test_fields_of_an_error(example, tmp_path):
    session = tmp_path / "session"
    shutil.copytree(example, session)
    record = session / "records" / "m02.csv"
    lines = record.read_text().splitlines()
    lines[40] = lines[40].replace(lines[40].split(",")[2], "NaN(ind)")
    record.write_text("\n".join(lines))
    with pytest.raises(ct.InputError) as caught:
        ct.calibrate(session)
    error = caught.value
    assert error.file == str(record) and error.place.startswith("line 41")
    assert "NaN(ind)" in error.found and "number" in error.expected
    for part in (error.file, error.place, error.found, error.expected):
        assert part in str(error)
    assert not isinstance(error, OSError)


def test_a_key_that_is_wrong(example, tmp_path):
    session = tmp_path / "session"
    shutil.copytree(example, session)
    file = session / "experiment.toml"
    file.write_text(file.read_text().replace("gravity = ", "gravity = '1 kg' # "))
    with pytest.raises(ct.InputError) as caught:
        ct.calibrate(session)
    assert caught.value.place == "[site], gravity" and caught.value.file == str(file)
    file.write_text("[session\n")
    with pytest.raises(ct.InputError) as caught:
        ct.observe(session)
    assert "line 1" in caught.value.place


def test_a_folder_that_takes_nothing(example, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ct.InputError):
        ct.reduce(example, tmp_path / "file" / "out")


def test_damaged_results(result, tmp_path):
    text = result.to_json().encode()
    for wrong in (b"", b"{}", b"\xff\xfe", text[: len(text) // 2], text.replace(b"centrical-result/1", b"centrical-result/9")):
        with pytest.raises(ct.InputError):
            result.native.from_json(wrong)
        (tmp_path / "result.json").write_bytes(wrong)
        with pytest.raises(ct.InputError):
            ct.read_result(tmp_path / "result.json")
    # What a file is not allowed to contradict, a text is not either.
    document = json.loads(text)
    document["parameters"][0]["standard_uncertainty"] *= 2.0
    with pytest.raises(ct.InputError, match="the square of its standard uncertainty"):
        result.native.from_json(json.dumps(document).encode())


def test_errors_are_pickled(tmp_path):
    with pytest.raises(ct.InputError) as caught:
        ct.calibrate(tmp_path / "nothing")
    again = pickle.loads(pickle.dumps(caught.value))
    assert type(again) is ct.NoSuchFileError and again.errno == 2
    assert (again.file, again.found, again.expected, str(again)) == (
        caught.value.file,
        caught.value.found,
        caught.value.expected,
        str(caught.value),
    )


def test_a_document_says_what_it_has(result):
    with pytest.raises(AttributeError, match="found no 'nothing', expected one of schema"):
        result.document.nothing
    with pytest.raises(KeyError):
        result.document["nothing"]
    assert "rank" in dir(result.document.observability) and "fit" in dir(result.document)
    assert "centrical-result/1" in repr(result.document) and "<table>" in result.document._repr_html_()


def test_wrong_types_are_type_errors(example):
    for call in (
        lambda: ct.calibrate(3),
        lambda: ct.montecarlo(example, runs="many"),
        lambda: ct.montecarlo(example, runs=1.5),
        lambda: ct.compare([1, 2]),
        lambda: ct.noise(example, readings=[None]),
    ):
        with pytest.raises(TypeError):
            call()
    with pytest.raises(ValueError, match="runs: found -1, expected 2 to"):
        ct.montecarlo(example, runs=-1)

"""A fleet on one machine: the same rows as a series, exactly once, whatever becomes of a session or a driver."""

import json
import multiprocessing
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import centrical as ct
import numpy as np
import obstore
import pytest

from .conftest import CHILD, command, of_session, rows

fleet = pytest.importorskip("centrical.fleet")
from centrical.fleet.parts import parts_of  # noqa: E402
from centrical.fleet.places import File, Place, Session  # noqa: E402
from centrical.fleet.walk import walk  # noqa: E402

#: Parts of a few sessions.
FEW = fleet.Settings(part=0.3)


@pytest.fixture(autouse=True)
def children_find_the_package(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", ":".join(path for path in sys.path if path))


def test_rows_are_those_of_a_series(fleet_of, tmp_path, monkeypatch):
    plant = fleet_of(12)
    (plant / "s011" / "experiment.toml").write_text("broken\n")
    (plant / "s010" / "plateaus.csv").write_text("nonsense\n1,2\n")
    done = fleet.calibrate(plant, tmp_path / "out", settings=FEW)
    assert (done.sessions, done.acceptable, done.failed, done.missing) == (12, 10, 2, ())
    assert done.made == done.parts > 2
    assert done.exit_code == 2
    monkeypatch.chdir(plant)
    ct.series(sorted(path.name for path in plant.iterdir()), tmp_path / "series")
    ours, count = rows(tmp_path / "out")
    theirs, _ = rows(tmp_path / "series")
    assert count == 12
    assert ours.equals(theirs)
    assert of_session(tmp_path / "out", "s011")["status"] == "failed"
    bad = of_session(tmp_path / "out", "s010")
    assert (bad["status"], bad["file"]) == ("failed", "s010/plateaus.csv")
    assert bad["found"] and bad["expected"]
    # The result is a store.
    assert len(ct.history(tmp_path / "out", "list").calibrations) == 12
    again = fleet.calibrate(plant, tmp_path / "out", settings=FEW)
    assert (again.made, again.sessions) == (0, 12)
    said = str(fleet.summary(tmp_path / "out"))
    assert said.startswith("12 sessions: 10 acceptable, 0 not acceptable, 2 failed")


def test_a_reduced_session_is_kept_by_its_key(fleet_of, tmp_path):
    fleet.calibrate(fleet_of(1), tmp_path / "out", settings=FEW)
    key = of_session(tmp_path / "out", "s000")["key"]
    again = ct.calibrate(tmp_path / "out" / "reduced" / key)
    first = ct.read_result(tmp_path / "out" / "results" / f"{key}.json")
    assert (again.values == first.values).all()


def test_only_what_changed_is_made_again(fleet_of, tmp_path):
    plant, out = fleet_of(12), tmp_path / "out"
    first = fleet.calibrate(plant, out, settings=FEW)
    text = (plant / "s004" / "experiment.toml").read_text()
    (plant / "s004" / "experiment.toml").write_text(text.replace('serial = "0004"', 'serial = "changed"'))
    shutil.rmtree(plant / "s009")
    second = fleet.calibrate(plant, out, settings=FEW)
    assert 0 < second.made < first.parts
    found, count = rows(out)
    serials = found["unit_serial"].to_pylist()
    assert count == second.sessions == 11
    assert "changed" in serials and "0004" not in serials and "0009" not in serials
    # Nothing that no row names comes back with `history add NEW STORE/results/*.json`.
    keys = set(found["key"].to_pylist())
    assert {file.stem for file in (out / "results").iterdir()} == keys
    assert {folder.name for folder in (out / "reduced").iterdir()} == keys


def test_a_result_stays_as_long_as_a_row_names_it(fleet_of, tmp_path):
    plant, out = fleet_of(2), tmp_path / "out"
    fleet.calibrate(plant, out)
    key = of_session(out, "s001")["key"]
    kept = tmp_path / "kept.json"
    shutil.copy(out / "results" / f"{key}.json", kept)
    ct.add_to_store(tmp_path / "other", kept)
    for file in (tmp_path / "other" / "rows").iterdir():
        shutil.copy(file, out / "rows")
    shutil.rmtree(plant / "s001")
    fleet.calibrate(plant, out)
    assert {file.stem for file in (out / "results").iterdir()} == {key, of_session(out, "s000")["key"]}


def test_cuts_stay_where_they_are_when_a_session_comes():
    def session(number, stamp="1"):
        return Session(f"s{number:04}", (File("experiment.toml", 1000, stamp),))

    sessions = [session(number) for number in range(400)]
    settings = fleet.Settings(part=1.0)
    before = {part.name for part in parts_of(sessions, settings)}
    assert len(before) > 20
    more = parts_of(sorted([*sessions, Session("s0200x", sessions[0].files)], key=lambda s: s.name), settings)
    assert len({part.name for part in more} - before) <= 2
    changed = [session(number, "2" if number == 77 else "1") for number in range(400)]
    assert len({part.name for part in parts_of(changed, settings)} - before) == 1
    assert sum(len(part.sessions) for part in more) == 401


@pytest.mark.parametrize(
    "wrong", [{"seconds": -1.0}, {"seconds": float("inf")}, {"part": 0.0}, {"memory": -1}, {"memory": 1 << 64}, {"method": "best"}]
)
def test_settings_are_checked(wrong):
    with pytest.raises(ValueError, match=f"{next(iter(wrong))}: found .*, expected "):
        fleet.Settings(**wrong)


def test_memory_in_which_no_process_starts_is_named(fleet_of, tmp_path):
    fleet.calibrate(fleet_of(1), tmp_path / "out", settings=fleet.Settings(memory=1 << 26))
    found = of_session(tmp_path / "out", "s000")["found"]
    assert found == "crashed: ended with exit code 1 in 0.0625 GiB of memory, twice"


@pytest.mark.parametrize(
    ("name", "limits", "found"),
    [
        ("aborts", {}, "crashed: ended by SIGABRT, twice"),
        ("eats", {}, "crashed: ended by SIGABRT, twice"),
        ("sleeps", {"seconds": 5.0}, "crashed: took longer than 5 s, twice"),
    ],
)
def test_a_session_that_ends_its_process_is_a_row(fleet_of, tmp_path, name, limits, found):
    plant = fleet_of(3)
    (plant / "s001").rename(plant / f"s001-{name}")
    done = fleet.calibrate(plant, tmp_path / "out", settings=fleet.Settings(child=CHILD, **limits))
    assert (done.acceptable, done.failed) == (2, 1)
    row = of_session(tmp_path / "out", f"s001-{name}")
    assert (row["status"], row["found"], row["expected"]) == ("failed", found, "a calibration")
    assert row["message"].startswith(f"s001-{name}: found crashed")
    # The fault is mended: the part is made again on request alone.
    assert fleet.calibrate(plant, tmp_path / "out").failed == 1
    mended = fleet.calibrate(plant, tmp_path / "out", again=True)
    assert (mended.made, mended.acceptable, mended.failed) == (1, 3, 0)
    assert rows(tmp_path / "out")[1] == 3


def test_an_output_among_the_sessions_is_no_session(fleet_of):
    plant = fleet_of(2)
    for _ in range(2):
        assert fleet.calibrate(plant, plant / "results").sessions == 2
    with pytest.raises(ValueError, match="found the place of the sessions, expected another one"):
        fleet.calibrate(plant, plant)


def test_a_link_in_a_circle_and_an_odd_name_are_left_out_alone(fleet_of, tmp_path):
    plant, other = fleet_of(2), tmp_path / "other"
    (plant / "s001").rename(other)
    # Links are followed, those to nothing left out without a word.
    (plant / "linked").symlink_to(other)
    (plant / "dangling").symlink_to("nowhere")
    (plant / "s000" / "up").symlink_to("..")
    (plant / "itself").symlink_to("itself")
    (plant / "root").symlink_to(plant.root)
    shutil.copytree(other, plant / "new\nline")
    if sys.platform == "linux":
        os.mkdir(os.fsencode(plant) + b"/caf\xe9")
    call = command("calibrate", plant, "--out", tmp_path / "out", "--json")
    done = subprocess.run(call, capture_output=True, text=True)
    said = json.loads(done.stdout)
    assert (done.returncode, said["sessions"], said["acceptable"]) == (0, 2, 2)
    assert len(list((tmp_path / "out" / "results").iterdir())) == 2
    for path in ("s000/up", "itself", "root"):
        assert f"centrical-fleet: {plant}/{path}: found a link that leads in a circle" in done.stderr
    assert f"centrical-fleet: {plant}/new\\nline: found a name with a control character" in done.stderr
    assert len(said["left_out"]) == len(done.stderr.splitlines()) == (5 if sys.platform == "linux" else 4)


def test_files_of_a_folder_are_those_that_obstore_lists(fleet_of):
    plant = Place.of(fleet_of(3))
    listed = [(item["path"], item["size"], item["e_tag"]) for batch in obstore.list(plant.open()) for item in batch]
    # Otherwise all parts would be made again.
    assert sorted(walk(plant.folder, [])) == sorted(listed)


def test_interrupted_within_seconds_and_nothing_is_called_crashed(fleet_of, tmp_path):
    plant, out = fleet_of(200), tmp_path / "out"
    call = command("calibrate", plant, "--out", out, "--part", "1", "--json")
    # A group of its own: a terminal's Ctrl-C reaches every process of it.
    driver = subprocess.Popen(call, stderr=subprocess.PIPE, text=True, start_new_session=True)
    # The first part is there and most are not, on a fast machine and on a slow one.
    while driver.poll() is None and not list((out / "rows").glob("*.parquet")):
        time.sleep(0.01)
    os.killpg(driver.pid, signal.SIGINT)
    made = len(list((out / "rows").glob("*.parquet")))
    # A loaded machine takes some seconds to end two processes and an interpreter.
    said = driver.communicate(timeout=20)[1]
    # What was at work is not finished first.
    assert len(list((out / "rows").glob("*.parquet"))) <= made + 2
    assert (driver.returncode, said) == (130, "centrical-fleet: interrupted; the same command goes on\n")
    again = json.loads(subprocess.run(call, capture_output=True, text=True, check=True).stdout)
    assert (again["sessions"], again["acceptable"], again["failed"]) == (200, 200, 0)


def test_any_executor(fleet_of, tmp_path):
    plant = fleet_of(3)
    with ThreadPoolExecutor(2) as executor:
        done = fleet.calibrate(plant, tmp_path / "out", executor, settings=FEW)
    assert done.acceptable == 3


def test_processes_of_an_executor_are_spawned(fleet_of, tmp_path):
    plant = fleet_of(3)
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as executor:
        done = fleet.calibrate(plant, tmp_path / "out", executor, settings=FEW)
    assert done.acceptable == 3


@pytest.mark.skipif(not hasattr(os, "fork"), reason="a system without fork")
def test_forked_processes_of_an_executor_are_refused_and_nothing_waits(fleet_of, tmp_path):
    text = """
import multiprocessing, sys
from concurrent.futures import ProcessPoolExecutor
from centrical import fleet

fleet.calibrate(sys.argv[1], sys.argv[2] + "/threads")
with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("fork")) as executor:
    try:
        fleet.calibrate(sys.argv[1], sys.argv[2] + "/processes", executor)
    except RuntimeError as error:
        print(error)
"""
    call = [sys.executable, "-W", "ignore::DeprecationWarning", "-c", text, str(fleet_of(1)), str(tmp_path)]
    done = subprocess.run(call, capture_output=True, text=True, timeout=60)
    assert 'use mp_context=multiprocessing.get_context("spawn")' in done.stdout, done.stderr
    assert not list((tmp_path / "processes").rglob("*.parquet"))


def test_another_program_ends_the_run_before_the_first_task(fleet_of, tmp_path, monkeypatch):
    plant = fleet_of(2)
    monkeypatch.setattr("centrical.fleet.run.expected", lambda: {"version": "9.9", "build": "0" * 64, "machine": "?"})
    with pytest.raises(fleet.EnvironmentMismatch, match=r"found centrical 0\.1\.0, build \w{12}, expected 9\.9"):
        fleet.calibrate(plant, tmp_path / "out")
    assert not list((tmp_path / "out").rglob("*.parquet"))


def test_a_killed_driver_loses_nothing_and_two_make_nothing_twice(fleet_of, tmp_path):
    plant, out = fleet_of(16), tmp_path / "out"
    chance = random.Random(3)
    call = command("calibrate", plant, "--out", out, "--part", "0.3", "--json")
    for _ in range(4):
        driver = subprocess.Popen(call, stdout=subprocess.DEVNULL)
        time.sleep(chance.uniform(0.3, 1.5))
        driver.kill()
        driver.wait()
    pair = [subprocess.Popen(call, stdout=subprocess.PIPE) for _ in range(2)]
    said = [json.loads(driver.communicate(timeout=120)[0]) for driver in pair]
    assert [(done["sessions"], done["acceptable"], done["missing"]) for done in said] == [(16, 16, [])] * 2
    found, count = rows(out)
    assert (count, len(set(found["unit_serial"].to_pylist()))) == (16, 16)
    fleet.calibrate(plant, tmp_path / "alone", settings=FEW)
    assert found.equals(rows(tmp_path / "alone")[0])


def test_planted_units_are_named(averaged, tmp_path):
    """Fifty units on four days: the scale of one is off by 1 %, the bias of another drifts by 0.2 mg a year."""
    chance = np.random.default_rng(50)
    text = (averaged / "experiment.toml").read_text()
    day = re.search(r"date = (\S+)", text)[1]
    header, *lines = (averaged / "plateaus.csv").read_text().splitlines()
    table = np.array([[float(cell or "nan") for cell in line.split(",")] for line in lines])
    at = {name: column for column, name in enumerate(header.split(","))}
    means, spinning = [at[f"mean_{i}"] for i in (1, 2, 3)], table[:, at["speed"]] != 0
    covariances = np.array([[table[:, at[f"cov_{min(i, j)}{max(i, j)}"]] for j in (1, 2, 3)] for i in (1, 2, 3)])
    whole = {at["mounting"], at["samples"]}
    factors = np.linalg.cholesky(np.moveaxis(covariances, 2, 0))
    for unit in range(50):
        bias, scale = 5e-3 * chance.normal(size=3), 1 + 1e-4 * chance.normal(size=3)
        if unit == 17:
            scale[0] *= 1.01
        for year in range(4):
            drift = np.array([0.0, 2e-3 * year if unit == 33 else 0.0, 0.0])
            speed = 1 + 2e-5 * chance.normal(size=(len(table), 1)) * spinning[:, None]
            noise = np.einsum("nij,nj->ni", factors, chance.normal(size=(len(table), 3)))
            drawn = table.copy()
            drawn[:, means] = table[:, means] * speed * scale + bias + drift + noise
            folder = tmp_path / "plant" / f"{unit:04}" / str(year)
            folder.mkdir(parents=True)
            cells = [[str(int(cell)) if n in whole else repr(float(cell)) for n, cell in enumerate(row)] for row in drawn]
            text_of_rows = [",".join(row).replace("nan", "") for row in cells]
            (folder / "plateaus.csv").write_text("\n".join([header, *text_of_rows]) + "\n")
            dated = text.replace('serial = "0001"', f'serial = "{unit:04}"').replace(day, f"{2022 + year}-{day[5:]}")
            (folder / "experiment.toml").write_text(dated)
    done = fleet.calibrate(tmp_path / "plant", tmp_path / "out")
    assert (done.sessions, done.failed) == (200, 0)
    said = fleet.summary(tmp_path / "out")
    found = said.units["TA-200"]
    assert [unit.unit_serial for unit in found.outlying] == ["0017"]
    assert [(f.kind, f.unit_serial, f.parameter) for f in found.findings] == [("drifts", "0033", "df_2")]
    for text in (str(said), said.to_html()):
        assert re.search(r"OUTLYING  TA-200, serial 0017: farthest, in standard deviations: G0_11 [+-]\d+\.\d, ", text)
        assert "DRIFTS  TA-200, serial 0033: df_2" in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["calibrate", "nowhere", "--out", "out"], "nowhere: found no such folder, expected sessions"),
        (["calibrate", ".", "--out", "out"], ".: found no experiment.toml in it or below, expected sessions"),
        (["summary", "."], ".: found no part, expected the result of centrical-fleet calibrate"),
        (["calibrate", ".", "--out", "out", "--seconds", "0"], "--seconds: found '0', expected a number above 0, at most 1e+06"),
        (["calibrate", ".", "--out", "out", "--seconds", "nan"], "--seconds: found 'nan', expected a number above 0"),
        (["calibrate", ".", "--out", "out", "--part", "-3"], "--part: found '-3', expected a number above 0"),
        (["calibrate", ".", "--out", "out", "--memory", "0"], "--memory: found '0', expected a number above 0"),
        (["calibrate", ".", "--out", "out", "--memory", "4G"], "--memory: found '4G', expected a number above 0"),
        (["calibrate", ".", "--out", "out", "--option", "endpoint"], "--option: found 'endpoint', expected NAME=VALUE"),
    ],
)
def test_wrong_requests(tmp_path, arguments, message):
    done = subprocess.run(command(*arguments), capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr
    assert "Traceback" not in done.stderr

"""A fleet on a real cluster on loopback: SeaweedFS, a Dask scheduler, two workers. Every wait has an end."""

import json
import os
import random
import subprocess
import sys
import threading
import time
from pathlib import Path

import obstore
import pytest

from .cluster import Cluster
from .conftest import CHILD, command, make_fleet, of_session, rows

if not (os.environ.get("CENTRICAL_FLEET_CLUSTER") and (Path(sys.executable).parent / "weed").exists()):
    pytest.skip("needs SeaweedFS, and a minute: set CENTRICAL_FLEET_CLUSTER", allow_module_level=True)

fleet = pytest.importorskip("centrical.fleet")

COUNT = 60
FEW = fleet.Settings(part=0.5)


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    made = Cluster(tmp_path_factory.mktemp("cluster"))
    try:
        yield made.start()
    finally:
        made.end()


@pytest.fixture(autouse=True)
def children_find_the_package(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", ":".join(path for path in sys.path if path))


@pytest.fixture(scope="module")
def uploaded(cluster, averaged, tmp_path_factory):
    """Sixty sessions in the bucket, and the rows of the run on this machine alone."""
    folder = tmp_path_factory.mktemp("plant")
    make_fleet(averaged, folder / "plant", COUNT)
    cluster.upload(folder / "plant", "plant")
    alone = fleet.calibrate(folder / "plant", folder / "alone", settings=FEW)
    assert alone.acceptable == COUNT
    return rows(folder / "alone")[0]


@pytest.fixture
def plant(uploaded, tmp_path):
    """The sessions, an output of its own, and the rows."""
    return "s3://fleet/plant", f"s3://fleet/{tmp_path.name}/out", uploaded


def call(cluster, source, out, *more):
    return command("calibrate", source, "--out", out, "--engine", cluster.engine, "--part", "0.5", "--json", *cluster.arguments(), *more)


def run(cluster, source, out, *more, seconds=120):
    done = subprocess.run(call(cluster, source, out, *more), capture_output=True, text=True, timeout=seconds)
    return done, json.loads(done.stdout) if done.stdout else None


def stored(cluster, out, folder):
    return rows(cluster.download(out.removeprefix("s3://fleet/"), folder))


def test_the_table_is_that_of_one_machine_and_is_made_once(cluster, plant, tmp_path):
    source, out, alone = plant
    done, said = run(cluster, source, out)
    assert done.returncode == 0, done.stderr
    assert (said["sessions"], said["acceptable"], said["made"]) == (COUNT, COUNT, said["parts"])
    found, count = stored(cluster, out, tmp_path / "found")
    assert count == COUNT
    assert found.equals(alone)
    done, said = run(cluster, source, out)
    assert (done.returncode, said["made"], said["sessions"]) == (0, 0, COUNT)
    # The reduced session and the result lie beside.
    key = found["key"][0].as_py()
    assert (tmp_path / "found/reduced" / key / "plateaus.csv").exists()
    assert (tmp_path / "found/results" / f"{key}.json").exists()


@pytest.mark.parametrize("victim", ["worker", "scheduler", "driver", "store"])
def test_killed_and_called_again(cluster, plant, tmp_path, victim):
    source, out, alone = plant
    chance = random.Random(victim)
    driver = subprocess.Popen(call(cluster, source, out), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    # A start of the driver takes a second; the sixty sessions some seconds.
    time.sleep(chance.uniform(1.0, 4.0))
    if victim == "worker":
        cluster.workers[0].kill()
        cluster.workers[0].start()
    elif victim == "scheduler":
        cluster.scheduler.kill()
        cluster.scheduler.start()
        # Workers end with their scheduler; a laboratory's own deployer starts them again.
        for worker in cluster.workers:
            worker.kill()
            worker.start()
    elif victim == "driver":
        driver.kill()
    else:
        cluster.store.kill()
        time.sleep(10)
        cluster.store.start()
    try:
        driver.wait(timeout=90)
    except subprocess.TimeoutExpired:
        driver.kill()
        pytest.fail("the driver did not end")
    cluster.wait_for_workers()
    made = len(list_of(cluster, out, "parts"))
    done, said = run(cluster, source, out)
    assert done.returncode == 0, done.stderr
    # Tasks that were running when the driver was killed may end after they were counted.
    assert said["made"] <= said["parts"] - made
    found, count = stored(cluster, out, tmp_path / "found")
    assert count == COUNT
    assert found.equals(alone)


def list_of(cluster, out, folder):
    store = cluster.open(out.removeprefix("s3://fleet/"))
    return [item["path"] for batch in obstore.list(store, f"{folder}/") for item in batch]


def test_two_drivers_at_once(cluster, plant, tmp_path):
    source, out, alone = plant
    pair = [subprocess.Popen(call(cluster, source, out), stdout=subprocess.PIPE) for _ in range(2)]
    said = [json.loads(driver.communicate(timeout=120)[0]) for driver in pair]
    assert [(done["sessions"], done["missing"]) for done in said] == [(COUNT, [])] * 2
    found, count = stored(cluster, out, tmp_path / "found")
    assert count == COUNT
    assert found.equals(alone)


def test_what_is_wrong_with_a_session_ends_as_a_row(cluster, fleet_of, tmp_path):
    folder = fleet_of(8)
    (folder / "s001" / "plateaus.csv").write_text("nonsense\n1,2\n")
    (folder / "s002").rename(folder / "s002-aborts")
    (folder / "s003").rename(folder / "s003-eats")
    # Fifty times the size: a comment in front of the table.
    text = (folder / "s004" / "plateaus.csv").read_text()
    (folder / "s004" / "plateaus.csv").write_text("# filler\n" * (50 * len(text) // 9) + text)
    prefix = tmp_path.name
    cluster.upload(folder, f"{prefix}/plant")
    source, out = f"s3://fleet/{prefix}/plant", f"s3://fleet/{prefix}/out"
    listing = fleet.run.list_sessions

    def one_vanishes(place):
        listed = listing(place)
        obstore.delete(cluster.open(f"{prefix}/plant"), "s005/plateaus.csv")
        return listed

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fleet.run, "list_sessions", one_vanishes)
        settings = fleet.Settings(part=0.5, child=CHILD)
        done = fleet.calibrate(source, out, cluster.engine, settings=settings, options=cluster.options)
    assert (done.sessions, done.acceptable, done.failed, done.missing) == (8, 4, 4, ())
    cluster.download(f"{prefix}/out", tmp_path / "found")
    found = {name: of_session(tmp_path / "found", name) for name in ("s001", "s002-aborts", "s003-eats", "s004", "s005")}
    assert found["s001"]["file"] == "s001/plateaus.csv"
    assert found["s002-aborts"]["found"] == found["s003-eats"]["found"] == "crashed: ended by SIGABRT, twice"
    assert found["s004"]["status"] == "done"
    assert (found["s005"]["file"], found["s005"]["found"]) == ("s005/plateaus.csv", "no such file")


def test_a_changed_session_is_made_again(cluster, averaged, tmp_path):
    make_fleet(averaged, tmp_path / "plant", COUNT)
    cluster.upload(tmp_path / "plant", f"{tmp_path.name}/plant")
    source, out = f"s3://fleet/{tmp_path.name}/plant", f"s3://fleet/{tmp_path.name}/out"
    assert run(cluster, source, out)[0].returncode == 0
    store = cluster.open(source.removeprefix("s3://fleet/"))
    text = bytes(obstore.get(store, "s030/experiment.toml").bytes()).replace(b'serial = "0030"', b'serial = "changed"')
    obstore.put(store, "s030/experiment.toml", text)
    done, said = run(cluster, source, out)
    assert (done.returncode, said["made"]) == (0, 1)
    found, count = stored(cluster, out, tmp_path / "found")
    assert count == COUNT
    assert "changed" in found["unit_serial"].to_pylist()
    assert "0030" not in found["unit_serial"].to_pylist()
    # Results that no row names any more went with their part.
    keys = set(found["key"].to_pylist())
    assert {path.split("/")[1].removesuffix(".json") for path in list_of(cluster, out, "results")} == keys
    assert {path.split("/")[1] for path in list_of(cluster, out, "reduced")} == keys


def test_a_wrong_credential_and_no_scheduler_end_at_once(cluster, plant):
    source, out, _ = plant
    done, said = run(cluster, source, out, "--option=secret_access_key=expired", seconds=60)
    assert (done.returncode, said) == (2, None)
    assert "403" in done.stderr
    assert "Traceback" not in done.stderr
    nobody = command("calibrate", source, "--out", out, "--engine", "tcp://127.0.0.1:1", *cluster.arguments())
    done = subprocess.run(nobody, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert "found no scheduler that answers" in done.stderr


def test_a_worker_with_another_program_ends_the_run_before_the_first_task(cluster, plant, monkeypatch):
    source, out, _ = plant
    monkeypatch.setattr("centrical.fleet.run.expected", lambda: {"version": "9.9", "build": "0" * 64, "machine": "?"})
    with pytest.raises(fleet.EnvironmentMismatch, match="2 of 2 workers cannot work"):
        fleet.calibrate(source, out, cluster.engine, settings=FEW, options=cluster.options)
    assert not list_of(cluster, out, "parts")

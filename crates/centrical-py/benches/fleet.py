"""Figures of a fleet on this machine: sessions per second, what an engine adds, memory, and large listings.

Usage: fleet.py SESSIONS... (folders of sessions; reduced ones show what is added to the arithmetic)
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import distributed
from centrical import fleet
from centrical.fleet.parts import parts_of
from centrical.fleet.places import File, Place, Session, list_sessions
from centrical.fleet.run import _run_key
from centrical.fleet.settings import expected
from centrical.fleet.work import Task

SETTINGS = fleet.Settings(part=2.0)


def timed(work):
    begun = time.perf_counter()
    outcome = work()
    return time.perf_counter() - begun, outcome


def memory(process):
    """Largest resident set of a process [MB]."""
    lines = Path(f"/proc/{process}/status").read_text().splitlines()
    return next(int(line.split()[1]) // 1024 for line in lines if line.startswith("VmHWM"))


def empty(task):
    return len(task.part.sessions)


def main():
    folder = Path(tempfile.mkdtemp())
    plant = folder / "plant"
    for source in map(Path, sys.argv[1:]):
        shutil.copytree(source, plant / source.name)
    count = len(sys.argv) - 1
    print(f"{count} sessions, {sum(f.stat().st_size for f in plant.rglob('*') if f.is_file()) / 1e6:.1f} MB")

    program = os.environ.get("CENTRICAL_PROGRAM", "centrical")
    names = sorted(path.name for path in plant.iterdir())
    one = f"{program} calibrate {{}} --json -q > {folder}/{{}}.json"
    listed = "\n".join(names).encode()
    seconds, _ = timed(lambda: subprocess.run(["xargs", "-P2", "-I{}", "sh", "-c", one], input=listed, cwd=plant, check=True))
    print(f"xargs -P2 calibrate --json: {seconds:.1f} s, {count / seconds:.1f} sessions/s")
    seconds, _ = timed(lambda: subprocess.run([program, "series", *names, "--out", folder / "series", "-q"], cwd=plant))
    print(f"series: {seconds:.1f} s, {count / seconds:.1f} sessions/s")
    seconds, done = timed(lambda: fleet.calibrate(plant, folder / "local", settings=SETTINGS))
    print(f"fleet, two processes: {seconds:.1f} s, {count / seconds:.1f} sessions/s, {done.parts} parts")
    for workers in (1, 2):
        begun = time.perf_counter()
        with distributed.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster:
            up = time.perf_counter() - begun
            out = folder / f"dask-{workers}"
            seconds, _ = timed(lambda: fleet.calibrate(plant, out, cluster.scheduler_address, settings=SETTINGS))
            print(f"fleet, Dask with {workers}: {seconds:.1f} s, {count / seconds:.1f} sessions/s; cluster up in {up:.1f} s")
            if workers == 2:
                pids = [worker["pid"] for worker in distributed.Client(cluster).run(lambda: {"pid": os.getpid()}).values()]
                print(f"memory: driver and scheduler {memory(os.getpid())} MB, workers {[memory(pid) for pid in pids]} MB")
                overheads(cluster)
    listing(folder)
    shutil.rmtree(folder)


def overheads(cluster):
    """Of empty tasks, and of as many as a fleet of millions has."""
    for count in (1_000, 100_000):
        sessions = [Session(f"s{n:07}", (File("experiment.toml", 5 * 10**9, "1"),)) for n in range(count)]
        parts = parts_of(sessions, fleet.Settings())
        here = Place("/nowhere")
        tasks = [Task(part, here, here, SETTINGS, expected()) for part in parts]
        with distributed.Client(cluster) as client:
            names = [_run_key(task) for task in tasks]
            begun = time.perf_counter()
            futures = client.map(empty, tasks, key=names, pure=False)
            handed = time.perf_counter() - begun
            distributed.wait(futures)
            seconds = time.perf_counter() - begun
            print(
                f"{len(tasks)} empty tasks: {seconds:.1f} s, {1e3 * seconds / len(tasks):.2f} ms each, handed over in {handed:.1f} s; "
                f"driver and scheduler {memory(os.getpid())} MB"
            )


def listing(folder):
    """Ten thousand sessions that hold nothing: listed, cut, and made rows."""
    plant = folder / "empty"
    for number in range(10_000):
        session = plant / f"s{number:05}"
        session.mkdir(parents=True)
        (session / "experiment.toml").write_text("")
    seconds, (sessions, _) = timed(lambda: list_sessions(Place.of(plant)))
    print(f"{len(sessions)} sessions listed in {seconds:.2f} s")
    seconds, parts = timed(lambda: parts_of(sessions, fleet.Settings()))
    print(f"cut into {len(parts)} parts in {seconds:.2f} s")
    seconds, done = timed(lambda: fleet.calibrate(plant, folder / "rows"))
    print(f"{done.failed} failed rows in {seconds:.1f} s, {1e3 * seconds / len(sessions):.2f} ms each")


if __name__ == "__main__":
    main()

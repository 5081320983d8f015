#!/usr/bin/env python3
"""Whole `centrical reduce` of a session against the plain mean per column of the same files by polars and DuckDB.

    cargo build --release
    python3 -m venv venv && venv/bin/pip install polars duckdb
    venv/bin/python benches/records/compare.py                 # a session of 1 GB, made once in the folder for temporary files

Every program runs with two threads on the same files in turn, several times; the best of each is shown: wall-clock time of
the work (without starting an interpreter), processor time and peak memory of the process. On a machine that is busy with
other things the processor time is the one to compare.
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent

POLARS = """
import sys, time, polars
files = sys.argv[1:]
scan = polars.scan_csv if files[0].endswith(".csv") else polars.scan_parquet
start = time.perf_counter()
for file in files:
    scan(file).mean().collect(engine="streaming")
print("seconds", time.perf_counter() - start)
"""

DUCKDB = """
import sys, time, duckdb
files = sys.argv[1:]
table = "read_csv" if files[0].endswith(".csv") else "read_parquet"
duckdb.execute("set threads = 2")
start = time.perf_counter()
for file in files:
    duckdb.execute(f"select avg(t), avg(f1), avg(f2), avg(f3) from {table}('{file}')").fetchall()
print("seconds", time.perf_counter() - start)
"""


def measured(command):
    """Wall-clock and processor seconds and peak memory [MB] of a command with two threads."""
    environment = dict(os.environ, RAYON_NUM_THREADS="2", POLARS_MAX_THREADS="2")
    start = time.perf_counter()
    process = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    wall = time.perf_counter() - start
    if status != 0:
        sys.exit(f"failed: {' '.join(map(str, command[:3]))}")
    own = re.search(r"^seconds (\S+)$", output, re.MULTILINE)
    return float(own.group(1)) if own else wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1000


def session(folder, program, form, seconds):
    """A simulated session of 12 mountings, 9 plateaus each, at 1 kHz."""
    out = folder / form
    if not (out / "experiment.toml").exists():
        truth = folder / "truth.toml"
        truth.write_text((HERE / "truth.toml").read_text().replace("PLATEAU", str(seconds)))
        plan = ROOT / "examples/ta-200"
        command = [program, "simulate", plan, "--truth", truth, "--seed", "1", "--format", form, "--out", out]
        subprocess.run(command, check=True)
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, default=Path(tempfile.gettempdir()) / "centrical-records", help="for the sessions")
    parser.add_argument("--program", type=Path, default=ROOT / "target/release/centrical")
    parser.add_argument("--seconds", type=float, default=255, help="length of a plateau: 255 makes 1 GB of CSV")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--forms", nargs="+", choices=["csv", "parquet"], default=["csv", "parquet"])
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    print("form      program     wall s   processor s   memory MB   GB/s")
    for form in arguments.forms:
        folder = session(arguments.folder, arguments.program, form, arguments.seconds)
        files = sorted(map(str, (folder / "records").iterdir()))
        size = sum(os.path.getsize(file) for file in files) / 1e9
        reduce = [arguments.program, "reduce", folder, "--out", arguments.folder / "reduced"]
        programs = {
            "centrical": reduce,
            "polars": [sys.executable, "-c", POLARS, *files],
            "duckdb": [sys.executable, "-c", DUCKDB, *files],
        }
        best = {}
        for _ in range(arguments.runs):
            for name, command in programs.items():
                run = measured(command)
                best[name] = tuple(map(min, best[name][:2], run[:2])) + (max(best[name][2], run[2]),) if name in best else run
        for name, (wall, processor, memory) in best.items():
            print(f"{form:8}  {name:10}  {wall:6.2f}   {processor:11.2f}   {memory:9.0f}   {size / wall:.2f}")


if __name__ == "__main__":
    main()

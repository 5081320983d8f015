#!/usr/bin/env python3
"""Calibration by gravity, beside what people use, on the same made records with a known truth.

    cargo build --release
    pip install numpy scipy imucal
    python3 scripts/against_peers.py target/release/centrical [--runs 100] [--xsens FILE]

The records have the unit of `examples/tumble/make.py`, at 100 Hz, each after 30 s of rest, which imu_tk takes its threshold
from: turned by hand into 24 attitudes of 3 to 6 s; on six faces of a cube, 10 s each, laid down to 1 mrad; and four of which
the attitudes do not suffice.

- imu_tk is the method of Tedaldi, Pretto and Menegatti (2014), written here anew in NumPy and SciPy with the defaults of the
  authors' program: windows of 101 samples; thresholds of 2 to 10 times the variance of the first 3000; the first 100 samples of
  each rest; 12 rests at least; the threshold whose cost is least. The program itself is in C++ and faster.
- imucal is the package of that name (Ferraris et al. 1995). It takes six faces, whose samples somebody has to mark: here they are
  the true ones. Its gyroscope is given readings that end its work.

All three estimate `reading = bias + M f`. A matrix in other axes than ours is turned into them: `M M^T` is the same in all, and our `M` is
its lower triangular factor. With `--xsens` the record of that name is calibrated by imu_tk and by the program.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np
from scipy.linalg import cholesky
from scipy.optimize import least_squares

sys.path.insert(0, str(Path(__file__).parent.parent / "examples" / "tumble"))
import make

make.RATE = 100.0
TRUTH = np.eye(3) + make.G0
LOWER = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)]
NAMES = ["df_1", "df_2", "df_3"] + [f"G0_{i + 1}{j + 1}" for i, j in LOWER]
IS_SCALE = np.array([i == j for i, j in LOWER])
UG, PPM = 1e6 / 9.80665, 1e6


class NoResult(Exception):
    """What a program says in place of a result."""


# The programs.


def imu_tk(readings, gravity, start=None, window=101, initial=3000, samples=100, fewest=12):
    """Bias, `M` and number of rests by the method of Tedaldi et al. (2014). `start` is a scale and bias to begin with, for counts."""
    half = window // 2
    sums = np.cumsum(np.vstack([np.zeros(3), readings - readings.mean(axis=0)]), axis=0)
    squares = np.cumsum(np.vstack([np.zeros(3), (readings - readings.mean(axis=0)) ** 2]), axis=0)
    mean = (sums[window:] - sums[:-window]) / window
    variance = np.linalg.norm((squares[window:] - squares[:-window]) / window - mean**2, axis=1)
    unit = np.linalg.norm(readings[:initial].var(axis=0))
    scale, bias = (np.ones(3), np.zeros(3)) if start is None else (1.0 / start[0], start[1])

    def force(x, of):
        a, b, c = x[:3]
        return (of - x[6:]) * (x[3:6] * scale) @ np.array([[1, -a, b], [0, 1, -c], [0, 0, 1]]).T

    best = None
    for factor in range(2, 11):
        still = np.concatenate([[False], variance < factor * unit, [False]])
        edges = np.flatnonzero(np.diff(still.astype(int))).reshape(-1, 2) + half
        rests = [readings[a : a + samples] for a, b in edges if b - a >= samples]
        if len(rests) < fewest:
            continue
        taken = np.concatenate(rests)
        fit = least_squares(
            lambda x: gravity - np.linalg.norm(force(x, taken), axis=1),
            np.concatenate([np.zeros(3), np.ones(3), bias]),
            method="lm",
            x_scale="jac",
        )
        if best is None or fit.cost < best[0].cost:
            best = fit, len(rests)
    if best is None:
        raise NoResult("Can't obtain any calibration with the current dataset")
    x, rests = best[0].x, best[1]
    a, b, c = x[:3]
    matrix = np.array([[1, -a, b], [0, 1, -c], [0, 0, 1]]) * (x[3:6] * scale)
    return x[6:], np.linalg.inv(matrix), rests


def imucal(readings, gravity, faces):
    """Bias and `M` by the package imucal; `faces` are the samples of x up, x down, y up, ..."""
    from imucal import FerrarisCalibration, FerrarisSignalRegions

    names = ["x_p", "x_a", "y_p", "y_a", "z_p", "z_a"]
    turns = -360.0 * np.eye(3)[:, None, :]
    regions = {f"acc_{name}": readings[a:b] for name, (a, b) in zip(names, faces)}
    regions |= {f"gyr_{name}": np.zeros((2, 3)) for name in names}
    regions |= {f"acc_{axis}_rot": np.zeros((1, 3)) for axis in "xyz"}
    regions |= {f"gyr_{axis}_rot": turn for axis, turn in zip("xyz", turns)}
    regions = FerrarisSignalRegions(**regions)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = FerrarisCalibration(grav=gravity).compute(regions, 1.0, "m/s^2", "deg/s")
    return found.b_a, found.K_a @ found.R_a


def centrical(program, record, gravity, *arguments):
    """The result of `centrical tumble`, and what it says."""
    command = [program, "tumble", record, "--gravity", repr(gravity), *arguments]
    run = subprocess.run([*command, "--json"], capture_output=True, text=True, check=False)
    if run.returncode == 2:
        raise NoResult(run.stderr.strip().splitlines()[0].replace(str(record), "RECORD"))
    return json.loads(run.stdout), run.returncode


def own(result):
    """Estimates of the nine quantities, `None` where there is no number, and the covariance of those that have one."""
    place = {p["name"]: n for n, p in enumerate(result["parameters"])}
    values = [result["parameters"][place[name]]["value"] for name in NAMES]
    taken = [place[name] for name, value in zip(NAMES, values) if value is not None]
    return values, np.array([[result["covariance"][a][b] for b in taken] for a in taken], dtype=float)


def errors(bias, matrix):
    """Errors of bias and matrix against the truth, the matrix turned into our axes."""
    lower = cholesky(matrix @ matrix.T, lower=True)
    difference = lower - TRUTH
    return np.concatenate([bias - make.DF, [difference[at] for at in LOWER]])


# The records.


def record(random, directions, lasting):
    """Readings, and from and to of the rests; 30 s of rest in the first of the attitudes come before."""
    way, rests = make.turned(random, directions, lasting)
    first = np.repeat(way[:1], 3000, axis=0)
    readings = make.readings_of(random, make.GRAVITY * np.concatenate([first, way]))
    return readings, [(a + 3000, b + 3000) for a, b in rests]


def written(readings, folder):
    """The record as a file. The rests of a table do not begin with the long one: it is part of the first."""
    file = Path(folder) / "record.csv"
    t = np.arange(len(readings)) / make.RATE
    np.savetxt(file, np.column_stack([t, readings]), "%.2f,%.4f,%.4f,%.4f", header="t,f1,f2,f3", comments="")
    return file


def by_hand(random, count=24):
    directions = random.normal(size=(count, 3))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)


def faces(random, error=1e-3):
    """x up, x down, y up, ..., each laid down with an error about either horizontal axis."""
    up = np.repeat(np.eye(3), 2, axis=0) * np.tile([1.0, -1.0], 3)[:, None]
    up = up + error * np.cross(random.normal(size=up.shape), up)
    return up / np.linalg.norm(up, axis=1, keepdims=True)


def upper_half(random):
    up = by_hand(random)
    up[:, 2] = np.abs(up[:, 2])
    return up


# The table.


class Errors:
    """Errors of one program over many records."""

    def __init__(self):
        self.rows, self.seconds, self.squared, self.objections, self.rests = [], 0.0, [], 0, []

    def line(self, name):
        rows = np.array(self.rows, dtype=float)
        rms = np.sqrt(np.mean(rows**2, axis=0))
        bias, matrix = rms[:3], rms[3:]
        size = lambda values, unit: f"{unit * np.sqrt(np.mean(values**2)):.0f}" if np.isfinite(values).all() else "no number"
        stated = f"{np.mean(self.squared):.2f}" if self.squared else "none"
        return [
            name,
            f"{np.mean(self.rests):.1f}",
            size(bias, UG),
            size(matrix[IS_SCALE], PPM),
            size(matrix[~IS_SCALE], PPM),
            stated,
            f"{1e3 * self.seconds / len(rows):.0f}",
        ]


def compared(program, runs, kind):
    """Errors of the programs that can take the records of this kind."""
    table = {}

    def timed(name, run):
        entry = table.setdefault(name, Errors())
        start = time.perf_counter()
        found = run()
        entry.seconds += time.perf_counter() - start
        return entry, found

    for seed in range(runs):
        random = np.random.default_rng([seed, len(kind)])
        is_cube = kind == "six faces"
        directions = faces(random) if is_cube else by_hand(random)
        readings, rests = record(random, directions, (10.0, 10.0) if is_cube else (3.0, 6.0))
        if is_cube:
            entry, (bias, matrix) = timed("imucal", lambda: imucal(readings, make.GRAVITY, rests))
            entry.rests.append(len(rests))
        else:
            entry, (bias, matrix, count) = timed("imu_tk", lambda: imu_tk(readings, make.GRAVITY))
            entry.rests.append(count)
        entry.rows.append(errors(bias, matrix))
        with tempfile.TemporaryDirectory() as folder:
            file = written(readings, folder)
            ways = {"centrical tumble": []}
            if is_cube:
                ways["centrical tumble --attitudes cube"] = ["--attitudes", "cube", "--attitude-uncertainty", "1 mrad"]
            for name, arguments in ways.items():
                entry, (result, code) = timed(name, lambda: centrical(program, file, make.GRAVITY, *arguments))
                values, covariance = own(result)
                truth = np.concatenate([make.DF, [TRUTH[at] - float(at[0] == at[1]) for at in LOWER]])
                error = np.array([np.nan if v is None else v - t for v, t in zip(values, truth)])
                entry.rows.append(error)
                entry.rests.append(len(result["plateaus"]))
                known = error[np.isfinite(error)]
                if len(known):
                    entry.squared.append(known @ np.linalg.solve(covariance, known) / len(known))
                entry.objections += code == 1
    return table


def print_table(head, rows):
    rows = [head, *rows]
    widths = [max(len(row[n]) for row in rows) for n in range(len(head))]
    for n, row in enumerate(rows):
        print("| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths)) + " |")
        if n == 0:
            print("|" + "|".join("-" * (width + 2) for width in widths) + "|")


def too_little(program):
    """What each program says where the attitudes do not suffice."""
    random = np.random.default_rng(7)
    cases = {
        "six faces, attitudes unknown": (faces(random), (10.0, 10.0)),
        "8 attitudes by hand": (by_hand(random, 8), (3.0, 6.0)),
        "24 attitudes, axis 3 never down": (upper_half(random), (3.0, 6.0)),
        "24 attitudes about one horizontal axis": (around(random), (3.0, 6.0)),
    }
    rows = []
    for name, (directions, lasting) in cases.items():
        readings, rests = record(random, directions, lasting)
        try:
            bias, matrix, count = imu_tk(readings, make.GRAVITY)
            worst = np.abs(errors(bias, matrix))
            said = f"9 numbers by {count} rests, the worst off by {UG * worst[:3].max():.0f} ug, {PPM * worst[3:].max():.0f} ppm"
        except NoResult as refused:
            said = str(refused)
        rows.append([name, "imu_tk", said])
        with tempfile.TemporaryDirectory() as folder:
            file = written(readings, folder)
            try:
                result, code = centrical(program, file, make.GRAVITY)
                values, _ = own(result)
                numbers = [n for n, v in zip(NAMES, values) if v is None]
                uncertain = {p["name"]: p["standard_uncertainty"] for p in result["parameters"] if p["name"] in NAMES}
                said = f"{9 - len(numbers)} numbers" + (f", none for {', '.join(numbers)}" if numbers else "")
                stated = [u for n, u in uncertain.items() if n.startswith("G0") and u is not None]
                said += f", uncertain by {PPM * max(stated):.0f} ppm at most" if stated else ""
                said += f"; exit {code}"
            except NoResult as refused:
                said = str(refused)
            rows.append([name, "centrical tumble", said])
    print_table(["attitudes", "program", "what it says"], rows)


def around(random):
    """Turned about axis 1 alone, which stays horizontal."""
    angle = random.uniform(0, 2 * np.pi, 24)
    return np.column_stack([np.zeros(24), np.cos(angle), np.sin(angle)])


def xsens(program, file):
    """A real record of counts, with the factory's scale and bias as start of imu_tk."""
    readings = np.loadtxt(file)[:, 1:4]
    gravity, scale, bias = 9.81744, np.array([415.0, 413.0, 415.0]), np.array([33123.0, 33276.0, 32360.0])
    start = time.perf_counter()
    b, matrix, rests = imu_tk(readings, gravity, start=(scale, bias))
    theirs = time.perf_counter() - start
    lower = cholesky(matrix @ matrix.T, lower=True)
    start = time.perf_counter()
    arguments = ["--time", "1", "--readings", "2,3,4", "--unit", "counts"]
    result, _ = centrical(program, file, gravity, *arguments)
    ours = time.perf_counter() - start
    parameters = {p["name"]: p for p in result["parameters"]}
    coarse = result["output"]
    print(f"\n{file}: imu_tk {rests} rests, {theirs:.2f} s; centrical {len(result['plateaus'])} rests, {ours:.2f} s")
    rows = []
    for i in range(3):
        factor = coarse["scale"][i]
        gain, offset = parameters[f"G0_{i + 1}{i + 1}"], parameters[f"df_{i + 1}"]
        rows.append(
            [
                f"{i + 1}",
                f"{lower[i, i]:.3f}",
                f"{factor * (1 + gain['value']):.3f} +- {factor * gain['standard_uncertainty']:.3f}",
                f"{b[i]:.2f}",
                f"{coarse['bias'][i] + factor * offset['value']:.2f} +- {factor * offset['standard_uncertainty']:.2f}",
            ]
        )
    print_table(["axis", "scale, imu_tk", "scale, centrical", "bias, imu_tk", "bias, centrical"], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("centrical")
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--xsens", type=Path, help="xsens_acc.txt of imu_tk")
    arguments = parser.parse_args()
    head = ["program", "rests", "bias, ug", "scale, ppm", "misalignment, urad", "squared error over covariance", "ms"]
    for kind in ("24 attitudes by hand", "six faces"):
        print(f"\n{kind}, {arguments.runs} records, errors RMS:")
        table = compared(arguments.centrical, arguments.runs, kind)
        print_table(head, [entry.line(name) for name, entry in table.items()])
        for name, entry in table.items():
            if name.startswith("centrical"):
                print(f"{name}: objections to {entry.objections} of {arguments.runs}")
    print("\nattitudes that do not suffice:")
    too_little(arguments.centrical)
    if arguments.xsens:
        xsens(arguments.centrical, arguments.xsens)


if __name__ == "__main__":
    main()

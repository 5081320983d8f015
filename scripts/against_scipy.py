#!/usr/bin/env python3
"""Ten thousand full non-linear calibrations, beside SciPy's least_squares on the same problem.

    cargo build --release
    python3 scripts/against_scipy.py target/release/centrical examples/ta-200 [--seconds 30] [--runs 10000] [--processes 2]

The problem is the session's: its plateau means and covariances, 49 unknowns, the exact model. The model is written here
anew in NumPy, all plateaus at once; before anything is timed its residuals at the program's estimate are held against
the program's own, and SciPy's estimate against the program's. Each run then draws the means anew and fits from zero.

Both sides fit three readings a plateau weighed by their covariance with the speed's rank-one term. The program takes that
from the model at each step and draws speeds as well; SciPy is given it fixed, which is less work. Needs NumPy and SciPy.
"""

import argparse
import json
import os
import resource
import subprocess
import time
import tomllib
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

# One thread per process: the processes share the cores.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from scipy.optimize import least_squares

EARTH_RATE = 7.292115e-5


def hat(v):
    """[[0, v3, -v2], [-v3, 0, v1], [v2, -v1, 0]] of vectors (..., 3)."""
    zero = np.zeros(v.shape[:-1])
    v1, v2, v3 = v[..., 0], v[..., 1], v[..., 2]
    rows = [np.stack(row, -1) for row in ((zero, v3, -v2), (-v3, zero, v1), (v2, -v1, zero))]
    return np.stack(rows, -2)


def rotation(v):
    """exp(hat(v))."""
    angle = np.linalg.norm(v, axis=-1)[..., None, None]
    safe = np.where(angle < 1e-12, 1.0, angle)
    first = np.where(angle < 1e-12, 1.0, np.sin(safe) / safe)
    second = np.where(angle < 1e-12, 0.5, (1.0 - np.cos(safe)) / safe**2)
    h = hat(v)
    return np.eye(3) + first * h + second * (h @ h)


class Problem:
    """Readings of all plateaus of a session as a function of the unknowns."""

    def __init__(self, result, experiment):
        model, plateaus = result["model"], result["plateaus"]
        self.names = [p["name"] for p in result["parameters"]]
        index = {name: j for j, name in enumerate(self.names)}
        position_of = [m["position"] for m in result["mountings"]]
        of_plateau = [position_of[p["mounting"] - 1] for p in plateaus]
        positions = {p["id"]: p for p in model["positions"]}
        arms = np.array([m["arm"] for m in result["mountings"]])

        self.p_zy = np.array([positions[k]["matrix"] for k in of_plateau])
        self.arm_y = arms[[p["mounting"] - 1 for p in plateaus]]
        self.turn = np.array([[index[f"delta_{i}[{k}]"] for i in (1, 2, 3)] for k in of_plateau])
        self.shift, self.sign = self.shifts(model["pair_relation"], positions, of_plateau, index)
        self.mass = [index["drho_22"], index["drho_33"]]

        masses = np.array(experiment["unit"]["proof_masses"], dtype=float)
        self.rho = (masses - masses[0]).T
        speed = np.array([p["speed"] for p in plateaus])
        coriolis = 2.0 * EARTH_RATE * np.sin(model["latitude"]) if model["latitude"] is not None else 0.0
        self.rate = speed * (speed + coriolis)
        self.gravity = model["gravity"]

        # Means over four equal steps of a revolution are exact for cubic terms; at rest all four are the known angle.
        steps = np.arange(4) * np.pi / 2
        rest = np.array([np.nan if p["angle"] is None else p["angle"] for p in plateaus])
        angle = np.where(np.isnan(rest)[:, None], steps[None, :], rest[:, None])
        self.cosine, self.sine = np.cos(angle), np.sin(angle)

        self.terms = [(index[t["name"]], t["axis"] - 1, t["powers"]) for t in model["error_model"]]
        self.mean = np.array([p["mean"] for p in plateaus])
        self.factor = np.linalg.cholesky(np.array([p["fit_covariance"] for p in plateaus]))
        self.whitener = np.linalg.inv(self.factor)

    @staticmethod
    def shifts(relation, positions, of_plateau, index):
        """Columns of dR of each plateau, and its sign."""
        first = {}
        for k, position in positions.items():
            first.setdefault(position["pair"], k)
        columns, signs = [], []
        for k in of_plateau:
            pair = positions[k]["pair"]
            name = k if relation == "free" else pair
            columns.append([index[f"dR_1[{name}]"], index[f"dR_2[{name}]"]])
            signs.append(-1.0 if relation == "opposite" and first[pair] != k else 1.0)
        return np.array(columns), np.array(signs)

    def reading(self, x):
        """Mean readings, plateau by axis."""
        tilt = rotation(np.array([x[0], x[1], 0.0])) @ np.array([0.0, 0.0, 1.0])
        b = rotation(x[self.turn]) @ self.p_zy
        rho = self.rho.copy()
        rho[1, 1] += x[self.mass[0]]
        rho[2, 2] += x[self.mass[1]]
        r = self.arm_y[:, :2] + self.sign[:, None] * x[self.shift]
        axis = b[:, :, 2]
        # e_i^T B D (r + B^T rho e_i), D = -w diag(1, 1, 0): B D B^T = -w (E - axis axis^T).
        own = np.diagonal(rho)[None, :] - axis * (axis @ rho)
        pull = -self.rate[:, None] * (np.einsum("nij,nj->ni", b[:, :, :2], r) + own)
        up = np.stack(
            [
                tilt[0] * self.cosine + tilt[1] * self.sine,
                tilt[1] * self.cosine - tilt[0] * self.sine,
                np.full_like(self.cosine, tilt[2]),
            ],
            -1,
        )
        f = pull[:, None, :] + self.gravity * np.einsum("nij,nsj->nsi", b, up)
        reading = f.copy()
        for column, i, powers in self.terms:
            monomial = x[column]
            for j, power in enumerate(powers):
                for _ in range(power):
                    monomial = monomial * f[:, :, j]
            reading[:, :, i] += monomial
        return reading.mean(axis=1)

    def whitened(self, x, mean):
        return np.einsum("nij,nj->ni", self.whitener, self.reading(x) - mean).ravel()

    def fit(self, mean, scale):
        return least_squares(self.whitened, np.zeros(len(self.names)), args=(mean,), method="lm", x_scale=scale)


def fits_for(seconds, seed, problem, truth, scale):
    """As many fits of drawn means as there is time for: their number and the processor time that they took."""
    random = np.random.default_rng(seed)
    exact = problem.reading(truth)
    count, start, work = 0, time.perf_counter(), time.process_time()
    while time.perf_counter() - start < seconds:
        noise = np.einsum("nij,nj->ni", problem.factor, random.standard_normal(exact.shape))
        problem.fit(exact + noise, scale)
        count += 1
    return count, time.process_time() - work


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("centrical")
    parser.add_argument("session", type=Path)
    parser.add_argument("--seconds", type=float, default=30.0, help="time given to SciPy")
    parser.add_argument("--runs", type=int, default=10_000, help="calibrations of the program")
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    arguments = parser.parse_args()

    calibrated = subprocess.run(
        [arguments.centrical, "calibrate", arguments.session, "--json"], capture_output=True, check=True
    )
    result = json.loads(calibrated.stdout)
    experiment = tomllib.loads((arguments.session / "experiment.toml").read_text())
    problem = Problem(result, experiment)
    estimate = np.array([p["value"] for p in result["parameters"]])
    sigma = np.array([p["standard_uncertainty"] for p in result["parameters"]])

    residual = np.array([p["residual"] for p in result["plateaus"]])
    off = np.abs(problem.mean - problem.reading(estimate) - residual).max()
    print(f"{len(problem.mean)} plateaus, {len(estimate)} unknowns; residuals here and there differ by {off:.1e} m/s^2")
    assert off < 1e-9, "not the same residual function"

    # The sizes that such unknowns have, which is the best scale SciPy could be given.
    scale = np.abs(estimate) + sigma
    start = time.perf_counter()
    fitted = problem.fit(problem.mean, scale)
    print(f"SciPy, one fit: {time.perf_counter() - start:.3f} s, {fitted.nfev} evaluations, {fitted.message}")
    print(f"  chi^2 {2.0 * fitted.cost:.3f}, the program's {result['fit']['chi_squared']:.3f}; "
          f"estimates differ by up to {np.abs((fitted.x - estimate) / sigma).max():.1e} standard uncertainties")

    with ProcessPoolExecutor(arguments.processes) as pool:
        jobs = [pool.submit(fits_for, arguments.seconds, k, problem, estimate, scale) for k in range(arguments.processes)]
        counts, works = zip(*(job.result() for job in jobs))
    cores, runs = arguments.processes, arguments.runs
    each = sum(works) / sum(counts)
    print(f"SciPy: {sum(counts)} fits in {arguments.seconds:.0f} s on {cores} processes, {1e3 * each:.0f} ms of a processor "
          f"each: {runs} in {runs * each / cores:.0f} s on {cores} cores of their own")

    start, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(
        [arguments.centrical, "montecarlo", arguments.session, "--runs", str(runs)],
        stdout=subprocess.DEVNULL,
        env={**os.environ, "RAYON_NUM_THREADS": str(cores)},
        check=True,
    )
    elapsed, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    work = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    print(f"centrical: {runs} calibrations in {elapsed:.1f} s on {cores} threads, {1e3 * work / runs:.2f} ms of a processor "
          f"each: {work / cores:.1f} s on {cores} cores of their own; {each * runs / work:.0f} times as many as SciPy")


if __name__ == "__main__":
    main()

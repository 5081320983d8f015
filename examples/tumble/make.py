"""Makes `record.csv` and `truth.json`: a unit turned by hand into 24 attitudes, 2 to 4 s each, 50 Hz. Needs NumPy.

Readings are `f + df + G0 f`, with white noise, noise of a correlation time of a second, and the tremor of a hand: the attitude
trembles, the size of gravity does not. One rest is bumped. From one attitude to the next the unit turns in 1 to 2 s and is shaken.
"""

import json
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
RATE, GRAVITY = 50.0, 9.81523
WHITE, SLOW, TREMOR = 4e-3, 5e-4, 1e-3
DF = np.array([0.12, -0.08, 0.21])
G0 = np.array([[3.1e-3, 0, 0], [-4.2e-3, -1.7e-3, 0], [6.5e-3, 2.4e-3, 4.4e-3]])


def markov(random, count, seconds):
    """Noise of unit variance and a correlation time, three columns."""
    keep = np.exp(-1 / (RATE * seconds))
    values = np.empty((count, 3))
    value = random.normal(size=3)
    for i in range(count):
        value = keep * value + np.sqrt(1 - keep**2) * random.normal(size=3)
        values[i] = value
    return values


def main():
    random = np.random.default_rng(24)
    directions = random.normal(size=(24, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    pieces, before = [], None
    for k, direction in enumerate(directions):
        if before is not None:
            count = int(RATE * random.uniform(1.0, 2.0))
            part = 0.5 - 0.5 * np.cos(np.pi * np.arange(count) / count)[:, None]
            way = (1 - part) * before + part * direction + 0.3 * np.sin(np.pi * part) * random.normal(size=3)
            way *= (1 + 0.1 * random.normal(size=(count, 1))) / np.linalg.norm(way, axis=1, keepdims=True)
            pieces.append(way)
        count = int(RATE * random.uniform(2.0, 4.0))
        rest = direction + TREMOR * np.cross(markov(random, count, 0.3), direction)
        rest /= np.linalg.norm(rest, axis=1, keepdims=True)
        if k == 9:
            rest[count // 2 : count // 2 + 4] += 0.2 * random.normal(size=(4, 3))
        pieces.append(rest)
        before = direction
    force = GRAVITY * np.concatenate(pieces)
    noise = WHITE * random.normal(size=force.shape) + SLOW * markov(random, len(force), 1.0)
    readings = force + DF + force @ G0.T + noise
    lines = [f"{i / RATE:.2f},{a:.4f},{b:.4f},{c:.4f}" for i, (a, b, c) in enumerate(readings)]
    (HERE / "record.csv").write_text("t,f1,f2,f3\n" + "\n".join(lines) + "\n")
    truth = {"gravity": GRAVITY, "rests": 24, "df": DF.tolist(), "G0": G0.tolist()}
    (HERE / "truth.json").write_text(json.dumps(truth, indent=1) + "\n")


if __name__ == "__main__":
    main()

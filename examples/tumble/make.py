"""Makes `record.csv`, `attitudes.csv` and `truth.json`: a unit turned by hand into 24 attitudes, 2 to 4 s each, 50 Hz. Needs NumPy.

Readings are `f + df + G0 f`, with white noise, noise of a correlation time of a second, and the tremor of a hand: the attitude
trembles, the size of gravity does not. One rest is bumped. From one attitude to the next the unit turns in 1 to 2 s and is shaken.

The attitudes are those of the case, against which the instrument is turned by `case_turn`, with an error of 1 mrad about either
horizontal axis, in a shuffled order.
"""

import json
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
RATE, GRAVITY = 50.0, 9.81523
ATTITUDE_ERROR = 1e-3
CASE_TURN = np.array([8e-3, -5e-3, 12e-3])
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


def in_case(directions):
    """The directions as a laboratory states them: in axes of the case, with errors, shuffled.

    `rotation(v)` takes coordinates in the case to those in the instrument: a turn by `-v` in the usual sense.
    """
    random = np.random.default_rng(25)
    angle = np.linalg.norm(CASE_TURN)
    x, y, z = CASE_TURN / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    to_case = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    stated = directions @ to_case.T
    stated += ATTITUDE_ERROR * np.cross(random.normal(size=stated.shape), stated)
    return random.permutation(stated / np.linalg.norm(stated, axis=1, keepdims=True))


def turned(random, directions, lasting, bumped=None):
    """Direction of the specific force of each sample, and from and to of each rest in samples.

    Each rest lasts a time between the two of `lasting` [s]; in the middle of rest `bumped` the unit is bumped.
    """
    pieces, rests, before = [], [], None
    for k, direction in enumerate(directions):
        if before is not None:
            count = int(RATE * random.uniform(1.0, 2.0))
            part = 0.5 - 0.5 * np.cos(np.pi * np.arange(count) / count)[:, None]
            way = (1 - part) * before + part * direction + 0.3 * np.sin(np.pi * part) * random.normal(size=3)
            way *= (1 + 0.1 * random.normal(size=(count, 1))) / np.linalg.norm(way, axis=1, keepdims=True)
            pieces.append(way)
        count = int(RATE * random.uniform(*lasting))
        rest = direction + TREMOR * np.cross(markov(random, count, 0.3), direction)
        rest /= np.linalg.norm(rest, axis=1, keepdims=True)
        if k == bumped:
            rest[count // 2 : count // 2 + 4] += 0.2 * random.normal(size=(4, 3))
        start = sum(map(len, pieces))
        rests.append((start, start + count))
        pieces.append(rest)
        before = direction
    return np.concatenate(pieces), rests


def readings_of(random, force):
    """What the unit reads of a specific force."""
    noise = WHITE * random.normal(size=force.shape) + SLOW * markov(random, len(force), 1.0)
    return force + DF + force @ G0.T + noise


def main():
    random = np.random.default_rng(24)
    directions = random.normal(size=(24, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    way, _ = turned(random, directions, (2.0, 4.0), bumped=9)
    readings = readings_of(random, GRAVITY * way)
    lines = [f"{i / RATE:.2f},{a:.4f},{b:.4f},{c:.4f}" for i, (a, b, c) in enumerate(readings)]
    (HERE / "record.csv").write_text("t,f1,f2,f3\n" + "\n".join(lines) + "\n")
    lines = [",".join(f"{component:.6f}" for component in up) for up in in_case(directions)]
    (HERE / "attitudes.csv").write_text("up_1,up_2,up_3\n" + "\n".join(lines) + "\n")
    truth = {"case_turn": CASE_TURN.tolist(), "gravity": GRAVITY, "rests": 24, "df": DF.tolist(), "G0": G0.tolist()}
    (HERE / "truth.json").write_text(json.dumps(truth, indent=1) + "\n")


if __name__ == "__main__":
    main()

"""Long campaigns: processor time and memory grow with the number of plateaus, and no faster."""

import math
import random
import re
import shutil

from judge import Group, run

# Plateaus a mounting, for each of the example's, and what 5000 may take: processor time [s] and memory [bytes]. It is about 1 s on the machine of
# docs/performance.md; a shared machine whose cores have other work takes 1.9 s.
REPEATS = (4, 46)
PROCESSOR = 5.0
MEMORY = 300 << 20

# Processor time grows as this power of the number of plateaus, at most, in the best of these attempts.
EXPONENT = 1.15
ATTEMPTS = 5

MOUNTINGS = 10_000


def check(place):
    yield plateaus(place)
    yield mountings(place)


def table(place):
    """The example's experiment, the header of its table and the rows of each mounting."""
    header, *rows = (place.reduced / "plateaus.csv").read_text().splitlines()
    text = (place.reduced / "experiment.toml").read_text()
    by_mounting = {}
    for row in rows:
        by_mounting.setdefault(row.split(",")[0], []).append(row.split(","))
    return text, header, list(by_mounting.values())


def plateaus(place):
    found = Group("plateaus by the thousand")
    text, header, rows = table(place)
    folder = place.new()
    drawn = random.Random(1)
    sessions, counts = [], []
    for repeats in REPEATS:
        session = folder / str(repeats)
        session.mkdir()
        lines = [header]
        for row in (row for mounting in rows for _ in range(repeats) for row in mounting):
            noisy = [repr(float(cell) + drawn.gauss(0, 6e-5)) for cell in row[3:6]]
            lines.append(",".join(row[:3] + noisy + row[6:]))
        (session / "experiment.toml").write_text(text)
        (session / "plateaus.csv").write_text("\n".join(lines) + "\n")
        sessions.append(session)
        counts.append(len(lines) - 1)
    for command in ("calibrate", "assess", "observe"):
        exponent = least_growth(found, command, sessions, counts, folder)
        found.judge(f"growth of {command}", why=f"as plateaus^{exponent:.2f}" if exponent > EXPONENT else None)
    shutil.rmtree(folder)
    return found


def least_growth(found, command, sessions, counts, folder):
    """The power of the number of plateaus with which a command takes processor time, the least of some attempts.

    A core that others share is slower by half for seconds: the short session runs as often as it takes for as many plateaus, half
    of the runs before the long one and half after it. One attempt without others shows the power; where it is too large, none does."""
    exponents = []
    half = round(counts[1] / counts[0] / 2)
    while len(exponents) < ATTEMPTS and min(exponents, default=math.inf) > EXPONENT:
        runs = [run([command, sessions[which], "--json"], folder) for which in [0] * half + [1] + [0] * half]
        long = runs.pop(half)
        short = sum(done.processor for done in runs) / len(runs)
        exponents.append(math.log(long.processor / short) / math.log(counts[1] / counts[0]))
        large = f"{long.processor:.1f} s, {long.memory >> 20} MB" if long.processor > PROCESSOR or long.memory > MEMORY else None
        found.judge(f"{command}, {counts[1]} plateaus", long, codes=(0, 1), why=large)
        found.judge(f"{command}, {counts[0]} plateaus", max(runs, key=lambda done: done.processor), codes=(0, 1))
    return min(exponents)


def mountings(place):
    found = Group("mountings by the thousand")
    text, header, rows = table(place)
    folder = place.new()
    head, *tables = re.split(r"^\[\[mounting\]\]$", text, flags=re.M)
    (folder / "experiment.toml").write_text(head + "".join("[[mounting]]" + tables[n % len(tables)] for n in range(MOUNTINGS)))
    lines = [header]
    for n in range(MOUNTINGS):
        row = rows[n % len(rows)]
        lines.append(",".join([str(n + 1), *row[n // len(rows) % len(row)][1:]]))
    (folder / "plateaus.csv").write_text("\n".join(lines) + "\n")
    for command in ("calibrate", "assess", "observe"):
        found.judge(f"{command}, {MOUNTINGS} mountings of one plateau", run([command, folder, "--json"], folder), codes=(0, 1))
    shutil.rmtree(folder)
    return found

"""Long campaigns: processor time and memory grow with the number of plateaus, and no faster."""

import math
import random
import re
import shutil

from judge import Group, run

# Plateaus a mounting, for each of the example's, and what 5000 may take: processor time [s] and memory [bytes]. It is about 1 s on the machine of
# docs/performance.md; a shared machine whose cores have other work took 4.6 s.
REPEATS = (4, 46)
PROCESSOR = 8.0
MEMORY = 300 << 20

# Processor time grows as this power of the number of plateaus, at most.
EXPONENT = 1.15

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
    counts, least = [], {}
    for repeats in REPEATS:
        session = folder / str(repeats)
        session.mkdir()
        lines = [header]
        for row in (row for mounting in rows for _ in range(repeats) for row in mounting):
            noisy = [repr(float(cell) + drawn.gauss(0, 6e-5)) for cell in row[3:6]]
            lines.append(",".join(row[:3] + noisy + row[6:]))
        (session / "experiment.toml").write_text(text)
        (session / "plateaus.csv").write_text("\n".join(lines) + "\n")
        counts.append(len(lines) - 1)
        for command in ("calibrate", "assess", "observe"):
            # The least of three: others on the machine only add to it.
            runs = [run([command, session, "--json"], folder) for _ in range(3)]
            best = min(runs, key=lambda done: done.processor)
            least[command, repeats] = best.processor
            large = f"{best.processor:.1f} s, {best.memory >> 20} MB" if best.processor > PROCESSOR or best.memory > MEMORY else None
            found.judge(f"{command}, {counts[-1]} plateaus", best, codes=(0, 1), why=large)
    for command in ("calibrate", "assess", "observe"):
        first, last = (least[command, repeats] for repeats in REPEATS)
        exponent = math.log(last / first) / math.log(counts[1] / counts[0])
        found.judge(f"growth of {command}", why=f"as plateaus^{exponent:.2f}" if exponent > EXPONENT else None)
    shutil.rmtree(folder)
    return found


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

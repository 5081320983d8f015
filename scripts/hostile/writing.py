"""What happens to files and streams: two processes, outputs that are inputs, kills, full disks, closed streams, special files."""

import os
import random
import shutil
import signal
import subprocess
import time

from forms import PLAN, TRUTH
from judge import EXAMPLE, PROGRAM, Group, files, parallel, run


def check(place):
    yield pairs(place)
    yield crowds(place)
    yield inputs(place)
    yield kills(place)
    yield full(place)
    yield streams(place)
    yield special(place)


def pairs(place):
    """Two `compensate` with one output: what is there in the end is one of the two, whole."""
    found = Group("pairs of processes with one --out")
    records = [EXAMPLE / "records" / name for name in ("m01.csv", "m04.csv")]
    folder = place.new()
    wholes = []
    for record in records:
        for end in ("csv", "parquet"):
            run(["compensate", place.result, record, "--out", f"w.{end}"], folder)
            wholes.append((folder / f"w.{end}").read_bytes())
    for n in range(40):
        end = ("csv", "parquet")[n % 2]
        out = folder / f"o{n}.{end}"
        mine = out.with_name(out.name + ".tmp")
        mine.write_bytes(b"mine")
        done = parallel(lambda record: run(["compensate", place.result, record, "--out", out], folder), records)
        why = None if out.read_bytes() in wholes else "a mixture of both"
        why = why or (None if mine.read_bytes() == b"mine" else "the user's own file with .tmp is gone")
        left = [p.name for p in folder.glob(f"o{n}.*.tmp") if p != mine]
        found.judge(f"pair {n}", max(done, key=lambda d: d.code), codes=(0,), why=why or (f"left {left}" if left else None))
    shutil.rmtree(folder)
    return found


def crowds(place):
    """Three commands at once into one folder: each completes, or says that another is at work there."""
    found = Group("three processes with one folder")
    alone = place.new()
    (alone / "truth.toml").write_text(TRUTH)
    simulate = ["simulate", EXAMPLE, "--truth", alone / "truth.toml"]
    commands = {
        "simulate": lambda n, out: [*simulate, "--seed", str(n), "--out", out],
        "reduce": lambda n, out: ["reduce", EXAMPLE, "--out", out],
        "calibrate": lambda n, out: ["calibrate", place.reduced, "--out", out],
        "watch": lambda n, out: ["watch", place.reduced, "--once", "--out", out],
    }
    for name, command in commands.items():
        wholes = []
        for n in range(3):
            out = alone / f"{name}{n}"
            run(command(n, out), alone, timeout=60)
            wholes.append(files(out))
        for again in range(3):
            out = alone / f"{name}-{again}"
            done = parallel(lambda n: run(command(n, out), alone, timeout=60), range(3))
            whole = [n for n in range(3) if done[n].code in (0, 1)]
            why = None if whole else "none completed"
            if files(out) not in [wholes[n] for n in whole]:
                why = f"a mixture: {sorted(files(out))[:5]}"
            for one in done:
                refused = one.code == 2 and not ("at work there" in one.message or "a folder without one" in one.message)
                found.judge(f"{name}", one, why="refused without a word on the other" if refused else why)
    shutil.rmtree(alone)
    return found


def inputs(place):
    """Outputs that are inputs, by name, by link and by another path."""
    found = Group("outputs that are inputs")
    folder = place.new()
    session = folder / "session"
    shutil.copytree(EXAMPLE, session)
    shutil.copy(place.result, folder / "result.json")
    (folder / "plan.toml").write_text(PLAN)
    (folder / "truth.toml").write_text(TRUTH)
    (folder / "linked.csv").symlink_to(session / "records/m01.csv")
    os.link(session / "records/m01.csv", folder / "hard.csv")
    other = (folder / "result.json").read_text().replace('"0001"', '"0002"')
    (folder / "elsewhere").mkdir()
    (folder / "elsewhere/result.json").write_text(other)
    record, laboratory = "session/records/m01.csv", "session/laboratory.toml"
    before = files(folder)
    cases = [
        ["compensate", "result.json", record, "--out", record],
        ["compensate", "result.json", record, "--out", "session/records/../records/m01.csv"],
        ["compensate", "result.json", record, "--out", "linked.csv"],
        ["compensate", "result.json", record, "--out", "hard.csv"],
        ["compensate", "result.json", "linked.csv", "--out", record],
        ["compensate", "result.json", record, "--out", "result.json"],
        ["compensate", "result.json", record, "--session", "session", "--out", "session/experiment.toml"],
        ["report", "result.json", "--html", "result.json"],
        ["report", "result.json", "--laboratory", laboratory, "--pdf", laboratory],
        ["report", "result.json", "--laboratory", laboratory, "--dcc", "result.json"],
        ["report", "result.json", "--laboratory", laboratory, "--pdf", "a", "--dcc", "./a"],
        ["plan", "plan.toml", "--out", "plan.toml"],
        ["plan", "plan.toml", "--frontier", "--levels", "1", "--svg", "plan.toml"],
        ["reduce", "session", "--out", "session"],
        ["simulate", "session", "--truth", "truth.toml", "--seed", "1", "--out", "session"],
        ["compensate", "result.json", record, "--out", "session"],
        ["compensate", "result.json", record, "--out", "/dev/null"],
    ]
    for arguments in cases:
        done = run(arguments, folder)
        why = None if files(folder) == before else "files have changed"
        found.judge(" ".join(arguments), done, codes=(2,), why=why)
    done = run(["calibrate", folder / "session"], folder / "elsewhere")
    same = (folder / "elsewhere/result.json").read_text() == other
    found.judge("calibrate over another unit's result.json", done, codes=(2,), why=None if same else "overwritten")
    done = run(["calibrate", folder / "session"], folder)
    found.judge("calibrate over its own result.json", done, codes=(0,))
    run(["reduce", folder / "session", "--out", "reduced"], folder)
    means = folder / "reduced/experiment.toml"
    means.write_text(means.read_text().replace('serial = "0001"', 'serial = "0002"'))
    before = means.read_text()
    done = run(["reduce", folder / "session", "--out", "reduced"], folder)
    why = None if means.read_text() == before else "overwritten"
    found.judge("reduce over the means of another unit", done, codes=(2,), why=why)
    shutil.rmtree(folder)
    return found


WRITERS = [
    (["reduce", "EXAMPLE", "--out", "out"], 0.02),
    (["calibrate", "EXAMPLE", "--out", "out"], 0.1),
    (["compensate", "RESULT", "RECORD", "--out", "out/f.csv"], 0.005),
    (["compensate", "RESULT", "RECORD", "--out", "out/f.parquet"], 0.005),
    (["simulate", "EXAMPLE", "--truth", "truth.toml", "--seed", "1", "--out", "out"], 0.1),
    (["report", "RESULT", "--html", "out/r.html"], 0.005),
]


def filled(place, arguments):
    names = {"EXAMPLE": EXAMPLE, "RESULT": place.result, "RECORD": EXAMPLE / "records/m01.csv"}
    return [names.get(a, a) for a in arguments]


def prepared(place):
    folder = place.new()
    (folder / "out").mkdir()
    (folder / "truth.toml").write_text(TRUTH)
    return folder


def kills(place):
    """Killed at any moment: no part of a file under its name. Interrupted: no temporary file either."""
    found = Group("kills and interruptions")
    chance = random.Random(18)
    for arguments, longest in WRITERS:
        arguments = filled(place, arguments)
        folder = prepared(place)
        run(arguments, folder, timeout=60)
        whole = files(folder / "out")
        for n in range(12):
            which = (signal.SIGKILL, signal.SIGINT, signal.SIGTERM)[n % 3]
            folder = prepared(place)
            child = subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(chance.uniform(0, longest))
            child.send_signal(which)
            child.wait(20)
            left = files(folder / "out")
            begun = [name for name in left if name.endswith(".tmp")]
            cut = [name for name, data in left.items() if name not in begun and whole.get(name) != data]
            why = f"in part: {cut}" if cut else None
            if which != signal.SIGKILL and begun:
                why = f"left behind: {begun}"
            found.judge(f"{arguments[0]}, {which.name}", why=why)
            shutil.rmtree(folder)
    return found


def full(place):
    """No room: an error that names the file, what was there before stays, nothing is left."""
    found = Group("full disks")
    for arguments, _ in WRITERS:
        arguments = filled(place, arguments)
        whole = prepared(place)
        run(arguments, whole, timeout=60)
        largest = max(len(data) for data in files(whole / "out").values())
        for size in (0, 512, largest // 2, largest - 1):
            folder = prepared(place)
            done = run(arguments, folder, file_size=size, timeout=60)
            left = files(folder / "out")
            cut = [name for name, data in left.items() if files(whole / "out").get(name) != data]
            why = f"in part: {cut}" if cut else None if "cannot be written" in done.message or size == 0 else "no file named"
            # The message itself is held back by the limit where nothing may be written at all.
            found.judge(f"{arguments[0]}, {size} bytes", done if size else None, codes=(2,), why=why)
            shutil.rmtree(folder)
    return found


def streams(place):
    """Full, closed and broken streams."""
    found = Group("closed and full streams")
    record = EXAMPLE / "records/m01.csv"
    commands = [["calibrate", place.reduced, "--json"], ["calibrate", place.reduced, "--out", "o"], ["assess", place.reduced],
                ["models", place.reduced], ["observe", place.reduced], ["observe", place.reduced, "--json"],
                ["compare", place.result, place.result], ["noise", record], ["noise", record, "--json"],
                ["montecarlo", place.reduced, "--runs", "50"], ["plan", "plan.toml"], ["plan", "plan.toml", "--json"],
                ["compensate", place.result, record, "--out", "f.csv"], ["reduce", EXAMPLE, "--out", "p"],
                ["watch", place.reduced, "--once", "--out", "w"], ["--help"], ["calibrate", "--help"], ["--version"]]
    for arguments in commands:
        folder = place.new()
        (folder / "plan.toml").write_text(PLAN)
        usual = run(arguments, folder, timeout=60).code
        again = lambda **streams: run(arguments, folder, timeout=60, **streams)
        with open("/dev/full", "wb") as device:
            found.judge(f"{arguments[0]}, full stdout", again(stdout=device), codes=(2,))
            found.judge(f"{arguments[0]}, full stderr", again(stderr=device), codes=(usual,))
        read, write = os.pipe()
        os.close(read)
        with os.fdopen(write, "wb") as pipe:
            found.judge(f"{arguments[0]}, broken pipe", again(stdout=pipe), codes=(usual,))
            found.judge(f"{arguments[0]}, broken stderr", again(stderr=pipe), codes=(usual,))
        found.judge(f"{arguments[0]}, closed stdout", again(before=lambda: os.close(1)), codes=(usual,))
        found.judge(f"{arguments[0]}, closed streams", again(before=lambda: [os.close(n) for n in (0, 1, 2)]), codes=(usual,))
        shutil.rmtree(folder)
    return found


def special(place):
    """Pipes, devices, folders, huge files and links to themselves wherever a document is read."""
    found = Group("special files")
    folder = place.new()
    os.mkfifo(folder / "fifo")
    (folder / "folder").mkdir()
    (folder / "loop").symlink_to("loop")
    with open(folder / "huge", "wb") as huge:
        huge.truncate(8 << 30)
    (folder / "binary").write_bytes(bytes(range(256)) * 100)
    (folder / "empty").write_bytes(b"")
    record = EXAMPLE / "records/m01.csv"
    for name in ("fifo", "/dev/zero", "/dev/full", "/dev/tty", "folder", "loop", "huge", "binary", "empty", "missing", "/proc/self/mem"):
        for arguments in (
            ["calibrate", name, "--json"], ["observe", name], ["plan", name], ["montecarlo", name], ["watch", name, "--once", "--out", "w"],
            ["simulate", EXAMPLE, "--truth", name, "--seed", "1", "--out", "s"], ["compare", name, place.result],
            ["report", name, "--html", "r.html"], ["report", place.result, "--html", "r.html", "--history", name],
            ["report", place.result, "--pdf", "r.pdf", "--laboratory", name], ["compensate", name, record, "--out", "f.csv"],
            ["compensate", place.result, name, "--out", "f.csv"], ["noise", name],
        ):
            # An empty history has no plateaus, an empty truth no errors.
            codes = (0, 2) if name == "empty" and ("--history" in arguments or "--truth" in arguments) else (2,)
            found.judge(" ".join(map(str, arguments)), run(arguments, folder), codes=codes)
        out = place.new()
        target = folder / name
        if name not in ("missing", "loop"):
            for state in ("watch.json", "watch-history.jsonl"):
                (out / state).symlink_to(target)
                codes = (0, 2) if name in ("empty", "binary", "/dev/full", "/dev/zero") else (2,)
                found.judge(f"watch with {state} -> {name}", run(["watch", place.reduced, "--once", "--out", out], folder), codes=codes)
                (out / state).unlink()
    shutil.rmtree(folder)
    return found

"""A session that is watched to its end has told the truth at every step."""

import json
import re
import shutil
import signal
import subprocess
import time

from judge import EXAMPLE, PROGRAM, Group, run


def check(place):
    yield rests(place)
    yield states(place)
    yield stops(place)


def with_rests(place):
    """The example's experiment with rests at 90 and 180 deg after the first plateau of every mounting, simulated."""
    folder = place.new()
    text = (EXAMPLE / "experiment.toml").read_text()
    added = re.sub(r"(plateaus = \[\s*\{[^}]*\},)", r'\1 { speed = 0, angle = "90 deg" }, { speed = 0, angle = "180 deg" },', text)
    (folder / "plan.toml").write_text(added)
    (folder / "truth.toml").write_text('typical = { size = 1.0, seed = 3 }\n[sensor]\nwhite = "0.2 mg"\n[machine]\nspeed_error = 1e-5\n')
    done = run(["simulate", "plan.toml", "--truth", "truth.toml", "--seed", "1", "--out", "s"], folder, timeout=60)
    assert done.code == 0, done.message
    return folder


def rests(place):
    """Records that are fed piece by piece: no alarm in a perfect session, and every plateau as `calibrate` has it."""
    found = Group("watched while it is filled")
    folder = with_rests(place)
    done = run(["calibrate", "s", "--json"], folder, timeout=60)
    found.judge("calibrate", done, codes=(0,))
    final = json.loads(done.text)["plateaus"]
    session = folder / "grown"
    shutil.copytree(folder / "s", session)
    (session / "records").rename(folder / "later")
    (session / "records").mkdir()
    seen = 0
    for mounting in (1, 2, 3):
        name = f"m{mounting:02}.csv"
        lines = (folder / "later" / name).read_text().splitlines(keepends=True)
        step = 700 if mounting == 1 else 2500
        # At 100 Hz, the first piece as far as the turn after the first rest.
        for end in [*range(1300, len(lines), step), len(lines)]:
            (session / "records" / name).write_text("".join(lines[:end]))
            done = run(["watch", session, "--once", "--out", folder / "w", "--quiet", "86400"], folder)
            why = "an alarm in a perfect session" if "DOES NOT FIT" in done.text else None
            state = folder / "w/watch.json"
            come = json.loads(state.read_text())["plateaus"] if state.exists() else []
            for plateau in come[seen:]:
                mean, whole = plateau["mean"], final[plateau["set_point"]]
                apart = max(abs(a - b) / max(c[k] ** 0.5, 1e-9) for k, (a, b, c) in enumerate(zip(mean, whole["mean"], whole["covariance"])))
                why = why or (f"set point {plateau['set_point']} is {apart:.1f} sigma from the calibration" if apart > 5 else None)
            why = why or ("plateaus are lost" if len(come) < seen else None)
            seen = len(come)
            found.judge(f"{name}, {end} lines", done, codes=(0,), why=why)
    found.judge("plateaus that have come", why=None if seen >= 22 else f"{seen} alone")
    shutil.rmtree(folder)
    return found


def states(place):
    """State files of another hand are blamed themselves."""
    found = Group("states from elsewhere")
    folder = place.new()
    shutil.copytree(place.reduced, folder / "s")
    run(["watch", "s", "--once", "--out", "w"], folder)
    whole = json.loads((folder / "w/watch.json").read_text())

    def changed(change):
        state = json.loads(json.dumps(whole))
        change(state)
        return json.dumps(state)

    texts = {
        "nothing": "", "no state": "{}", "a list": "[]", "cut": json.dumps(whole)[:500],
        "another experiment": changed(lambda s: s["experiment"].update(sha256="0" * 64)),
        "a set point too many": changed(lambda s: s["plateaus"][3].update(set_point=1000)),
        "a set point twice": changed(lambda s: s["plateaus"][3].update(set_point=0)),
        "a negative variance": changed(lambda s: s["plateaus"][3]["covariance"][0].__setitem__(0, -1)),
        "an asymmetric covariance": changed(lambda s: s["plateaus"][3]["covariance"][0].__setitem__(1, 1)),
        "a mean beyond numbers": changed(lambda s: s["plateaus"][3]["mean"].__setitem__(0, 1e300)),
        "a short point": changed(lambda s: s.update(point=[0.0])),
        "a null": changed(lambda s: s["plateaus"][3].update(mean=None)),
    }
    for what, text in texts.items():
        (folder / "w/watch.json").write_text(text)
        done = run(["watch", "s", "--once", "--out", "w"], folder)
        found.judge(what, done, codes=(2,), why=None if "watch.json" in done.message else "another file is blamed")
    shutil.rmtree(folder)
    return found


def stops(place):
    """SIGTERM ends a watch as Ctrl-C does, soon; `--once` on files just copied says what `--quiet 0` would do; alarms are told once."""
    found = Group("stops, quiet and alarms of a watch")
    folder = place.new()
    shutil.copytree(EXAMPLE, folder / "s")
    records = sorted((folder / "s/records").iterdir())
    for record in records[3:]:
        record.unlink()
    for which in (signal.SIGINT, signal.SIGTERM):
        out = folder / which.name
        child = subprocess.Popen([PROGRAM, "watch", "s", "--interval", "3600", "--out", out], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        deadline = time.monotonic() + 20
        while not (out / "watch.json").exists() and time.monotonic() < deadline:
            time.sleep(0.05)
        time.sleep(1)
        child.send_signal(which)
        begun = time.monotonic()
        message = child.communicate(timeout=20)[1].decode()
        why = None if child.returncode == 0 and "goes on from" in message else f"code {child.returncode}: {message[-200:]}"
        found.judge(which.name, why=why or ("not at once" if time.monotonic() - begun > 2 else None))
    for record in records[:3]:
        record.touch()
    done = run(["watch", "s", "--once", "--out", "o"], folder)
    found.judge("--once on files just copied", done, codes=(0,), why=None if "--quiet 0" in done.message else "no word of --quiet 0")
    lines = records[1].read_text().splitlines()
    spoilt = [line if k < 4000 or k == 0 else ",".join([*line.split(",")[:1], *(str(float(f) * 1.01) for f in line.split(",")[1:])]) for k, line in enumerate(lines)]
    records[1].write_text("\n".join(spoilt) + "\n")
    done = run(["watch", "s", "--once", "--quiet", "0", "--out", "a"], folder)
    alarms = [line for line in done.text.splitlines() if "DOES NOT FIT" in line]
    twice = [line for line in alarms if alarms.count(line) > 1]
    found.judge("an alarm is told once", done, codes=(0,), why=f"told again: {twice[0]}" if twice else None if alarms else "no alarm")
    shutil.rmtree(folder)
    return found

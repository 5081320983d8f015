"""Mutated files of settings: every key of every form, every kind of wrong value."""

import json
import math
import shutil
import tomllib

from judge import EXAMPLE, Group, parallel, run

TRUTH = """typical = { size = 1.0, seed = 3 }
[parameters]
G0_11 = 1e-3
[machine]
plateau = "2 s"
plateau_spread = "1 s"
ramp = "1 s"
speed_error = 1e-5
settling = 1e-4
settling_time = "0.4 s"
[sensor]
white = "0.2 mg"
coloured = { deviation = "0.1 mg", time = "0.5 s" }
bias_instability = "1 ug"
random_walk = "1 ug"
drift = 1e-9
quantum = "1 ug"
range = "500 g"
[recorder]
rate = "20 Hz"
spikes = { probability = 1e-3, size = "1 g" }
gaps = { probability = 1e-3, length = 5 }
repeats = 1e-3
[tachometer]
rate = "5 Hz"
clock_offset = "1 s"
clock_drift = 1e-6
noise = "0.01 rpm"
quantum = "0.01 rpm"
"""

PLAN = """session = { title = "t", date = 2026-10-05 }
plan = { noise = "20 ug/sqrt(Hz)", floor = "1 ug", duration = "60 s" }
target = { criterion = "I", range = "200 g", time = "8 h" }
site = { gravity = "9.8 m/s^2", latitude = "55.7 deg" }
unit = { output_unit = "m/s^2", proof_masses = [[0, 0, 0], [0.02, 0.01, 0.01], [0.01, -0.01, -0.01]] }
centrifuge = { speed_uncertainty = "10 ppm", rotation = "+3" }
model = { error_model = "kozlov-2017", pair_relation = "common" }
position = [{ id = "1", axes = "+1 +2 +3", pair = "A" }, { id = "2", axes = "-1 -2 +3", pair = "A" }]
robust = { against = "mean", noise = ["40 ug/sqrt(Hz)"] }
prior = { drho_22 = "1 mm" }

[candidates]
radii = ["0.5 m"]
loads = { from = "5 g", to = "200 g", count = 2 }
rest_angles = ["0 deg", "180 deg"]
durations = ["60 s"]
repeats = 1
max_speed = "1000 rpm"
max_load = "300 g"

[cost]
position = "20 min"
seat = "10 min"
run_up = "2 min"
ramp = "20 s"
turn = "10 s"
"""

EXTRA = """
[uncertainty]
gravity = "1e-5 m/s^2"
radius = "0.1 mm"
arm_turn_load = "1 urad at 100 g"
spin_step = "1 ug"
bias_drift = "1 ug"
[prior]
drho_22 = "1 mm"
"""


class Raw(str):
    """TOML as it is to be written."""


VALUES = {
    "wrong type": [True, [], {}, [1, "a"], "some words"],
    "negative": [-1, -1.5],
    "zero": [0],
    "not finite": [Raw("nan"), Raw("inf"), Raw("-inf"), "nan m", "inf g"],
    "huge": [1e308, 9223372036854775807, "1e308 s"],
    "tiny": [5e-324],
    "empty": ["", "   "],
    "wrong unit": ["1 kg", "5 furlong", "1 m/s^2 s"],
    "unicode": ["a\u202eb\u2066c", "\u0000", "\ufffe", "x" * 5000, "\x1b[31m"],
}


def toml(value):
    """A value as TOML."""
    if isinstance(value, Raw):
        return str(value)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, float):
        return "nan" if math.isnan(value) else repr(value)
    if isinstance(value, int):
        return str(value)
    if isinstance(value, list):
        return "[" + ", ".join(toml(v) for v in value) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(k)} = {toml(v)}" for k, v in value.items()) + " }"
    return str(value)


def document(tree):
    return "".join(f"{json.dumps(key)} = {toml(value)}\n" for key, value in tree.items())


def leaves(tree, path=()):
    """Paths of all values: of each list the first entry alone."""
    for key, value in tree.items() if isinstance(tree, dict) else enumerate(tree[:1]):
        yield (*path, key)
        if isinstance(value, (dict, list)):
            yield from leaves(value, (*path, key))


def changed(tree, path, change):
    """A copy with one value changed, or removed by `None`."""
    if not path:
        return change
    copy = dict(tree) if isinstance(tree, dict) else list(tree)
    if len(path) == 1 and change is None:
        del copy[path[0]]
    else:
        copy[path[0]] = changed(copy[path[0]], path[1:], change)
    return copy


def mutations(text, share=1):
    """Texts of a form with one value missing, twice or wrong; every `share`-th of them."""
    tree = tomllib.loads(text)
    every = 0
    for path in leaves(tree):
        name = ".".join(map(str, path))
        cases = [("missing", document(changed(tree, path, None)))]
        cases += [(f"{kind} {toml(v)[:30]}", document(changed(tree, path, v))) for kind, values in VALUES.items() for v in values]
        if len(path) == 1:
            cases.append(("twice", document(tree) + f"{json.dumps(path[0])} = {toml(tree[path[0]])}\n"))
        for kind, mutated in cases:
            every += 1
            if every % share == 0:
                yield f"{name}, {kind}", mutated


def check(place):
    """Groups of cases by form."""
    experiment = (place.reduced / "experiment.toml").read_text() + EXTRA
    laboratory = (EXAMPLE / "laboratory.toml").read_text()
    yield group("experiment.toml", place, experiment, 3, session)
    yield group("laboratory.toml", place, laboratory, 3, certificate)
    yield group("a truth file", place, TRUTH, 2, simulated)
    yield group("a plan", place, PLAN, 4, planned)
    yield from meanings(place, laboratory)


def group(name, place, text, share, work):
    found = Group(f"mutated forms: {name}")
    cases = [("as it is", text), *mutations(text, share)]
    for (what, _), done in zip(cases, parallel(lambda case: work(place, case[1]), cases)):
        strange = "no control character reaches the terminal" if is_commanding(done) else None
        long = "a value of thousands of characters in a message" if len(done.message) > 4000 else None
        found.judge(what, done, why=strange or long)
        if what == "as it is" and done.code == 2:
            found.judge("the form itself", why=f"refused: {done.message}")
    return found


def is_commanding(done):
    return any(c in done.message + done.text for c in "\x1b\x00\u202e\u2066\ufffe")


def session(place, text):
    folder = place.new()
    shutil.copy(place.reduced / "plateaus.csv", folder)
    (folder / "experiment.toml").write_text(text)
    done = run(["calibrate", folder, "--json"], folder)
    shutil.rmtree(folder)
    return done


def certificate(place, text):
    folder = place.new()
    (folder / "laboratory.toml").write_text(text)
    done = run(["report", place.result, "--pdf", "c.pdf", "--dcc", "c.xml", "--laboratory", "laboratory.toml"], folder)
    shutil.rmtree(folder)
    return done


def simulated(place, text):
    folder = place.new()
    (folder / "truth.toml").write_text(text)
    done = run(["simulate", EXAMPLE, "--truth", "truth.toml", "--seed", "1", "--out", "out"], folder)
    shutil.rmtree(folder)
    return done


def planned(place, text):
    folder = place.new()
    (folder / "plan.toml").write_text(text)
    done = run(["plan", "plan.toml", "--out", "out.toml"], folder)
    shutil.rmtree(folder)
    return done


def meanings(place, laboratory):
    """Values that a certificate must not show, and settings that no simulation can have."""
    found = Group("values that cannot be")
    conditions = ["temperature = { value = 20.3, range = 0.5 }", "humidity = { value = 45, range = 5 }", "pressure = { value = 100.9, range = 0.4 }"]
    for line in conditions:
        key = line.split(" ")[0]
        for value, spread in [("nan", 1), ("inf", 1), (20, "nan"), (20, -1), (-300, 1), (1e6, 1), (20, "inf")]:
            text = laboratory.replace(line, f"{key} = {{ value = {value}, range = {spread} }}")
            found.judge(f"{key} = {value}, {spread}", certificate(place, text), codes=(2,))
    for low, high in [("nan", 1), ("-inf", 1), (0, "inf"), (1, 0)]:
        text = laboratory.replace("low = -0.15\nhigh = 0.15", f"low = {low}\nhigh = {high}", 1)
        found.judge(f"limits {low}, {high}", certificate(place, text), codes=(2,))
    truths = ["[machine]\nplateau = 9223372036854775807", "[tachometer]\nrate = 1e308", "[recorder]\nrate = 1e308",
              "[recorder]\ngaps = { probability = 0.1, length = 1e308 }", "[recorder]\nrate = 1e-2", "typical = { size = nan }",
              "typical = { size = 1e300 }", "[parameters]\nG0_11 = 1e300", "[parameters]\nG2_11 = 1e200", "[machine]\nramp = 1e-300",
              "[sensor]\nwhite = 1e308", "[sensor]\nquantum = 1e308", "[machine]\nplateau = 1e7\n[recorder]\nrate = 1e7"]
    for text in truths:
        found.judge(f"truth {text!r}", simulated(place, text), codes=(2,))
    session_text = (place.reduced / "experiment.toml").read_text()
    for prior in ["5e-324", "1e-300", "1e308", "nan", "0", "-1"]:
        done = session(place, session_text + f"\n[prior]\ndrho_22 = {prior}\n")
        found.judge(f"prior {prior}", done, codes=(2,))
    plans = {"loads = { from": "loads = { form", "count = 2": "count = -2", "time = \"8 h\"": "time = 0.5", "\"8 h\"": "inf"}
    for before, after in plans.items():
        done = planned(place, PLAN.replace(before, after, 1))
        why = "a sentence of the parser" if "did not match" in done.message else None
        found.judge(f"plan {after}", done, codes=(2,), why=why)
    yield found

"""Results that were edited by hand: no number of one reaches a document unless it can be what its key says."""

import json
import shutil

from judge import EXAMPLE, Group, parallel, run

EDITS = {
    "a residual beyond numbers": lambda r: r["plateaus"][0]["residual"].__setitem__(1, 1e308),
    "a force beyond numbers": lambda r: r["plateaus"][0].update(specific_force=[1e300, 0, 0]),
    "a variance of zero beside covariances": lambda r: r["plateaus"][1]["covariance"][0].__setitem__(0, 0),
    "a variance below numbers": lambda r: r["plateaus"][1]["covariance"][0].__setitem__(0, 1e-310),
    "a covariance of one side": lambda r: r["plateaus"][0]["covariance"][1].__setitem__(0, 1e18),
    "steps of no length": lambda r: r.update(records=[dict(mounting=1, start=0, step=5e-324, low=[[0]] * 3, high=[[1]] * 3)]),
    "a probability of 2": lambda r: r["validity"].update(probability=2),
    "ten times gravity": lambda r: r["model"].update(gravity=98.1523),
    "gravity below zero": lambda r: r["model"].update(gravity=-9.81523),
    "a parameter twice": lambda r: r["parameters"].append(r["parameters"][0]),
    "a covariance without a row": lambda r: r["covariance"].pop(),
}

# What is so small that a law of chance has no digits for it is a number nevertheless.
TINY = {"the least chi^2": lambda r: r["fit"].update(chi_squared=5e-324)}


def check(place):
    found = Group("results that were edited")
    result = json.loads(place.result.read_text())
    cases = [(what, edit, (2,)) for what, edit in EDITS.items()] + [(what, edit, (0, 1)) for what, edit in TINY.items()]

    def judged(case):
        what, edit, codes = case
        folder, edited = place.new(), json.loads(json.dumps(result))
        edit(edited)
        (folder / "r.json").write_text(json.dumps(edited))
        runs = [
            run(["report", "r.json", "--html", "r.html", "--pdf", "r.pdf", "--laboratory", EXAMPLE / "laboratory.toml"], folder),
            run(["compare", place.result, "r.json"], folder),
            run(["compensate", "r.json", EXAMPLE / "records/m01.csv", "--out", "out.csv"], folder),
            run(["history", "add", "store", "r.json"], folder),
        ]
        shutil.rmtree(folder)
        return [(what, done, codes) for done in runs]

    for what, done, codes in sum(parallel(judged, cases), []):
        found.judge(f"{what}: {done.arguments[0]}", done, codes=codes)
    yield found

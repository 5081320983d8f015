"""Every command has its function, and its document the same bytes."""

import gc
import inspect
import json
import re
import shutil
import subprocess
import time
from pathlib import Path

import centrical as ct
import pytest


@pytest.fixture(autouse=True)
def at_the_root(root, monkeypatch):
    monkeypatch.chdir(root)


SESSION = "examples/ta-200"
PLAN = "examples/plans/four-positions.toml"


@pytest.fixture(scope="module")
def result_file(result, tmp_path_factory):
    file = tmp_path_factory.mktemp("result") / "result.json"
    result.to_json(file)
    return file


def test_calibrate(program):
    for method, option in (("exact", []), ("recursive", ["--method", "recursive"]), ("linear", ["--linear"]),
                           ("recursive-linear", ["--linear", "--method", "recursive"])):
        assert ct.calibrate(SESSION, method=method).to_json() == program("calibrate", SESSION, *option), method
    held_out = program("calibrate", SESSION, "--hold-out", "4:3", "--hold-out", "1:1")
    assert ct.Session(SESSION).calibrate(hold_out=["4:3", "1:1"]).to_json() == held_out


def test_calibrate_into_a_folder(program, tmp_path, root):
    laboratory = f"{SESSION}/laboratory.toml"
    ct.calibrate(SESSION, out=tmp_path / "python", laboratory=laboratory, language="ru")
    program("calibrate", SESSION, "--out", tmp_path / "command", "--laboratory", laboratory, "--language", "ru")
    names = [sorted(str(f.relative_to(tmp_path / side)) for f in (tmp_path / side).rglob("*") if f.is_file()) for side in ("python", "command")]
    assert names[0] == names[1] and "certificate.pdf" in names[0]
    for name in names[0]:
        assert (tmp_path / "python" / name).read_bytes() == (tmp_path / "command" / name).read_bytes(), name


def test_limits_of_the_unit(program, tmp_path):
    laboratory = Path(f"{SESSION}/laboratory.toml")
    assert ct.calibrate(SESSION).within_limits is None
    assert ct.calibrate(SESSION, laboratory=laboratory).within_limits is True
    strict = tmp_path / "laboratory.toml"
    strict.write_text(laboratory.read_text() + '\n[[decision.limit]]\ngroup = "bias"\nwithin = "1 mg"\n')
    result = ct.calibrate(SESSION, laboratory=strict)
    assert result.acceptable and result.within_limits is False
    assert "UNIT NOT WITHIN ITS LIMITS" in str(result)
    result.to_json(tmp_path / "result.json")
    said = ct.report(tmp_path / "result.json", pdf=tmp_path / "c.pdf", laboratory=strict)
    assert said.acceptable and said.within_limits is False
    with pytest.raises(FileNotFoundError):
        ct.calibrate(SESSION, laboratory="nowhere.toml")


def test_observe(program):
    assert ct.observe(SESSION).to_json() == program("observe", SESSION)
    combination = "dR_2[A] + drho_22"
    assert ct.observe(PLAN, [combination]).to_json() == program("observe", PLAN, "--combination", combination)


def test_assess(program):
    assert ct.assess(SESSION).to_json() == program("assess", SESSION)
    options = {"coverage": 0.99, "without_outliers": 0.05, "scale_by_residuals": True, "range": "12 g"}
    command = ["--coverage", "0.99", "--without-outliers", "0.05", "--scale-by-residuals", "--range", "12"]
    assert ct.assess(SESSION, **options).to_json() == program("assess", SESSION, *command)


def test_montecarlo(program):
    given = ct.montecarlo(SESSION, runs=50, seed=7)
    assert given.to_json() == program("montecarlo", SESSION, "--runs", "50", "--seed", "7")
    given = ct.montecarlo(PLAN, runs=50, linear=True, noise_ug=10.0, typical=True, coverage=0.9)
    options = ["--runs", "50", "--linear", "--noise", "10", "--typical", "--coverage", "0.9"]
    assert given.to_json() == program("montecarlo", PLAN, *options)


def test_models(program):
    assert ct.models(SESSION).to_json() == program("models", SESSION)


def test_noise(program, tmp_path):
    given = ct.noise(SESSION, plateau="2:1", out=tmp_path / "python")
    assert given.to_json() == program("noise", SESSION, "--plateau", "2:1", "--out", tmp_path / "command")
    for file in (tmp_path / "command").iterdir():
        assert file.read_bytes() == (tmp_path / "python" / file.name).read_bytes()
    record = f"{SESSION}/records/m01.csv"
    given = ct.noise(record, session=SESSION, estimators=["total", "time"])
    assert given.to_json() == program("noise", record, "--session", SESSION, "--estimators", "total,time")


def test_plan(program, tmp_path):
    file = "examples/03_plan/plan.toml"
    given = ct.plan(file, out=tmp_path / "python.toml")
    assert given.to_json() == program("plan", file, "--out", tmp_path / "command.toml")
    assert (tmp_path / "python.toml").read_bytes() == (tmp_path / "command.toml").read_bytes()
    for time in ("5 h", 18_000.0):
        assert ct.plan(file, time=time).to_json() == program("plan", file, "--time", "5 h")
    assert ct.plan(file, time="5 h").time <= 18_000.0 < given.time
    for wrong in ("5 g", 0.5, "soon"):
        with pytest.raises(ValueError, match="time: found .* expected"):
            ct.plan(file, time=wrong)
    assert len(given.schedule["speed"]) == sum(len(m.plateaus) for m in given.mountings)
    with pytest.raises(ValueError, match="frontier"):
        ct.plan(file, svg=tmp_path / "x.svg")


def test_simulate(program, truth, tmp_path):
    truth = truth(20, 15)
    given = ct.simulate(SESSION, truth, seed=3, out=tmp_path / "python", format="parquet")
    said = program("simulate", SESSION, "--truth", truth, "--seed", "3", "--out", tmp_path / "command", "--format", "parquet")
    assert given.to_json().replace("/python", "/command") == said
    record = "records/m01.parquet"
    assert (tmp_path / "python" / record).read_bytes() == (tmp_path / "command" / record).read_bytes()


def test_compare(program, result, result_file, tmp_path):
    other = tmp_path / "other.json"
    other.write_text(result.to_json().replace('"date": "', '"date": "2', 1))
    given = ct.compare([result_file, other], years=2.0, svg=tmp_path / "drift.svg")
    assert given.to_json() == program("compare", result_file, other, "--years", "2")
    assert (tmp_path / "drift.svg").read_text().startswith("<svg")
    assert ct.compare([result, ct.read_result(result_file)], years=1.0).agree
    for alone in ([result], result, str(result_file)):
        with pytest.raises(ValueError, match="found 1, expected two or more"):
            ct.compare(alone)
    for years in (0.0, -1.0, float("nan"), float("inf")):
        with pytest.raises(ValueError, match="years: found .*, expected a number above 0"):
            ct.compare([result_file, other], years=years)


def test_reduce(program, tmp_path):
    given = ct.reduce(SESSION, tmp_path / "python")
    said = program("reduce", SESSION, "--out", tmp_path / "command")
    assert given.to_json().replace("/python", "/command") == said
    for file in (tmp_path / "command").iterdir():
        assert file.read_bytes() == (tmp_path / "python" / file.name).read_bytes()
    assert ct.calibrate(tmp_path / "python").values.tolist() == ct.calibrate(SESSION).values.tolist()


def test_compensate(program, result_file, tmp_path):
    record = f"{SESSION}/records/m01.csv"
    given = ct.compensate(result_file, record, tmp_path / "python.parquet", session=SESSION, range="120 g")
    options = ["--session", SESSION, "--range", "120 g"]
    said = program("compensate", result_file, record, "--out", tmp_path / "command.parquet", *options)
    assert given.to_json().replace("/python", "/command") == said
    assert (tmp_path / "python.parquet").read_bytes() == (tmp_path / "command.parquet").read_bytes()


def test_report(program, result_file, tmp_path):
    given = ct.report(result_file, html=tmp_path / "python.html", code=tmp_path / "code", range="120 g")
    said = program("report", result_file, "--html", tmp_path / "command.html", "--code", tmp_path / "code", "--range", "120 g")
    assert given.to_json().replace("/python", "/command") == said
    assert (tmp_path / "python.html").read_bytes() == (tmp_path / "command.html").read_bytes()
    for wrong in ({"pdf": "x.pdf"}, {"dcc": "x.xml"}, {"history": "h"}, {"range": 1.0}, {"before": "b"}):
        with pytest.raises(ValueError, match=f"^{next(iter(wrong))}: found no"):
            ct.report(result_file, **wrong)


def test_init(program, tmp_path):
    given = ct.init([f"{SESSION}/records", f"{SESSION}/telemetry"], positions="six")
    assert given.to_json() == program("init", f"{SESSION}/records", f"{SESSION}/telemetry", "--positions", "six")
    written = ct.init(f"{SESSION}/records", out=tmp_path / "experiment.toml")
    assert (tmp_path / "experiment.toml").read_text() == written.text
    with pytest.raises(ct.InputError, match="a file that exists"):
        ct.init(f"{SESSION}/records", out=tmp_path / "experiment.toml")


def test_schema(program):
    for form in ("experiment", "plan", "truth", "laboratory"):
        assert ct.schema(form).to_json() == program("schema", form)


def test_watch(program, tmp_path):
    reduced = tmp_path / "reduced"
    ct.reduce(SESSION, reduced)
    with ct.watch(reduced, tmp_path / "python", once=True, targets=["bias"]) as watched:
        lines = [document.to_json() for document in watched]
    assert "".join(lines) == program("watch", reduced, "--out", tmp_path / "command", "--once")
    assert len(lines) == 108 and watched.result.acceptable
    for name in ("watch.json", "watch-history.jsonl", "watch-history.svg", "result.json"):
        assert (tmp_path / "python" / name).read_bytes() == (tmp_path / "command" / name).read_bytes(), name
    assert list(watched) == []


def test_watch_writes_what_the_live_page_shows(tmp_path):
    reduced = tmp_path / "reduced"
    ct.reduce(SESSION, reduced)
    watched = ct.watch(reduced, tmp_path / "out", once=True, targets={"bias": 0.01}, live=True)
    assert len(list(watched)) == 108
    state = json.loads((tmp_path / "out/watch-live.json").read_text())
    assert (state["arrived"], state["acceptable"]) == (108, True)
    (bias,) = [group for group in state["groups"] if group["group"] == "bias"]
    assert bias["target"] == 0.01
    list(ct.watch(reduced, tmp_path / "without", once=True, targets=["bias"]))
    assert not (tmp_path / "without/watch-live.json").exists()


def test_watch_is_served_while_it_is_held(tmp_path):
    from urllib.request import urlopen

    reduced = tmp_path / "reduced"
    ct.reduce(SESSION, reduced)
    try:
        watched = ct.watch(reduced, tmp_path / "out", once=True, serve="127.0.0.1:0")
    except ValueError as error:
        # As wheels are built.
        assert "found the address 127.0.0.1:0, expected none in a package that was built without the feature" in str(error)
        return
    lines = list(watched)
    assert watched.url.startswith("http://127.0.0.1:") and len(lines) == 108
    with urlopen(watched.url + "state.json", timeout=10) as answer:
        assert json.load(answer)["arrived"] == 108
    url, watched = watched.url, None
    gc.collect()
    with pytest.raises(OSError):
        urlopen(url, timeout=1)
    with pytest.raises(ValueError, match="--serve nowhere"):
        ct.watch(reduced, tmp_path / "out", once=True, serve="nowhere")


def test_watch_calls_at_an_alarm(tmp_path):
    session = tmp_path / "session"
    ct.reduce(SESSION, session)
    table = (session / "plateaus.csv").read_text().splitlines()
    # The first reading of a late plateau is off by 0.1 m/s^2.
    header = table[0].split(",")
    row = table[100].split(",")
    column = header.index("mean_1")
    row[column] = repr(float(row[column]) + 0.1)
    table[100] = ",".join(row)
    (session / "plateaus.csv").write_text("\n".join(table) + "\n")
    heard = []
    lines = list(ct.watch(session, tmp_path / "out", once=True, on_alarm=lambda *alarm: heard.append(alarm)))
    assert len(heard) == sum(line.alarm for line in lines)
    assert heard and all(kind == "plateau" and "does not fit: a chance of " in found for kind, found in heard), heard
    command = 'echo "$CENTRICAL_ALARM $CENTRICAL_MESSAGE" >> ' + str(tmp_path / "alarms.txt")
    list(ct.watch(session, tmp_path / "again", once=True, on_alarm=command))
    wanted = [" ".join(alarm) for alarm in heard]
    deadline = time.monotonic() + 10.0
    while time.monotonic() < deadline:
        alarms = tmp_path / "alarms.txt"
        said = alarms.read_text().splitlines() if alarms.exists() else []
        if sorted(said) == sorted(wanted):
            return
        time.sleep(0.05)
    pytest.fail(f"{said} {wanted}")


def test_watch_says_what_it_waits_for(tmp_path):
    session = tmp_path / "session"
    shutil.copytree(SESSION, session)
    shutil.rmtree(session / "records")
    watched = ct.Session(session).watch(tmp_path / "out", once=True)
    assert list(watched) == [] and watched.result is None and "m01.csv" in watched.waiting


@pytest.fixture(scope="module")
def store(result_file, tmp_path_factory):
    """Three calibrations each of two units."""
    folder = tmp_path_factory.mktemp("history")
    document = json.loads(result_file.read_text())
    for n, serial in enumerate(["0001", "0002"] * 3):
        document["session"] |= {"date": f"{2020 + n}-01-01", "unit_serial": serial}
        for parameter in document["parameters"]:
            if parameter["value"] is not None:
                parameter["value"] += 0.3 * (-1) ** n * parameter["standard_uncertainty"]
        (folder / f"{n}.json").write_text(json.dumps(document))
    assert ct.add_to_store(folder / "store", folder.glob("*.json")) == (6, 0)
    return folder / "store"


def test_history(program, store, tmp_path):
    listed = ct.history(store, "list", check=True)
    assert listed.to_json() == program("history", "list", store, "--check") and listed.doubts
    assert ct.history(store, "list", serial="0002").to_json() == program("history", "list", store, "--serial", "0002")
    given = ct.history(store, serial="0001", limit="300 ug", until="2030-01-01", confidence=0.9, trend=False, together=True, out=tmp_path / "python")
    options = ["--limit", "300 ug", "--until", "2030-01-01", "--confidence", "0.9", "--without-trend", "--together"]
    assert given.to_json() == program("history", "unit", store, "--serial", "0001", *options, "--out", tmp_path / "command")
    assert_same_files(tmp_path)
    batches = tmp_path / "batches.csv"
    batches.write_text("serial,batch\n0001,a\n0002,b\n")
    laboratory = f"{SESSION}/laboratory.toml"
    given = ct.history([store], "units", laboratory=laboratory, batches=batches)
    assert given.to_json() == program("history", "units", store, "--laboratory", laboratory, "--batches", batches)
    assert ct.history(store, "station").to_json() == program("history", "station", store)


def test_results_in_memory_are_added(example, tmp_path):
    result = ct.calibrate(example)
    result.to_json(tmp_path / "result.json")
    assert ct.add_to_store(tmp_path / "store", result) == (1, 0)
    assert ct.add_to_store(tmp_path / "store", [tmp_path / "result.json", result]) == (0, 2)
    copy = next((tmp_path / "store" / "results").iterdir())
    assert copy.read_bytes() == (tmp_path / "result.json").read_bytes()
    assert ct.add_to_store(tmp_path / "rows", [result], rows_only=True) == (1, 0)
    assert not (tmp_path / "rows" / "results").exists()


def test_what_a_history_is_not_asked(store):
    for wrong, said in (
        (lambda: ct.history(store, "years"), 'of: found \'years\', expected "list"'),
        (lambda: ct.history(store, "station", limit=1.0), "limit: found it for 'station', expected it for 'unit' alone"),
        (lambda: ct.history(store, "station", confidence=0.95), "confidence: found it for 'station', expected it for 'unit' alone"),
        (lambda: ct.history(store, limit=0.0), "limit: found 0.0, expected an acceleration above zero"),
        (lambda: ct.write_pages(store, "pages", limit="-1 ug"), "limit: found "),
        (lambda: ct.history(store, check=True), "check: found it for 'unit', expected it for 'list' alone"),
        (lambda: ct.history([], "unit"), "results: found none, expected a store"),
        (lambda: ct.history([store, store], "list"), "results: found 2, expected one store"),
        (lambda: ct.history(store), "expected calibrations of one, by --serial and --model"),
        (lambda: ct.history(store, serial="0001", on="2020-01-01"), "found --on 2020-01-01, expected "),
        (lambda: ct.control_chart("df_1", store, limits=(0.0, -1.0)), "deviation: found -1 about 0, expected"),
        (lambda: ct.control_chart("df_9", store), "no session that determines df_9"),
    ):
        with pytest.raises(ValueError, match=re.escape(said)):
            wrong()


def test_models_and_stations_are_not_mixed(result_file, tmp_path):
    document = json.loads(result_file.read_text())
    for n in range(4):
        document["session"] |= {"date": f"{2020 + n}-01-01", "unit_model": ["even", "odd"][n % 2], "station": "NS"[n // 2]}
        (tmp_path / f"{n}.json").write_text(json.dumps(document))
    files = sorted(tmp_path.glob("*.json"))
    models, stations = 'found "even", "odd", expected one, by --model', 'found "N", "S", expected one, by --station'
    for wrong, said in (
        (lambda: ct.history(files, "units"), models),
        (lambda: ct.history(files, "station"), stations),
        (lambda: ct.control_chart("df_1", files), models),
        (lambda: ct.control_chart("df_1", files, model="even"), stations),
    ):
        with pytest.raises(ct.InputError, match=re.escape(said)):
            wrong()


def test_control_chart(program, store, tmp_path):
    given = ct.control_chart("df_1", store, accepted=4, rules="western-electric", out=tmp_path / "python")
    options = ["--accepted", "4", "--rules", "western-electric", "--out", tmp_path / "command"]
    assert given.to_json() == program("history", "chart", "df_1", store, *options)
    assert given.values == given["values"] and isinstance(given.values, list)
    assert_same_files(tmp_path)
    stated = program("history", "chart", "df_1", store, "--centre", "-0.01", "--deviation", "0.001")
    assert ct.control_chart("df_1", store, limits=(-0.01, 0.001)).to_json() == stated


def test_pages_of_a_store(executable, store, tmp_path):
    pages = ct.write_pages(store, tmp_path / "python", limit="300 ug", accepted=4)
    command = [executable, "history", "page", store, "--out", tmp_path / "command", "--limit", "300 ug", "--accepted", "4"]
    subprocess.run(command, check=True, capture_output=True)
    assert pages == assert_same_files(tmp_path) == 6


def assert_same_files(folder):
    """The folders of both have the same files; how many."""
    names = sorted(file.name for file in (folder / "command").iterdir())
    assert names == sorted(file.name for file in (folder / "python").iterdir())
    for name in names:
        assert (folder / "python" / name).read_bytes() == (folder / "command" / name).read_bytes(), name
    return len(names)


def test_every_command_has_its_function(root, executable):
    commands = set(all_commands(executable)) - {"completions", "man", "view"}
    assert {"calibrate", "history page"} <= commands
    rows = re.findall(r"^\| `([a-z -]+)[^`]*` \| `ct\.(\w+)\(", (root / "docs/python.md").read_text(), re.MULTILINE)
    assert sorted(command.strip() for command, _ in rows) == sorted(commands)
    for _, name in rows:
        assert inspect.isfunction(getattr(ct, name)) and getattr(ct, name).__doc__, name


def all_commands(executable, *of):
    """The commands of the program and their subcommands, by its help."""
    helped = subprocess.run([executable, *of, "--help"], check=True, capture_output=True, text=True).stdout
    if not re.search(r"^Usage: .* <COMMAND>$", helped, re.MULTILINE):
        return [" ".join(of)]
    names = set(re.findall(r"^  ([a-z-]+)(?: {2,}|$)", helped, re.MULTILINE)) - {"help"}
    assert names
    return [command for name in names for command in all_commands(executable, *of, name)]


def test_arguments_are_checked(result):
    for call in (
        lambda: ct.calibrate(SESSION, method="best"),
        lambda: ct.calibrate(SESSION, hold_out=["four"]),
        lambda: ct.calibrate(SESSION, language="de"),
        lambda: ct.reduce(SESSION, "x", format="xls"),
        lambda: ct.assess(SESSION, coverage=1.0),
        lambda: ct.assess(SESSION, range="12 bananas"),
        lambda: ct.noise(SESSION, estimators=["adev"]),
        lambda: ct.noise(SESSION, rate=-1.0),
        lambda: ct.schema("session"),
        lambda: ct.watch(SESSION, "x", interval=-1.0),
        lambda: ct.montecarlo(SESSION, runs=-5),
        lambda: ct.montecarlo(SESSION, runs=1 << 64),
        lambda: ct.montecarlo(SESSION, seed=-1),
        lambda: ct.simulate("x", "x", seed=-1, out="x"),
        lambda: ct.series([SESSION], "x", jobs=-2),
        lambda: result.summary(-1),
        lambda: ct.control_chart("alpha_1", "x", accepted=-1),
        lambda: ct.write_pages("x", "x", accepted=-1),
        lambda: ct.noise([float(n % 7) for n in range(64)], rate=100.0).deviation("oadev", 7),
        lambda: ct.set_threads(100_000),
        lambda: ct.set_threads(0),
        lambda: ct.set_threads(-1),
    ):
        with pytest.raises(ValueError, match="found .* expected"):
            call()
    # The limits of the commands.
    for wrong in (0.0, -1.0, 1e300, "0 g", "-1e3 m/s^2"):
        with pytest.raises(ValueError, match="range: found .* expected a number above 0 and up to 1e6 g"):
            ct.assess(SESSION, range=wrong)
    for wrong in (0.0, -3.0, 1e7, float("nan")):
        with pytest.raises(ValueError, match="noise_ug: found .* expected a number above 0 and up to 1e6"):
            ct.montecarlo(SESSION, noise_ug=wrong)
    with pytest.raises(TypeError, match="expected a list of texts"):
        ct.calibrate(SESSION, hold_out="4:3")

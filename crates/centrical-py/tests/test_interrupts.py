"""Ctrl-C: every long function ends with KeyboardInterrupt, at once, and leaves nothing half done."""

import json
import os
import re
import shutil
import signal
import sys
import threading
import time

import centrical as ct
import numpy as np
import pytest

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals of this kind are those of Unix")

#: Seconds from a signal to the exception, on a machine that has nothing else to do.
AT_MOST = 0.2

#: Seconds in which such a machine adds half a million squares.
ADDED = 0.015

#: When signals come, as parts of the time that the work takes undisturbed.
MOMENTS = np.random.default_rng(20).uniform(size=4)


def bound():
    """Seconds from a signal to the exception on this machine as it is now: it may be slow, or have other work."""
    begun = time.monotonic()
    sum(n * n for n in range(500_000))
    return AT_MOST * min(max((time.monotonic() - begun) / ADDED, 1.0), 25.0)


def assert_in_time(call, after=0.3):
    """Work that does not end by itself, interrupted: a busy machine is late now and then, work that does not ask is late always."""
    late = []
    for _ in range(3):
        took = signalled(call, after)
        assert took is not None, f"found a call that ended within {after:.1e} s, expected an endless one"
        if took < bound():
            return
        late.append(took)
    pytest.fail(f"found {late} s from the signal {after:.2f} s after the beginning, expected {bound():.2f} s")


def assert_in_time_throughout(call, between=lambda: None):
    """The same of work that ends by itself, at random moments. ``between`` clears away what a whole call leaves."""
    begun = time.monotonic()
    call()
    whole = time.monotonic() - begun
    for moment in MOMENTS:
        after, late = moment * whole, []
        for _ in range(10):
            between()
            took = signalled(call, after)
            if took is not None and took < bound():
                break
            if took is None:
                # This time the work was faster.
                after *= 0.7
            else:
                late.append(took)
            if len(late) == 3:
                pytest.fail(f"found {late} s from the signal {after:.2f} of {whole:.2f} s on, expected {bound():.2f} s")
        else:
            pytest.fail(f"found a call that ended within {after:.1e} s, expected a longer one")


def signalled(call, after):
    """Seconds from the signal to the exception; nothing if the call ended before the signal."""
    sent, ended = [], threading.Event()

    def send():
        if not ended.wait(after):
            sent.append(time.monotonic())
            os.kill(os.getpid(), signal.SIGINT)

    sender = threading.Thread(target=send)
    sender.start()
    try:
        call()
        ended.set()
        # A signal that is on its way arrives here, too late.
        sender.join()
        time.sleep(1.0 if sent else 0.0)
        return None
    except KeyboardInterrupt:
        return None if ended.is_set() else time.monotonic() - sent[0]
    finally:
        ended.set()
        sender.join()


@pytest.fixture(scope="module")
def long_session(example, truth, tmp_path_factory):
    """The example with thirty times as many samples."""
    folder = tmp_path_factory.mktemp("long") / "session"
    ct.simulate(example, truth(500, 60), seed=1, out=folder)
    return folder


@pytest.fixture(scope="module")
def long_record(tmp_path_factory):
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    n = 3_000_000
    columns = {"t": np.arange(n) / 100.0}
    columns.update({name: np.random.default_rng(1).normal(size=n) for name in ("f1", "f2", "f3")})
    file = tmp_path_factory.mktemp("record") / "long.parquet"
    parquet.write_table(pyarrow.table(columns), file)
    return file


def test_montecarlo(example):
    assert_in_time(lambda: ct.montecarlo(example, runs=10_000_000))


def test_plan(root):
    assert_in_time_throughout(lambda: ct.plan(root / "examples/plans/best.toml", certify=True))


@pytest.mark.parametrize("name", ["calibrate", "observe", "assess", "models", "montecarlo", "noise"])
def test_sessions(long_session, name):
    options = {"runs": 500} if name == "montecarlo" else {}
    assert_in_time_throughout(lambda: getattr(ct, name)(long_session, **options))


@pytest.fixture(scope="module")
def long_campaign(example, truth, tmp_path_factory):
    """The example with 414 loads a mounting, 4968 plateaus in all, already averaged."""
    folder = tmp_path_factory.mktemp("campaign")
    text = (example / "experiment.toml").read_text()
    loads = "".join(f'  {{ speed = "{133.0 + 465.0 * n / 414:.3f} rpm" }},\n' for n in range(414))
    plan = re.sub(r"plateaus = \[\n.*?\n\]", lambda _: f"plateaus = [\n{loads}]", text, flags=re.DOTALL)
    (folder / "plan").mkdir()
    (folder / "plan" / "experiment.toml").write_text(plan)
    ct.simulate(folder / "plan", truth(20, 20), seed=1, out=folder / "records")
    ct.reduce(folder / "records", folder / "means")
    return folder / "means"


def test_calibrate_of_thousands_of_plateaus(long_campaign, tmp_path):
    out = tmp_path / "out"
    assert_in_time_throughout(lambda: ct.Session(long_campaign).calibrate())
    assert_in_time_throughout(lambda: ct.Session(long_campaign).calibrate(out=out), lambda: shutil.rmtree(out, ignore_errors=True))


def test_models_between_rivals(example):
    assert_in_time_throughout(lambda: ct.models(example))


def test_reduce(long_session, tmp_path):
    assert_nothing_half_done(lambda out: ct.reduce(long_session, out), tmp_path)


def test_simulate(example, truth, tmp_path):
    file = truth(500, 60)

    def simulate(out):
        ct.simulate(example, file, seed=1, out=out)

    # Records that are whole may be there; without the experiment they are no session.
    assert_nothing_half_done(simulate, tmp_path, lambda files: "experiment.toml" not in files)


def test_compensate(result, long_record, tmp_path):
    file = tmp_path / "result.json"
    result.to_json(file)

    def compensate(out):
        out.mkdir()
        ct.compensate(file, long_record, out / "forces.csv")

    assert_nothing_half_done(compensate, tmp_path)


def assert_nothing_half_done(job, folder, is_nothing=lambda files: not files):
    """A job that writes the folder it is given: after a signal there is nothing, or all, if it came when all was done."""
    out = folder / "out"
    whole = []

    def call():
        job(out)
        whole.append(files_in(out))

    def check():
        there = files_in(out)
        assert is_nothing(there) or there == whole[0], there
        shutil.rmtree(out, ignore_errors=True)

    assert_in_time_throughout(call, check)
    check()


def files_in(folder):
    """Names and sizes of the files in a folder."""
    return {str(file.relative_to(folder)): file.stat().st_size for file in folder.rglob("*") if file.is_file()}


def test_noise_of_a_long_record(long_record):
    assert_in_time_throughout(lambda: ct.noise(long_record))


def test_noise_of_an_array():
    readings = np.random.default_rng(1).normal(size=(2_000_000, 3))
    assert_in_time_throughout(lambda: ct.noise(readings, rate=100.0))


def test_tumble(root):
    assert_in_time_throughout(lambda: ct.tumble(root / "examples/tumble/record.csv", gravity=9.81523))


@pytest.fixture(scope="module")
def hundreds_of_rests(tmp_path_factory):
    """A record of a unit that is turned by hand and left alone 240 times."""
    random = np.random.default_rng(24)
    rests, samples, turning = 240, 100, 30
    up = random.normal(size=(rests, 3))
    up /= np.linalg.norm(up, axis=1)[:, None]
    there = np.minimum(np.arange(samples + turning) / turning, 1.0)[None, :, None]
    way = (1.0 - there) * np.roll(up, 1, axis=0)[:, None] + there * up[:, None]
    force = (9.81523 * way / np.linalg.norm(way, axis=2)[:, :, None]).reshape(-1, 3)
    readings = 1.001 * force + 0.02 + 2e-3 * random.normal(size=force.shape)
    record = np.column_stack([np.arange(len(readings)) / 50.0, readings])
    file = tmp_path_factory.mktemp("rests") / "record.csv"
    np.savetxt(file, record, delimiter=",", header="t,f1,f2,f3", comments="", fmt="%.6f")
    return file


def test_tumble_of_hundreds_of_rests(hundreds_of_rests):
    assert len(ct.tumble(hundreds_of_rests, gravity=9.81523).names) > 400
    assert_in_time_throughout(lambda: ct.tumble(hundreds_of_rests, gravity=9.81523))


def test_watch_that_reads_rests(example, hundreds_of_rests, tmp_path):
    table = np.loadtxt(hundreds_of_rests, delimiter=",", skiprows=1)
    # At 20 kHz: it takes a while to read, and has few rests.
    assert_watch_in_time_throughout(example, np.repeat(table[: 12 * 130], 400, axis=0), 20000.0, tmp_path)


def test_watch_of_hundreds_of_rests(example, hundreds_of_rests, tmp_path):
    table = np.loadtxt(hundreds_of_rests, delimiter=",", skiprows=1)
    assert_watch_in_time_throughout(example, table[: 160 * 130], 50.0, tmp_path)


def assert_watch_in_time_throughout(example, record, rate, tmp_path):
    """Of the example with a record of rests, at `rate` samples a second."""
    session, out = shutil.copytree(example, tmp_path / "session"), tmp_path / "out"
    record[:, 0] = np.arange(len(record)) / rate
    np.savetxt(session / "tumble.csv", record, delimiter=",", header="t,f1,f2,f3", comments="", fmt="%.6f")
    with (session / "experiment.toml").open("a") as file:
        file.write('\n[[tumble]]\nrecord = "tumble.csv"\n')

    def watch():
        with ct.watch(session, out, once=True, quiet=0.0) as watched:
            assert len(list(watched)) > 108

    assert_in_time_throughout(watch, lambda: shutil.rmtree(out, ignore_errors=True))


def test_series(example, long_session, tmp_path):
    out = tmp_path / "store"
    assert_in_time_throughout(lambda: ct.series([example, long_session], out), lambda: shutil.rmtree(out, ignore_errors=True))


def test_history_and_comparison(result, tmp_path):
    result.to_json(tmp_path / "result.json")
    document = json.loads((tmp_path / "result.json").read_text())
    for n in range(100):
        document["session"]["date"] = f"{1900 + n}-01-01"
        (tmp_path / f"{n}.json").write_text(json.dumps(document))
    (tmp_path / "result.json").unlink()
    store, files = tmp_path / "store", sorted(tmp_path.glob("*.json"))
    assert_in_time_throughout(lambda: ct.add_to_store(store, files), lambda: shutil.rmtree(store, ignore_errors=True))
    assert_in_time_throughout(lambda: ct.compare(files))
    ct.add_to_store(store, files)
    for of in ("unit", "station"):
        assert_in_time_throughout(lambda of=of: ct.history(store, of))
    assert_in_time_throughout(lambda: ct.history(store, "list", check=True))
    pages = tmp_path / "pages"
    assert_in_time_throughout(lambda: ct.write_pages(store, pages), lambda: shutil.rmtree(pages, ignore_errors=True))


def test_watch(example, tmp_path):
    # Files of today: old ones are complete, and the watch ends.
    session = shutil.copytree(example, tmp_path / "session", copy_function=shutil.copyfile)
    with ct.watch(session, tmp_path / "out", interval=60.0, quiet=3600.0) as watched:
        assert_in_time(lambda: list(watched), 1.5)
    # It goes on from its state.
    with ct.watch(session, tmp_path / "out", once=True, quiet=0.0) as watched:
        list(watched)
    assert watched.result.acceptable


def test_watch_while_it_reads(long_session, tmp_path):
    out = tmp_path / "out"

    def watch():
        with ct.watch(long_session, out, once=True, quiet=0.0) as watched:
            assert len(list(watched)) == 108

    assert_in_time_throughout(watch, lambda: shutil.rmtree(out, ignore_errors=True))


def test_arrays(example, long_session):
    pandas = pytest.importorskip("pandas")
    tables = [pandas.read_csv(file).to_numpy() for file in sorted((long_session / "records").glob("*.csv"))]
    session = ct.Session.from_arrays(long_session, [(table[:, 0], table[:, 1:]) for table in tables])
    assert_in_time_throughout(session.calibrate)


def test_a_handler_of_ones_own(example):
    class Enough(Exception):
        pass

    def handler(*_):
        raise Enough

    before = signal.signal(signal.SIGALRM, handler)
    signal.setitimer(signal.ITIMER_REAL, 0.2)
    try:
        with pytest.raises(Enough):
            ct.montecarlo(example, runs=10_000_000)
    finally:
        signal.signal(signal.SIGALRM, before)


def test_a_bar_that_fails_stops_the_work(example):
    from centrical import _native

    def shown(done, everything):
        assert done <= everything
        raise RuntimeError("a bar that fails")

    with pytest.raises(RuntimeError, match="a bar that fails"):
        _native.montecarlo(example, 10_000_000, 1, 0.95, False, None, False, shown)


def test_after_an_interrupt_all_goes_on(example):
    assert_in_time(lambda: ct.montecarlo(example, runs=10_000_000), 0.1)
    assert ct.montecarlo(example, runs=20).runs == 20

"""Ctrl-C: every long function ends with KeyboardInterrupt, at once, and leaves nothing half done."""

import os
import shutil
import signal
import sys
import threading
import time

import centrical as ct
import numpy as np
import pytest

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals of this kind are those of Unix")

#: Seconds; a loaded machine of two processors that runs a debugger of its own takes longer than the 0.2 of the page.
AT_MOST = float(os.environ.get("CENTRICAL_INTERRUPT_SECONDS", "0.5"))


def interrupted(call, after=0.3):
    """Seconds from the signal to the exception, of work that does not end by itself."""
    took = signalled(call, after)
    assert took is not None, f"found a call that ended within {after:.1e} s, expected an endless one"
    return took


def interrupted_half_way(call, between=lambda: None):
    """The same of work that ends by itself, on a machine of any speed: the signal comes at a third of the time that it takes
    undisturbed, and sooner where a second call is much faster. ``between`` clears away what a whole call leaves."""
    begun = time.monotonic()
    call()
    after = (time.monotonic() - begun) / 3.0
    for _ in range(10):
        between()
        took = signalled(call, after)
        if took is not None:
            return took
        after /= 2.0
    pytest.fail(f"found a call that ended within {2.0 * after:.1e} s, expected a longer one")


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
    assert interrupted(lambda: ct.montecarlo(example, runs=10_000_000)) < AT_MOST


def test_plan(root):
    assert interrupted_half_way(lambda: ct.plan(root / "examples/plans/best.toml", certify=True)) < AT_MOST


@pytest.mark.parametrize("name", ["calibrate", "observe", "assess", "models", "montecarlo", "noise"])
def test_sessions(long_session, name):
    options = {"runs": 500} if name == "montecarlo" else {}
    assert interrupted_half_way(lambda: getattr(ct, name)(long_session, **options)) < AT_MOST


def test_models_between_rivals(example):
    assert interrupted_half_way(lambda: ct.models(example)) < AT_MOST


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

    assert interrupted_half_way(call, lambda: shutil.rmtree(out, ignore_errors=True)) < AT_MOST
    there = files_in(out)
    assert is_nothing(there) or there == whole[0], there


def files_in(folder):
    """Names and sizes of the files in a folder."""
    return {str(file.relative_to(folder)): file.stat().st_size for file in folder.rglob("*") if file.is_file()}


def test_noise_of_a_long_record(long_record):
    # A third of the time is past the reading, in the analysis.
    assert interrupted_half_way(lambda: ct.noise(long_record)) < AT_MOST


def test_watch(example, tmp_path):
    # Files of today: old ones are complete, and the watch ends.
    session = shutil.copytree(example, tmp_path / "session", copy_function=shutil.copyfile)
    with ct.watch(session, tmp_path / "out", interval=60.0, quiet=3600.0) as watched:
        assert interrupted(lambda: list(watched), 1.5) < AT_MOST
    # It goes on from its state.
    with ct.watch(session, tmp_path / "out", once=True, quiet=0.0) as watched:
        list(watched)
    assert watched.result.acceptable


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
    interrupted(lambda: ct.montecarlo(example, runs=10_000_000), 0.1)
    assert ct.montecarlo(example, runs=20).runs == 20

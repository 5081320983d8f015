"""Ctrl-C: every long function ends with KeyboardInterrupt, at once, and leaves nothing half done."""

import os
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
    """Seconds from the signal to the exception."""
    sent = []

    def send():
        time.sleep(after)
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    sender = threading.Thread(target=send)
    sender.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            call()
            # A call that was too short for the signal.
            sender.join()
            time.sleep(1.0)
            pytest.fail("found a call that ended before the signal, expected a longer one")
        took = time.monotonic() - sent[0]
    finally:
        sender.join()
    print(f"{took:.3f} s", end=" ")
    return took


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
    assert interrupted(lambda: ct.plan(root / "examples/plans/best.toml", certify=True)) < AT_MOST


@pytest.mark.parametrize("name", ["calibrate", "reduce", "observe", "assess", "models", "montecarlo", "noise"])
def test_sessions(long_session, tmp_path, name):
    calls = {"reduce": lambda: ct.reduce(long_session, tmp_path / "out")}
    call = calls.get(name, lambda: getattr(ct, name)(long_session))
    assert interrupted(call, 0.15) < AT_MOST
    assert not (tmp_path / "out").exists() or not list((tmp_path / "out").iterdir())


def test_models_between_rivals(example):
    assert interrupted(lambda: ct.models(example), 0.4) < AT_MOST


def test_simulate(example, truth, tmp_path):
    file = truth(500, 60)
    assert interrupted(lambda: ct.simulate(example, file, seed=1, out=tmp_path / "out"), 0.15) < AT_MOST
    assert not (tmp_path / "out" / "experiment.toml").exists()


def test_compensate(result, long_record, tmp_path):
    result.to_json(tmp_path / "result.json")
    out = tmp_path / "out.csv"
    assert interrupted(lambda: ct.compensate(tmp_path / "result.json", long_record, out)) < AT_MOST
    assert [file.name for file in tmp_path.iterdir()] == ["result.json"]


def test_noise_of_a_long_record(long_record):
    # Reading is stopped at once; the analysis after it, some seconds, goes on to its end.
    assert interrupted(lambda: ct.noise(long_record)) < 30.0


def test_watch(example, tmp_path):
    with ct.watch(example, tmp_path, interval=60.0, quiet=3600.0) as watched:
        assert interrupted(lambda: list(watched), 1.5) < AT_MOST
    # It goes on from its state.
    with ct.watch(example, tmp_path, once=True, quiet=0.0) as watched:
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

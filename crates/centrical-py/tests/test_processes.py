"""Fork and spawn, threads, a Python without NumPy."""

import multiprocessing
import os
import subprocess
import sys
import threading
import time

import centrical as ct
import numpy as np
import pytest


def work(example):
    return ct.calibrate(example).to_json()


def compensated(pair):
    result, readings = pair
    return result.compensate(readings)


def runs_that_take(seconds, example):
    """Calibrations that keep this machine, fast or slow, busy for some seconds."""
    begun = time.monotonic()
    ct.montecarlo(example, runs=200)
    return round(200 * seconds / (time.monotonic() - begun))


def python(text, *arguments, **options):
    command = [sys.executable, "-W", "ignore::DeprecationWarning", "-c", text, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, **options)


def test_spawn(example, result, readings):
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        assert pool.map(work, [example] * 2) == [result.to_json()] * 2
        forces = pool.map(compensated, [(result, readings)] * 2)
    assert all(np.array_equal(f, result.compensate(readings)) for f in forces)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="a system without fork")
def test_fork_before_the_first_call(example):
    done = python(
        """
import multiprocessing, sys
import centrical as ct

def work(example):
    return len(ct.calibrate(example))

with multiprocessing.get_context("fork").Pool(2) as pool:
    print(pool.map(work, [sys.argv[1]] * 3))
""",
        example,
    )
    assert done.stdout == "[49, 49, 49]\n", done.stderr


@pytest.mark.skipif(not hasattr(os, "fork"), reason="a system without fork")
def test_fork_after_the_first_call(example):
    done = python(
        """
import multiprocessing, sys
import centrical as ct
import numpy as np

result = ct.calibrate(sys.argv[1])
readings = np.ones((100_000, 3))
expected = result.compensate(readings)

def work(example):
    # Compensation needs no threads; what needs them says so.
    same = np.array_equal(result.compensate(readings), expected)
    try:
        ct.calibrate(example)
    except RuntimeError as error:
        return same, "spawn" in str(error)

with multiprocessing.get_context("fork").Pool(2) as pool:
    print(pool.map(work, [sys.argv[1]] * 2))
""",
        example,
    )
    assert done.stdout == "[(True, True), (True, True)]\n", done.stderr


def test_from_many_threads(example, result):
    texts = []
    threads = [threading.Thread(target=lambda: texts.append(work(example))) for _ in range(4)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert texts == [result.to_json()] * 4


def test_other_threads_run_meanwhile(example):
    count, stop = [0], threading.Event()

    def tick():
        while not stop.wait(0.001):
            count[0] += 1

    ticking = threading.Thread(target=tick)
    runs = runs_that_take(0.5, example)
    ticking.start()
    ct.montecarlo(example, runs=runs)
    stop.set()
    ticking.join()
    assert count[0] > 5


def test_without_numpy(tmp_path):
    (tmp_path / "numpy.py").write_text("raise ImportError('found no NumPy')\n")
    folder = os.path.dirname(os.path.dirname(ct.__file__))
    done = python(
        """
try:
    import centrical
except ImportError as error:
    print("ImportError", error)
""",
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), folder])},
    )
    assert done.stdout.startswith("ImportError found no NumPy"), done.stderr


def test_number_of_threads(example, result):
    done = python(
        """
import sys
import centrical as ct
ct.set_threads(1)
sys.stdout.write(ct.calibrate(sys.argv[1]).to_json())
try:
    ct.set_threads(2)
except RuntimeError as error:
    sys.stderr.write(str(error))
""",
        example,
    )
    assert done.stdout == result.to_json() and "before the first call" in done.stderr


def test_the_end_of_the_interpreter_during_a_watch(example, tmp_path):
    done = python(
        """
import sys
import centrical as ct
watched = ct.watch(sys.argv[1], sys.argv[2], interval=3600.0, quiet=0.0)
next(watched)
""",
        example,
        tmp_path,
    )
    assert done.returncode == 0, done.stderr


def test_no_bar_where_nobody_looks(example):
    done = python("import sys, centrical as ct; ct.montecarlo(sys.argv[1], runs=500)", example)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.skipif(not hasattr(os, "fork"), reason="a system without terminals of this kind")
def test_a_bar_on_a_terminal(example):
    import pty

    leader, follower = pty.openpty()
    text = "import sys, centrical as ct; ct.montecarlo(sys.argv[1], runs=int(sys.argv[2]))"
    # The bar comes after half a second.
    runs = runs_that_take(3.0, example)
    process = subprocess.Popen([sys.executable, "-c", text, str(example), str(runs)], stderr=follower)
    os.close(follower)
    said = b""
    try:
        while chunk := os.read(leader, 4096):
            said += chunk
    except OSError:
        pass
    assert process.wait() == 0
    assert b"calibrating [" in said and b"%, " in said and said.endswith(b"\x1b[K")

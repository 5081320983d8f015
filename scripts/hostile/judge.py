"""Runs of the program, and how they are judged."""

import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "ta-200"
PROGRAM = os.environ.get("CENTRICAL_PROGRAM", str(ROOT / "target" / "release" / "centrical"))

# So wide that no sentence is folded: cases look for whole ones.
os.environ["COLUMNS"] = "1000"

# A run that takes more processor time hangs, and so does one that has not ended by then [s]: a machine that others load is slow, and
# no fault of the program. One that takes more fills the memory [bytes].
LONGEST = 10.0
PATIENCE = 60.0
LARGEST = 1 << 30

# What an error message has: where, what was found, what was expected; or what the system refused.
REFUSALS = [("found ", "expected "), ("cannot be written: ",), ("cannot be read: ",), ("not found: looked for ", "seen: ")]


class Run:
    """A run that has ended."""

    def __init__(self, arguments, code, out, err, seconds, processor, memory):
        self.arguments, self.code, self.memory = arguments, code, memory
        self.seconds, self.processor = seconds, processor
        self.out, self.err = out, err

    @property
    def message(self):
        return self.err.decode("utf-8", "replace")

    @property
    def text(self):
        return self.out.decode("utf-8", "replace")

    def badly(self, codes=(0, 1, 2)):
        """Why the run is judged badly, or nothing."""
        if "panicked" in self.message or self.code in (101, 134, -6, -11):
            return f"panic (code {self.code})"
        if self.processor > LONGEST or self.seconds > PATIENCE:
            return f"hang: {self.seconds:.1f} s, {self.processor:.1f} s of them at work"
        if self.memory > LARGEST:
            return f"memory: {self.memory >> 20} MB"
        if self.code not in codes:
            return f"exit code {self.code}, expected one of {codes}"
        if self.code == 2 and not self.usage() and not any(all(p in self.message for p in parts) for parts in REFUSALS):
            return "a message without found and expected"
        return None

    def usage(self):
        return self.message.startswith("error: ")


def run(arguments, folder, stdin=None, stdout=None, stderr=None, file_size=None, timeout=PATIENCE + 1, before=None):
    """Runs the program in a folder. Streams not given are kept; `before` runs in the child before it."""
    out = tempfile.TemporaryFile() if stdout is None else stdout
    err = tempfile.TemporaryFile() if stderr is None else stderr

    def prepare():
        os.setsid()
        if file_size is not None:
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (file_size, file_size))
        if before:
            before()

    begun = time.monotonic()
    arguments = [str(a) for a in arguments]
    child = subprocess.Popen([PROGRAM, *arguments], cwd=folder, stdin=stdin or subprocess.DEVNULL, stdout=out, stderr=err,
                             preexec_fn=prepare)
    status, usage = wait(child, begun + timeout)
    seconds = time.monotonic() - begun
    texts = []
    for stream, given in ((out, stdout), (err, stderr)):
        if given is None:
            stream.seek(0)
            texts.append(stream.read())
            stream.close()
        else:
            texts.append(b"")
    return Run(arguments, os.waitstatus_to_exitcode(status), *texts, seconds, usage.ru_utime + usage.ru_stime,
               usage.ru_maxrss * 1024)


def wait(child, until):
    """Status and use of a child, killed when it is too late."""
    while True:
        pid, status, usage = os.wait4(child.pid, os.WNOHANG)
        if pid:
            child.returncode = os.waitstatus_to_exitcode(status)
            return status, usage
        if time.monotonic() > until:
            os.kill(child.pid, signal.SIGKILL)
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = -9
            return status, usage
        time.sleep(0.002)


class Group:
    """Cases of one kind, and those that were judged badly."""

    def __init__(self, name):
        self.name, self.count, self.bad, self.begun = name, 0, [], time.monotonic()
        self.longest, self.largest = 0.0, 0

    def judge(self, what, run=None, codes=(0, 1, 2), why=None):
        """Counts a case: by its run, and by what else is wrong with it."""
        self.count += 1
        if run is not None:
            self.longest, self.largest = max(self.longest, run.seconds), max(self.largest, run.memory)
            why = run.badly(codes) or why
        if why:
            shown = f" | {run.message.strip()[:300]!r}" if run is not None else ""
            self.bad.append(f"{self.name}: {what}: {why}{shown}")

    def report(self):
        figures = f"{self.count:5d} cases, {len(self.bad)} judged badly"
        cost = f"longest {self.longest:5.2f} s, largest {self.largest >> 20:4d} MB, in {time.monotonic() - self.begun:5.1f} s"
        print(f"hostile: {self.name:<42} {figures}; {cost}", flush=True)
        for line in self.bad[:20]:
            print(f"  {line}", file=sys.stderr, flush=True)


def parallel(work, items):
    """Results of `work` on items, in their order, on all processors."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(work, items))


def files(folder):
    """Bytes of all files below a folder, by name."""
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(Path(folder).rglob("*")) if p.is_file()}


class Place:
    """A folder with a reduced session, its result and copies of inputs, made once and copied from."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.reduced = self.folder / "reduced"
        for arguments in (["reduce", EXAMPLE, "--out", self.reduced], ["calibrate", self.reduced, "--out", self.folder / "calibrated"]):
            done = run(arguments, self.folder)
            assert done.code == 0, done.message
        self.result = self.folder / "calibrated" / "result.json"
        self.count = 0

    def new(self):
        """An empty folder."""
        return Path(tempfile.mkdtemp(dir=self.folder))

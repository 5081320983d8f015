"""An object store, a scheduler and workers on loopback, each a process of its own that can be killed."""

import json
import os
import random
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import obstore

from .conftest import HERE

OPTIONS = {"region": "us-east-1", "access_key_id": "key", "secret_access_key": "secret"}


def free_port():
    """A port that is free, and the one ten thousand above it, which SeaweedFS takes too."""
    while True:
        port = random.randrange(20_000, 32_000)
        with socket.socket() as low, socket.socket() as high:
            try:
                low.bind(("127.0.0.1", port))
                high.bind(("127.0.0.1", port + 10_000))
            except OSError:
                continue
            return port


def wait_for(port, seconds=30):
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.05)
    raise TimeoutError(f"nothing listens at port {port}")


class Program:
    """A process that starts again where it was."""

    def __init__(self, command, port, folder):
        self.command, self.port, self.folder = command, port, Path(folder)
        self.process = None

    def start(self):
        log = open(self.folder / f"{Path(self.command[0]).name}-{self.port}.log", "ab")
        environment = {**os.environ, "PYTHONPATH": ":".join(path for path in [str(HERE.parent), *sys.path] if path)}
        self.process = subprocess.Popen(
            self.command, stdout=log, stderr=log, cwd=self.folder, env=environment, start_new_session=True
        )
        if self.port:
            wait_for(self.port)
        return self

    def kill(self):
        """Kills it and what it started, at once."""
        if self.process is not None:
            try:
                os.killpg(self.process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            self.process.wait()
            self.process = None


class Cluster:
    """SeaweedFS, a Dask scheduler and workers."""

    def __init__(self, folder):
        self.folder = Path(folder)
        programs = Path(sys.executable).parent
        self.s3, self.scheduler_port = free_port(), free_port()
        identities = [{"name": "lab", "credentials": [{"accessKey": "key", "secretKey": "secret"}], "actions": ["Admin"]}]
        (self.folder / "s3.json").write_text(json.dumps({"identities": identities}))
        (self.folder / "objects").mkdir()
        ports = [free_port() for _ in range(3)]
        self.store = Program(
            [
                str(programs / "weed"), "server", "-ip=127.0.0.1", "-ip.bind=127.0.0.1", "-dir=objects",
                f"-master.port={ports[0]}", f"-volume.port={ports[1]}", f"-filer.port={ports[2]}",
                "-filer", "-s3", f"-s3.port={self.s3}", "-s3.config=s3.json", "-s3.port.iceberg=0", "-s3.port.lance=0",
                "-volume.max=20", "-master.volumeSizeLimitMB=64",
            ],
            self.s3,
            folder,
        )  # fmt: skip
        dask = [sys.executable, "-m", "dask"]
        self.scheduler = Program(
            [*dask, "scheduler", "--host=127.0.0.1", f"--port={self.scheduler_port}", "--no-dashboard"],
            self.scheduler_port,
            folder,
        )
        worker = [*dask, "worker", self.engine, "--nthreads=1", "--no-dashboard", f"--local-directory={folder}"]
        self.workers = [Program(worker, 0, folder) for _ in range(2)]

    @property
    def engine(self):
        return f"tcp://127.0.0.1:{self.scheduler_port}"

    @property
    def options(self):
        return {**OPTIONS, "endpoint": f"http://127.0.0.1:{self.s3}"}

    def arguments(self):
        return [f"--option={name}={value}" for name, value in self.options.items()]

    def open(self, prefix):
        client = {"allow_http": True}
        return obstore.store.from_url(f"s3://fleet/{prefix}", config=self.options, client_options=client)

    def start(self):
        self.store.start()
        until = time.monotonic() + 60
        while True:
            # Its parts find each other some seconds after the port is open.
            try:
                obstore.put(self.open(""), "ready", b"yes")
                break
            except obstore.exceptions.BaseError:
                if time.monotonic() > until:
                    raise
                time.sleep(0.3)
        self.scheduler.start()
        for worker in self.workers:
            worker.start()
        self.wait_for_workers()
        return self

    def wait_for_workers(self, count=2, seconds=60):
        import distributed

        with distributed.Client(self.engine, timeout=seconds) as client:
            client.wait_for_workers(count, timeout=seconds)

    def end(self):
        for program in (*self.workers, self.scheduler, self.store):
            program.kill()

    def upload(self, folder, prefix):
        store = self.open(prefix)
        for file in sorted(Path(folder).rglob("*")):
            if file.is_file():
                obstore.put(store, file.relative_to(folder).as_posix(), file)

    def download(self, prefix, folder):
        store = self.open(prefix)
        for batch in obstore.list(store):
            for item in batch:
                target = Path(folder, item["path"])
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(bytes(obstore.get(store, item["path"]).bytes()))
        return folder

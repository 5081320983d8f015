"""The example session, the program, and a truth to simulate."""

import os
import shutil
import subprocess
from pathlib import Path

import centrical as ct
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]
EXAMPLE = ROOT / "examples" / "ta-200"

ct.set_progress(False)


@pytest.fixture(scope="session")
def example():
    return EXAMPLE


@pytest.fixture(scope="session")
def root():
    return ROOT


@pytest.fixture(scope="session")
def result():
    return ct.calibrate(EXAMPLE)


@pytest.fixture(scope="session")
def executable(root):
    """The program, built by the same job; without it the comparisons are left out."""
    named = os.environ.get("CENTRICAL_PROGRAM") or shutil.which("centrical")
    for folder in (os.environ.get("CARGO_TARGET_DIR", root / "target"),):
        built = os.path.join(folder, "release", "centrical")
        named = named or (built if os.path.exists(built) else None)
    if named is None:
        pytest.skip("the program is not built: cargo build --release")
    return named


@pytest.fixture(scope="session")
def program(root, executable):
    """What the program prints as JSON."""

    def run(*arguments):
        done = subprocess.run([executable, *map(str, arguments), "--json"], capture_output=True, cwd=root)
        assert done.returncode in (0, 1), done.stderr.decode()
        return done.stdout.decode()

    return run


@pytest.fixture(scope="session")
def truth(root, tmp_path_factory):
    """Writes a truth file for records at a rate, with plateaus of a length."""
    text = (root / "benches/records/truth.toml").read_text()
    folder = tmp_path_factory.mktemp("truth")

    def written(rate, plateau):
        file = folder / f"{rate}-{plateau}.toml"
        file.write_text(text.replace("1000 Hz", f"{rate} Hz").replace("PLATEAU", str(plateau)))
        return file

    return written


@pytest.fixture
def readings():
    return np.random.default_rng(1).uniform(-300.0, 300.0, size=(1000, 3))

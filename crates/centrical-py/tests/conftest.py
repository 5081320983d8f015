"""The example session, and a folder for each test."""

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

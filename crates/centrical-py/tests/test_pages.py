"""The examples in docstrings, the types, and the page."""

import doctest
import importlib
import pkgutil
import re
import subprocess
import sys

import centrical as ct
import numpy as np
import pytest

MODULES = ["centrical", *(f"centrical.{module.name}" for module in pkgutil.iter_modules(ct.__path__) if module.name != "_native")]


@pytest.mark.parametrize("name", MODULES)
def test_examples_in_docstrings(name, example, tmp_path):
    module = importlib.import_module(name)
    names = {"ct": ct, "np": np, "example": example, "folder": tmp_path}
    outcome = doctest.testmod(module, extraglobs=names, optionflags=doctest.ELLIPSIS)
    assert outcome.failed == 0


def test_everything_public_has_a_docstring():
    for name in ct.__all__:
        thing = getattr(ct, name)
        assert thing.__doc__, name
        members = vars(thing).items() if isinstance(thing, type) else ()
        missing = [key for key, member in members if not key.startswith("_") and callable(member) and not member.__doc__]
        assert not missing, (name, missing)


def test_examples_of_the_page(root, tmp_path, monkeypatch):
    monkeypatch.chdir(root)
    page = (root / "docs/python.md").read_text()
    blocks = re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    assert blocks
    names = {"folder": tmp_path}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)


def test_the_example_runs(root, tmp_path):
    script = root / "examples/06_python/calibrate.py"
    done = subprocess.run([sys.executable, script, tmp_path], capture_output=True, text=True, cwd=root)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "certificate.pdf").read_bytes().startswith(b"%PDF")


def test_types(root):
    pytest.importorskip("mypy")
    for command in (["mypy.stubtest", "centrical._native"], ["mypy", "--strict", "-p", "centrical"]):
        done = subprocess.run([sys.executable, "-m", *command], capture_output=True, text=True, cwd=root)
        assert done.returncode == 0, done.stdout + done.stderr

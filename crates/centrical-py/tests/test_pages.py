"""The examples in docstrings, the types, and the page."""

import ast
import doctest
import importlib
import pathlib
import pkgutil
import re
import shutil
import subprocess
import sys

import centrical as ct
import numpy as np
import pytest

MODULES = ["centrical", *(f"centrical.{module.name}" for module in pkgutil.iter_modules(ct.__path__) if module.name != "_native")]


@pytest.mark.parametrize("name", MODULES)
def test_examples_in_docstrings(name, example, tmp_path):
    if name == "centrical.fleet":
        pytest.importorskip("obstore")
    module = importlib.import_module(name)
    names = {"ct": ct, "np": np, "example": example, "folder": tmp_path}
    outcome = doctest.testmod(module, extraglobs=names, optionflags=doctest.ELLIPSIS)
    assert outcome.failed == 0


def test_no_module_imports_one_that_imports_it():
    # Those for type checkers count: a reader follows them too.
    folder = pathlib.Path(ct.__file__).parent
    names = {file: ".".join(file.relative_to(folder).with_suffix("").parts) for file in folder.rglob("*.py")}
    imported = {name.removesuffix(".__init__"): set() for name in names.values()}
    for file, name in names.items():
        package = name.split(".")[:-1]
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.ImportFrom) and node.level:
                place = package[: len(package) - node.level + 1] + (node.module.split(".") if node.module else [])
                known = [".".join([*place, alias.name]) for alias in node.names] + [".".join(place)]
                imported[name.removesuffix(".__init__")] |= {known_name for known_name in known if known_name in imported}
    assert {"_plot", "_document"} <= imported["_result"] and imported["fleet.run"]
    below: dict[str, set[str]] = {}
    while below != (further := {name: of | {two for one in of for two in below.get(one, ())} for name, of in imported.items()}):
        below = imported = further
    circles = sorted(name for name, of in below.items() if name in of)
    assert not circles, circles


def test_everything_public_has_a_docstring():
    for name in ct.__all__:
        thing = getattr(ct, name)
        assert thing.__doc__, name
        members = vars(thing).items() if isinstance(thing, type) else ()
        missing = [key for key, member in members if not key.startswith("_") and callable(member) and not member.__doc__]
        assert not missing, (name, missing)


def test_the_line_for_tumble_on_the_page_runs(root, monkeypatch):
    monkeypatch.chdir(root)
    call = re.search(r"`(ct\.tumble\(records, .*?\))`", (root / "docs/python.md").read_text())[1]
    given = {"ct": ct, "records": "examples/tumble/record.csv"}
    assert eval(call.replace("gravity=...", "gravity=9.81523"), given).names


def test_examples_of_the_page(root, tmp_path, monkeypatch):
    # From elsewhere, as the page writes a report where it is.
    (tmp_path / "examples").symlink_to(root / "examples")
    monkeypatch.chdir(tmp_path)
    page = (root / "docs/python.md").read_text()
    blocks = re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    assert blocks
    names = {"folder": tmp_path}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)


@pytest.fixture
def repository(root, tmp_path):
    """A folder with the script of the example and its session where they are in the repository."""
    for name in ("06_python", "ta-200"):
        shutil.copytree(root / "examples" / name, tmp_path / "examples" / name)
    return tmp_path


def test_the_example_runs(repository):
    script = repository / "examples/06_python/calibrate.py"
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, cwd=repository)
    assert done.returncode == 0, done.stderr
    assert (repository / "certificates/certificate.pdf").read_bytes().startswith(b"%PDF")


def test_the_example_runs_as_a_notebook(repository):
    jupytext = pytest.importorskip("jupytext")
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    notebook = jupytext.read(repository / "examples/06_python/calibrate.py")
    client = nbclient.NotebookClient(
        notebook, timeout=120, kernel_name="python3", resources={"metadata": {"path": str(repository)}}
    )
    client.execute()
    shown = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    assert not [output for output in shown if output.output_type == "error"]
    pages = [output.data["text/html"] for output in shown if "text/html" in output.get("data", {})]
    assert any("<svg" in page and "ERROR MODEL" in page for page in pages)
    assert (repository / "certificates/certificate.pdf").read_bytes().startswith(b"%PDF")


def test_types(root):
    pytest.importorskip("mypy")
    for command in (["mypy.stubtest", "centrical._native"], ["mypy", "--strict", "-p", "centrical"]):
        done = subprocess.run([sys.executable, "-m", *command], capture_output=True, text=True, cwd=root)
        assert done.returncode == 0, done.stdout + done.stderr

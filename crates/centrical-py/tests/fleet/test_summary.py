"""What the summary of a fleet says of its units."""

import re
import sys

import pytest

from .conftest import command  # noqa: F401 - without the packages of a fleet all is left out

fleet = pytest.importorskip("centrical.fleet")

DATE, MODEL = r"(?m)^date = .*$", r"(?m)^model = .*$"


@pytest.fixture(autouse=True)
def children_find_the_package(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", ":".join(path for path in sys.path if path))


def test_units_of_each_model_are_compared_or_it_says_why_not(fleet_of, tmp_path, recwarn):
    plant = fleet_of(5)
    changes = [(2, DATE, ""), (3, MODEL, 'model = "TA-300"'), (4, MODEL, 'model = "TA-400"'), (4, DATE, "")]
    for number, line, other in changes:
        file = plant / f"s{number:03}" / "experiment.toml"
        text, count = re.subn(line, other, file.read_text(), count=1)
        assert count == 1
        file.write_text(text)
    fleet.calibrate(plant, tmp_path / "out")
    found = fleet.summary(tmp_path / "out")
    assert {model: units.units for model, units in found.units.items()} == {"TA-200": 2, "TA-300": 1}
    assert list(found.not_tested) == ["TA-400"]
    text = str(found)
    assert "\nNOT TESTED  TA-300, 1 unit" in text
    assert f"\nNOT TESTED  TA-400: {tmp_path / 'out'}: found " in text
    # A line of the summary, and no warning of Python beside it.
    assert "\nNO DAY  TA-200, serial 0002, " in text
    assert not recwarn.list
    assert "NO DAY  TA-200" in found.to_html()

"""A result: its numbers, its text, its forms."""

import json
import pickle
import sys

import centrical as ct
import numpy as np
import pytest


def test_numbers_are_those_of_the_document(result):
    document = json.loads(result.to_json())
    assert list(result.names) == [p["name"] for p in document["parameters"]]
    assert result.values.tolist() == [p["value"] for p in document["parameters"]]
    assert result.uncertainties.tolist() == [p["standard_uncertainty"] for p in document["parameters"]]
    assert result.covariance.tolist() == document["covariance"]
    assert np.allclose(np.sqrt(np.diag(result.covariance)), result.uncertainties, rtol=1e-12)
    g = result["G1_11"]
    assert (g.value, g.u, g.unit, g.group) == (
        next((p["value"], p["standard_uncertainty"], p["unit"], p["group"]) for p in document["parameters"] if p["name"] == "G1_11")
    )


def test_what_is_not_determined_is_nan(result):
    document = json.loads(result.to_json())
    lost = result.names.index("df_1")
    document["parameters"][lost].update(value=None, standard_uncertainty=None, estimable=False)
    document["covariance"] = [[None if lost in (i, j) else c for j, c in enumerate(row)] for i, row in enumerate(document["covariance"])]
    other = ct.Result(result.native.from_json(json.dumps(document).encode()))
    first = other["df_1"]
    assert np.isnan(first.value) and np.isnan(first.u) and not first.is_estimable
    assert np.isnan(other.covariance[lost]).all() and np.isnan(other.covariance).sum() == 2 * 49 - 1
    assert not other.acceptable and other.objections[0].name == "not-determined"
    assert first.name in str(other.objections[0])
    with pytest.raises(ct.InputError, match=first.name):
        other.compensate(np.zeros((1, 3)))


def test_arrays_are_read_only(result):
    for array in (result.values, result.uncertainties, result.covariance):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


def test_unknown_parameter_names_its_neighbours(result):
    with pytest.raises(KeyError, match="G1_11"):
        result["G1_99"]
    assert "G1_11" in result and "nothing" not in result and len(list(result)) == len(result) == 49


def test_verdict_and_parts(result):
    assert result.acceptable and result.objections == ()
    assert result.rests_on[0].name == "cubic-products"
    assert result.observability.rank == 49 and result.observability.lost == ()
    assert result.budget.sources
    assert result.document.session.unit_model == "TA-200"
    assert str(result).startswith("ACCEPTABLE") and "49 parameters" in repr(result)


def test_notebook_has_table_and_figures(result):
    page = result._repr_html_()
    assert page.startswith("<pre style='font-family: monospace;") and page.count("<svg") > 5
    assert page.split(">")[1].startswith("ACCEPTABLE")


def test_round_trip_by_file_and_pickle(result, tmp_path):
    text = result.to_json(tmp_path / "result.json")
    assert (tmp_path / "result.json").read_bytes() == text.encode()
    again = ct.read_result(tmp_path / "result.json")
    assert again.to_json() == text and again == result
    for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
        assert pickle.loads(pickle.dumps(result, protocol)) == result


def test_documents_of_a_result(result, example, tmp_path):
    written = result.report(
        html=tmp_path / "report.html",
        pdf=tmp_path / "certificate.pdf",
        dcc=tmp_path / "certificate.xml",
        code=tmp_path / "code",
        laboratory=example / "laboratory.toml",
        language="ru",
    )
    assert [document.kind for document in written.written] == ["report", "certificate", "digital-certificate", "code"]
    assert (tmp_path / "certificate.pdf").read_bytes().startswith(b"%PDF")
    assert all((tmp_path / name).stat().st_size for name in ("report.html", "certificate.xml", "code"))
    assert written.result == "result.json" and written.acceptable


def test_ufloats_and_xarray(result):
    uncertainties = pytest.importorskip("uncertainties")
    numbers = result.ufloats()
    assert numbers["df_1"].nominal_value == result["df_1"].value
    assert np.isclose(numbers["df_1"].std_dev, result["df_1"].u, rtol=1e-6)
    both = uncertainties.covariance_matrix([numbers["df_1"], numbers["G1_11"]])
    i, j = result.names.index("df_1"), result.names.index("G1_11")
    assert np.isclose(both[0][1], result.covariance[i, j], rtol=1e-4)
    pytest.importorskip("xarray")
    data = result.to_xarray()
    assert float(data.value.sel(parameter="df_1")) == result["df_1"].value


def test_parts_are_pickled(result):
    for thing in (result["G1_11"], result.document, result.observability, result.rests_on[0]):
        again = pickle.loads(pickle.dumps(thing))
        assert type(again) is type(thing)
    assert pickle.loads(pickle.dumps(result.document)).to_json() == result.to_json()


def test_figures_on_axes(result):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = result.plot("residuals")
    drawn = np.array([line.get_ydata() for line in axes.lines[:3]]).T * 9.80665e-6
    assert np.allclose(drawn, [plateau.residual for plateau in result.document.plateaus], rtol=1e-12)
    (image,) = result.plot("correlation", ax=matplotlib.figure.Figure().subplots()).images
    assert np.allclose(np.diag(image.get_array()), 1.0) and image.get_array().shape == (49, 49)
    analysis = ct.noise(np.random.default_rng(1).normal(size=4096), rate=100.0)
    tau, deviation = analysis.deviation("oadev")
    curve = analysis.plot().lines[0]
    assert np.array_equal(curve.get_xdata(), tau) and np.array_equal(curve.get_ydata(), deviation)


def test_figures_without_matplotlib(result, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert result.plot("residuals")._repr_svg_().startswith("<svg")
    assert result.plot("before")._repr_html_().count('class="plot panel"') == 3
    with pytest.raises(ValueError, match="name: found 'x', expected one of"):
        result.plot("x")
    analysis = ct.noise(np.random.default_rng(1).normal(size=4096), rate=100.0, estimators=["allan", "time"])
    svg = analysis.plot()._repr_svg_()
    # A marker with its values for each deviation, as the report has them.
    assert svg.startswith("<svg") and svg.count("<title>") == sum(len(curve.deviations) for curve in analysis.readings[0].deviations)
    assert "averaging time, s" in svg and ", allan" in svg and ", time" in svg

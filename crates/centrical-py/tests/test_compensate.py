"""Compensation of arrays: the same bits in every order, and clear refusals."""

import json
import pickle
import threading
import timeit
import warnings

import centrical as ct
import numpy as np
import pytest


@pytest.fixture(scope="module")
def expected(result):
    def of(readings):
        return np.concatenate([result.compensate(np.array([row])) for row in readings])

    return of


def test_all_layouts_give_the_same_bits(result, readings, expected):
    forces = expected(readings[:50])
    wide = np.full((50, 7), np.nan)
    wide[:, 1:7:2] = readings[:50]
    unaligned = np.frombuffer(b"x" + readings[:50].tobytes(), dtype=np.uint8)[1:].view(np.float64).reshape(50, 3)
    layouts = {
        "C": readings[:50],
        "F": np.asfortranarray(readings[:50]),
        "strided": wide[:, 1:7:2],
        "reversed": readings[:50][::-1].copy()[::-1],
        "unaligned": unaligned,
    }
    for name, array in layouts.items():
        before = array.copy()
        assert np.array_equal(result.compensate(array), forces), name
        out = np.empty((50, 3))
        assert result.compensate(array, out) is out and np.array_equal(out, forces), name
        assert np.array_equal(array, before), name


def test_one_thread_or_all(result, readings, expected):
    many = np.tile(readings, (100, 1))
    assert np.array_equal(result.compensate(many), np.tile(result.compensate(readings), (100, 1)))
    assert np.array_equal(result.compensate(readings)[:20], expected(readings[:20]))


def test_in_place(result, readings):
    forces = result.compensate(readings)
    own = readings.copy()
    assert result.compensate(own, out=own) is own
    assert np.array_equal(own, forces)


def test_the_model_gives_the_readings_back(result, readings):
    forces = result.compensate(readings)
    terms = result.document.model.error_model
    again = forces.copy()
    for term in terms:
        monomial = np.prod(forces ** np.array(term.powers), axis=1)
        again[:, term.axis - 1] += result[term.name].value * monomial
    assert np.allclose(again, readings, rtol=0, atol=1e-12)


def test_empty_and_one(result):
    assert result.compensate(np.empty((0, 3))).shape == (0, 3)
    out = np.empty((0, 3))
    assert result.compensate(np.empty((0, 3)), out) is out
    assert result.compensate(np.array([[9.8, 0.0, 0.0]])).shape == (1, 3)


def test_nan_stays_and_is_not_counted(result, readings):
    readings[3, 1] = np.nan
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        forces = result.compensate(readings)
        own = readings.copy()
        result.compensate(own, out=own)
    assert np.isnan(forces[3]).all() and np.isfinite(np.delete(forces, 3, axis=0)).all()
    assert np.array_equal(own, forces, equal_nan=True)


def test_out_of_range_is_counted(result, readings):
    readings[[2, 7]] = 1e9
    readings[5, 0] = np.inf
    readings[6, 0] = np.nan
    for out in (None, np.empty_like(readings), readings):
        with pytest.warns(RuntimeWarning, match="^3 readings that no force within") as seen:
            forces = result.compensate(readings, out)
        assert len(seen) == 1 and seen[0].filename == __file__
        assert np.flatnonzero(np.isnan(forces[:, 0])).tolist() == [2, 5, 6, 7]
        if out is not readings:
            continue
    assert result.range > 300


BASE = np.zeros((4, 3))
READ_ONLY = np.zeros((4, 3))
READ_ONLY.setflags(write=False)
MISUSE = {
    "list": (([[1.0, 2.0, 3.0]],), TypeError, "found list, expected a NumPy array of float64"),
    "none": ((None,), TypeError, "found NoneType"),
    "float32": ((np.zeros((4, 3), np.float32),), TypeError, "float32.*expected float64"),
    "int": ((np.zeros((4, 3), int),), TypeError, "int64.*expected float64"),
    "complex": ((np.zeros((4, 3), complex),), TypeError, "complex128"),
    "big endian": ((np.zeros((4, 3), ">f8"),), TypeError, ">f8.*expected float64"),
    "object": ((np.zeros((4, 3), object),), TypeError, "object"),
    "transposed": ((np.zeros((3, 4)),), ValueError, r"readings: found shape \(3, 4\), expected \(n, 3\)"),
    "vector": ((np.zeros(3),), ValueError, r"readings: found shape \(3,\), expected \(n, 3\)"),
    "cube": ((np.zeros((2, 3, 3)),), ValueError, r"readings: found shape \(2, 3, 3\)"),
    "scalar": ((np.array(1.0),), ValueError, r"readings: found shape \(\)"),
    "out too short": ((BASE, np.zeros((3, 3))), ValueError, r"out: found shape \(3, 3\), expected \(4, 3\)"),
    "out transposed": ((BASE, np.zeros((3, 4))), ValueError, r"out: found shape \(3, 4\)"),
    "out Fortran": ((BASE, np.zeros((4, 3), order="F")), ValueError, "out: found strides .* expected an aligned array in C order"),
    "out strided": ((BASE, np.zeros((4, 6))[:, ::2]), ValueError, "out: found strides"),
    "out float32": ((BASE, np.zeros((4, 3), np.float32)), TypeError, "out: found dtype float32"),
    "out read-only": ((BASE, READ_ONLY), ValueError, "out: found a read-only array, expected a writable one"),
    "out a list": ((BASE, [[0.0] * 3] * 4), TypeError, "out: found list"),
}


@pytest.mark.parametrize("case", MISUSE)
def test_misuse(result, case):
    arguments, kind, text = MISUSE[case]
    with pytest.raises(kind, match=text):
        result.compensate(*arguments)


def test_memory_in_part_shared_is_refused(result):
    whole = np.zeros((5, 3))
    with pytest.raises(ValueError, match="shared with readings"):
        result.compensate(whole[:4], whole[1:])
    assert not whole.any()


def test_read_only_readings_are_fine(result, readings):
    forces = result.compensate(readings)
    readings.setflags(write=False)
    assert np.array_equal(result.compensate(readings), forces)
    with pytest.raises(ValueError, match="read-only"):
        result.compensate(readings, out=readings)


def test_other_threads(result, readings):
    many = np.tile(readings, (50, 1))
    forces = result.compensate(many)
    wrong = []

    def work():
        for _ in range(5):
            if not np.array_equal(result.compensate(many), forces):
                wrong.append(1)

    threads = [threading.Thread(target=work) for _ in range(8)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert not wrong


def test_uncertainty(result, readings):
    forces, deviations = result.compensate(readings, uncertainty=True)
    assert deviations.shape == forces.shape and (deviations > 0).all()
    # df/dp = -J^-1 of the monomials, by differences of the inverse itself.
    names = [term.name for term in result.document.model.error_model]
    places = [result.names.index(name) for name in names]
    covariance = result.covariance[np.ix_(places, places)]
    f = forces[0]
    gain = np.eye(3)
    by_coefficient = np.zeros((3, len(names)))
    for k, term in enumerate(result.document.model.error_model):
        powers = np.array(term.powers)
        by_coefficient[term.axis - 1, k] = np.prod(f**powers)
        for j in np.flatnonzero(powers):
            less = powers - (np.arange(3) == j)
            gain[term.axis - 1, j] += result[term.name].value * powers[j] * np.prod(f**less)
    df = np.linalg.solve(gain, by_coefficient)
    assert np.allclose(deviations[0], np.sqrt(np.diag(df @ covariance @ df.T)), rtol=1e-9)
    own = readings.copy()
    forces, again = result.compensate(own, own, uncertainty=True)
    assert forces is own and np.array_equal(again, deviations)


def test_tables(result, readings):
    forces = result.compensate(readings)
    columns = {name: readings[:, axis].copy() for axis, name in enumerate(("f1", "f2", "f3"))}
    tables = [columns]
    for name, make in (("pandas", "DataFrame"), ("polars", "DataFrame"), ("pyarrow", "table")):
        try:
            tables.append(getattr(__import__(name), make)(columns))
        except ImportError:
            pass
    for table in tables:
        got = result.compensate(table)
        assert list(got) == ["f1", "f2", "f3"]
        assert all(np.array_equal(got[name], forces[:, axis]) for axis, name in enumerate(got)), type(table)
        assert result.compensate(table, uncertainty=True)[1]["f1"].shape == (1000,)
        short = {"f1": columns["f1"], "f2": columns["f2"]}
        with pytest.raises(ValueError, match="f3"):
            result.compensate(short if table is columns else type(table)(short) if not hasattr(table, "drop_columns") else table.drop_columns("f3"))
    with pytest.raises(TypeError, match="column f1"):
        result.compensate({**columns, "f1": np.array(["x"] * 1000)})
    with pytest.raises(ValueError, match="rows"):
        result.compensate({**columns, "f1": columns["f1"][:9]})


def test_an_arrow_stream_alone(result, readings):
    pyarrow = pytest.importorskip("pyarrow")
    columns = pyarrow.table({name: readings[:, axis] for axis, name in enumerate(("f1", "f2", "f3"))})

    class Stream:
        def __arrow_c_stream__(self, requested_schema=None):
            return columns.__arrow_c_stream__(requested_schema)

    assert np.array_equal(result.compensate(Stream())["f2"], result.compensate(readings)[:, 1])


def test_a_table_out(result, readings):
    columns = result.compensate({name: readings[:, axis] for axis, name in enumerate(("f1", "f2", "f3"))})
    with pytest.raises(TypeError, match="found a change"):
        columns["f4"] = columns["f1"]
    again = pickle.loads(pickle.dumps(columns))
    for given in (columns, again):
        with pytest.raises(ValueError, match="read-only"):
            given["f1"][0] = 5.0
    assert type(again) is ct.Columns and np.array_equal(again["f3"], columns["f3"])


@pytest.mark.parametrize("package, make, options", [("pandas", "DataFrame", {"copy": False}), ("polars", "DataFrame", {}), ("pyarrow", "table", {})])
def test_tables_of_others_share_its_memory(result, readings, package, make, options):
    columns = result.compensate({name: readings[:, axis] for axis, name in enumerate(("f1", "f2", "f3"))})
    table = getattr(pytest.importorskip(package), make)(columns, **options)
    assert table.shape == (1000, 3)
    for name, column in columns.items():
        taken = table[name].chunk(0).to_numpy() if package == "pyarrow" else table[name].to_numpy()
        assert np.array_equal(taken, column) and np.shares_memory(taken, column)


def test_the_arrow_stream_of_a_table(result, readings):
    pyarrow = pytest.importorskip("pyarrow")
    readings[0] = np.nan
    columns = result.compensate({name: readings[:, axis] for axis, name in enumerate(("f1", "f2", "f3"))})
    table = pyarrow.RecordBatchReader.from_stream(columns).read_all()
    assert table["f1"].null_count == 0 and np.shares_memory(table["f1"].chunk(0).to_numpy(), columns["f1"])


def test_a_structured_array_is_a_table(result, readings):
    table = np.zeros(len(readings), dtype=[("t", "f8"), ("f1", "f4"), ("f2", "f8"), ("f3", "f8")])
    for axis, name in enumerate(("f1", "f2", "f3")):
        table[name] = readings[:, axis]
    wanted = result.compensate(np.column_stack([table[name] for name in ("f1", "f2", "f3")]).astype(float))
    for given in (table, table.view(np.recarray)):
        forces = result.compensate(given)
        assert np.array_equal(np.column_stack([forces[name] for name in ("f1", "f2", "f3")]), wanted)
    with pytest.raises(ValueError, match="'f2' cannot be read .* expected f1, f2, f3"):
        result.compensate(table[["t", "f1", "f3"]])


def test_what_is_masked_becomes_nan(result, readings):
    holes = readings > 250.0
    given = np.ma.masked_array(readings, holes)
    forces = result.compensate(given)
    assert holes.any() and np.array_equal(forces, result.compensate(np.where(holes, np.nan, readings)), equal_nan=True)
    assert np.isnan(forces[holes]).all() and type(forces) is np.ndarray
    columns = {name: given[:, axis] for axis, name in enumerate(("f1", "f2", "f3"))}
    assert np.array_equal(result.compensate(columns)["f2"], forces[:, 1], equal_nan=True)


def test_readings_go_through_vectors(result, readings):
    # A wheel whose last crate was compiled for size gave the same bits in twenty times the time: thirty square roots of NumPy in place of
    # less than two.
    many = np.tile(readings, (8, 1))
    squares, out = many * many, np.empty_like(many)

    def least(call):
        return min(timeit.repeat(call, number=5, repeat=40))

    assert least(lambda: result.compensate(many, out)) < 8.0 * least(lambda: np.sqrt(squares, out=out))


@pytest.mark.parametrize("rows", [3, 2000])
def test_readings_in_the_unit_of_the_records(result, readings, rows, tmp_path):
    document = json.loads(result.to_json())
    assert result.output_unit == "m/s^2"
    scale, bias = np.array([0.02, -0.021, 0.019]), np.array([0.1, 0.0, -0.2])
    document["output"] = {"unit": "V", "scale": scale.tolist(), "bias": bias.tolist()}
    (tmp_path / "volts.json").write_text(json.dumps(document))
    in_volts = ct.read_result(tmp_path / "volts.json")
    assert in_volts.output_unit == "V"
    given = np.resize(readings, (rows, 3))
    volts, forces = given * scale + bias, result.compensate(given)
    assert np.allclose(in_volts.compensate(volts), forces, rtol=0, atol=1e-9)
    assert np.allclose(in_volts.compensate(volts, np.empty_like(volts)), forces, rtol=0, atol=1e-9)
    table = in_volts.compensate(dict(zip(("f1", "f2", "f3"), volts.T.copy())))
    assert np.allclose(np.column_stack([table[name] for name in table]), forces, rtol=0, atol=1e-9)
    assert in_volts.compensate(volts, volts) is volts and np.allclose(volts, forces, rtol=0, atol=1e-9)

"""The commands of the program as functions; ``docs/python.md`` has the table.

Each gives the document that the command prints with ``--json``. Paths are texts or ``os.PathLike``. Wrong files raise
:class:`InputError`, wrong arguments ``ValueError`` or ``TypeError``. Ctrl-C stops a function within a fifth of
a second.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from . import _native
from ._document import Document
from ._documents import check_documents
from ._given import given_file, given_session, is_file
from ._noise import Noise, noise_of_array
from ._numbers import above_zero, natural
from ._paths import paths
from ._plan import Plan
from ._progress import Bar
from ._records import directions, given_records
from ._result import Result

if TYPE_CHECKING:
    from typing import Literal

    from ._types import Array, File, Form, Format, Language, Method, Path, Quantity, Session, Table


G = 9.80665
"""Standard gravity [m/s^2]."""

SEEDS = "a number from 0 to 2^64 - 1"


def calibrate(
    session: Path | Session,
    *,
    method: Method = "exact",
    hold_out: Iterable[str] = (),
    out: Path | None = None,
    laboratory: Path | None = None,
    language: Language = "en",
) -> Result:
    """Calibrates a unit: plateau means, fit, budget, checks.

    Parameters
    ----------
    session
        The folder of a session, its ``experiment.toml``, or a :class:`Session`.
    method
        ``"exact"``: Gauss-Newton on the exact model; ``"recursive"``: the same estimates by the recursive filter;
        ``"linear"``: the linear fit of [K5.3] alone, with its second-order error; ``"recursive-linear"``: the same by
        one pass of the filter.
    hold_out
        Plateaus that are predicted and not fitted: ``"4:3"`` for the third of the fourth mounting.
    out
        A folder for ``result.json``, the report and its plots; with ``laboratory`` also the certificates.
    laboratory
        A laboratory file. Its limits are judged: :attr:`Result.within_limits`.

    >>> ct.calibrate(example).names[:2]
    ('alpha_1', 'alpha_2')
    """
    with Bar("calibrating") as shown:
        return Result(_native.calibrate(given_session(session), method, _texts(hold_out), out, laboratory, language, shown))


def tumble(
    records: Path | File | Array | Table | Sequence[Path | File | Array | Table],
    *,
    time: str | int = "t",
    rate: Quantity | None = None,
    readings: Sequence[str | int] = ("f1", "f2", "f3"),
    unit: str = "m/s^2",
    gravity: Quantity | None = None,
    gravity_uncertainty: Quantity | None = None,
    attitudes: Path | Iterable[Iterable[float]] | Table | None = None,
    attitude_uncertainty: Quantity | None = None,
    turning_radius: Quantity | None = None,
    terms: Iterable[str] | None = None,
    model: str = "",
    serial: str = "",
    date: str = "",
    out: Path | None = None,
) -> Result:
    """Calibrates a unit by gravity alone, from records in which it is turned and rests again and again.

    Parameters
    ----------
    records
        One record or several of one unit, in any format: paths, bytes, files that are open, tables with named columns, or
        arrays of shape ``(n, 4)`` with time and readings, ``(n, 3)`` with a ``rate``.
    time, readings
        Columns of a record by their names, or by their numbers from 1.
    rate
        Sampling rate [Hz], or a text such as ``"100 Hz"``, of records without a column of time.
    unit
        Of the readings: of acceleration, or ``"counts"`` or ``"V"``, whose scale and bias are found.
    gravity
        At the place [m/s^2]; 9.80665 m/s^2, uncertain by 0.02 m/s^2, if it is not given.
    gravity_uncertainty
        Standard uncertainty of a gravity that is given [m/s^2]; zero if it is not given.
    attitudes
        Attitudes in which the unit was laid down, where they are known, in any order: an array of shape ``(n, 3)`` of the
        direction of up in axes of the case, the path of such a table, or ``"cube"`` for its faces, edges and corners.
    attitude_uncertainty
        Their standard uncertainty [rad], or a text such as ``"0.1 deg"``.
    turning_radius
        Takes slow rotation too, up to 3 deg/s: the largest distance of the proof masses from its axis [m], or a text such as
        ``"50 mm"``.
    terms
        Of the error model, as in ``experiment.toml``; bias, scale and misalignment by default.
    model, serial, date
        Of the unit and of the records: histories are of one model and serial number.
    out
        A folder for ``result.json``, the rests as a session, the report and its plots.

    Raises
    ------
    ValueError
        A record without rests, of another unit, or with rests that do not show what is asked for (:class:`InputError`); an
        invalid argument.
    """
    given = [str(name) for name in terms] if terms is not None else None
    if attitudes is None and attitude_uncertainty is not None:
        raise ValueError("attitude_uncertainty: found one without attitudes, expected attitudes that are this uncertain")
    known: tuple[Path | list[list[float]], Quantity | None] | None = None
    if isinstance(attitudes, (str, os.PathLike)):
        known = (attitudes, attitude_uncertainty)
    elif attitudes is not None:
        known = (directions(attitudes), attitude_uncertainty)
    if len(readings) != 3:
        raise ValueError(f"readings: found {len(readings)} columns, expected three")
    at = (gravity, gravity_uncertainty)
    files = given_records(records, [*([] if rate is not None else [time]), *readings])
    with Bar("finding rests") as shown:
        return Result(
            _native.tumble(
                files,
                time,
                rate,
                list(readings),
                unit,
                at,
                known,
                turning_radius,
                given,
                model,
                serial,
                date,
                out,
                shown,
            )
        )


def observe(subject: Path | Session, combinations: Iterable[str] = ()) -> Document:
    """Rank, undetermined combinations, causes and remedies, of a session or a plan, before or after the experiment.

    ``combinations`` are sums of parameters to look at, such as ``"dR_2[A] + drho_22"``.

    >>> ct.observe(example).rank
    49
    """
    with Bar("observing") as shown:
        return Document(_native.observe(given_session(subject), _texts(combinations), shown))


def assess(
    session: Path | Session,
    *,
    coverage: float = 0.954499736103642,
    without_outliers: float | None = None,
    scale_by_residuals: bool = False,
    range: Quantity | None = None,
) -> Document:
    """Uncertainty budget (GUM), validity, patterns in the residuals, uncertainty of a compensated reading.

    ``without_outliers`` is the family-wise error at which outlying plateaus are left out, 0.05 for instance; ``range``
    the largest specific force of the prediction [m/s^2], by default the highest of the session. ``acceptable`` and
    ``objections`` of the document have the verdict of `calibrate` on the fit that is assessed.
    """
    above_zero("range", range, G, " g")
    with Bar("assessing") as shown:
        return Document(_native.assess(given_session(session), coverage, without_outliers, scale_by_residuals, range, shown))


def montecarlo(
    subject: Path | Session,
    *,
    runs: int = 10_000,
    seed: int = 1,
    coverage: float = 0.95,
    linear: bool = False,
    noise_ug: float | None = None,
    typical: bool = False,
) -> Document:
    """Repeats the calibration of a session or a plan on drawn readings, and checks the stated uncertainties.

    ``noise_ug`` is the white noise of the means of a plan [micro-g], in place of the plan's own; ``typical`` takes a
    unit with errors of typical size for the true one. The same seed gives the same numbers on any number of threads.

    >>> ct.montecarlo(example, runs=20, seed=7).runs
    20
    """
    natural("runs", runs, "2 to 10,000,000 calibrations")
    natural("seed", seed, SEEDS)
    above_zero("noise_ug", noise_ug)
    with Bar("calibrating") as shown:
        return Document(_native.montecarlo(given_session(subject), runs, seed, coverage, linear, noise_ug, typical, shown))


def models(session: Path | Session) -> Document:
    """Fits the model with each effect that it leaves out, and with pairs of the best: F test, BIC, hold-out."""
    with Bar("fitting rivals") as shown:
        return Document(_native.models(given_session(session), shown))


def noise(
    source: Any,
    *,
    plateau: str | None = None,
    session: Path | None = None,
    time: str | int = "t",
    rate: Quantity | None = None,
    readings: Sequence[str | int] = ("f1", "f2", "f3"),
    unit: str = "m/s^2",
    start: float = float("-inf"),
    end: float = float("inf"),
    estimators: Sequence[str] = ("overlapping-allan", "overlapping-hadamard"),
    out: Path | None = None,
) -> Noise:
    """Deviations of the Allan family with intervals, spectrum and noise terms.

    Parameters
    ----------
    source
        A record, by its path, as bytes or as a file that is open; a session and one ``plateau`` of it; or an array of readings,
        shape ``(n,)`` or ``(n, k)``, which needs a ``rate`` and is copied.
    rate
        Sampling rate [Hz], or a text such as ``"250 Hz"``, of readings without a column of time.
    readings
        Columns of a record, by their names or their numbers from 1.
    start, end
        The part of the record to analyse, on its own clock [s].
    estimators
        Names, or ``["all"]``.

    >>> x = np.random.default_rng(1).normal(size=4096)
    >>> tau, deviation = ct.noise(x, rate=100.0).deviation("oadev")
    >>> bool(abs(deviation[0] - 1.0) < 0.05)
    True
    """
    with Bar("analysing noise") as shown:
        if not is_file(source) and (hasattr(source, "__array__") or isinstance(source, (list, tuple))):
            return noise_of_array(source, rate, unit, (start, end), list(estimators), out, shown)
        given = given_file("record", given_session(source))
        if isinstance(given, tuple) and len(given) > 2:
            return Noise(_native.noise_of_session(given, plateau, list(estimators), out, shown))
        text = _native.noise(
            given, plateau, session, time, rate, list(readings), unit, (start, end), list(estimators), out, shown
        )
        return Noise(text)


def plan(
    file: Path,
    *,
    time: Quantity | None = None,
    out: Path | None = None,
    frontier: bool = False,
    svg: Path | None = None,
    levels: Sequence[float] | None = None,
    certify: bool = False,
    coverage: float = 0.954499736103642,
) -> Plan:
    """The schedule with the smallest uncertainty in the time available, or the shortest that meets the goals.

    ``time`` [s], or a text such as ``"8 h"``, takes the place of the time available that the file states.
    ``out`` takes the schedule as a plan file for :func:`observe`, :func:`montecarlo` and :func:`simulate`; ``certify``
    searches until the optimality gap is below 0.25 %; ``frontier`` plans for other times too.
    """
    with Bar("planning") as shown:
        chosen = None if levels is None else list(levels)
        return Plan(_native.plan(file, time, out, frontier, svg, chosen, certify, coverage, shown))


def simulate(plan: Path, truth: Path, *, seed: int, out: Path, format: Format = "csv") -> Document:
    """Writes a whole session to the folder ``out`` as a laboratory would deliver it, with ``truth.json`` beside it."""
    natural("seed", seed, SEEDS)
    with Bar("simulating") as shown:
        return Document(_native.simulate(plan, truth, seed, out, format, shown))


def compare(
    results: Sequence[Path | Result],
    *,
    years: float | None = None,
    other_units: bool = False,
    svg: Path | None = None,
) -> Document:
    """Compares calibrations of one unit, each with the one before and the last with the first: E_n, drift, joint test.

    ``years`` lie between two results, by default as the dates of their sessions say.

    >>> result = ct.calibrate(example)
    >>> ct.compare([result, result]).agree
    True
    """
    if years is not None and not 0.0 < years < math.inf:
        raise ValueError(f"years: found {years}, expected a number above 0")
    given = [results] if isinstance(results, Result) else paths(results)
    natives = [result.native if isinstance(result, Result) else result for result in given]
    return Document(_native.compare(natives, years, other_units, svg))


def reduce(session: Path | Session, out: Path, *, format: Format = "csv") -> Document:
    """Converts records to a session of plateau means in the folder ``out`` that calibrates to the same numbers."""
    with Bar("reducing") as shown:
        return Document(_native.reduce(given_session(session), out, format, shown))


def series(
    sessions: Iterable[Path],
    out: Path,
    *,
    method: Method = "exact",
    jobs: int | None = None,
    rows_only: bool = False,
    reduced: bool = False,
) -> Document:
    """Calibrates many sessions, one on each core, into a store in the folder ``out``, with a table of all.

    A pattern such as ``"plant/*"`` stands for all paths that match it.

    A bad session becomes a row with its message. With ``reduced`` each session is kept reduced, some kB, in ``reduced/KEY`` by the
    key of its row: a later model is fitted to it without the records. Sessions that were done before, with the same files, are not calibrated again.

    >>> ct.series([example], folder / "store").acceptable
    1
    """
    if jobs is not None:
        natural("jobs", jobs, "a number of cores")
    with Bar("calibrating") as shown:
        return Document(_native.series(paths(sessions), out, method, jobs, rows_only, reduced, shown))


def compensate(
    result: Path,
    record: Path,
    out: Path,
    *,
    session: Path | None = None,
    range: Quantity | None = None,
    within_calibration: bool = False,
    axes: str | None = None,
) -> Document:
    """Converts a record of readings to one of specific force, Parquet or CSV by the name of ``out``.

    Memory does not grow with the record. ``session`` says columns and units of the record; ``range`` is the largest
    specific force on each axis [m/s^2]; readings beyond it become NaN. ``axes``: see
    :meth:`Result.in_axes`. For arrays: :meth:`Result.compensate`.
    """
    with Bar("compensating") as shown:
        return Document(_native.compensate(result, record, out, session, range, within_calibration, axes, shown))


def report(
    result: Path,
    *,
    html: Path | None = None,
    history: Path | None = None,
    past: Path | Iterable[Path] = (),
    pdf: Path | None = None,
    before: Path | None = None,
    dcc: Path | None = None,
    code: Path | None = None,
    range: Quantity | None = None,
    laboratory: Path | None = None,
    axes: str | None = None,
    language: Language = "en",
) -> Document:
    """Writes the documents of a result; for one in memory: :meth:`Result.report`.

    ``html``: the report; ``pdf``: the certificate; ``dcc``: the digital certificate, both with a ``laboratory``;
    ``code``: a folder for the compensation as source code. ``past``: earlier calibrations of the unit, results, folders of
    them or stores; what they say of a reading after a switch-on stands in the report and in the certificates. ``axes``: see :meth:`Result.in_axes`.
    """
    check_documents(html, history, pdf, before, dcc, code, range, laboratory)
    text = _native.report(result, None, html, history, paths(past), pdf, before, dcc, code, range, laboratory, axes, language)
    return Document(text)


def init(
    inputs: Path | Iterable[Path],
    *,
    out: Path | None = None,
    positions: Literal["six"] | None = None,
    tumble: Path | None = None,
) -> Document:
    """Drafts ``experiment.toml`` from records and telemetry, or folders of them; ``text`` has the draft.

    ``tumble``: the folder of a tumble of the unit, whose scale and bias, gravity, serial number and rests are taken.

    >>> ct.init(example / "records").guesses > 0
    True
    """
    return Document(_native.init(paths(inputs), out, positions, tumble))


def schema(form: Form, *, out: Path | None = None) -> Document:
    """The JSON Schema of a file that people write.

    >>> ct.schema("experiment")["type"]
    'object'
    """
    return Document(_native.schema(form, out))


def _texts(names: Iterable[str]) -> list[str]:
    if isinstance(names, str):
        raise TypeError(f"found the text {names!r}, expected a list of texts")
    return list(names)

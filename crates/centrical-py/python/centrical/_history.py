"""Stores of calibrations, and what many of them say: the subcommands of ``centrical history``."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from . import _native
from ._document import Document
from ._numbers import natural
from ._paths import paths
from ._progress import Bar
from ._result import Result

if TYPE_CHECKING:
    from typing import Literal

    from ._types import Path, Quantity


SESSIONS = "a number of acceptable sessions, 2 or more"


def add_to_store(store: Path, results: Path | Result | Iterable[Path | Result], *, rows_only: bool = False) -> tuple[int, int]:
    """Adds results, their files, or folders of them, to a store, which is made if it is not there; how many were new, how many known.

    >>> result = ct.calibrate(example)
    >>> written = result.to_json(folder / "result.json")
    >>> ct.add_to_store(folder / "kept", folder / "result.json"), ct.add_to_store(folder / "kept", [result])
    ((1, 0), (0, 1))
    """
    given = [results] if isinstance(results, Result) else paths(results)
    natives = [result.native if isinstance(result, Result) else result for result in given]
    with Bar("adding") as shown:
        return _native.add_to_store(store, natives, rows_only, shown)


def history(
    results: Path | Iterable[Path],
    of: Literal["list", "unit", "units", "station"] = "unit",
    *,
    model: str | None = None,
    serial: str | None = None,
    station: str | None = None,
    check: bool = False,
    limit: Quantity | None = None,
    on: str | None = None,
    until: str | None = None,
    confidence: float | None = None,
    trend: bool = True,
    together: bool = False,
    out: Path | None = None,
    laboratory: Path | None = None,
    batches: Path | None = None,
) -> Document:
    """What many calibrations say: a unit over the years, units of one type beside each other, a station over its sessions.

    Parameters
    ----------
    results
        Stores, results of calibrations, or folders of them; for ``"list"`` a store.
    of
        ``"list"``: the calibrations of a store; ``"unit"``: scatter between sessions, drift, forecast and due date;
        ``"units"``: distribution, outlying units; ``"station"``: parameters of the machine that drift or have changed.
    model, serial, station
        Calibrations of these alone.
    check
        Of a list: ``doubts`` says what may not be meant, such as one unit under two names, or a copy that is missing.
    limit
        Of a unit: largest error of a compensated reading [m/s^2], for the due date.
    on
        Of a unit: day on which that limit is to hold, for ``is_within``; today by default.
    until
        Of a unit: day of the forecasts, ``"2027-10-05"``; a year after the last calibration by default.
    confidence
        Of a unit: probability of all intervals; 0.95 by default.
    trend
        Of a unit: without it, parameters are constant but for the scatter between sessions.
    together
        Of a unit: the scatter between sessions is that of all units of the model.
    out
        Of a unit: a folder for a plot of each parameter.
    laboratory
        Of units: a file with limits of parameters, for Cp and Cpk.
    batches
        Of units: a table with the columns serial and batch, as text; batches are compared.

    Raises
    ------
    ValueError
        An argument that does not go with ``of``, or calibrations that are not there (:class:`InputError`).

    >>> ct.series([example], folder / "store").sessions
    1
    >>> ct.history(folder / "store", "list").calibrations[0].unit_model
    'TA-200'
    >>> ct.history(folder / "store", "list", check=True).doubts
    []
    """
    chosen = (model, serial, station)
    given: dict[str, dict[str, object]] = {
        "list": {"check": check},
        "unit": {"limit": limit, "on": on, "until": until, "confidence": confidence, "trend": not trend, "together": together, "out": out},
        "units": {"laboratory": laboratory, "batches": batches},
        "station": {},
    }
    if of not in given:
        raise ValueError(f'of: found {of!r}, expected "list", "unit", "units" or "station"')
    for other in given.keys() - {of}:
        for name, value in given[other].items():
            if value is not None and value is not False:
                raise ValueError(f"{name}: found it for {of!r}, expected it for {other!r} alone")
    if of == "list":
        stores = paths(results)
        if len(stores) != 1:
            raise ValueError(f"results: found {len(stores)}, expected one store for a list")
        return Document(_native.history_list(stores[0], chosen, check))
    if of == "unit":
        return Document(_native.history_unit(paths(results), chosen, limit, on, until, confidence, trend, together, out))
    if of == "units":
        return Document(_native.history_units(paths(results), chosen, laboratory, batches))
    return Document(_native.history_station(paths(results), chosen))


def control_chart(
    parameter: str,
    results: Path | Iterable[Path],
    *,
    model: str | None = None,
    serial: str | None = None,
    station: str | None = None,
    accepted: int = 20,
    limits: tuple[float, float] | None = None,
    rules: Literal["nelson", "western-electric"] = "nelson",
    out: Path | None = None,
) -> Document:
    """Control charts of one parameter over sessions: individuals and moving range, EWMA, CUSUM.

    Parameters
    ----------
    parameter
        Its name, ``"alpha_1"``.
    results, model, serial, station
        As of :func:`history`.
    accepted
        Acceptable sessions whose values give the limits.
    limits
        In place of those: mean and standard deviation of the process in control [SI].
    rules
        For single values.
    out
        A folder for the charts: ``individuals.svg``, ``moving-ranges.svg``, ``ewma.svg``, ``cusum.svg``.

    >>> made = ct.series([example], folder / "charted")
    >>> ct.control_chart("df_1", folder / "charted", limits=(0.0, 0.01)).name
    'df_1'
    """
    natural("accepted", accepted, SESSIONS)
    chosen = (model, serial, station)
    return Document(_native.history_chart(parameter, paths(results), chosen, accepted, limits, rules, out))


def write_pages(
    store: Path,
    out: Path,
    *,
    limit: Quantity | None = None,
    laboratory: Path | None = None,
    batches: Path | None = None,
    accepted: int = 20,
) -> int:
    """Writes the pages of a store, ``index.html`` first, and returns their number; options as of :func:`history` and :func:`control_chart`.

    A page for each model of units, each station, and each unit with two calibrations or more. Pages of units without a new calibration
    are left as they are.

    >>> made = ct.series([example], folder / "shown")
    >>> ct.write_pages(folder / "shown", folder / "pages")
    3
    """
    natural("accepted", accepted, SESSIONS)
    return _native.history_pages(store, out, limit, laboratory, batches, accepted)

"""The native core: each command as a function that gives the JSON text which the command prints."""

import os
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Union, final

import numpy as np
from numpy.typing import NDArray

_Path = Union[str, os.PathLike[str]]
_Quantity = Union[float, str]
_Shown = Union[Callable[[int, int], None], None]
_Chosen = tuple[Union[str, None], Union[str, None], Union[str, None]]
_File = Union[_Path, tuple[str, bytes]]
_Names = tuple[str, Union[str, None], Union[str, None]]
_Session = Union[_Path, tuple[str, str, list[tuple[str, bytes]], list[_Names]]]
_Column = NDArray[np.float64]
_Recorded = tuple[_Column, list[_Column], Union[list[_Column], None], Union[_Column, None]]

__all__ = [
    "CalibrationResult",
    "Watcher",
    "__version__",
    "assess",
    "calibrate",
    "add_failure",
    "add_to_store",
    "calibrate_arrays",
    "compare",
    "compensate",
    "draw_curves",
    "history_chart",
    "history_list",
    "history_pages",
    "history_station",
    "history_unit",
    "history_units",
    "init",
    "models",
    "montecarlo",
    "noise",
    "noise_of_session",
    "observe",
    "plan",
    "plateau_columns",
    "reduce",
    "report",
    "schema",
    "series",
    "set_threads",
    "simulate",
    "tumble",
]

__version__: str

@final
class CalibrationResult:
    @staticmethod
    def read(file: _Path) -> CalibrationResult: ...
    @staticmethod
    def from_json(text: bytes) -> CalibrationResult: ...
    def to_json(self) -> bytes: ...
    def write(self, file: _Path) -> None: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def units(self) -> list[str]: ...
    @property
    def groups(self) -> list[str]: ...
    @property
    def values(self) -> NDArray[np.float64]: ...
    @property
    def uncertainties(self) -> NDArray[np.float64]: ...
    @property
    def covariance(self) -> NDArray[np.float64]: ...
    @property
    def objections(self) -> list[tuple[str, str]]: ...
    @property
    def range(self) -> float: ...
    @property
    def within_limits(self) -> bool | None: ...
    @property
    def output_unit(self) -> str: ...
    def text(self, width: int) -> str: ...
    def figures(self) -> list[tuple[str, str, str, list[str]]]: ...
    def compensate(self, readings: Any, out: Any = None) -> tuple[Any, int]: ...
    def in_axes(self, axes: str) -> CalibrationResult: ...
    def uncertainty(self, forces: Any) -> NDArray[np.float64]: ...

@final
class Watcher(Iterator[tuple[str, str | tuple[str, str] | CalibrationResult | None]]):
    def __new__(
        cls,
        session: _Path,
        out: _Path,
        targets: Sequence[str],
        false_alarm: float,
        hold_out: Sequence[str],
        hold_out_alarms: bool,
        interval: float,
        quiet: float,
        frozen: float,
        once: bool,
        serve: str | None,
        serve_names: Sequence[str],
        live_targets: Sequence[tuple[str, float]] | None,
    ) -> Watcher: ...
    @property
    def url(self) -> str | None: ...
    def __iter__(self) -> Watcher: ...
    def __next__(self) -> tuple[str, str | tuple[str, str] | CalibrationResult | None]: ...
    def close(self) -> None: ...

def draw_curves(
    title: str,
    x_label: str,
    y_label: str,
    curves: Sequence[tuple[str, _Column, _Column, _Column, _Column]],
) -> str: ...
def assess(
    session: _Session,
    coverage: float,
    without_outliers: float | None,
    scale_by_residuals: bool,
    range: _Quantity | None,
    shown: _Shown,
) -> str: ...
def calibrate(
    session: _Session,
    method: str,
    hold_out: Sequence[str],
    out: _Path | None,
    laboratory: _Path | None,
    language: str,
    shown: _Shown,
) -> CalibrationResult: ...
def add_failure(store: _Path, session: str, message: str, file: str, found: str, expected: str) -> str: ...
def add_to_store(store: _Path, results: Sequence[CalibrationResult | _Path], rows_only: bool, shown: _Shown) -> tuple[int, int]: ...
def history_list(store: _Path, chosen: _Chosen, check: bool) -> str: ...
def history_unit(
    results: Sequence[_Path],
    chosen: _Chosen,
    limit: float | str | None,
    on: str | None,
    until: str | None,
    confidence: float | None,
    trend: bool,
    together: bool,
    out: _Path | None,
) -> str: ...
def history_units(results: Sequence[_Path], chosen: _Chosen, laboratory: _Path | None, batches: _Path | None) -> str: ...
def history_station(results: Sequence[_Path], chosen: _Chosen) -> str: ...
def history_chart(
    parameter: str,
    results: Sequence[_Path],
    chosen: _Chosen,
    accepted: int,
    stated: tuple[float, float] | None,
    rules: str,
    out: _Path | None,
) -> str: ...
def history_pages(
    store: _Path, out: _Path, limit: float | str | None, laboratory: _Path | None, batches: _Path | None, accepted: int
) -> int: ...
def series(
    sessions: Sequence[_Path],
    out: _Path,
    method: str,
    jobs: int | None,
    rows_only: bool,
    reduced: bool,
    shown: _Shown,
) -> str: ...
def calibrate_arrays(
    session: _Session,
    records: Sequence[_Recorded],
    plateaus: Sequence[_Column] | None,
    method: str,
    hold_out: Sequence[str],
    shown: _Shown,
) -> CalibrationResult: ...
def plateau_columns() -> list[str]: ...
def compare(
    results: Sequence[CalibrationResult | _Path], years: float | None, other_units: bool, svg: _Path | None
) -> str: ...
def compensate(
    result: _Path,
    record: _Path,
    out: _Path,
    session: _Path | None,
    range: _Quantity | None,
    within_calibration: bool,
    axes: str | None,
    shown: _Shown,
) -> str: ...
def init(inputs: Sequence[_Path], out: _Path | None, positions: str | None, tumble: _Path | None) -> str: ...
def models(session: _Session, shown: _Shown) -> str: ...
def montecarlo(
    subject: _Session,
    runs: int,
    seed: int,
    coverage: float,
    linear: bool,
    noise: float | None,
    typical: bool,
    shown: _Shown,
) -> str: ...
def noise(
    source: _File,
    plateau_name: str | None,
    session: _Path | None,
    time: str | int,
    rate: _Quantity | None,
    readings: Sequence[str | int],
    unit: str,
    window: tuple[float, float],
    estimators: Sequence[str],
    out: _Path | None,
    shown: _Shown,
) -> str: ...
def noise_of_session(
    session: _Session,
    plateau_name: str | None,
    estimators: Sequence[str],
    out: _Path | None,
    shown: _Shown,
) -> str: ...
def tumble(
    records: Sequence[_File],
    time: str | int,
    rate: _Quantity | None,
    readings: Sequence[str | int],
    unit: str,
    gravity: tuple[_Quantity | None, _Quantity | None],
    attitudes: tuple[_Path | Sequence[Sequence[float]], _Quantity | None] | None,
    turning_radius: _Quantity | None,
    terms: Sequence[str] | None,
    model: str,
    serial: str,
    date: str,
    out: _Path | None,
    shown: _Shown,
) -> CalibrationResult: ...
def observe(given: _Session, combinations: Sequence[str], shown: _Shown) -> str: ...
def plan(
    file: _Path,
    time: _Quantity | None,
    out: _Path | None,
    frontier: bool,
    svg: _Path | None,
    levels: Sequence[float] | None,
    certify: bool,
    coverage: float,
    shown: _Shown,
) -> str: ...
def reduce(session: _Session, out: _Path, format: str, shown: _Shown) -> str: ...
def report(
    result: _Path,
    name: _Path | None,
    html: _Path | None,
    history: _Path | None,
    past: Sequence[_Path],
    pdf: _Path | None,
    before: _Path | None,
    dcc: _Path | None,
    code: _Path | None,
    range: _Quantity | None,
    laboratory: _Path | None,
    axes: str | None,
    language: str,
) -> str: ...
def schema(form: str, out: _Path | None) -> str: ...
def set_threads(count: int) -> None: ...
def simulate(plan: _Path, truth: _Path, seed: int, out: _Path, format: str, shown: _Shown) -> str: ...

"""Calibration of newtonometer (accelerometer) triads on precision centrifuges.

Every command of the program ``centrical`` is a function here, with the same numbers to the last bit; numbers are in
SI units, and a text such as ``"120 g"`` may stand for a quantity with a unit.

>>> import centrical as ct
>>> result = ct.Session(example).calibrate()
>>> result.acceptable
True
>>> result["G1_11"].unit
's^2/m'
>>> result.compensate(np.array([[9.81, 0.0, 0.0]])).shape
(1, 3)
"""

import typing as _typing

# First: without NumPy this is an ImportError, and not a panic at the first array.
import numpy as _numpy  # noqa: F401

from . import _native
from ._array_session import ArraySession
from ._columns import Columns
from ._commands import (
    assess,
    calibrate,
    compare,
    compensate,
    init,
    models,
    montecarlo,
    noise,
    observe,
    plan,
    reduce,
    report,
    schema,
    series,
    simulate,
    tumble,
)
from ._document import Document, Record
from ._errors import FileError, InputError, NoSuchFileError
from ._history import add_to_store, control_chart, history, write_pages
from ._noise import Noise
from ._plan import Plan
from ._progress import set_progress
from ._result import Objection, Observability, Parameter, Result, read_result
from ._session import Session
from ._watch import Watch, watch

if _typing.TYPE_CHECKING:
    from ._plot import Drawing

set_threads = _native.set_threads
__version__ = _native.__version__

__all__ = [
    "ArraySession",
    "Columns",
    "Document",
    "Drawing",
    "FileError",
    "InputError",
    "NoSuchFileError",
    "Noise",
    "Objection",
    "Observability",
    "Parameter",
    "Plan",
    "Record",
    "Result",
    "Session",
    "Watch",
    "add_to_store",
    "assess",
    "calibrate",
    "compare",
    "compensate",
    "control_chart",
    "history",
    "init",
    "models",
    "montecarlo",
    "noise",
    "observe",
    "plan",
    "read_result",
    "reduce",
    "report",
    "schema",
    "series",
    "set_progress",
    "set_threads",
    "simulate",
    "tumble",
    "watch",
    "write_pages",
]


def __getattr__(name: str) -> object:
    # The figures are loaded when they are used.
    if name == "Drawing":
        from ._plot import Drawing

        return Drawing
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

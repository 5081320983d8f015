"""Thousands of sessions on a share or in an object store, on this machine or on an engine: ``centrical-fleet``.

A fleet is cut into *parts* of some thirty seconds of work. A part is named by the hash of what goes into it: names and stamps of its
sessions, version of the program, settings. It is there once its marker is there, and the marker is written last, by one conditional
write. So the same command again makes only the parts that are missing, whatever was killed, and two at once make no row twice.

The result is a store, as ``centrical history`` keeps it, with a table of sessions and one of parameters beside it.

    import centrical.fleet
    done = centrical.fleet.calibrate("plant", "results")
    done = centrical.fleet.calibrate("s3://bucket/plant", "s3://bucket/results", engine="tcp://scheduler:8786")

Needs the packages of ``pip install "centrical[fleet]"``.
"""

from .engines import EngineError
from .run import Done, calibrate
from .settings import EnvironmentMismatch, Settings
from .summary import Summary, summary

__all__ = ["Done", "EngineError", "EnvironmentMismatch", "Settings", "Summary", "calibrate", "summary"]

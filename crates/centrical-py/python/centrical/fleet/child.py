"""The process that runs the native core: a session that ends it takes nothing else with it.

One request a line on standard input, one answer a line on standard output, both JSON.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from typing import Any


def calibrate(request: dict[str, Any]) -> None:
    """Calibrates one session into the store of a part; what is wrong with the session is a row there."""
    from .. import _native

    os.chdir(request["folder"])
    _native.series([request["session"]], request["out"], request["method"], 1, False, request["reduced"], None)


def main() -> None:
    """Answers requests until there are no more."""
    # Ctrl-C reaches every process of a terminal; when to end is the driver's to say.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    answers = os.fdopen(os.dup(1), "w")
    # Other output must not mix with the answers.
    os.dup2(2, 1)
    _limit_memory(int(sys.argv[1]))
    from .. import _native

    _native.set_threads(1)
    for line in sys.stdin:
        answer: dict[str, str] = {}
        try:
            calibrate(json.loads(line))
        except MemoryError:
            os.abort()
        except Exception as error:
            answer["error"] = f"{type(error).__name__}: {error}"
        print(json.dumps(answer), file=answers, flush=True)


def _limit_memory(limit: int) -> None:
    try:
        import resource
    except ImportError:
        # Windows has no such limit.
        return
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))


if __name__ == "__main__":
    main()

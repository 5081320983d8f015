"""``centrical-fleet``: arguments -> one call -> exit code."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import obstore

from .engines import EngineError
from .isolation import WorkerTrouble
from .places import first_line
from .run import calibrate
from .settings import METHODS, MOST, EnvironmentMismatch, Settings
from .summary import summary

EXPECTED = (OSError, ValueError, EngineError, EnvironmentMismatch, WorkerTrouble, obstore.exceptions.BaseError)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; its exit code."""
    parsed = _parser().parse_args(arguments)
    try:
        code: int = parsed.run(parsed)
        return code
    except KeyboardInterrupt:
        print("centrical-fleet: interrupted; the same command goes on", file=sys.stderr)
        return 130
    except EXPECTED as error:
        print(f"centrical-fleet: {first_line(error)}", file=sys.stderr)
        return 2


def _calibrate(parsed: argparse.Namespace) -> int:
    settings = Settings(
        method=parsed.method,
        results=not parsed.rows_only,
        part=parsed.part,
        memory=int(parsed.memory * (1 << 30)),
        seconds=parsed.seconds,
    )
    done = calibrate(
        parsed.sessions,
        parsed.out,
        parsed.engine,
        settings=settings,
        options=_options(parsed),
        again=parsed.again,
        progress=not parsed.quiet,
    )
    for message in done.missing + done.left_out:
        print(f"centrical-fleet: {message}", file=sys.stderr)
    if parsed.json:
        print(json.dumps({"schema": "centrical-fleet/1", **asdict(done)}))
    elif not parsed.quiet:
        print(
            f"{done.sessions} sessions: {done.acceptable} acceptable, {done.not_acceptable} not acceptable, {done.failed} failed; "
            f"{done.made} of {done.parts} parts made now, {len(done.missing)} missing"
        )
    return done.exit_code


def _summary(parsed: argparse.Namespace) -> int:
    found = summary(parsed.results, _options(parsed))
    if parsed.html is not None:
        parsed.html.write_text(found.to_html(), encoding="utf-8")
    print(found)
    return 0


def _options(parsed: argparse.Namespace) -> dict[str, str]:
    options = {}
    for given in parsed.option:
        name, sign, value = given.partition("=")
        if not sign:
            raise ValueError(f"--option: found {given!r}, expected NAME=VALUE such as endpoint=http://localhost:8333")
        options[name] = value
    return options


def _above_zero(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not 0.0 < value <= MOST:
        raise argparse.ArgumentTypeError(f"found {text!r}, expected a number above 0, at most {MOST:g}")
    return value


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="centrical-fleet", description="Calibrate thousands of sessions on this machine or on a Dask cluster."
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    options = argparse.ArgumentParser(add_help=False)
    options.add_argument(
        "--option", action="append", default=[], metavar="NAME=VALUE", help="option of the object store, such as endpoint=URL"
    )

    one = commands.add_parser(
        "calibrate",
        parents=[options],
        help="calibrate every session of a folder, a bucket or a manifest",
        description="Calibrate every session of a folder, a bucket's prefix or a manifest. The same command again makes only what is "
        "missing or changed. Exit code: 0 all acceptable, 1 some are not, 2 some failed or parts are missing.",
        epilog="Example: centrical-fleet calibrate s3://bucket/plant --out s3://bucket/results --engine tcp://scheduler:8786",
    )
    one.add_argument("sessions", metavar="FOLDER|s3://BUCKET/PREFIX|MANIFEST")
    one.add_argument("--out", required=True, metavar="FOLDER|s3://BUCKET/PREFIX", help="where the store of rows lies or is made")
    one.add_argument("--engine", metavar="tcp://HOST:PORT", help="Dask scheduler [default: processes on this machine]")
    one.add_argument("--method", choices=METHODS, default="exact", help="how a fit is computed")
    one.add_argument("--again", action="store_true", help="make parts with sessions that failed again, for other limits")
    one.add_argument("--rows-only", action="store_true", help="keep rows of 11 kB alone, without result.json")
    one.add_argument("--part", type=_above_zero, default=30.0, metavar="S", help="work in a part [default: 30]")
    one.add_argument("--memory", type=_above_zero, default=4.0, metavar="GIB", help="memory of the process that calibrates [default: 4]")
    one.add_argument("--seconds", type=_above_zero, default=600.0, metavar="S", help="time for one session [default: 600]")
    one.add_argument("-j", "--json", action="store_true", help="print the counts as JSON")
    one.add_argument("-q", "--quiet", action="store_true", help="print nothing but errors")
    one.set_defaults(run=_calibrate)

    two = commands.add_parser("summary", parents=[options], help="what a fleet's result says")
    two.add_argument("results", metavar="RESULTS")
    two.add_argument("--html", type=Path, metavar="FILE", help="write it as a page too")
    two.set_defaults(run=_summary)
    return parser


if __name__ == "__main__":
    sys.exit(main())

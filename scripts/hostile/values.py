"""Records and tables that were read with a silent wrong result, and packed ones that would not end."""

import gzip
import json
import shutil

from judge import EXAMPLE, Group, run


def check(place):
    yield records(place)
    yield ranges(place)
    yield bombs(place)


def compensated(place, folder, name):
    return run(["compensate", place.result, name, "--out", "out.csv"], folder)


def records(place):
    """Rows that vanish, plateaus too short, types that are no numbers."""
    found = Group("rows and columns")
    folder = place.new()
    lines = (EXAMPLE / "records/m01.csv").read_text().splitlines()
    for cell in ("#N/A", "#DIV/0!", "#NUM!", "#VALUE!", "#REF!", "#NAME?", "#NULL!", "#n/a", "#SPILL!", "#Н/Д", "#NV", "#DIV/0", "#####"):
        for row in (1, 2, 500, len(lines) - 1):
            spoilt = list(lines)
            spoilt[row] = ",".join([cell, *spoilt[row].split(",")[1:]])
            (folder / "r.csv").write_text("\n".join(spoilt) + "\n")
            done = compensated(place, folder, "r.csv")
            found.judge(f"{cell} in row {row}", done, codes=(2,), why=None if f"line {row + 1}" in done.message else "no line")
    (folder / "r.csv").write_text("# one\n\n" + "\n".join([*lines[:5], "# a comment, of, four, cells", "#", *lines[5:]]) + "\n")
    found.judge("comments are comments", compensated(place, folder, "r.csv"), codes=(0,))
    for name, table in (("long", "x" * 5000), ("controls", "\x1b[2Jgone\u202e")):
        (folder / "r.csv").write_text("\n".join([*lines[:5], f"{table},1,2,3", *lines[5:]]) + "\n")
        done = compensated(place, folder, "r.csv")
        why = "not cut" if len(done.message) > 1000 else "commands the terminal" if "\x1b" in done.message else None
        found.judge(f"a cell that is {name}", done, codes=(2,), why=why)
    header = "\n".join([f"{'y' * 6000},f1,f2,f3", *lines[1:]])
    (folder / "r.csv").write_text(header)
    done = compensated(place, folder, "r.csv")
    found.judge("a header of thousands", done, codes=(2,), why="not cut" if len(done.message) > 2000 else None)
    short = folder / "short"
    shutil.copytree(EXAMPLE, short)
    rows = [f"{n / 50},{9.8 if n > 100 else 0.01},0.01,9.81" for n in range(300)]
    (short / "records/m01.csv").write_text("t,f1,f2,f3\n" + "\n".join(rows) + "\n")
    found.judge("a record of six seconds", run(["calibrate", short, "--json"], folder), codes=(2,))
    found.judge("plateaus too short to use", too_short(place), codes=(2,), why=None)
    shutil.rmtree(folder)
    return found


def too_short(place):
    """Plateaus of 2 s at 50 Hz: the message says too short, and not that what it saw was not found."""
    folder = place.new()
    (folder / "truth.toml").write_text('[machine]\nplateau = "2 s"\n[recorder]\nrate = "50 Hz"\n[sensor]\nwhite = "0.2 mg"\n')
    run(["simulate", EXAMPLE, "--truth", "truth.toml", "--seed", "1", "--out", "s"], folder)
    done = run(["calibrate", "s", "--json"], folder)
    if "not found" in done.message and "too short" not in done.message:
        done.code = -1
    shutil.rmtree(folder)
    return done


def ranges(place):
    """Readings beyond the calibrated range are counted and shown and, on request, refused."""
    found = Group("readings beyond the calibration")
    folder = place.new()
    largest = max(abs(p["mean"][0]) for p in json.loads(place.result.read_text())["plateaus"])
    for factor, beyond in ((0.5, 0), (1.001, 0), (1.2, 3), (1.9, 3)):
        rows = ["0,0.1,0.1,9.8"] + [f"{n},{largest * factor},0.1,9.8" for n in (1, 2, 3)]
        (folder / "r.csv").write_text("t,f1,f2,f3\n" + "\n".join(rows) + "\n")
        done = compensated(place, folder, "r.csv")
        why = None if (f"{beyond} readings beyond" in done.text) == (beyond > 0) else "not counted"
        found.judge(f"{factor} of the range", done, codes=(0,), why=why)
        done = run(["compensate", place.result, "r.csv", "--out", "no.csv", "--within-calibration"], folder)
        why = "written all the same" if beyond and (folder / "no.csv").exists() else None
        found.judge(f"{factor}, on request", done, codes=(2,) if beyond else (0,), why=why)
        (folder / "no.csv").unlink(missing_ok=True)
    shutil.rmtree(folder)
    return found


def bombs(place):
    """Files of some kilobytes that unpack to gigabytes, and text that is nothing but ends of lines."""
    found = Group("files that unpack without end")
    folder = place.new()
    contents = {"empty lines": b"\n" * (1 << 20), "returns": b"\r\n" * (1 << 19), "comments": b"#\n" * (1 << 19), "blanks": b" \n" * (1 << 19),
                "zeros": bytes(1 << 20), "rows": b"1,1,1,1\n" * (1 << 17), "one line": b"1" * (1 << 20)}
    for header in (b"t,f1,f2,f3\n1,1,1,1\n", b""):
        for name, piece in contents.items():
            if not header and name not in ("empty lines", "comments", "one line"):
                continue
            # One member of 16 MB again and again: a gzip of many members is one file.
            (folder / "r.csv.gz").write_bytes(gzip.compress(header) + 64 * gzip.compress(16 * piece, 9))
            found.judge(f"{name} after {len(header)} bytes", compensated(place, folder, "r.csv.gz"), codes=(2,))
    shutil.rmtree(folder)
    return found

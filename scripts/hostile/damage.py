"""Damaged binary files against the verdict of pyarrow and NumPy: what these refuse, or read otherwise, is never read in silence."""

import io
import random
import shutil
import sys
from pathlib import Path

from judge import EXAMPLE, Group, parallel, run

try:
    import numpy as np
    import pyarrow as pa
    import pyarrow.parquet as pq
except ImportError:
    np = None

# Flips of one bit in each kind of file.
FLIPS = 60


def check(place):
    if np is None:
        print("hostile: NumPy and pyarrow are not there, damaged files are left out", file=sys.stderr)
        return
    yield damaged(place)
    yield types(place)


def table():
    rows = [line.split(",") for line in (EXAMPLE / "records/m01.csv").read_text().split()[1:2001]]
    return {name: np.array([float(row[k]) for row in rows]) for k, name in enumerate(("t", "f1", "f2", "f3"))}


def kinds(columns):
    """Files by name, and who reads them back."""
    arrow = pa.table(columns)
    parquet = lambda data: pq.read_table(io.BytesIO(data), page_checksum_verification=True).to_pydict()
    npz = lambda data: {k: v.tolist() for k, v in np.load(io.BytesIO(data)).items()}

    def written(write):
        out = io.BytesIO()
        write(out)
        return out.getvalue()

    for packing in ("NONE", "SNAPPY", "ZSTD"):
        make = lambda out: pq.write_table(arrow, out, compression=packing, write_page_checksum=True, use_dictionary=packing == "ZSTD")
        yield f"{packing}.parquet", written(make), parquet
    yield "stored.npz", written(lambda out: np.savez(out, **columns)), npz
    yield "packed.npz", written(lambda out: np.savez_compressed(out, **columns)), npz


def damaged(place):
    found = Group("damaged files against pyarrow and NumPy")
    folder, chance, columns = place.new(), random.Random(18), table()
    cases = []
    for name, data, read in kinds(columns):
        whole = read(data)
        for n in range(FLIPS):
            flipped = bytearray(data)
            flipped[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
            cases.append((f"{n}-{name}", bytes(flipped), read, whole))
        for n in range(10):
            cases.append((f"cut{n}-{name}", data[: chance.randrange(len(data))], read, whole))
        cases.append((f"whole-{name}", data, read, whole))

    def judged(case):
        name, data, _, _ = case
        (folder / name).write_bytes(data)
        done = run(["compensate", place.result, name, "--out", f"{name}.csv"], folder)
        out = folder / f"{name}.csv"
        return done, out.read_bytes() if out.exists() else None

    outcomes = parallel(judged, cases)
    right = {case[0].split("-", 1)[1]: out for case, (_, out) in zip(cases, outcomes) if case[0].startswith("whole-")}
    for (name, data, read, whole), (done, out) in zip(cases, outcomes):
        try:
            theirs = read(data)
        except Exception:
            theirs = None
        silent = out is not None and done.code in (0, 1) and out != right[name.split("-", 1)[1]]
        # A flip that both take for data, as in a file without checksums, is nobody's fault.
        why = "read otherwise in silence" if silent and (theirs is None or theirs == whole) else None
        why = why or ("an output of a file that was refused" if done.code == 2 and out is not None else None)
        found.judge(name, done, why=why)
    shutil.rmtree(folder)
    return found


def types(place):
    """Types that are no numbers in the unit asked for are named."""
    found = Group("types of columns")
    folder, columns = place.new(), table()
    t = columns["t"]
    for unit, factor in (("s", 1), ("ms", 1e3), ("us", 1e6), ("ns", 1e9)):
        durations = pa.array(np.round(t * factor).astype("int64"), pa.duration(unit))
        for end, write in (("parquet", pq.write_table), ("arrow", feather)):
            write(pa.table({**columns, "t": durations}), folder / f"d.{end}")
            done = run(["compensate", place.result, f"d.{end}", "--out", "o.csv"], folder)
            found.judge(f"duration in {unit}, {end}", done, codes=(2,), why=None if "duration" in done.message else "not named")
    unsigned = pa.array(np.full(len(t), 4_000_000_000, "uint32"))
    pq.write_table(pa.table({**columns, "t": t, "f1": unsigned}), folder / "u.parquet")
    done = run(["noise", "u.parquet", "--json"], folder)
    found.judge("counts without sign", done, why="read with a sign" if "-294967296" in done.text else None)
    halves = {name: column.astype("float16") for name, column in columns.items()}
    np.savez(folder / "h.npz", **halves)
    records = np.zeros(len(t), [(name, "<f2") for name in columns])
    np.save(folder / "h.npy", records)
    pq.write_table(pa.table(halves), folder / "h.parquet")
    feather(pa.table(halves), folder / "h.arrow")
    np.save(folder / "matrix.npy", np.array(list(halves.values())).T)
    for name in ("h.npz", "h.npy", "matrix.npy", "h.parquet", "h.arrow"):
        done = run(["compensate", place.result, name, "--out", "o.csv"], folder)
        found.judge(f"float16, {name}", done, codes=(2,), why=None if "16" in done.message else "not named")
    shutil.rmtree(folder)
    return found


def feather(arrow, path: Path):
    with pa.ipc.new_file(path, arrow.schema) as out:
        out.write_table(arrow)

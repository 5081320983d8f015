"""Writes the records in this folder, the same 300 rows in every format, with the programs laboratories use.

    pip install h5py npTDMS numpy openpyxl pandas polars pyarrow scipy && python generate.py [FOLDER]

`.ci/run generated` writes them anew into another folder and has the tests read those.

`record.csv` is the reference: every other file holds the same numbers to the last bit (or, where the name says
float32 or counts, what that type makes of them). The numbers are drawn from a fixed seed.
"""

import datetime
import gzip
import struct
import sys
from pathlib import Path

import h5py
import numpy as np
import openpyxl
import pandas as pd
import polars as pl
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.feather as feather
import pyarrow.parquet as pq
import scipy.io
from nptdms import ChannelObject, GroupObject, RootObject, TdmsFile, TdmsWriter

HERE = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent


def rows():
    """t [s], f1, f2, f3 [m/s^2]: noise of 5 mm/s^2 on a plateau, multiples of 1/8192 so that float32 holds them."""
    generator = np.random.default_rng(20261005)
    t = np.arange(300) / 128.0 - 0.5
    t[100:] += 0.25  # a gap
    t[200] = t[199]  # a repeated stamp
    f = np.array([-98.0, 0.125, 9.8125]) + 0.005 * generator.standard_normal((300, 3))
    return t, np.round(f * 8192) / 8192


def main():
    t, f = rows()
    write_text(t, f)
    write_parquet(t, f)
    write_arrays(t, f)
    write_hdf5(t, f)
    write_arrow(t, f)
    write_frames(t, f)
    write_tdms(t, f)
    write_encodings(t, f)
    write_sheets(t, f)


def write_text(t, f):
    matrix = np.column_stack([t, f])
    numbers = [[repr(float(v)) for v in row] for row in matrix]
    lines = [",".join(row) for row in numbers]
    text = "\n".join(["t,f1,f2,f3"] + lines) + "\n"
    (HERE / "record.csv").write_text(text)
    (HERE / "record.csv.gz").write_bytes(gzip.compress(text.encode(), mtime=0))
    (HERE / "record.csv.zst").write_bytes(pa.Codec("zstd").compress(text.encode(), asbytes=True))
    comma = [";".join(row).replace(".", ",") for row in numbers]
    (HERE / "comma.csv").write_text("\r\n".join(["\ufeff\"t\";\"f1\";\"f2\";\"f3\""] + comma) + "\r\n")
    tabs = ["\t".join(row).replace(".", ",") for row in numbers]
    (HERE / "headerless.tsv").write_text("\n".join(tabs) + "\n")
    np.savetxt(HERE / "headerless.txt", matrix, fmt="%25.17e")
    np.savetxt(HERE / "savetxt.txt", matrix, fmt="%.17g", header="rows of a session\nt f1 f2 f3")
    extra = [f'{i};"a;""b""";{row[3]};{row[1]};\'x\';{row[0]};{row[2]}' for i, row in enumerate(numbers)]
    (HERE / "extra.csv").write_text("\n".join(["# x", "", "n;text;f3;f1;u;t;f2"] + extra) + "\n\n\n")
    counter = [f"{round(v * 128)},{','.join(row[1:])}" for v, row in zip(t, numbers)]
    (HERE / "counter.csv").write_text("\n".join(["n,f1,f2,f3"] + counter) + "\n")
    start = datetime.datetime(2026, 10, 5, 10, 0, 0)
    stamps = [(start + datetime.timedelta(seconds=float(v))).isoformat(timespec="microseconds") for v in t]
    stamped = [",".join([stamp] + row[1:]) for stamp, row in zip(stamps, numbers)]
    (HERE / "stamps.csv").write_text("\n".join(["t,f1,f2,f3"] + stamped) + "\n")
    columns = {"t": pa.array(np.array(stamps, "datetime64[us]")), **{f"f{i + 1}": f[:, i] for i in range(3)}}
    pq.write_table(pa.table(columns), HERE / "stamps.parquet")


def write_arrays(t, f):
    matrix = np.column_stack([t, f])
    named = {"t": t, "f1": f[:, 0], "f2": f[:, 1], "f3": f[:, 2]}
    np.save(HERE / "rows.npy", matrix)
    np.save(HERE / "columns.npy", np.asfortranarray(matrix))
    np.save(HERE / "big_endian.npy", matrix.astype(">f4"))
    kinds = [("note", "<U3"), ("t", "<f8"), ("flag", "?"), ("f2", "<f4"), ("f1", ">f8"), ("f3", "<f8")]
    record = np.zeros(300, kinds)
    for name, values in named.items():
        record[name] = values
    np.save(HERE / "record.npy", record)
    np.savez(HERE / "plain.npz", **named, other=np.array(["text"]))
    np.savez_compressed(HERE / "packed.npz", **named)
    np.savez_compressed(HERE / "matrix.npz", matrix)
    counts = {name: np.round(f[:, i] * 8192).astype(kind) for i, (name, kind) in enumerate([("f1", "<i4"), ("f2", "<i2"), ("f3", ">u4")])}
    np.savez_compressed(HERE / "counts.npz", t=t, **counts)
    save_matlab("plain.mat", {"note": "text", **named, "z": 1 + 2j, "cell": np.array([1, "a"], object)})
    save_matlab("packed.mat", named, do_compression=True, oned_as="column")
    save_matlab("matrix.mat", {"data": matrix}, do_compression=True)
    save_matlab("counts.mat", {"t": t, "f1": counts["f1"], "f2": counts["f2"], "f3": counts["f3"].astype("<u4")})


def save_matlab(name, variables, **options):
    scipy.io.savemat(HERE / name, variables, **options)
    with open(HERE / name, "r+b") as file:
        file.write(b"MATLAB 5.0 MAT-file".ljust(116))  # without the time of writing


def write_hdf5(t, f):
    matrix = np.column_stack([t, f])
    with h5py.File(HERE / "named.h5", "w") as file:
        for name, values in {"t": t, "f1": f[:, 0], "f2": f[:, 1], "f3": f[:, 2]}.items():
            chunks = dict(chunks=(64,), compression="gzip", shuffle=True) if name != "f2" else {}
            file.create_dataset(name, data=values, **chunks)
    with h5py.File(HERE / "matrix.h5", "w") as file:
        file["data"] = matrix
    with h5py.File(HERE / "counts.h5", "w") as file:
        file["t"] = t.astype(np.float32)
        for i in range(3):
            file[f"f{i + 1}"] = np.round(f[:, i] * 8192).astype(np.int32)
    # Since 1.10 there is an index for every way in which chunks come: along one direction or two, a number of them, one, all at once.
    with h5py.File(HERE / "v110.h5", "w", libver=("v110", "v110")) as file:
        file.create_dataset("t", data=t, maxshape=(None,), chunks=(16,), compression="gzip", shuffle=True)
        file.create_dataset("f1", data=f[:, 0], maxshape=(None,), chunks=(16,))
        file.create_dataset("f2", data=f[:, 1], chunks=(64,), compression="gzip")
        file.create_dataset("f3", data=f[:, 2], chunks=(300,), compression="gzip")
    with h5py.File(HERE / "v110_rows.h5", "w", libver=("v110", "v110")) as file:
        file.create_dataset("data", data=matrix, maxshape=(None, 4), chunks=(64, 3), compression="gzip")
    with h5py.File(HERE / "v110_early.h5", "w", libver=("v110", "v110")) as file:
        early = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        early.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
        file.create_dataset("data", data=matrix, chunks=(64, 3), dcpl=early)
    for name, libver in [("", "earliest"), ("_v110", ("v110", "v110")), ("_v200", ("v200", "v200"))]:
        with h5py.File(HERE / f"unlimited{name}.h5", "w", libver=libver) as file:
            file.create_dataset("data", data=matrix, maxshape=(None, None), chunks=(64, 3), compression="gzip")
    # MATLAB 7.3 is not at hand: its form (a user block of 512 bytes, vectors as 1 x N) is documented.
    with h5py.File(HERE / "matlab73.mat", "w", userblock_size=512) as file:
        for name, values in {"t": t, "f1": f[:, 0], "f2": f[:, 1], "f3": f[:, 2]}.items():
            file.create_dataset(name, data=values[np.newaxis, :], chunks=(1, 300), compression="gzip")
    header = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM"
    with open(HERE / "matlab73.mat", "r+b") as file:
        file.write(header)


def write_parquet(t, f):
    table = pa.table({"t": t, "f1": f[:, 0], "f2": f[:, 1], "f3": f[:, 2]})
    required = pa.schema([pa.field(name, pa.float64(), nullable=False) for name in table.column_names])
    others = {"note": pa.array(["x"] * 300), "lists": pa.array([[1.0, 2.0]] * 300), "code": pa.array(range(300))}
    wide = pa.table({**others, "f3": f[:, 2], "f1": f[:, 0], "t": t, "f2": f[:, 1]})
    counts = pa.table({"t": pa.array(t, pa.float32()), **{f"f{i + 1}": pa.array((f[:, i] * 8192).astype(np.int32)) for i in range(3)}})
    long = pa.table({"t": t, **{f"f{i + 1}": pa.array((f[:, i] * 8192).astype(np.int64)) for i in range(3)}})
    pq.write_table(table, HERE / "snappy.parquet", compression="snappy")
    pq.write_table(table, HERE / "zstd.parquet", compression="zstd", row_group_size=97)
    pq.write_table(table, HERE / "gzip.parquet", compression="gzip", data_page_version="2.0")
    pq.write_table(table, HERE / "lz4.parquet", compression="lz4", data_page_size=512, write_batch_size=16)
    pq.write_table(table.slice(0, 3), HERE / "brotli.parquet", compression="brotli")
    pq.write_table(table.cast(required), HERE / "required.parquet", compression="none", use_dictionary=False)
    pq.write_table(table, HERE / "split.parquet", use_dictionary=False, use_byte_stream_split=True)
    pq.write_table(wide, HERE / "wide.parquet")
    pq.write_table(counts, HERE / "counts_int32.parquet")
    pq.write_table(long, HERE / "counts_int64.parquet", use_dictionary=False, column_encoding={"f1": "DELTA_BINARY_PACKED", "f2": "PLAIN", "f3": "DELTA_BINARY_PACKED"})
    holes = table.set_column(2, "f2", pa.array([None if i == 7 else float(v) for i, v in enumerate(f[:, 1])]))
    pq.write_table(holes, HERE / "null.parquet")
    text = table.set_column(2, "f2", pa.array([str(v) for v in f[:, 1]]))
    pq.write_table(text, HERE / "text.parquet")
    nan = table.set_column(3, "f3", pa.array(np.where(np.arange(300) == 250, np.nan, f[:, 2])))
    pq.write_table(nan, HERE / "nan.parquet", row_group_size=100)
    back = table.set_column(0, "t", pa.array(np.where(np.arange(300) == 150, -9.0, t)))
    pq.write_table(back, HERE / "backwards.parquet", row_group_size=150)


def write_arrow(t, f):
    table = pa.table({"t": t, "f1": f[:, 0], "f2": f[:, 1], "f3": f[:, 2]})
    for compression in ["uncompressed", "lz4", "zstd"]:
        feather.write_feather(table, HERE / f"{compression}.feather", compression=compression, chunksize=97)
    others = {"note": pa.array(["x"] * 300), "pair": pa.array([[1.0, 2.0]] * 300), "on": pa.array([True] * 300)}
    kinds = pa.array(["a", "b"] * 150).dictionary_encode()
    wide = pa.table({**others, "kind": kinds, "f3": f[:, 2], "f1": pa.array(f[:, 0], pa.float32()), "t": t, "f2": f[:, 1]})
    write_stream("wide.arrows", wide)
    write_stream("plain.arrows", table)
    counts = pa.table({"t": pa.array(t, pa.float32()), **{f"f{i + 1}": pa.array((f[:, i] * 8192).astype(kind)) for i, kind in enumerate(["i4", "i8", "u4"])}})
    feather.write_feather(counts, HERE / "counts.feather")
    start = np.datetime64("2026-10-05T10:00:00", "us")
    stamps = start + np.round(t * 1e6).astype("timedelta64[us]")
    feather.write_feather(table.set_column(0, "t", pa.array(stamps)), HERE / "stamps.feather")
    holes = table.set_column(2, "f2", pa.array([None if i == 7 else float(v) for i, v in enumerate(f[:, 1])]))
    feather.write_feather(holes, HERE / "null.feather")
    write_stream("text.arrows", table.set_column(2, "f2", pa.array([str(v) for v in f[:, 1]])))
    write_stamps(t, f)


def write_stamps(t, f):
    """A column of time for every unit of a timestamp, with a zone and without; in `stamps_of_units.txt` as NumPy writes them."""
    columns, texts = {}, {}
    for unit, per_second in [("s", 1), ("ms", 10**3), ("us", 10**6), ("ns", 10**9)]:
        # All digits of the unit are used.
        ticks = 1791194400 * per_second + np.floor(t * per_second).astype("i8") + np.arange(300) // 7
        stamps = ticks.astype(f"datetime64[{unit}]")
        for name, zone in [(unit, None), (f"{unit}_utc", "Europe/Moscow")]:
            columns[name] = pa.array(ticks).cast(pa.timestamp(unit, zone))
            texts[name] = np.datetime_as_string(stamps, unit, timezone="UTC" if zone else "naive")
    table = pa.table({**columns, **{f"f{i + 1}": f[:, i] for i in range(3)}})
    feather.write_feather(table, HERE / "stamps_of_units.feather")
    pq.write_table(table, HERE / "stamps_of_units.parquet", version="2.6")
    lines = [",".join(texts)] + [",".join(row) for row in zip(*texts.values())]
    (HERE / "stamps_of_units.txt").write_text("\n".join(lines) + "\n")
    write_dates(t, f)


def write_dates(t, f):
    """Dates and times of the day in two columns, in every type that Arrow has for them; midnight comes after half a second."""
    stamps = pa.array(np.datetime64("2026-10-06", "ns") + np.round(t * 1e9).astype("timedelta64[ns]"))
    days, times = stamps.cast(pa.date32()), stamps.cast(pa.time64("ns"))
    columns = {"Date": days, "Date64": days.cast(pa.date64()), "Time": times, "Time us": pc.cast(times, pa.time64("us"), safe=False)}
    columns |= {name: pc.cast(times, pa.time32(unit), safe=False) for name, unit in [("Time ms", "ms"), ("Time s", "s")]}
    table = pa.table({**columns, **{f"f{i + 1}": f[:, i] for i in range(3)}})
    feather.write_feather(table, HERE / "dates.feather")
    pq.write_table(table, HERE / "dates.parquet", version="2.6")


def write_stream(name, table):
    with pa.OSFile(str(HERE / name), "wb") as file, pa.ipc.new_stream(file, table.schema) as writer:
        writer.write_table(table, max_chunksize=64)


def write_frames(t, f):
    columns = {"t": t, "f1": f[:, 0], "f2": f[:, 1], "f3": f[:, 2]}
    pandas = pd.DataFrame(columns)
    pandas.to_csv(HERE / "pandas.csv")
    pandas.to_parquet(HERE / "pandas.parquet")
    pandas.to_feather(HERE / "pandas.feather")
    polars = pl.DataFrame(columns)
    polars.write_csv(HERE / "polars.csv")
    polars.write_parquet(HERE / "polars.parquet")
    polars.write_ipc(HERE / "polars.arrow", compression="zstd")
    polars.write_ipc_stream(HERE / "polars.arrows", compression="lz4")


def write_tdms(t, f):
    names = ["t", "f1", "f2", "f3"]
    values = dict(zip(names, [t, f[:, 0], f[:, 1], f[:, 2]]))
    with TdmsWriter(HERE / "plain.tdms", index_file=False) as writer:
        writer.write_segment([RootObject({"title": "a record"}), *(ChannelObject("g", n, v) for n, v in values.items())])
    # Several segments; the last ones say nothing new. Another group has text and a channel of its own length.
    with TdmsWriter(HERE / "segments.tdms") as writer:
        others = [ChannelObject("notes", "text", ["one", "two"]), ChannelObject("notes", "f9", np.arange(7, dtype=np.int8))]
        writer.write_segment(others + [ChannelObject("g", n, v[:10]) for n, v in values.items()])
        for k in range(10, 300, 29):
            writer.write_segment([ChannelObject("g", n, v[k : k + 29]) for n, v in values.items()])
    counts = {n: np.round(values[n] * 8192) for n in names[1:]}
    linear = lambda slope, intercept: {
        "NI_Number_Of_Scales": 1,
        "NI_Scaling_Status": "unscaled",
        "NI_Scale[0]_Scale_Type": "Linear",
        "NI_Scale[0]_Linear_Slope": slope,
        "NI_Scale[0]_Linear_Y_Intercept": intercept,
        "NI_Scale[0]_Linear_Input_Source": 0xFFFFFFFF,
    }
    chain = {
        "NI_Number_Of_Scales": 2,
        "NI_Scale[0]_Scale_Type": "Polynomial",
        "NI_Scale[0]_Polynomial_Coefficients_Size": 3,
        "NI_Scale[0]_Polynomial_Coefficients[0]": 1.0,
        "NI_Scale[0]_Polynomial_Coefficients[1]": 0.5,
        "NI_Scale[0]_Polynomial_Coefficients[2]": 0.0,
        "NI_Scale[0]_Polynomial_Input_Source": 0xFFFFFFFF,
        "NI_Scale[1]_Scale_Type": "Linear",
        "NI_Scale[1]_Linear_Slope": 2 / 8192,
        "NI_Scale[1]_Linear_Y_Intercept": -2 / 8192,
        "NI_Scale[1]_Linear_Input_Source": 0,
    }
    with TdmsWriter(HERE / "scaled.tdms") as writer:
        writer.write_segment([
            ChannelObject("g", "t", t),
            ChannelObject("g", "f1", counts["f1"].astype(np.int32), linear(1 / 8192, 0.0)),
            ChannelObject("g", "f2", counts["f2"].astype(np.int16), chain),
            ChannelObject("g", "f3", values["f3"].astype(np.float32), {"NI_Number_Of_Scales": 1, "NI_Scaling_Status": "scaled"}),
        ])
    waveform = {"wf_start_time": np.datetime64("2026-10-05T10:00:00"), "wf_start_offset": 0.25, "wf_increment": 1 / 128}
    with TdmsWriter(HERE / "waveform.tdms") as writer:
        writer.write_segment([ChannelObject("g", n, values[n], waveform) for n in names[1:]])
    stamps = np.datetime64("2026-10-05T10:00:00", "us") + np.round(t * 1e6).astype("timedelta64[us]")
    with TdmsWriter(HERE / "stamps.tdms") as writer:
        writer.write_segment([ChannelObject("g", "t", stamps), *(ChannelObject("g", n, values[n]) for n in names[1:])])
    # npTDMS writes neither interleaved data nor those of the driver DAQmx nor the high byte first: by the description of the format,
    # and read by npTDMS as what they are meant to be.
    rows = np.column_stack(list(values.values()))
    for name, order in [("interleaved.tdms", "<"), ("big_endian.tdms", ">")]:
        index = [struct.pack(order + "IIIQ", 20, 10, 1, 1) for _ in names]
        data = rows.astype(order + "f8").tobytes()
        (HERE / name).write_bytes(segment(names, index, data, 1 << 5, order))
    widths = [10]
    scalers = [(3, 0, 0, 0), (5, 0, 2, 0), (3, 0, 6, 0), (2, 0, 8, 0)]  # type, buffer, byte, scale
    index = [
        struct.pack("<IIIQI", 0x1269, 0xFFFFFFFF, 1, 100, 1) + struct.pack("<IIIII", kind, buffer, byte, 0, scale) + struct.pack("<II", 1, *widths)
        for kind, buffer, byte, scale in scalers
    ]
    raw = np.zeros(300, np.dtype({"names": names, "formats": ["<i2", "<i4", "<i2", "<u2"], "offsets": [0, 2, 6, 8], "itemsize": 10}))
    raw["t"] = np.round(t * 128)
    for n in names[1:]:
        raw[n] = counts[n] - (60000 if n == "f3" else 0)
    scale = lambda slope, intercept: {
        "NI_Number_Of_Scales": 2,
        "NI_Scale[1]_Scale_Type": "Linear",
        "NI_Scale[1]_Linear_Slope": slope,
        "NI_Scale[1]_Linear_Y_Intercept": intercept,
        "NI_Scale[1]_Linear_Input_Source": 0,
    }
    properties = [scale(1 / 128, 0.0), scale(1 / 8192, 0.0), scale(1 / 8192, 0.0), scale(1 / 8192, 60000 / 8192)]
    first = segment(names, index, raw[:200].tobytes(), 1 << 7, "<", properties)
    # The second segment has no metadata, and ends within a chunk.
    second = b"TDSm" + struct.pack("<IIQQ", 1 << 3 | 1 << 7, 4713, 1000, 0) + raw[200:].tobytes()
    (HERE / "daqmx.tdms").write_bytes(first + second)
    for name in ["plain", "segments", "scaled", "stamps", "interleaved", "big_endian", "daqmx"]:
        group = TdmsFile.read(HERE / f"{name}.tdms")["g"]
        for n in names[name == "stamps" :]:
            assert np.array_equal(group[n][:], values[n]), (name, n)


def segment(names, indices, data, contents, order, properties=({},) * 4):
    text = lambda words: struct.pack(order + "I", len(words)) + words.encode()
    metadata = struct.pack(order + "I", len(names))
    for name, index, own in zip(names, indices, properties):
        metadata += text(f"/'g'/'{name}'") + index + struct.pack(order + "I", len(own))
        for key, value in own.items():
            kind = {str: 0x20, float: 10, int: 7}[type(value)]
            metadata += text(key) + struct.pack(order + "I", kind)
            metadata += text(value) if kind == 0x20 else struct.pack(order + ("d" if kind == 10 else "I"), value)
    contents |= 1 << 1 | 1 << 2 | 1 << 3 | (1 << 6 if order == ">" else 0)
    lead_in = b"TDSm" + struct.pack("<I", contents) + struct.pack(order + "IQQ", 4713, len(metadata) + len(data), len(metadata))
    return lead_in + metadata + data


def write_encodings(t, f):
    """Text as Excel and LabVIEW write it: decimal commas, a header that is no ASCII, lines above it, a row of units."""
    names = ["Время", "Ускорение 1", "Ускорение 2", "Ускорение 3"]
    start = datetime.datetime(2026, 10, 5, 10, 0, 0)
    stamps = [(start + datetime.timedelta(seconds=float(v))).strftime("%d.%m.%Y %H:%M:%S,%f") for v in t]
    rows = [";".join([stamp, *(repr(float(v)).replace(".", ",") for v in row)]) for stamp, row in zip(stamps, f)]
    above = ["Рекордер;7", "Дата;05.10.2026", "", ";".join(names) + ";;", ";м/с^2;м/с^2;м/с^2;;"]
    text = "\r\n".join(above + [row + ";;" for row in rows] + [";;;;;"])
    for name, encoding in [("windows_1251", "cp1251"), ("utf_16", "utf-16"), ("utf_16_be", "utf-16-be"), ("utf_8_mark", "utf-8-sig")]:
        (HERE / f"{name}.csv").write_bytes(text.encode(encoding))
    table = pd.DataFrame({"Zeit": t, "Größe 1": f[:, 0], "Größe 2": f[:, 1], "Größe 3": f[:, 2]})
    table.to_csv(HERE / "latin_1.csv", sep="\t", decimal=",", encoding="latin-1", index=False)


def write_sheets(t, f):
    """Workbooks as people type them: a title over merged cells, a row of units, a second sheet; with dates; with formulas that nobody computed."""
    names = ["t", "f1", "f2", "f3"]
    book = openpyxl.Workbook()
    sheet = book.active
    sheet["A1"] = "A record; typed"
    sheet.merge_cells("A1:D1")
    sheet.append([])
    sheet.append([*names, "note"])
    sheet.append(["s", "m/s^2", "м/с²", "m/s2"])
    for row in np.column_stack([t, f]):
        sheet.append([*map(float, row), "a, \"b\""])
    book.create_sheet("other")["A1"] = "nothing"
    save_workbook(book, "typed.xlsx")
    book = openpyxl.Workbook()
    sheet = book.active
    sheet.append(names)
    start = datetime.datetime(2026, 10, 5, 10, 0, 0)
    for k, row in enumerate(f):
        sheet.append([start + datetime.timedelta(milliseconds=8 * k), *map(float, row)])
    save_workbook(book, "dates.xlsx")
    book = openpyxl.Workbook()
    sheet = book.active
    sheet.append(names)
    sheet.append([0, 1, 2, "=B2+C2"])
    save_workbook(book, "formula.xlsx")


def save_workbook(book, name):
    book.properties.created = book.properties.modified = datetime.datetime(2026, 10, 5)
    book.save(HERE / name)


if __name__ == "__main__":
    main()

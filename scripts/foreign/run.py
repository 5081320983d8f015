"""The example session in the forms of other laboratories, each calibrated from the file that `centrical init` drafts.

Every form is written from the example's records and telemetry; the marked lines of the draft are filled in with the example's
values, and nothing else is edited. The parameters have to be those of the example, to the rounding of the form.

    python3 scripts/foreign/run.py target/release/centrical
"""

import gzip
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy
import pandas

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples/ta-200"
PROGRAM = pathlib.Path(sys.argv[1]).resolve()
GRAVITY = 9.80665

ANSWERS = {
    'gravity = "?"': 'gravity = "9.81523 m/s^2"',
    'latitude = "?"': 'latitude = "55.7 deg"',
    'serial = "?"': 'serial = "0001"',
    'speed_uncertainty = "?"': "speed_uncertainty = 1e-5",
    'proof_masses = [[0, 0, 0], ["?", "?", "?"], ["?", "?", "?"]]':
        "proof_masses = [[0, 0, 0], [0.0210, 0.0120, 0.0105], [0.0150, -0.0100, -0.0140]]",
}


def read(kind, name):
    return pandas.read_csv(EXAMPLE / kind / name)


NAMES = sorted(path.name for path in (EXAMPLE / "records").glob("*.csv"))
RECORDS = {name: read("records", name) for name in NAMES}
TELEMETRY = {name: read("telemetry", name) for name in NAMES}


def text(frame, delimiter=",", decimal=".", header=True, digits=10):
    """A table as text, numbers with `digits` significant digits."""
    def number(value):
        return f"{value:.{digits}g}".replace(".", decimal) if isinstance(value, float) else str(value)
    lines = [delimiter.join(frame.columns)] if header else []
    lines += [delimiter.join(number(value) for value in row) for row in frame.itertuples(index=False)]
    return "\n".join(lines) + "\n"


class Form:
    """Writes the session of one laboratory. `raw` is the line of a nominal scale and bias."""
    # Standard uncertainties by which a parameter may move.
    rounding = 1e-6
    raw = None

    def write(self, folder):
        for name in NAMES:
            stem = name.removesuffix(".csv")
            self.record(folder, stem, RECORDS[name].astype(float))
            self.telemetry(folder, stem, TELEMETRY[name].astype(float))

    def telemetry(self, folder, stem, frame):
        (folder / f"{stem}_speed.csv").write_text(text(frame))


class Semicolons(Form):
    """Excel in German: semicolons, decimal commas, empty columns at the end."""
    def record(self, folder, stem, frame):
        body = text(frame, ";", ",")
        (folder / f"{stem}.csv").write_text("\n".join(line + ";;" for line in body.splitlines()) + "\n")


class Cyrillic(Form):
    """Windows-1251 with Russian names and a row of units."""
    def record(self, folder, stem, frame):
        frame = frame.set_axis(["Время", "Канал 1", "Канал 2", "Канал 3"], axis=1)
        header, rest = text(frame, ";", ",").split("\n", 1)
        (folder / f"{stem}.csv").write_bytes(f"{header}\nс;м/с²;м/с²;м/с²\n{rest}".replace("²", "^2").encode("cp1251"))

    def telemetry(self, folder, stem, frame):
        frame = frame.set_axis(["Время, с", "Скорость, об/мин"], axis=1)
        frame["Скорость, об/мин"] *= 30 / numpy.pi
        (folder / f"{stem}_speed.csv").write_bytes(text(frame, ";", ",", digits=15).encode("cp1251"))


class Utf16(Form):
    """UTF-16 with tabs, as Excel saves Unicode text."""
    def record(self, folder, stem, frame):
        (folder / f"{stem}.txt").write_bytes(text(frame, "\t").encode("utf-16"))


class LabView(Form):
    """Lines above the header, as LabVIEW writes them, with units in brackets."""
    def record(self, folder, stem, frame):
        above = "LabVIEW Measurement\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nOperator\tIvanov\n***End_of_Header***\n\n"
        frame = frame.set_axis(["Time [s]", "f1 [m/s^2]", "f2 [m/s^2]", "f3 [m/s^2]"], axis=1)
        (folder / f"{stem}.lvm").write_text(above + text(frame, "\t"))


class Stamps(Form):
    """Stamps with the day first and a decimal comma. Rounded times bring other samples into a window."""
    rounding = 0.5

    def record(self, folder, stem, frame):
        stamp = pandas.Timestamp("2026-10-05 09:10:00") + pandas.to_timedelta(frame["t"], unit="s")
        frame = frame.astype(object)
        frame["t"] = stamp.dt.strftime("%d.%m.%Y %H:%M:%S,%f").str[:-2]
        (folder / f"{stem}.csv").write_text(text(frame, ";", ","))

    def telemetry(self, folder, stem, frame):
        stamp = pandas.Timestamp("2026-10-05 09:10:00") + pandas.to_timedelta(frame["t"], unit="s")
        frame = frame.astype(object)
        frame["t"] = stamp.dt.strftime("%d.%m.%Y %H:%M:%S,%f").str[:-2]
        (folder / f"{stem}_speed.csv").write_text(text(frame, ";", ","))


class ThreeFiles(Form):
    """One file for each newtonometer."""
    def record(self, folder, stem, frame):
        for axis, column in zip("xyz", ["f1", "f2", "f3"]):
            (folder / f"{stem}_{axis}.csv").write_text(text(frame[["t", column]]))


class ThreeRecorders(Form):
    """One file for each newtonometer, by recorders of their own: the second samples 0.37 of a step later, the third at twice the rate.
    Interpolation is what moves a parameter."""
    rounding = 0.5

    def record(self, folder, stem, frame):
        late = frame["t"].iloc[:-1] + 0.0037
        often = numpy.linspace(frame["t"].iloc[0], frame["t"].iloc[-1], 2 * len(frame) - 1).round(4)
        second = pandas.DataFrame({"t": late, "f2": numpy.interp(late, frame["t"], frame["f2"])})
        third = pandas.DataFrame({"t": often, "f3": numpy.interp(often, frame["t"], frame["f3"])})
        for axis, one in zip("xyz", [frame[["t", "f1"]], second, third]):
            (folder / f"{stem}_{axis}.csv").write_text(text(one))


class Gs(Form):
    """Readings in g, with a row of units."""
    def record(self, folder, stem, frame):
        frame[["f1", "f2", "f3"]] /= GRAVITY
        header, rest = text(frame, digits=15).split("\n", 1)
        (folder / f"{stem}.csv").write_text(f"{header}\ns,g,g,g\n{rest}")


class Volts(Form):
    """Volts, with nominal scale and bias."""
    raw = "volts = { scale = [0.005, 0.005, 0.005], bias = [0.1, 0.1, 0.1] }"

    def record(self, folder, stem, frame):
        frame[["f1", "f2", "f3"]] = frame[["f1", "f2", "f3"]] * 0.005 + 0.1
        frame = frame.set_axis(["t (s)", "U1 (V)", "U2 (V)", "U3 (V)"], axis=1)
        (folder / f"{stem}.csv").write_text(text(frame, digits=15))


class Packed(Form):
    """Gzip, milliseconds. Rounded times bring other samples into a window."""
    rounding = 0.5

    def record(self, folder, stem, frame):
        frame = frame.rename(columns={"t": "time (ms)"})
        frame["time (ms)"] *= 1000
        with gzip.open(folder / f"{stem}.csv.gz", "wt") as file:
            file.write(text(frame, digits=12))


class Parquet(Form):
    """Parquet."""
    def record(self, folder, stem, frame):
        frame.to_parquet(folder / f"{stem}.parquet")

    def telemetry(self, folder, stem, frame):
        frame.to_parquet(folder / f"{stem}_speed.parquet")


class ParquetOfPandas(Form):
    """Parquet with names of another laboratory: stamps, units in names, a text column, the index. Rounded times bring other samples
    into a window."""
    rounding = 0.5

    def stamps(self, frame):
        return pandas.Timestamp("2026-10-05 09:10:00") + pandas.to_timedelta(frame["t"], unit="s")

    def record(self, folder, stem, frame):
        names = {"operator": "Ivanov", "stamp": self.stamps(frame), "acc_z [g]": frame["f3"] / GRAVITY, "acc_y [g]": frame["f2"] / GRAVITY,
                 "acc_x [g]": frame["f1"] / GRAVITY}
        pandas.DataFrame(names)[5:].to_parquet(folder / f"{stem}.parquet")

    def telemetry(self, folder, stem, frame):
        names = {"stamp": self.stamps(frame), "speed (rpm)": frame["omega"] * 30 / numpy.pi}
        pandas.DataFrame(names).to_parquet(folder / f"{stem}_speed.parquet")


class Matrix(Form):
    """Matrices of NumPy, without names."""
    def record(self, folder, stem, frame):
        numpy.save(folder / f"{stem}.npy", frame.to_numpy())

    def telemetry(self, folder, stem, frame):
        numpy.save(folder / f"{stem}_speed.npy", frame.to_numpy())


class Together(Form):
    """Readings and speed in one table, sampled together, temperature among them."""
    def record(self, folder, stem, frame):
        speed = TELEMETRY[f"{stem}.csv"]
        frame["omega"] = numpy.interp(frame["t"], speed["t"], speed["omega"])
        frame["Temp"] = 23.5
        (folder / f"{stem}.csv").write_text(text(frame))

    def telemetry(self, folder, stem, frame):
        pass


class NoHeader(Form):
    """Numbers alone, divided by blanks."""
    def record(self, folder, stem, frame):
        (folder / f"{stem}.dat").write_text(text(frame, "  ", header=False))

    def telemetry(self, folder, stem, frame):
        (folder / f"{stem}_speed.dat").write_text(text(frame, "  ", header=False))


class Tdms(Form):
    """NI TDMS, written by npTDMS, time by the properties of the waveform, which brings other samples into a window."""
    rounding = 0.5

    def record(self, folder, stem, frame):
        from nptdms import ChannelObject, TdmsWriter
        step = frame["t"].iloc[1] - frame["t"].iloc[0]
        waveform = {"wf_increment": step, "wf_start_offset": frame["t"].iloc[0]}
        with TdmsWriter(folder / f"{stem}.tdms") as writer:
            names = {"f1": "Acc X", "f2": "Acc Y", "f3": "Acc Z"}
            writer.write_segment([ChannelObject("data", names[f], frame[f].to_numpy(), waveform) for f in names])


FORMS = [Semicolons, Cyrillic, Utf16, LabView, Stamps, ThreeFiles, ThreeRecorders, Gs, Volts, Packed, Parquet, ParquetOfPandas, Matrix, Together, NoHeader, Tdms]


def run(*arguments, codes=(0,)):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode not in codes:
        raise RuntimeError(f"{' '.join(map(str, arguments))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def filled(draft, form):
    """The draft with the marked lines filled in; a first rest is at 0 deg, a later one at 180 deg."""
    marked = 0
    lines = []
    is_second = False
    for line in draft.splitlines():
        if "# FILL IN" in line:
            marked += 1
            for question, answer in ANSWERS.items():
                line = line.replace(question, answer)
            if 'angle = "?"' in line:
                line = line.replace('"?"', '"180 deg"' if is_second else '"0 deg"')
                is_second = not is_second
        if form.raw and line.startswith(form.raw.split(" = ")[0] + " = "):
            line = form.raw
        lines.append(line)
    return "\n".join(lines) + "\n", marked


def parameters(folder):
    result = json.loads((folder / "result.json").read_text())
    return {p["name"]: (p["value"], p["standard_uncertainty"]) for p in result["parameters"]}


def main():
    failed = 0
    with tempfile.TemporaryDirectory() as place:
        place = pathlib.Path(place)
        run("calibrate", EXAMPLE, "--out", place / "example")
        expected = parameters(place / "example")
        for kind in FORMS:
            form, folder = kind(), place / kind.__name__
            folder.mkdir()
            try:
                form.write(folder)
                toml = folder / "experiment.toml"
                run("init", folder, "--out", toml)
                draft, marked = filled(toml.read_text(), form)
                toml.write_text(draft)
                run("calibrate", folder, "--out", folder / "out")
                found = parameters(folder / "out")
                worst = max(abs(found[name][0] - value) / u for name, (value, u) in expected.items())
                verdict = "ok" if worst < form.rounding else "OTHER NUMBERS"
                print(f"{kind.__name__:12} {marked} lines filled in, largest difference {worst:.1e} u: {verdict}")
                failed += verdict != "ok"
            except (RuntimeError, ImportError) as error:
                failed += 1
                print(f"{kind.__name__:12} FAILED: {error}")
    print(f"{len(FORMS) - failed} of {len(FORMS)} forms calibrate to the example's parameters")
    sys.exit(failed > 0)


main()

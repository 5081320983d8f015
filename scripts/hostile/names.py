"""Names that command a terminal, deceive a reader, close a comment or break XML, in every text of every document."""

import json
import shutil
import subprocess
import xml.etree.ElementTree as xml

from judge import EXAMPLE, Group, files, parallel, run

# Each with a mark that survives: the text around it is still there.
HOSTILE = {
    "escape": "mark\x1b[2J\x1b]0;x\x07", "nul": "mark\x00x", "override": "mark\u202egnp.exe", "isolate": "mark\u2066x\u2069", "mark": "mark\ufeffx",
    "no character": "mark\ufffex\uffff", "c1": "mark\x9b31m", "comment": "mark*/ int x; /*", "trigraph": "mark??/", "markup": "mark</script><b>&amp;\"'",
    "cdata": "mark]]><!--", "lines": "mark\nACCEPTABLE\r\nx", "separators": "mark\u2028x\u2029", "backslash": "mark\\", "template": "mark@range@",
    "quotes": "mark\"\"\"'''", "long": "mark" + "x" * 5000, "tags": "mark\U000e0041", "percent": "mark%s%n{}", "combining": "mark" + "\u0301" * 50,
}
FORBIDDEN = [*"\x00\x07\x1b\x7f\x9b\u202a\u202e\u2066\u2069\u200b\u200e\u2028\ufeff\ufffe\uffff\U000e0041"]


def check(place):
    found = Group("hostile names in every text")
    kinds = list(HOSTILE)
    # Every kind in every place, each session with another kind in each: all documents of these.
    sessions = [{where: kinds[(n + 3 * k) % len(kinds)] for k, where in enumerate(ANYWHERE)} for n in range(len(kinds))]
    sessions += [{where: kind} for where in ("position", "record") for kind in kinds]
    for where, done in parallel(lambda session: documents(place, session), sessions):
        for what, run_, codes, why in done:
            found.judge(f"{where}: {what}", run_, codes=codes, why=why)
    yield found


ANYWHERE = ("title", "date", "model", "serial", "laboratory")

# Where a name stands in the experiment file.
PLACES = {
    "title": ('title = "Triad TA-200, six positions, two radii"', "title = {}"),
    "date": ("date = 2026-10-05", "date = {}"),
    "model": ('model = "TA-200"', "model = {}"),
    "serial": ('serial = "0001"', "serial = {}"),
    "position": ('id = "1"', "id = {}"),
    "record": ('record = "records/m01.csv"', "record = {}"),
}


def documents(place, session):
    """Everything that is made of a session with hostile names."""
    folder = place.new()
    text = ((EXAMPLE if "record" in session else place.reduced) / "experiment.toml").read_text()
    laboratory = (EXAMPLE / "laboratory.toml").read_text()
    for where, kind in session.items():
        quoted = '"' + "".join(c if c.isalnum() and c.isascii() else f"\\U{ord(c):08x}" for c in HOSTILE[kind]) + '"'
        if where == "laboratory":
            for name in ('"Northern Navigation Works"', '"A. Ivanova"', '"FS-1, no. 7"'):
                laboratory = laboratory.replace(name, quoted)
            continue
        before, after = PLACES[where]
        text = text.replace(before, after.format(quoted), 1)
        if where == "position":
            text = text.replace('position = "1"', f"position = {quoted}")
    (folder / "experiment.toml").write_text(text)
    shutil.copy(place.reduced / "plateaus.csv", folder)
    (folder / "laboratory.toml").write_text(laboratory)
    names = ", ".join(f"{where} {kind}" for where, kind in session.items())
    may_be_refused = "position" in session or "record" in session
    done = run(["calibrate", "experiment.toml", "--out", "out", "--laboratory", "laboratory.toml"], folder)
    # A certificate is refused where its font lacks a letter; the other documents are there.
    lacks_letters = done.code == 2 and "the font of the PDF" in done.message
    judged = [("calibrate", done, (0, 1, 2) if may_be_refused or lacks_letters else (0, 1), terminal(done))]
    if lacks_letters:
        done = run(["calibrate", "experiment.toml", "--out", "out"], folder)
        judged.append(("calibrate without a certificate", done, (0, 1), terminal(done)))
    if done.code != 2:
        for arguments in (["report", "out/result.json", "--code", "code"], ["observe", "experiment.toml"], ["compare", "out/result.json", "out/result.json"],
                          ["watch", "experiment.toml", "--once", "--out", "w"], ["calibrate", "experiment.toml", "--method", "recursive", "--out", "o"]):
            done = run(arguments, folder)
            judged.append((arguments[0], done, (0, 1), terminal(done)))
        for made in ("out", "code"):
            for file, data in files(folder / made).items():
                judged.append((file, None, (0,), inside(folder / made / file, data)))
    shutil.rmtree(folder)
    return names, judged


def terminal(done):
    """What is wrong with what a terminal gets."""
    text = done.text + done.message
    shown = [c for c in FORBIDDEN if c in text]
    if shown:
        return f"{shown!r} reaches the terminal"
    if "\nACCEPTABLE\nx" in text or "\nACCEPTABLE\r" in text:
        return "a forged line"
    return "a message of thousands of characters" if len(done.message) > 4000 else None


def inside(path, data):
    """What is wrong with a document."""
    if path.suffix == ".pdf":
        return None if data.startswith(b"%PDF") and data.rstrip().endswith(b"%%EOF") else "no PDF"
    text = data.decode("utf-8")
    # JSON keeps what it was given, escaped.
    shown = [c for c in FORBIDDEN if c in text]
    if shown:
        return f"{shown!r} stands there"
    if path.suffix in (".xml", ".svg"):
        xml.fromstring(text)
    if path.suffix == ".html" and ("<b>" in text or "</script>" in text):
        return "markup of a name"
    if path.suffix == ".py":
        compile(text, str(path), "exec")
    if path.suffix == ".c" and shutil.which("gcc"):
        built = subprocess.run(["gcc", "-std=c99", "-trigraphs", "-fsyntax-only", "-Wall", "-Wbidi-chars=any", "-Werror", str(path)], capture_output=True)
        return None if built.returncode == 0 else built.stderr.decode()[:300]
    return None

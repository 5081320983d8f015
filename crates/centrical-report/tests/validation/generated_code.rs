//! The generated code, compiled and run, against the library: gcc, clang, Octave, Python.
//!
//! A tool that is not installed is named on standard error and its part left out, unless `CENTRICAL_ALL_TOOLS` is
//! set, as `.ci/run` does after installing them.

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use centrical_compensate::{Compensation, Monomial, Term, reading};
use centrical_report::codegen::compensation_source;
use centrical_session::OutputSummary;
use tempfile::TempDir;

use crate::random::Random;

/// 1 g [m/s^2].
const G: f64 = 9.806_65;
const RANGE: f64 = 200.0 * G;
const READINGS: usize = 100_000;

/// A term under the name of its coefficient.
type Named = (String, Term);

/// The source's terms at 5 mg, 1e-3, 1e-5 /g, 1e-7 /g^2, with signs that differ.
fn kozlov() -> Vec<Named> {
    let sizes = [5e-3 * G, 1e-3, 1e-5 / G, 1e-7 / (G * G)];
    let model = centrical::ErrorModel::kozlov_2017();
    let term = |(k, term): (usize, &centrical::Term)| {
        let size = sizes[usize::from(term.monomial.degree())];
        let coefficient = size * (1.0 + (k as f64 * 0.618).sin()) * if k % 3 == 0 { -1.0 } else { 1.0 };
        let term = Term { axis: term.axis, monomial: term.monomial, coefficient };
        (model.terms[k].name.clone(), term)
    };
    model.terms.iter().enumerate().map(term).collect()
}

/// The same with a product, an odd square, a kink and a fourth power, under the names that sessions give them.
fn with_more_terms() -> Vec<Named> {
    let mut terms = kozlov();
    let mut add = |axis, monomial, coefficient| {
        let name = centrical::Term::new(axis, monomial).name;
        terms.push((name, Term { axis, monomial, coefficient }));
    };
    add(0, Monomial::product(&[0, 1]), 1e-5 / G);
    add(1, Monomial::odd_square(1), -1e-5 / G);
    add(2, Monomial { sign_of: Some(2), ..Monomial::power(2, 1) }, 1e-3);
    add(2, Monomial::power(0, 4), 1e-10 / G.powi(3));
    terms
}

/// Axes of specific forces, if not those of the newtonometers.
type Axes = Option<[[f64; 3]; 3]>;

/// Far from the newtonometers' axes, so that a transposed matrix shows.
const TURNED: Axes = Some([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]]);

fn models() -> [(&'static str, Vec<Named>, Axes); 4] {
    [
        ("kozlov", kozlov(), None),
        ("with more terms", with_more_terms(), None),
        ("without terms", Vec::new(), None),
        ("in other axes", kozlov(), TURNED),
    ]
}

/// A folder with the generated files, whose heading tries to break out of its comment.
fn generate(terms: &[Named], axes: Axes) -> TempDir {
    generate_for(terms, None, axes)
}

/// The same for a unit with raw output of its own.
fn generate_for(terms: &[Named], output: Option<&OutputSummary>, axes: Axes) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let heading = ["TA-200 */ No. 0001 /* ??/\\".to_owned(), "line\nof \"\"\" a session @vectors@".to_owned()];
    let (names, plain): (Vec<String>, Vec<Term>) = terms.iter().cloned().unzip();
    let compensation = Compensation::new(plain, RANGE).unwrap();
    let compensation = match axes {
        Some(axes) => compensation.in_axes(axes),
        None => compensation,
    };
    for file in compensation_source(&heading, &names, &compensation, 0.5 * RANGE, output) {
        fs::write(folder.path().join(file.name), file.text).unwrap();
    }
    folder
}

/// Whether a tool can be run.
fn has(tool: &str) -> bool {
    let answers = Command::new(tool).arg("--version").output().is_ok_and(|output| output.status.success());
    assert!(answers || std::env::var_os("CENTRICAL_ALL_TOOLS").is_none(), "{tool} is not installed");
    if !answers {
        eprintln!("{tool} is not installed: the code generated for it is not checked");
    }
    answers
}

/// What a program prints when it is given `input`; its warnings and errors are a failure.
fn run(command: &mut Command, input: &str) -> String {
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut pipe = child.stdin.take().unwrap();
    let input = input.to_owned();
    let writer = std::thread::spawn(move || pipe.write_all(input.as_bytes()));
    let output = child.wait_with_output().unwrap();
    // A program that needs no input may end before it is all written.
    let _ = writer.join().unwrap();
    let messages = String::from_utf8_lossy(&output.stderr);
    // Octave 7 takes leave like this whatever it was asked.
    let messages = messages.replace("error: ignoring const execution_exception& while preparing to exit\n", "");
    assert!(output.status.success() && messages.is_empty(), "{command:?}: {}\n{messages}", output.status);
    String::from_utf8(output.stdout).unwrap()
}

/// Random readings over the range, here and there one from beyond it.
fn readings(terms: &[Term]) -> Vec<[f64; 3]> {
    let mut random = Random::new(1);
    let mut one = |k: usize| {
        let scale = if k.is_multiple_of(100) { 1.2 * RANGE } else { RANGE };
        reading(terms, [(); 3].map(|()| scale * (2.0 * random.uniform() - 1.0)))
    };
    (0..READINGS).map(&mut one).collect()
}

fn as_text(readings: &[[f64; 3]]) -> String {
    readings.iter().fold(String::new(), |mut text, [a, b, c]| {
        writeln!(text, "{a:e} {b:e} {c:e}").unwrap();
        text
    })
}

/// Compares lines `f1 f2 f3`, or `outside`, with the library: each to `tolerance` of the largest component.
fn agrees(lines: &str, readings: &[[f64; 3]], (terms, axes): (&[Term], Axes), tolerance: f64, what: &str) {
    let compensation = Compensation::new(terms, RANGE).unwrap();
    let compensation = axes.map_or(compensation, |axes| compensation.in_axes(axes));
    let (mut worst, mut refused) = (0.0_f64, 0);
    assert_eq!(lines.lines().count(), readings.len(), "{what}");
    for (line, reading) in lines.lines().zip(readings) {
        match compensation.apply(*reading) {
            Err(_) => {
                assert_eq!(line, "outside", "{what}: {reading:?}");
                refused += 1;
            }
            Ok(f) => {
                let found: Vec<f64> = line.split_whitespace().map(|word| word.parse().expect(line)).collect();
                let largest = f.iter().fold(0.0_f64, |largest, x| x.abs().max(largest));
                let error = (0..3).map(|i| (found[i] - f[i]).abs()).fold(0.0, f64::max);
                worst = worst.max(error / largest);
            }
        }
    }
    println!("{what}: {worst:.2e} relative over {} readings, {refused} refused", readings.len());
    assert!(worst <= tolerance, "{what}: {worst:e}");
    assert!((1..READINGS / 100).contains(&refused), "{what}: {refused} refused");
}

/// Reads `f1 f2 f3` from standard input; argument `f` chooses single precision. The test vectors are run first.
const C_MAIN: &str = r#"
#include <stdio.h>
#include "centrical_compensate.h"
int main(int argc, char **argv) {
    double f[3];
    float s[3];
    int i, outside;
    (void)argv;
    if (centrical_compensate_self_test() != 0) { return 1; }
    while (scanf("%lf %lf %lf", &f[0], &f[1], &f[2]) == 3) {
        if (argc > 1) {
            for (i = 0; i < 3; i++) { s[i] = (float)f[i]; }
            outside = centrical_compensate_float(s, s);
            for (i = 0; i < 3; i++) { f[i] = (double)s[i]; }
        } else {
            outside = centrical_compensate(f, f);
        }
        if (outside) { puts("outside"); } else { printf("%.17g %.17g %.17g\n", f[0], f[1], f[2]); }
    }
    return 0;
}
"#;

fn check_c(compiler: &str, optimisation: &str, (name, terms, axes): (&str, &[Named], Axes)) {
    let folder = generate(terms, axes);
    let at = |name: &str| folder.path().join(name);
    fs::write(at("main.c"), C_MAIN).unwrap();
    let mut compile = Command::new(compiler);
    compile.args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-Wconversion", optimisation, "-o"]);
    compile.args(["program", "main.c", "centrical_compensate.c"]).current_dir(&folder);
    run(&mut compile, "");

    let plain: Vec<Term> = terms.iter().map(|(_, term)| *term).collect();
    let readings = readings(&plain);
    let what = format!("{compiler} {optimisation}, {name}");
    let double = run(&mut Command::new(at("program")), &as_text(&readings));
    agrees(&double, &readings, (&plain, axes), 1e-12, &format!("{what}, double"));

    // Single precision is given what it can hold, and not within its rounding of the edge.
    let [less, more] = [1.0 - 1e-5, 1.0 + 1e-5].map(|scale| Compensation::new(&plain, scale * RANGE).unwrap());
    let near_edge = |r: &[f64; 3]| less.apply(*r).is_ok() != more.apply(*r).is_ok();
    #[allow(clippy::cast_possible_truncation, reason = "single precision is what is checked")]
    let rounded = readings.iter().map(|r| r.map(|x| f64::from(x as f32)));
    let rounded: Vec<[f64; 3]> = rounded.filter(|r| !near_edge(r)).collect();
    let single = run(Command::new(at("program")).arg("f"), &as_text(&rounded));
    agrees(&single, &rounded, (&plain, axes), 1e-6, &format!("{what}, single"));
}

#[test]
fn c_by_gcc() {
    if has("gcc") {
        for (name, terms, axes) in models() {
            check_c("gcc", "-O0", (name, &terms, axes));
        }
        check_c("gcc", "-O2", ("kozlov", &kozlov(), None));
    }
}

#[test]
fn c_by_clang() {
    if has("clang") {
        for (name, terms, axes) in models() {
            check_c("clang", "-O2", (name, &terms, axes));
        }
    }
}

const OCTAVE_MAIN: &str = r#"
centrical_compensate();
[f, outside] = centrical_compensate(load("-ascii", "readings.txt"));
file = fopen("answers.txt", "w");
fprintf(file, "%.17g %.17g %.17g\n", f.');
fclose(file);
if any(outside != any(isnan(f), 2)), exit(1); end
"#;

/// Anything but a matrix of readings, and a second argument other than 'raw', end in an error that says so; integers and single precision
/// count as double. `is_raw` says whether the unit has raw output.
const OCTAVE_REFUSALS: &str = r#"
function said = message(varargin)
  said = "";
  try
    centrical_compensate(varargin{:});
  catch problem
    said = problem.message;
  end
end
function expect(said, part)
  if isempty(strfind(said, part)), error('found "%s", expected "%s"', said, part); end
end
expect(message([10; 20; 30]), "found a double array of 3 x 1, expected real numbers, N x 3");
expect(message([]), "found a double array of 0 x 0, expected");
expect(message(ones(2, 3, 2)), "found a double array of 2 x 3 x 2, expected");
expect(message("abc"), "found a char array of 1 x 3, expected");
expect(message([1i 2 3]), "expected real numbers");
if is_raw, among = "'raw'"; else among = "readings in m/s^2 alone"; end
expect(message([1 2 3], "Raw"), ["found 'Raw', expected " among]);
expect(message([1 2 3], "volts"), ["found 'volts', expected " among]);
expect(message([1 2 3], 1), "found a second argument of class double, expected");
if ~is_raw, expect(message([1 2 3], "raw"), "found 'raw', expected readings in m/s^2 alone"); end
if any(centrical_compensate(int16([10 20 30])) ~= centrical_compensate([10 20 30])), error("integers"); end
f = centrical_compensate(single([1000.5 -20.25 30.125]));
if ~isa(f, "double") || any(f ~= centrical_compensate([1000.5 -20.25 30.125])), error("single precision"); end
"#;

#[test]
fn octave_refuses_what_is_no_reading() {
    if !has("octave-cli") {
        return;
    }
    for (output, is_raw) in [(None, "is_raw = false;"), (Some(counts()), "is_raw = true;")] {
        let folder = generate_for(&kozlov(), output.as_ref(), None);
        fs::write(folder.path().join("main.m"), format!("{is_raw}\n{OCTAVE_REFUSALS}")).unwrap();
        run(Command::new("octave-cli").args(["--no-init-file", "main.m"]).current_dir(&folder), "");
    }
}

#[test]
fn octave() {
    if !has("octave-cli") {
        return;
    }
    for (name, terms, axes) in models() {
        let folder = generate(&terms, axes);
        let plain: Vec<Term> = terms.iter().map(|(_, term)| *term).collect();
        let readings = readings(&plain);
        fs::write(folder.path().join("readings.txt"), as_text(&readings)).unwrap();
        fs::write(folder.path().join("main.m"), OCTAVE_MAIN).unwrap();
        run(Command::new("octave-cli").args(["--no-init-file", "main.m"]).current_dir(&folder), "");
        let answers = fs::read_to_string(folder.path().join("answers.txt")).unwrap();
        let answers = answers.replace("NaN NaN NaN", "outside");
        agrees(&answers, &readings, (&plain, axes), 1e-12, &format!("Octave, {name}"));
    }
}

const PYTHON_MAIN: &str = r#"
import sys
from centrical_compensate import compensate, self_test

self_test()
for line in sys.stdin:
    try:
        print(*map(repr, compensate([float(word) for word in line.split()])))
    except ValueError:
        print("outside")
"#;

#[test]
fn python() {
    if !has("python3") {
        return;
    }
    for (name, terms, axes) in models() {
        let folder = generate(&terms, axes);
        let plain: Vec<Term> = terms.iter().map(|(_, term)| *term).collect();
        let readings = readings(&plain);
        fs::write(folder.path().join("main.py"), PYTHON_MAIN).unwrap();
        let answers = run(Command::new("python3").args(["-B", "main.py"]).current_dir(&folder), &as_text(&readings));
        agrees(&answers, &readings, (&plain, axes), 1e-12, &format!("Python, {name}"));
        run(Command::new("python3").args(["-B", "centrical_compensate.py"]).current_dir(&folder), "");
    }
}

/// The nominal output of a unit in counts, its axes apart from each other.
fn counts() -> OutputSummary {
    OutputSummary { unit: "counts".to_owned(), scale: [105_123.0, -98_000.5, 1.1e5], bias: [12.5, -340.0, 7.0] }
}

/// The program of `PYTHON_MAIN` by arrays, and from raw output.
const NUMPY_MAIN: &str = r#"
import sys
import numpy
from centrical_compensate import RAW_BIAS, RAW_SCALE, compensate, compensate_array, compensate_raw, compensate_raw_array, self_test

self_test()
readings = numpy.loadtxt(sys.stdin)
raw = readings * RAW_SCALE + RAW_BIAS
for f, of_raw in zip(compensate_array(readings), compensate_raw_array(raw)):
    assert numpy.allclose(f, of_raw, rtol=1e-9, atol=1e-9, equal_nan=True) or numpy.isnan(f).any() or numpy.isnan(of_raw).any()
    print("outside" if numpy.isnan(f).any() else " ".join(map(repr, map(float, f))))
assert numpy.allclose(compensate_raw(raw[1]), compensate_array(readings)[1], rtol=1e-9)
assert compensate_array(readings[:0]).shape == (0, 3)
# A row of single precision counts as the same numbers in double.
single, raw_single = readings[1].astype(numpy.float32), raw[1].astype(numpy.float32)
assert compensate(single) == compensate([float(x) for x in single]) and isinstance(compensate(single)[0], float)
assert compensate_raw(raw_single) == compensate_raw([float(x) for x in raw_single])
for four in (compensate, compensate_raw):
    try:
        four((1.0, 2.0, 3.0, 4.0))
    except ValueError as error:
        assert "found 4 numbers, expected 3" in str(error)
    else:
        sys.exit(1)
# A row with one masked number has no specific force.
for array, of in ((readings, compensate_array), (raw, compensate_raw_array), (numpy.rint(raw).astype(int), compensate_raw_array)):
    mask = [[True, False, False], [False, False, False]]
    found = of(numpy.ma.masked_array(array[1:3], mask=mask))
    assert type(found) is numpy.ndarray and numpy.isnan(found[0]).all()
    assert (found[1] == of(array[2:3])[0]).all()
try:
    compensate_array(readings.T)
except ValueError:
    sys.exit(0)
sys.exit(1)
"#;

/// Arrays give what single readings give, and raw output what its readings give.
#[test]
fn numpy() {
    let has_numpy = || Command::new("python3").args(["-c", "import numpy"]).output().is_ok_and(|o| o.status.success());
    let is_there = has_numpy();
    assert!(is_there || std::env::var_os("CENTRICAL_ALL_TOOLS").is_none(), "NumPy is not installed");
    if !is_there {
        eprintln!("NumPy is not installed: the code generated for it is not checked");
        return;
    }
    for (name, terms, axes) in models() {
        let folder = generate_for(&terms, Some(&counts()), axes);
        let plain: Vec<Term> = terms.iter().map(|(_, term)| *term).collect();
        let readings = readings(&plain);
        fs::write(folder.path().join("main.py"), NUMPY_MAIN).unwrap();
        let answers = run(Command::new("python3").args(["-B", "main.py"]).current_dir(&folder), &as_text(&readings));
        agrees(&answers, &readings, (&plain, axes), 1e-12, &format!("NumPy, {name}"));
    }
}

/// Every language takes the raw output of a unit in counts: its own test vectors, as raw output, pass; with another scale
/// they do not.
#[test]
fn raw_output_by_every_language() {
    let folder = generate_for(&kozlov(), Some(&counts()), TURNED);
    fs::write(folder.path().join("main.c"), C_MAIN).unwrap();
    let check = |is_sound: bool| {
        let succeeds = |command: &mut Command| command.current_dir(&folder).output().unwrap().status.success();
        if has("python3") {
            assert_eq!(succeeds(Command::new("python3").args(["-B", "centrical_compensate.py"])), is_sound, "Python");
        }
        if has("octave-cli") {
            let arguments = ["--no-init-file", "--eval", "centrical_compensate()"];
            assert_eq!(succeeds(Command::new("octave-cli").args(arguments)), is_sound, "Octave");
        }
        if has("gcc") {
            let strict = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-Wconversion", "-o", "program"];
            assert!(succeeds(Command::new("gcc").args(strict).args(["main.c", "centrical_compensate.c"])));
            let mut program = Command::new(folder.path().join("program"));
            assert_eq!(succeeds(program.stdin(Stdio::null())), is_sound, "C");
        }
    };
    check(true);
    // The first place where each applies the bias of axis 1: the constants, not the test.
    for (name, from, to) in [
        ("centrical_compensate.py", "(raw[i] - RAW_BIAS[i])", "(raw[i] - 1.01 * RAW_BIAS[i])"),
        ("centrical_compensate.m", "bsxfun(@minus, reading, [1.25e1,", "bsxfun(@minus, reading, [1.26e1,"),
        ("centrical_compensate.c", "raw_bias[3] = {1.25e1,", "raw_bias[3] = {1.26e1,"),
    ] {
        let file = folder.path().join(name);
        let text = fs::read_to_string(&file).unwrap();
        assert!(text.contains(from), "{name}");
        fs::write(&file, text.replacen(from, to, 1)).unwrap();
    }
    check(false);
}

/// The test vectors have power: a coefficient that is off by the tolerance is found by each language.
#[test]
fn test_vectors_find_a_wrong_coefficient() {
    let folder = generate(&kozlov(), None);
    spoil(folder.path(), "centrical_compensate.py", "COEFFICIENTS = (\n    ");
    spoil(folder.path(), "centrical_compensate.m", "  c = [\n    ");
    spoil(folder.path(), "centrical_compensate.c", "coefficient[] = {\n    ");
    fs::write(folder.path().join("main.c"), C_MAIN).unwrap();
    let fails = |command: &mut Command| !command.current_dir(&folder).output().unwrap().status.success();
    if has("python3") {
        assert!(fails(Command::new("python3").args(["-B", "centrical_compensate.py"])));
    }
    if has("octave-cli") {
        assert!(fails(Command::new("octave-cli").args(["--no-init-file", "--eval", "centrical_compensate()"])));
    }
    if has("gcc") {
        let build = ["-std=c99", "-o", "program", "main.c", "centrical_compensate.c"];
        assert!(!fails(Command::new("gcc").args(build)));
        assert!(fails(Command::new(folder.path().join("program")).stdin(Stdio::null())));
    }
}

/// Moves the first coefficient, a bias, by 1e-8 m/s^2.
fn spoil(folder: &Path, name: &str, table: &str) {
    let text = fs::read_to_string(folder.join(name)).unwrap();
    let start = text.find(table).unwrap() + table.len();
    fs::write(folder.join(name), format!("{}1e-8 + {}", &text[..start], &text[start..])).unwrap();
}

//! What commands print fits the width of the terminal; colour repeats what words say, and only where it is wanted.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::session::{Copy, example};

/// Runs in a folder with variables set; others of width and colour are unset.
fn printed(folder: &Path, arguments: &[&str], variables: &[(&str, &str)]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_centrical"));
    for name in ["COLUMNS", "NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE"] {
        command.env_remove(name);
    }
    let output = command.args(arguments).current_dir(folder).envs(variables.iter().copied()).output().unwrap();
    assert!(output.status.code() != Some(2), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn assert_fits(text: &str, width: usize, of: &[&str]) {
    assert!(!text.is_empty(), "{of:?} prints nothing");
    for line in text.lines() {
        assert!(line.chars().count() <= width, "{of:?} at {width}: {} characters: {line}", line.chars().count());
    }
}

#[test]
fn every_command_fits_80_columns() {
    let copy = Copy::new();
    let folder = copy.session();
    let commands: [&[&str]; 12] = [
        &["calibrate", "."],
        &["assess", ".", "--correlations", "--without-outliers"],
        &["models", "."],
        &["observe", "."],
        &["montecarlo", ".", "--runs", "20"],
        &["noise", "."],
        &["compare", "result.json", "result.json", "--years", "2"],
        &["compensate", "result.json", "records/m01.csv", "--out", "f.csv"],
        &["reduce", ".", "--out", "reduced"],
        &["init", "records", "telemetry", "--out", "draft.toml"],
        &["watch", ".", "--once", "--out", "watched"],
        &["report", "result.json", "--html", "report.html"],
    ];
    for arguments in commands {
        let text = printed(&folder, arguments, &[]);
        if arguments[0] != "report" {
            assert_fits(&text, 80, arguments);
        }
    }
    for width in [60, 120] {
        let columns = width.to_string();
        for arguments in &commands[..2] {
            assert_fits(&printed(&folder, arguments, &[("COLUMNS", &columns)]), width, arguments);
        }
    }
}

/// The lines that the README shows are lines of the program, but for dots and the lines between which they stand.
#[test]
fn the_readme_shows_what_is_printed() {
    let copy = Copy::new();
    let text = printed(&copy.session(), &["calibrate", "."], &[]);
    let readme = fs::read_to_string(example().join("../../README.md")).unwrap();
    let shown = readme.split("```text\n").nth(1).unwrap().split("```").next().unwrap();
    assert!(shown.lines().count() > 20);
    let mut lines = text.lines();
    for line in shown.lines().filter(|line| *line != "  ...") {
        assert!(lines.any(|printed| printed == line), "not printed, or not in this order: {line}");
    }
}

#[test]
fn the_verdict_comes_first_and_in_colour_where_it_is_wanted() {
    let copy = Copy::new();
    let folder = copy.session();
    let plain = printed(&folder, &["calibrate", "."], &[]);
    assert!(plain.starts_with("ACCEPTABLE  no check raised an objection\n"), "{plain}");
    assert_eq!(plain.lines().last(), plain.lines().next(), "the text is longer than a screen");
    assert!(!plain.contains('\u{1b}'), "a pipe has no colour");
    let coloured = printed(&folder, &["calibrate", "."], &[("CLICOLOR_FORCE", "1")]);
    assert!(coloured.starts_with("\u{1b}[32m\u{1b}[1mACCEPTABLE\u{1b}[0m  no check"), "{coloured:?}");
    let without = without_colour(&coloured);
    assert_eq!(without, plain, "colour changes no word");
    assert_eq!(printed(&folder, &["calibrate", "."], &[("NO_COLOR", "1")]), plain);
}

/// The text without sequences of colour.
fn without_colour(text: &str) -> String {
    let mut pieces = text.split("\u{1b}[");
    let first = pieces.next().unwrap_or_default().to_owned();
    pieces.fold(first, |text, piece| text + piece.split_once('m').unwrap().1)
}

//! What stands around the commands: version, help, completions, manual pages.

use std::fs;

use crate::session::Copy;

fn printed(copy: &Copy, arguments: &[&str]) -> String {
    let output = copy.run(arguments);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Names of the commands, from the help.
fn commands(help: &str) -> Vec<&str> {
    let lines = help.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   ") && !line.contains(" -"));
    lines.filter_map(|line| line.split_whitespace().next()).collect()
}

#[test]
fn the_version_names_the_program() {
    let copy = Copy::new();
    let expected = concat!("centrical ", env!("CARGO_PKG_VERSION"), "\n");
    assert_eq!(printed(&copy, &["--version"]), expected);
    assert_eq!(printed(&copy, &["-V"]), expected);
}

#[test]
fn help_completions_and_manual_pages_know_every_command() {
    let copy = Copy::new();
    let help = printed(&copy, &["--help"]);
    let names = commands(&help);
    assert!(names.len() >= 17 && names.contains(&"calibrate"), "{help}");
    for shell in ["bash", "zsh", "fish", "powershell"] {
        let script = printed(&copy, &["completions", shell]);
        for word in names.iter().chain(&["hold-out", "within-calibration"]) {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    printed(&copy, &["man", "--out", "pages"]);
    let pages = fs::read_dir(copy.out().join("pages")).unwrap().count();
    assert_eq!(pages, names.len() + 1);
    for name in names {
        let page = fs::read_to_string(copy.out().join(format!("pages/centrical-{name}.1"))).unwrap();
        assert!(page.contains(".SH NAME") && page.contains(&format!("Example: centrical {name} ")), "{page}");
    }
}

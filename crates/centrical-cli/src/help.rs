//! The help of the program: its commands in groups, by the task that they are for.

use std::fmt::Write;

use clap::Command;

/// Tasks in their order, and the commands of each.
pub const GROUPS: [(&str, &[&str]); 5] = [
    ("Prepare", &["init", "schema", "observe", "plan", "simulate"]),
    ("Measure", &["watch", "reduce", "noise"]),
    ("Calibrate", &["calibrate", "tumble", "series", "history", "models", "assess", "montecarlo", "compare"]),
    ("Use", &["report", "view", "compensate"]),
    ("This program", &["completions", "man"]),
];

/// Columns of the commands and of what they do.
const INDENT: usize = 15;
const WIDTH: usize = 80;

/// The program with its commands in groups in its help.
pub fn grouped(program: Command) -> Command {
    let commands = commands(&program);
    let template = "{about-with-newline}\n{usage-heading} {usage}\n\n{before-help}Options:\n{options}{after-help}";
    program.before_help(commands).help_template(template)
}

/// The commands in groups, each with the first sentence of its help.
fn commands(program: &Command) -> String {
    let mut text = String::new();
    for (task, names) in GROUPS {
        let _ = writeln!(text, "{task}:");
        for command in names.iter().filter_map(|name| program.find_subcommand(name)) {
            let about = command.get_about().map(ToString::to_string).unwrap_or_default();
            let lines = folded(&about, WIDTH - INDENT);
            let _ = writeln!(text, "  {:<width$}{lines}", command.get_name(), width = INDENT - 2);
        }
        text.push('\n');
    }
    text + "centrical COMMAND --help shows the options of a command and an example."
}

/// A text in lines of `width` characters at most; those after the first are indented.
fn folded(text: &str, width: usize) -> String {
    let mut lines = String::new();
    let mut used = 0;
    for word in text.split_whitespace() {
        let length = word.chars().count();
        if used > 0 && used + 1 + length > width {
            let _ = write!(lines, "\n{:INDENT$}", "");
            used = 0;
        } else if used > 0 {
            lines.push(' ');
            used += 1;
        }
        lines.push_str(word);
        used += length;
    }
    lines
}

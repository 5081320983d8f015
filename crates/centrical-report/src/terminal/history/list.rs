//! The calibrations of a store as text for the terminal.

use centrical_session::{DoubtKind, HistoryLine, HistoryList, unit_name};

use crate::number::counted;
use crate::terminal::phrases::short_list;
use crate::terminal::screen::{Emphasis, Screen};
use crate::terminal::table::{Align, Table};

/// A line for each calibration, by unit and day.
pub fn history_list_text(list: &HistoryList) -> Screen {
    let mut screen = Screen::default();
    let failed = list.failed();
    let calibrations = counted(list.calibrations.len() - failed, "calibration");
    screen.head("CALIBRATIONS", &format!("{calibrations}, {}", counted(failed, "failed session")));
    let names = ["date", "model", "serial", "station"];
    let mut table =
        Table::new(3, &[(Align::Left, &names), (Align::Right, &["chi^2/nu"]), (Align::Words, &["verdict"])]);
    for line in &list.calibrations {
        let ratio = line.ratio().map_or(String::new(), |ratio| format!("{ratio:.3}"));
        let cells = [&line.date, &line.unit_model, &line.unit_serial, &line.station].map(|text| text.as_str().into());
        table.row(cells.into_iter().chain([ratio.into(), verdict(line).into()]));
    }
    screen.table(table);
    doubts(&mut screen, list);
    screen
}

fn verdict(line: &HistoryLine) -> String {
    match (line.acceptable, &line.message) {
        (Some(true), _) => "acceptable".to_owned(),
        (Some(false), _) => format!("not acceptable: {}", line.objections.join(", ")),
        (None, message) => format!("failed: {}", message.as_deref().unwrap_or_default()),
    }
}

/// What may not be meant in a store that was checked.
fn doubts(screen: &mut Screen, list: &HistoryList) {
    let Some(doubts) = &list.doubts else { return };
    screen.gap();
    if doubts.is_empty() {
        screen.marked(Emphasis::Acceptable, "CHECKED", "names, days, repeated results and copies raise no doubt");
    }
    for doubt in doubts {
        let (mark, words) = words(doubt.kind);
        let of: Vec<String> = doubt.of.iter().map(|of| named(list, of)).collect();
        screen.marked(Emphasis::NotAcceptable, mark, &format!("{}: {words}", short_list(&of, MOST_SHOWN, "; ")));
    }
}

/// A calibration by its unit and day before its key; other names as they are.
fn named(list: &HistoryList, of: &str) -> String {
    let line = list.calibrations.iter().find(|line| line.key == of);
    let with_unit =
        |line: &HistoryLine| format!("{}, {}, {of}", unit_name(&line.unit_model, &line.unit_serial), line.date);
    line.map_or_else(|| of.to_owned(), with_unit)
}

/// Calibrations that a line names; the document has all.
const MOST_SHOWN: usize = 4;

/// What was found and what was expected.
const fn words(kind: DoubtKind) -> (&'static str, &'static str) {
    match kind {
        DoubtKind::Spelling => (
            "SPELLING",
            "found names that differ in spaces, hyphens, case, leading zeros or Cyrillic letters alone, expected one name for one unit or station",
        ),
        DoubtKind::SameInputs => {
            ("SAME FILES", "found results of the same files, expected one: histories count each as a session")
        }
        DoubtKind::SameDay => (
            "SAME DAY",
            "found results of one unit and day, expected one, or a switch-on between them: histories count each as a session",
        ),
        DoubtKind::NoDay => {
            ("NO DAY", "found a text that is not a date, expected one such as 2026-10-05: histories leave it out")
        }
        DoubtKind::Ahead => ("AHEAD", "found a date later than today, expected the day of the session"),
        DoubtKind::LongAgo => ("LONG AGO", "found a date before 1980, expected the day of the session"),
        DoubtKind::Missing => ("MISSING", "found no copy of the result in the folder results, expected one"),
        DoubtKind::RowChanged => (
            "ROW CHANGED",
            "found a row with other names, day or numbers, expected those of its copy in the folder results",
        ),
        DoubtKind::Changed => ("CHANGED", "found a copy with other bytes, expected those of the result that was added"),
    }
}

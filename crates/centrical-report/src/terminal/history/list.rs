//! The calibrations of a store as text for the terminal.

use centrical_session::{HistoryLine, HistoryList};

use crate::number::counted;
use crate::terminal::screen::Screen;
use crate::terminal::table::{Align, Table};

/// A line for each calibration, by unit and day.
pub fn history_list_text(list: &HistoryList) -> Screen {
    let mut screen = Screen::default();
    let failed = list.calibrations.iter().filter(|line| line.status == "failed").count();
    screen.head("CALIBRATIONS", &format!("{}, {failed} failed", counted(list.calibrations.len(), "calibration")));
    let columns = [
        ("date", Align::Left),
        ("model", Align::Left),
        ("serial", Align::Left),
        ("station", Align::Left),
        ("chi^2/nu", Align::Right),
        ("verdict", Align::Words),
    ];
    let mut table = Table::new(3, columns);
    for line in &list.calibrations {
        let ratio = line.chi_squared.filter(|_| line.degrees_of_freedom > 0);
        let ratio = ratio.map_or(String::new(), |c| format!("{:.3}", c / line.degrees_of_freedom as f64));
        let cells = [&line.date, &line.unit_model, &line.unit_serial, &line.station].map(|text| text.as_str().into());
        table.row(cells.into_iter().chain([ratio.into(), verdict(line).into()]));
    }
    screen.table(table);
    screen
}

fn verdict(line: &HistoryLine) -> String {
    match (line.acceptable, &line.message) {
        (Some(true), _) => "acceptable".to_owned(),
        (Some(false), _) => format!("not acceptable: {}", line.objections.join(", ")),
        (None, message) => format!("failed: {}", message.as_deref().unwrap_or_default()),
    }
}

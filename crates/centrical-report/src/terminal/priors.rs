//! What the data add to prior knowledge, as a table for the terminal.

use centrical::Group;

use super::rests_line::rests_name;
use super::table::{Align, Table};

/// A row for each prior: its parameter, and the standard uncertainty after the data over that before. The known attitudes of rests stand
/// in one row.
pub(super) fn priors<'p>(given: impl Iterator<Item = (&'p str, Group, f64)>) -> Table {
    let mut table = Table::new(1, [("", Align::Left), ("", Align::Right)]);
    let mut attitudes: Vec<f64> = Vec::new();
    for (name, group, ratio) in given {
        if group == Group::Attitude {
            attitudes.push(ratio);
        } else {
            table.row([name.into(), format!("{ratio:.3}").into()]);
        }
    }
    if !attitudes.is_empty() {
        let (low, high) = attitudes.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), r| (low.min(*r), high.max(*r)));
        table.row([rests_name(attitudes.len()).into(), format!("{low:.3} to {high:.3}").into()]);
    }
    table
}

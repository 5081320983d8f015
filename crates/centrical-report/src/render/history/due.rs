//! Which units are due and overdue: of each on its page, of all in a list.

use std::fmt::Write;

use centrical_session::{Date, MICRO_G, UnitHistoryReport};

use super::frame::{linked_serial, opening, page};
use super::units::ListedUnit;
use crate::number::{counted, two_digits};
use crate::plot::Escaped;

/// What the history of a unit says of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum UnitDue {
    /// A reading is not within it since that day, or since the last calibration.
    Overdue(Option<Date>),
    /// All readings are within it until that day.
    Due(Date),
    /// All readings are within it beyond that day.
    After(Date),
    /// Some readings are not known.
    NotKnown,
}

impl UnitDue {
    /// What `report` says; not known without a history.
    pub fn of(report: Option<&UnitHistoryReport>) -> Self {
        let Some(report) = report else { return Self::NotKnown };
        match (report.is_within, &report.due, report.due_after) {
            (Some(false), due, _) => Self::Overdue(due.as_ref().map(|due| due.date)),
            (_, Some(due), _) => Self::Due(due.date),
            (_, None, Some(day)) => Self::After(day),
            (_, None, None) => Self::NotKnown,
        }
    }

    /// As the comment that a page of a unit has behind its document type.
    pub fn comment(self) -> String {
        let (word, day) = self.words();
        format!("<!-- {word} {} -->\n", day.map_or_else(String::new, |day| day.to_string()))
    }

    /// That of a page, from the beginning of its text; `None` where it has no such comment.
    pub fn read(page: &str) -> Option<Self> {
        let mut comments = page.lines().skip(1).map_while(|line| line.strip_prefix("<!-- ")?.strip_suffix(" -->"));
        comments.find_map(Self::parsed)
    }

    fn parsed(comment: &str) -> Option<Self> {
        let (word, day) = comment.rsplit_once(' ')?;
        let day: Option<Date> = day.parse().ok();
        match (word, day) {
            (OVERDUE, day) => Some(Self::Overdue(day)),
            (DUE, Some(day)) => Some(Self::Due(day)),
            (AFTER, Some(day)) => Some(Self::After(day)),
            (NOT_KNOWN, None) => Some(Self::NotKnown),
            _ => None,
        }
    }

    fn words(self) -> (&'static str, Option<Date>) {
        match self {
            Self::Overdue(day) => (OVERDUE, day),
            Self::Due(day) => (DUE, Some(day)),
            Self::After(day) => (AFTER, Some(day)),
            Self::NotKnown => (NOT_KNOWN, None),
        }
    }
}

const OVERDUE: &str = "overdue";
const DUE: &str = "due";
const AFTER: &str = "due after";
const NOT_KNOWN: &str = "not known";

/// The list of units with what is said of each for a `limit` [m/s^2], on a day: the overdue ones first, then by day.
pub fn history_due_page(mut units: Vec<(&ListedUnit, UnitDue)>, limit: f64, on: Date) -> String {
    units.sort_by_key(|(_, due)| *due);
    let overdue = units.iter().filter(|(_, due)| matches!(due, UnitDue::Overdue(_))).count();
    let mut body = opening("Store", "Due dates");
    let _ = writeln!(
        body,
        "<p>On {on}, of {}, for compensated readings within {} µg: {overdue} overdue.</p>\n<div class=\"scroll\"><table class=\"sortable\"><thead><tr><th scope=\"col\">serial</th>\
         <th scope=\"col\">model</th><th scope=\"col\">last calibration</th><th scope=\"col\">state</th>\
         <th scope=\"col\">day</th></tr></thead><tbody>",
        counted(units.len(), "unit"),
        two_digits(limit / MICRO_G)
    );
    for (unit, due) in units {
        let (word, day) = due.words();
        let class = match due {
            UnitDue::Overdue(_) => " class=\"bad\"",
            UnitDue::Due(_) | UnitDue::After(_) => " class=\"good\"",
            UnitDue::NotKnown => "",
        };
        let _ = writeln!(
            body,
            "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td{class}>{word}</td><td>{}</td></tr>",
            linked_serial(&unit.model, &unit.serial, |_| true),
            Escaped(&unit.model),
            Escaped(&unit.last),
            day.map_or_else(String::new, |day| day.to_string())
        );
    }
    body.push_str("</tbody></table></div>\n");
    page("Due dates", &body)
}

#[cfg(test)]
mod tests {
    use super::UnitDue;

    #[test]
    fn what_is_due_is_read_from_the_page_of_a_unit() {
        let day = "2026-06-01".parse().unwrap();
        for due in [
            UnitDue::Overdue(None),
            UnitDue::Overdue(Some(day)),
            UnitDue::Due(day),
            UnitDue::After(day),
            UnitDue::NotKnown,
        ] {
            let page = format!("<!DOCTYPE html>\n<!-- 0123abcd -->\n{}<html>", due.comment());
            assert_eq!(UnitDue::read(&page), Some(due));
        }
        assert_eq!(UnitDue::read("<!DOCTYPE html>\n<!-- 0123abcd -->\n<html>"), None);
    }
}

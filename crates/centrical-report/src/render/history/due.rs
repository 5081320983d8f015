//! Which units are due and overdue: of each on its page, of all in a list.

use std::fmt::Write;

use centrical_session::{Date, MICRO_G, UnitHistoryReport};

use super::frame::{opening, page};
use super::units::ListedUnit;
use crate::number::{counted, two_digits};
use crate::plot::Escaped;
use crate::render::frame::{Column, sortable};

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
    fn of(report: Option<&UnitHistoryReport>) -> Self {
        let Some(report) = report else { return Self::NotKnown };
        match (report.is_within, &report.due, report.due_after) {
            (Some(false), due, _) => Self::Overdue(due.as_ref().map(|due| due.date)),
            (_, Some(due), _) => Self::Due(due.date),
            (_, None, Some(day)) => Self::After(day),
            (_, None, None) => Self::NotKnown,
        }
    }

    /// Its word, and the day if there is one.
    fn words(self) -> (&'static str, Option<Date>) {
        match self {
            Self::Overdue(day) => ("overdue", day),
            Self::Due(day) => ("due", Some(day)),
            Self::After(day) => ("due after", Some(day)),
            Self::NotKnown => ("not known", None),
        }
    }

    /// Of its word, and of the day if there is one; `None` of other words.
    fn named(word: &str, day: Option<Date>) -> Option<Self> {
        let with_day = day.into_iter().flat_map(|day| [Self::Due(day), Self::After(day)]);
        [Self::Overdue(day), Self::NotKnown].into_iter().chain(with_day).find(|due| due.words() == (word, day))
    }

    /// The comment that says so in a page.
    fn comment(self) -> String {
        let (word, day) = self.words();
        format!("<!-- {word} {} -->\n", day.map_or_else(String::new, |day| day.to_string()))
    }
}

/// What the history of a unit says of a limit, as the comment that its page has behind the document type.
pub fn due_comment(report: Option<&UnitHistoryReport>) -> String {
    UnitDue::of(report).comment()
}

/// What is said of a unit, from the beginning of its page; `None` where that has no such comment.
pub fn due_of_page(page: &str) -> Option<UnitDue> {
    let mut comments = page.lines().skip(1).map_while(|line| line.strip_prefix("<!-- ")?.strip_suffix(" -->"));
    comments.find_map(|comment| {
        let (word, day) = comment.rsplit_once(' ')?;
        UnitDue::named(word, day.parse().ok())
    })
}

/// The list of units with what is said of each for a `limit` [m/s^2], on a day: the overdue ones first, then by day, those not known last.
pub fn history_due_page(mut units: Vec<(&ListedUnit, UnitDue)>, limit: f64, on: Date) -> String {
    units.sort_by_key(|(_, due)| *due);
    let overdue = units.iter().filter(|(_, due)| matches!(due, UnitDue::Overdue(_))).count();
    let unknown = units.iter().filter(|(_, due)| *due == UnitDue::NotKnown).count();
    let mut body = opening("Store", "Due dates");
    let _ = writeln!(
        body,
        "<p>On {on}, of {}, for compensated readings within {} µg: {overdue} overdue, {unknown} not known. A due date needs calibrations of \
         several days.</p>",
        counted(units.len(), "unit"),
        two_digits(limit / MICRO_G)
    );
    let columns = ["serial", "model", "last calibration", "state", "day"].map(Column::Words);
    sortable(&mut body, "", &columns, |body| units.into_iter().for_each(|(unit, due)| row(body, unit, due)));
    page("Due dates", &body)
}

fn row(body: &mut String, unit: &ListedUnit, due: UnitDue) {
    let (word, day) = due.words();
    let class = match due {
        UnitDue::Overdue(_) => " class=\"bad\"",
        UnitDue::Due(_) | UnitDue::After(_) => " class=\"good\"",
        UnitDue::NotKnown => "",
    };
    let _ = writeln!(
        body,
        "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td{class}>{word}</td><td>{}</td></tr>",
        unit.linked,
        Escaped(&unit.model),
        Escaped(&unit.last),
        day.map_or_else(String::new, |day| day.to_string())
    );
}

#[cfg(test)]
mod tests {
    use super::{UnitDue, due_of_page};

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
            assert_eq!(due_of_page(&page), Some(due));
        }
        assert_eq!(due_of_page("<!DOCTYPE html>\n<!-- 0123abcd -->\n<html>"), None);
    }
}

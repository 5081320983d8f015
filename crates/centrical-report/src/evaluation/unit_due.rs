//! What the history of a unit says of a limit.

use centrical_session::{Date, UnitHistoryReport};

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

    /// Its word, and the day if there is one.
    pub fn words(self) -> (&'static str, Option<Date>) {
        match self {
            Self::Overdue(day) => (OVERDUE, day),
            Self::Due(day) => (DUE, Some(day)),
            Self::After(day) => (AFTER, Some(day)),
            Self::NotKnown => (NOT_KNOWN, None),
        }
    }

    /// Of its word, and of the day if there is one; `None` of other words.
    pub fn named(word: &str, day: Option<Date>) -> Option<Self> {
        match (word, day) {
            (OVERDUE, day) => Some(Self::Overdue(day)),
            (DUE, Some(day)) => Some(Self::Due(day)),
            (AFTER, Some(day)) => Some(Self::After(day)),
            (NOT_KNOWN, None) => Some(Self::NotKnown),
            _ => None,
        }
    }
}

const OVERDUE: &str = "overdue";
const DUE: &str = "due";
const AFTER: &str = "due after";
const NOT_KNOWN: &str = "not known";

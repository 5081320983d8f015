//! Limits in words and as a table.

use centrical_session::{DecisionRule, LimitEnd, Limited};

use super::content::{Align, Table};
use crate::evaluation::{Judged, UnitStatement, symbol};
use crate::language::Language;
use crate::number::converted;

/// The decision rule in words.
pub(crate) fn rule(rule: DecisionRule, language: Language) -> &'static str {
    let messages = language.messages();
    match rule {
        DecisionRule::Simple => messages.rule_simple,
        DecisionRule::Guarded => messages.rule_guarded,
    }
}

/// Every limit with the value that it is of and what is stated.
pub(super) fn conformity_table(unit: &UnitStatement, language: Language) -> Table {
    let messages = language.messages();
    let row = |judged: &Judged| {
        let verdict = match judged.conforms {
            Some(true) => messages.conforms,
            Some(false) if judged.is_in_guard_band => messages.in_guard_band,
            Some(false) => messages.does_not_conform,
            None => messages.conformity_not_stated,
        };
        let Shown { name, range, value, unit } = shown(judged, language);
        vec![name, range, value, unit, verdict.to_owned()]
    };
    let columns = [
        (messages.parameter, 0.26, Align::Left),
        (messages.limits, 0.18, Align::Right),
        (messages.value, 0.25, Align::Right),
        (messages.unit, 0.12, Align::Left),
        ("", 0.19, Align::Left),
    ];
    Table::numbers(columns, unit.judged.iter().map(row))
}

/// A limit and its value in a line: `df₁ = −3.9524 ± 0.0040 mg, limits −3 … 3 mg`.
pub(crate) fn judged_in_words(judged: &Judged, language: Language) -> String {
    let Shown { name, range, value, unit } = shown(judged, language);
    format!("{name}: {value} {unit}; {} {range} {unit}", language.messages().limits.to_lowercase())
}

/// A limit as it is shown: in the unit in which it was stated, with the digits that it has.
struct Shown {
    name: String,
    range: String,
    value: String,
    unit: String,
}

fn shown(judged: &Judged, language: Language) -> Shown {
    let (messages, limit) = (language.messages(), &judged.limit);
    let (unit, size) =
        limit.high.as_ref().or(limit.low.as_ref()).map_or(("", 1.0), |end| (end.unit.as_str(), end.size));
    // An end that was stated in another unit is shown by its SI value in this one.
    let number = |end: &LimitEnd| if end.unit == unit { end.number } else { converted(end.si / size) };
    let end = |end: &LimitEnd| language.number(&number(end).to_string());
    let range = match (&limit.low, &limit.high) {
        (Some(low), Some(high)) => format!("{} … {}", end(low), end(high)),
        (Some(low), None) => format!("> {}", end(low)),
        (None, Some(high)) => format!("< {}", end(high)),
        (None, None) => String::new(),
    };
    let value = judged.value.map_or_else(
        || messages.not_determined.to_owned(),
        |(value, expanded)| language.plus_minus(value / size, expanded / size),
    );
    let name = match &limit.of {
        Limited::Parameter(name) => symbol(name),
        Limited::CompensatedReading(axis) => {
            let place = judged.plateau.as_ref().map(|at| format!(" ({} {at})", messages.plateau));
            format!("{} {axis}{}", messages.compensated_reading, place.unwrap_or_default())
        }
    };
    Shown { name, range, value, unit: language.unit(unit) }
}

//! The verdict on a calibration, what a decision says of the unit, and the result below both, as text for the terminal.

use centrical_session::{CalibrationResult, Redundancy, ResultObjection};

use super::calibrate::table_of;
use super::phrases::short_list;
use super::screen::{Emphasis, Screen};
use crate::document::{counts_as_exact, judged_in_words, objection};
use crate::evaluation::{UnitStatement, UnitVerdict};
use crate::language::Language;
use crate::number::counted;

/// The verdicts, the result that they are of, and a last line if one is `said`.
pub fn result_text(result: &CalibrationResult, unit: Option<&UnitStatement>, said: Option<&str>) -> Screen {
    let mut screen = verdict_text(result);
    screen.add(unit.map(unit_text).unwrap_or_default());
    screen.gap();
    screen.add(table_of(result));
    if let Some(said) = said {
        screen.gap();
        screen.say(0, said);
    }
    screen
}

/// The verdict in a line, or one for each objection; said again below a text that is longer than a screen.
pub(super) fn verdict_text(result: &CalibrationResult) -> Screen {
    /// Parameters that are named.
    const NAMED: usize = 9;
    let mut screen = objections_text(&result.objections());
    if !screen.parts().is_empty() {
        return screen;
    }
    let words = match result.redundancy() {
        Redundancy::Everywhere => "no check raised an objection".to_owned(),
        Redundancy::ButFor(parameters) => {
            format!("but no redundant reading checks {}", short_list(parameters, NAMED, ", "))
        }
        Redundancy::Nowhere => "but no reading is redundant: nothing checks the stated uncertainties".to_owned(),
    };
    screen.marked(Emphasis::Acceptable, "ACCEPTABLE", &words);
    screen.close(Emphasis::Acceptable, "ACCEPTABLE", &words);
    screen
}

/// The verdict of these objections: empty without any.
pub fn objections_text(objections: &[ResultObjection]) -> Screen {
    let mut screen = Screen::default();
    for reason in objections {
        screen.marked(Emphasis::NotAcceptable, "NOT ACCEPTABLE", &objection(reason, Language::English));
    }
    if !objections.is_empty() {
        let reasons = format!("for {}, in the first lines", counted(objections.len(), "reason"));
        screen.close(Emphasis::NotAcceptable, "NOT ACCEPTABLE", &reasons);
    }
    screen
}

/// The quantities that a certificate of the result takes as exact: empty without any.
pub fn exact_text(result: &CalibrationResult) -> Screen {
    let mut screen = Screen::default();
    if let Some(exact) = counts_as_exact(result, Language::English) {
        let words = format!(
            "{exact}: U of the certificate contains no contribution of these; state them under [uncertainty] of the session"
        );
        screen.marked(Emphasis::Warning, "COUNT AS EXACT", &words);
    }
    screen
}

/// What is said of the unit: a line, and one for each limit that is not kept.
pub fn unit_text(unit: &UnitStatement) -> Screen {
    let specification = &unit.specification;
    let mut screen = Screen::default();
    match unit.verdict() {
        UnitVerdict::Within => screen.marked(
            Emphasis::Acceptable,
            "UNIT",
            &format!("within its limits: {} judged, {specification}", unit.judged.len()),
        ),
        UnitVerdict::NotStated => {
            screen.marked(Emphasis::Warning, "UNIT", &format!("conformity not stated: {specification}"));
        }
        UnitVerdict::Outside | UnitVerdict::InGuardBand => {
            for broken in unit.judged.iter().filter(|judged| judged.conforms == Some(false)) {
                let words = judged_in_words(broken, Language::English);
                let mark = if broken.is_in_guard_band {
                    "UNIT WITHIN ITS LIMITS BY LESS THAN U, NOT ACCEPTED"
                } else {
                    "UNIT NOT WITHIN ITS LIMITS"
                };
                screen.marked(Emphasis::NotAcceptable, mark, &words);
            }
            screen.say(2, specification);
        }
    }
    screen
}

//! What a decision says of the unit, as lines for the terminal.

use super::screen::{Emphasis, Screen};
use crate::document::judged_in_words;
use crate::evaluation::{UnitStatement, UnitVerdict};
use crate::language::Language;

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

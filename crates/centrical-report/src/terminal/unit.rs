//! What a decision says of the unit, as lines for the terminal.

use crate::document::judged_in_words;
use crate::evaluation::{UnitStatement, UnitVerdict};
use crate::language::Language;

/// What is said of the unit: a line, and one for each limit that is not kept.
pub fn unit_text(unit: &UnitStatement) -> String {
    let specification = &unit.specification;
    match unit.verdict() {
        UnitVerdict::Within => format!("UNIT  within its limits: {} judged, {specification}\n", unit.judged.len()),
        UnitVerdict::NotStated => format!("UNIT  conformity not stated: {specification}\n"),
        UnitVerdict::Outside => {
            let broken = unit.judged.iter().filter(|judged| judged.conforms == Some(false));
            let line = |judged| format!("UNIT NOT WITHIN ITS LIMITS  {}\n", judged_in_words(judged, Language::English));
            broken.map(line).chain([format!("      {specification}\n")]).collect()
        }
    }
}

//! Objections and patterns as sentences.

use centrical::uncertainty::Objection;
use centrical_session::{Follows, MICRO_G, PatternSummary, ResultObjection};

use crate::language::Language;

/// An objection to a result.
pub(crate) fn objection(objection: &ResultObjection, language: Language) -> String {
    let messages = language.messages();
    match objection {
        Objection::NotConverged { termination, iterations } => {
            format!("{} ({}, {iterations})", messages.not_converged, (messages.words.termination)(*termination))
        }
        Objection::Residuals { chi_squared, degrees_of_freedom, chance } => {
            let (chi_squared, chance) = (language.fixed(*chi_squared, 1), language.probability(*chance));
            format!(
                "{}: χ² = {chi_squared}, {} {degrees_of_freedom}, {} {chance}",
                messages.residuals_too_large, messages.degrees_of_freedom, messages.chance
            )
        }
        Objection::Outlying(plateaus, chance) => {
            let chance = language.probability(*chance);
            format!("{}: {}, {} {chance}", messages.outlying_plateaus, plateaus.join(", "), messages.chance)
        }
        Objection::Patterns(patterns) => {
            let found: Vec<String> = patterns.iter().map(|found| pattern(found, language)).collect();
            format!("{}: {}", messages.patterns_found, found.join("; "))
        }
        Objection::Speeds(findings) => {
            let said: Vec<String> = findings.iter().map(messages.words.speed_finding).collect();
            said.join("; ")
        }
        Objection::NotDetermined(names) => format!("{}: {}", messages.lost_parameters, names.join(", ")),
    }
}

/// A pattern in the residuals: newtonometer, what it follows, amplitude.
pub(super) fn pattern(pattern: &PatternSummary, language: Language) -> String {
    let messages = language.messages();
    let place = match &pattern.follows {
        Follows::Position { position } | Follows::SpeedInPosition { position } => format!(" {position}"),
        Follows::SpeedOnSeat { radius } => {
            format!(" {} {}", language.number(&radius.to_string()), language.unit("m"))
        }
        Follows::Mounting { mounting } => format!(" {mounting}"),
        Follows::Speed | Follows::Load | Follows::Time => String::new(),
    };
    let [amplitude, uncertainty] =
        [pattern.amplitude, pattern.standard_uncertainty].map(|a| language.significant(a / MICRO_G, 2));
    let chance = language.probability(pattern.probability);
    let follows = (messages.words.follows)(&pattern.follows);
    format!(
        "{} {}, {follows}{place}: {amplitude} ± {uncertainty} {}, {} {chance}",
        messages.axis,
        pattern.axis,
        language.unit("ug"),
        messages.chance
    )
}

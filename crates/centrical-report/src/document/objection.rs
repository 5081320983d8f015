//! Objections and patterns as sentences.

use centrical::uncertainty::{Level, Objection};
use centrical::{Course, Extension, Rival};
use centrical_session::{Follows, MICRO_G, PatternSummary, ResultObjection, RivalSummary};

use super::content::Block;
use crate::language::Language;

/// Rivals that a sentence names beside the first.
const ALIKE: usize = 5;

/// Patterns that a sentence names: one cause makes many.
const PATTERNS: usize = 3;

/// An objection to a result as a sentence.
pub fn objection(objection: &ResultObjection, language: Language) -> String {
    let messages = language.messages();
    match objection {
        Objection::NotConverged { termination, iterations } => {
            format!("{} ({}, {iterations})", messages.not_converged, (messages.words.termination)(*termination))
        }
        Objection::LeftOut(rivals) => left_out(rivals, language),
        Objection::Residuals { chi_squared, degrees_of_freedom, chance } => {
            too_large(messages.residuals_too_large, (*chi_squared, *degrees_of_freedom, *chance), language)
        }
        Objection::Outlying(plateaus, chance) => {
            let chance = language.probability(*chance);
            format!("{}: {}, {} {chance}", messages.outlying_plateaus, plateaus.join(", "), messages.chance)
        }
        Objection::Patterns(patterns) => {
            let found: Vec<String> = patterns.iter().take(PATTERNS).map(|found| pattern(found, language)).collect();
            let further = match patterns.len().saturating_sub(PATTERNS) {
                0 => String::new(),
                further => format!("; {} {further}", messages.further_patterns),
            };
            format!("{}: {}{further}", messages.patterns_found, found.join("; "))
        }
        Objection::Speeds(findings) => {
            let said: Vec<String> = findings.iter().map(messages.words.speed_finding).collect();
            said.join("; ")
        }
        Objection::Drift { chi_squared, degrees_of_freedom, chance } => {
            too_large(messages.readings_drift, (*chi_squared, *degrees_of_freedom, *chance), language)
        }
        Objection::Creep(chance) => {
            format!("{}, {} {}", messages.readings_creep, messages.chance, language.probability(*chance))
        }
        Objection::NotDetermined(names) => format!("{}: {}", messages.lost_parameters, names.join(", ")),
    }
}

/// The warning that a result must not be used, with the reasons.
pub(super) fn refusal(objections: &[ResultObjection], language: Language) -> Vec<Block> {
    let messages = language.messages();
    let reasons = objections.iter().map(|reason| objection(reason, language)).collect();
    vec![Block::heading(messages.not_acceptable, 4), Block::paragraph(messages.verdict_bad), Block::List(reasons)]
}

/// A chi^2 with its degrees of freedom, and the probability of one as large.
fn too_large(what: &str, (chi_squared, degrees_of_freedom, chance): (f64, usize, f64), language: Language) -> String {
    let messages = language.messages();
    let (chi_squared, chance) = (language.fixed(chi_squared, 1), language.probability(chance));
    format!(
        "{what}: χ² = {chi_squared}, {} {degrees_of_freedom}, {} {chance}",
        messages.degrees_of_freedom, messages.chance
    )
}

/// What the model leaves out: the rival that explains most, and those which the data cannot tell from it.
fn left_out(rivals: &[RivalSummary], language: Language) -> String {
    let messages = language.messages();
    let Some((first, alike)) = rivals.split_first() else { return messages.left_out.to_owned() };
    let explained = language.fixed(first.chi_squared, 1);
    let is_unexplained = first.probability_of_rest.is_some_and(|chance| Level::Objection.is_passed_by(chance));
    let text = format!(
        "{}: {}, {} {explained} {}, {} {}{}",
        messages.left_out,
        rival(first, language),
        messages.explains,
        messages.of_chi_squared,
        messages.chance,
        language.probability(first.probability),
        if is_unexplained { messages.unexplained_rest } else { "" }
    );
    if alike.is_empty() {
        return text;
    }
    let names: Vec<String> = alike.iter().take(ALIKE).map(|other| rival(other, language)).collect();
    let more = if alike.len() > ALIKE { "; …" } else { "" };
    format!("{text}; {}: {}{more}", messages.left_out_alike, names.join("; "))
}

/// A rival by its cause, its formula and its name in sessions.
pub(crate) fn rival(rival: &RivalSummary, language: Language) -> String {
    let formula = (language.messages().words.formula)(&rival.formula);
    format!("{} ({formula}; {})", cause(&rival.name, language), rival.name)
}

/// The cause of a rival, by its name in sessions; of one mounting with its number.
pub(crate) fn cause(name: &str, language: Language) -> String {
    let messages = language.messages();
    match Rival::named(name) {
        Some(rival @ Rival::Effect(Extension::OneMounting(_, mounting))) => {
            format!("{} ({} {})", (messages.words.rival)(rival), messages.in_mounting, mounting + 1)
        }
        // The step comes with the rest that begins it.
        Some(rival @ Rival::Effect(Extension::Disturbance(Course::From(rest)))) => {
            format!("{} {}", (messages.words.rival)(rival), rest + 1)
        }
        Some(rival) => (messages.words.rival)(rival).to_owned(),
        // A result of a later program may know more.
        None => name.to_owned(),
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
    let amplitude = language.plus_minus(pattern.amplitude / MICRO_G, pattern.standard_uncertainty / MICRO_G);
    let chance = language.probability(pattern.probability);
    let follows = (messages.words.follows)(&pattern.follows);
    format!(
        "{} {}, {follows}{place}: {amplitude} {}, {} {chance}",
        messages.axis,
        pattern.axis,
        language.unit("ug"),
        messages.chance
    )
}

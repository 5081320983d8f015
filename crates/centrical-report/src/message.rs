//! The message catalogue: everything the documents say, in each language.
//!
//! One field a message, so that a language that lacks one does not compile.

mod english;
mod russian;

pub(crate) use english::ENGLISH;
pub(crate) use russian::RUSSIAN;

use centrical_session::{Follows, PatternSummary};

use crate::language::Language;
use crate::reading_error::MICRO_G;
use crate::verdict::Objection;

/// What the documents say, in one language.
#[allow(missing_docs)]
pub(crate) struct Messages {
    pub calibration_report: &'static str,
    pub acceptable: &'static str,
    pub not_acceptable: &'static str,
    pub verdict_good: &'static str,
    pub verdict_bad: &'static str,
    pub serial: &'static str,
    pub not_given: &'static str,
    pub session: &'static str,
    pub date: &'static str,
    pub gravity: &'static str,
    pub latitude: &'static str,
    pub pair_relation: &'static str,
    pub reference: &'static str,
    pub speed_uncertainty: &'static str,
    pub data: &'static str,
    pub method: &'static str,
    pub software: &'static str,
    pub chi_squared: &'static str,
    pub rank: &'static str,
    pub residual_error: &'static str,
    pub residual_error_note: &'static str,
    pub before: &'static str,
    pub after: &'static str,
    pub after_speed_free: &'static str,
    pub compensation_uncertainty: &'static str,
    pub axis: &'static str,
    pub newtonometer: &'static str,
    pub number_sign: &'static str,
    pub parameters: &'static str,
    pub parameters_note: &'static str,
    pub instrument: &'static str,
    pub mounting: &'static str,
    pub parameter: &'static str,
    pub value: &'static str,
    pub unit: &'static str,
    pub value_si: &'static str,
    pub not_determined: &'static str,
    pub budget: &'static str,
    pub budget_note: &'static str,
    pub no_budget: &'static str,
    pub combined: &'static str,
    pub degrees_word: &'static str,
    pub chi_squared_chance: &'static str,
    pub outlying_plateaus: &'static str,
    pub patterns_found: &'static str,
    pub worst_mounting: &'static str,
    pub steadiness: &'static str,
    pub steadiness_note: &'static str,
    pub drift_over_plateau: &'static str,
    pub drift_over_session: &'static str,
    pub plateaus_drift: &'static str,
    pub session_drifts: &'static str,
    pub no_drift: &'static str,
    pub within_scatter: &'static str,
    pub run_again: &'static str,
    pub farthest_apart: &'static str,
    pub differ: &'static str,
    pub no_difference: &'static str,
    pub tilt_spinning: &'static str,
    pub tilt_at_rest: &'static str,
    pub tilts_agree: &'static str,
    pub tilts_differ: &'static str,
    pub tilt_reversed: &'static str,
    pub tilts_scatter: &'static str,
    pub not_used: &'static str,
    pub spikes: &'static str,
    pub missing: &'static str,
    pub stuck: &'static str,
    pub repeated: &'static str,
    pub positions: &'static str,
    pub positions_caption: &'static str,
    pub position: &'static str,
    pub pair: &'static str,
    pub plots: &'static str,
    pub force_axis: &'static str,
    pub error_before_axis: &'static str,
    pub error_after_axis: &'static str,
    pub before_caption: &'static str,
    pub after_caption: &'static str,
    pub residuals_title: &'static str,
    pub residuals_caption: &'static str,
    pub normalised_title: &'static str,
    pub normalised_caption: &'static str,
    pub plateau_axis: &'static str,
    pub residual_axis: &'static str,
    pub normalised_axis: &'static str,
    pub correlation_title: &'static str,
    pub correlation_caption: &'static str,
    pub singular_title: &'static str,
    pub singular_axis: &'static str,
    pub order_axis: &'static str,
    pub singular_caption_full: &'static str,
    pub singular_caption_short: &'static str,
    pub determined: &'static str,
    pub lost: &'static str,
    pub limit: &'static str,
    pub null_directions: &'static str,
    pub prediction_title: &'static str,
    pub prediction_axis: &'static str,
    pub prediction_caption: &'static str,
    pub history_title: &'static str,
    pub history_caption: &'static str,
    pub convergence_title: &'static str,
    pub convergence_axis: &'static str,
    pub convergence_caption: &'static str,
    pub plateaus_used_axis: &'static str,
    pub records_title: &'static str,
    pub records_caption: &'static str,
    pub mounting_word: &'static str,
    pub radius: &'static str,
    pub plateau: &'static str,
    pub samples: &'static str,
    pub rejected: &'static str,
    pub time_axis: &'static str,
    pub stability_title: &'static str,
    pub tau_axis: &'static str,
    pub deviation_axis: &'static str,
    pub stability_caption: &'static str,
    pub inputs: &'static str,
    pub inputs_note: &'static str,
    pub file: &'static str,
    pub certificate: &'static str,
    pub certificate_number: &'static str,
    pub page: &'static str,
    pub of: &'static str,
    pub laboratory: &'static str,
    pub accreditation: &'static str,
    pub customer: &'static str,
    pub item: &'static str,
    pub manufacturer: &'static str,
    pub model: &'static str,
    pub description: &'static str,
    pub customer_number: &'static str,
    pub condition: &'static str,
    pub received: &'static str,
    pub calibrated: &'static str,
    pub issued: &'static str,
    pub place: &'static str,
    pub own_premises: &'static str,
    pub replaces: &'static str,
    pub procedure: &'static str,
    pub method_text: &'static str,
    pub deviations: &'static str,
    pub none: &'static str,
    pub conditions: &'static str,
    pub temperature: &'static str,
    pub humidity: &'static str,
    pub pressure: &'static str,
    pub traceability: &'static str,
    pub traceability_text: &'static str,
    pub standard: &'static str,
    pub standard_certificate: &'static str,
    pub traceable_to: &'static str,
    pub results: &'static str,
    pub results_model: &'static str,
    pub uncertainty_statement: &'static str,
    pub adjustment: &'static str,
    pub before_adjustment: &'static str,
    pub after_adjustment: &'static str,
    pub no_adjustment: &'static str,
    pub errors_of_readings: &'static str,
    pub conformity: &'static str,
    pub specification: &'static str,
    pub decision_rule: &'static str,
    pub rule_simple: &'static str,
    pub rule_guarded: &'static str,
    pub limits: &'static str,
    pub conforms: &'static str,
    pub does_not_conform: &'static str,
    pub conformity_not_stated: &'static str,
    pub authorised: &'static str,
    pub responsible: &'static str,
    pub signature: &'static str,
    pub item_only: &'static str,
    pub reproduction: &'static str,
    pub end: &'static str,
    pub covariance_note: &'static str,
    pub mountings_used: &'static str,
    pub plateaus_used: &'static str,
    pub uncertainty: &'static str,
    pub covariance: &'static str,
    pub specific_force: &'static str,
    /// Words of the result, groups of parameters among them, as people are shown them.
    words: &'static [(&'static str, &'static str)],
    not_converged: &'static str,
    residuals_too_large: &'static str,
    degrees_of_freedom: &'static str,
    chance: &'static str,
    lost_parameters: &'static str,
}

impl Messages {
    /// A word of the result as people are shown it; itself if it is not known.
    pub fn word<'a>(&self, word: &'a str) -> &'a str {
        self.words.iter().find(|(name, _)| *name == word).map_or(word, |(_, shown)| shown)
    }

    /// A pattern in the residuals: newtonometer, what it follows, amplitude.
    pub fn pattern(&self, pattern: &PatternSummary, language: Language) -> String {
        let (follows, place) = match &pattern.follows {
            Follows::Position { position } => ("step in position", position.clone()),
            Follows::SpeedInPosition { position } => ("square of the speed in position", position.clone()),
            Follows::SpeedOnSeat { radius } => (
                "square of the speed at radius",
                format!("{} {}", language.number(&radius.to_string()), language.unit("m")),
            ),
            Follows::Speed => ("square of the speed", String::new()),
            Follows::Load => ("load", String::new()),
            Follows::Mounting { mounting } => ("step in mounting", mounting.to_string()),
            Follows::Time => ("drift", String::new()),
        };
        let [amplitude, uncertainty] =
            [pattern.amplitude, pattern.standard_uncertainty].map(|a| language.significant(a / MICRO_G, 2));
        let chance = language.probability(pattern.probability);
        let follows = format!("{} {place}", self.word(follows));
        format!(
            "{} {}, {}: {amplitude} ± {uncertainty} {}, {} {chance}",
            self.axis,
            pattern.axis,
            follows.trim_end(),
            language.unit("ug"),
            self.chance
        )
    }

    /// What speaks against a result.
    pub fn objection(&self, objection: &Objection, language: Language) -> String {
        match objection {
            Objection::NotConverged { termination, iterations } => {
                format!("{} ({}, {iterations})", self.not_converged, self.word(termination))
            }
            Objection::Residuals { chi_squared, degrees_of_freedom, chance } => {
                let (chi_squared, chance) = (language.fixed(*chi_squared, 1), language.probability(*chance));
                format!(
                    "{}: χ² = {chi_squared}, {} {degrees_of_freedom}, {} {chance}",
                    self.residuals_too_large, self.degrees_of_freedom, self.chance
                )
            }
            Objection::Outlying(plateaus, chance) => {
                let chance = language.probability(*chance);
                format!("{}: {}, {} {chance}", self.outlying_plateaus, plateaus.join(", "), self.chance)
            }
            Objection::Patterns(patterns) => {
                let told: Vec<String> = patterns.iter().map(|pattern| self.pattern(pattern, language)).collect();
                format!("{}: {}", self.patterns_found, told.join("; "))
            }
            Objection::NotDetermined(names) => format!("{}: {}", self.lost_parameters, names.join(", ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{ENGLISH, Messages, RUSSIAN};

    /// Every word of one language has its counterpart where a translation is due.
    #[test]
    fn russian_knows_all_words_of_english() {
        let knows = |messages: &Messages, word: &str| messages.words.iter().any(|(name, _)| *name == word);
        for (word, _) in ENGLISH.words {
            assert!(knows(&RUSSIAN, word), "{word}");
        }
    }
}

//! Whether a result can be accepted as it stands, and why not.

use centrical::Group;
use centrical::uncertainty::{Findings, Level, Objection};

use super::budget_and_checks::PatternSummary;
use super::rivals::RivalSummary;
use super::schema::{CalibrationResult, ParameterEstimate};
use super::speeds::SpeedFinding;

/// A scale or a misalignment that is less certain has no covariance that holds: the reading is not linear over so much.
const MOST_UNCERTAIN: f64 = 0.1;

/// Whether a coefficient of a group is so uncertain that it has no value.
pub(super) fn is_vague(group: Group, standard_uncertainty: f64) -> bool {
    matches!(group, Group::Scale | Group::Misalignment) && standard_uncertainty > MOST_UNCERTAIN
}

/// An objection to a result: plateaus as `mounting:plateau`, counted from 1.
pub type ResultObjection = Objection<String, PatternSummary, RivalSummary, SpeedFinding>;

/// How far redundant readings check a result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Redundancy<'r> {
    /// Every parameter of the instrument rests on readings that others check.
    Everywhere,
    /// All but these do.
    ButFor(&'r [String]),
    /// No reading is redundant.
    Nowhere,
}

impl CalibrationResult {
    /// The objections to the result; empty if it is acceptable.
    pub fn objections(&self) -> Vec<ResultObjection> {
        let validity = self.validity.iter();
        let outlying = validity.clone().flat_map(|validity| &validity.outlying);
        let rivals = validity.clone().flat_map(|validity| &validity.rivals).filter(|rival| rival.explains_most);
        let patterns = validity.flat_map(|validity| &validity.patterns);
        let speeds = self.speeds.iter().flat_map(|speeds| &speeds.findings);
        let terms = self.model.error_model.iter().map(|term| &term.name);
        // Older programs gave such a coefficient a value.
        let is_without = |p: &ParameterEstimate| p.standard_uncertainty.is_some_and(|u| is_vague(p.group, u));
        let is_lost = |name: &&String| self.parameter(name).is_none_or(|p| !p.estimable || is_without(p));
        Findings {
            termination: self.fit.termination,
            iterations: self.fit.iterations,
            chi_squared: self.fit.chi_squared,
            degrees_of_freedom: self.fit.degrees_of_freedom,
            of_strongest_noise: self.of_strongest_noise(),
            outlying: outlying.map(|p| (format!("{}:{}", p.mounting, p.index + 1), p.probability)).collect(),
            rivals: rivals.map(|rival| (rival.clone(), rival.probability)).collect(),
            patterns: patterns.map(|pattern| (pattern.clone(), pattern.probability)).collect(),
            speeds: speeds.map(|finding| (finding.clone(), finding.probability())).collect(),
            slopes: self
                .drift
                .as_ref()
                .map(|drift| (drift.beyond_speed.unwrap_or(drift.chi_squared), drift.degrees_of_freedom)),
            creep: self.drift.as_ref().and_then(|drift| drift.creep).map(|creep| creep.probability),
            not_determined: terms.filter(is_lost).cloned().collect(),
        }
        .objections()
    }

    /// chi^2 with the strongest noise of rests that is not excluded. Older programs wrote no more than how strong it is.
    fn of_strongest_noise(&self) -> Option<f64> {
        let validity = self.validity.as_ref()?;
        validity.of_strongest_noise.or_else(|| Some(self.fit.chi_squared / validity.noise_at_most?))
    }

    /// How far redundant readings check the result.
    pub fn redundancy(&self) -> Redundancy<'_> {
        match self.validity.as_ref().map_or(&[][..], |validity| &validity.unchecked) {
            _ if self.fit.degrees_of_freedom == 0 => Redundancy::Nowhere,
            [] => Redundancy::Everywhere,
            unchecked => Redundancy::ButFor(unchecked),
        }
    }

    /// Whether chi^2 is smaller than chance allows: the stated uncertainties are too large then.
    pub fn chi_squared_is_small(&self) -> bool {
        let validity = self.validity.as_ref().filter(|_| self.fit.degrees_of_freedom > 0);
        validity.is_some_and(|validity| Level::Real.is_passed_by(1.0 - validity.probability))
    }
}

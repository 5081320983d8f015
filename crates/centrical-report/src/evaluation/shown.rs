//! The units in which noise, and the criterion of a plan, are shown.

use centrical::stability::{Estimator, NoiseTerm};
use centrical_session::{CriterionName, MICRO_G, PlanReport, ReadingNoise, UnitOfMeasure};

/// How the numbers of one column are shown.
pub(crate) struct Shown {
    /// Shown value over the value in the readings' unit.
    pub factor: f64,
    /// Unit.
    pub unit: String,
}

impl Shown {
    /// Readings: accelerations in ug.
    pub fn reading(reading: &ReadingNoise) -> Self {
        if is_acceleration(reading) {
            Self { factor: 1.0 / MICRO_G, unit: "ug".to_owned() }
        } else {
            Self { factor: 1.0, unit: reading.unit.clone() }
        }
    }

    /// Their integral over time.
    fn phase(reading: &ReadingNoise) -> Self {
        if is_acceleration(reading) {
            Self { factor: 1e6, unit: "um/s".to_owned() }
        } else {
            Self { factor: 1.0, unit: format!("{} s", reading.unit) }
        }
    }

    pub fn deviation(reading: &ReadingNoise, estimator: Estimator) -> Self {
        if estimator.is_of_phase() { Self::phase(reading) } else { Self::reading(reading) }
    }

    pub fn coefficient(reading: &ReadingNoise, term: NoiseTerm) -> Self {
        let Self { factor, unit } = Self::reading(reading);
        let per = |what: &str| Self { factor, unit: format!("{unit}{what}") };
        match term {
            NoiseTerm::Quantisation => Self::phase(reading),
            NoiseTerm::White => per("/sqrt(Hz)"),
            NoiseTerm::BiasInstability => per(""),
            NoiseTerm::RandomWalk => per("/sqrt(s)"),
            NoiseTerm::Ramp => per("/s"),
        }
    }
}

fn is_acceleration(reading: &ReadingNoise) -> bool {
    UnitOfMeasure::parse(&reading.unit) == Ok(UnitOfMeasure::ACCELERATION)
}

/// Size of the unit [unit of the criterion], and its name; none of a number without a unit.
pub(crate) fn criterion_unit(report: &PlanReport) -> (f64, Option<&'static str>) {
    match report.criterion {
        CriterionName::I => (MICRO_G, Some("ug")),
        CriterionName::A | CriterionName::D | CriterionName::Worst => (1.0, None),
    }
}

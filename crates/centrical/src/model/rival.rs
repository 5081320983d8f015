//! The catalogue of rivals: physical effects that a model may leave out, and what each would do to the readings.

use super::course::{Course, Law};
use super::error_model::{ErrorModel, Extra, Term};
use super::experiment::Experiment;
use super::extension::{Difference, Extension};
use super::parameter::{Parameter, coefficient};

/// A physical effect that a model may leave out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rival {
    /// Terms of the error model.
    Terms(Extra),
    /// Anything else.
    Effect(Extension),
}

impl Rival {
    /// Number of rivals that concern a whole session.
    pub const COUNT: usize = Extra::NAMED.len() + Extension::NAMED.len();

    /// Those that concern a whole session: every term and every extension.
    pub const COMMON: [Self; Self::COUNT] = {
        let mut list = [Self::Terms(Extra::CrossProducts); Self::COUNT];
        let (mut n, terms) = (0, Extra::NAMED.len());
        while n < Self::COUNT {
            list[n] =
                if n < terms { Self::Terms(Extra::NAMED[n].1) } else { Self::Effect(Extension::NAMED[n - terms].1) };
            n += 1;
        }
        list
    };

    /// The rival of a name as written in sessions.
    pub fn named(name: &str) -> Option<Self> {
        Extra::named(name).map(Self::Terms).or_else(|| Extension::named(name).map(Self::Effect))
    }

    /// Its name as written in sessions: in `error_model` for terms, in `extensions` otherwise.
    pub fn name(self) -> String {
        match self {
            Self::Terms(extra) => extra.name().to_owned(),
            Self::Effect(extension) => extension.name(),
        }
    }

    /// Whether a model of that error model and those extensions has it.
    pub(super) fn is_in(self, error_model: &ErrorModel, extensions: &[Extension]) -> bool {
        match self {
            Self::Terms(extra) => extra.terms().iter().all(|term| has(error_model, term)),
            Self::Effect(extension) => extensions.contains(&extension),
        }
    }

    /// Adds it to an error model or to extensions.
    pub(super) fn add_to(self, error_model: &mut ErrorModel, extensions: &mut Vec<Extension>) {
        match self {
            Self::Terms(extra) => {
                let new: Vec<Term> = extra.terms().into_iter().filter(|term| !has(error_model, term)).collect();
                error_model.terms.extend(new);
            }
            Self::Effect(extension) => extensions.push(extension),
        }
    }

    /// Its unknowns in an experiment, those that the error model lacks.
    pub fn parameters(self, experiment: &Experiment, error_model: &ErrorModel) -> Vec<Parameter> {
        match self {
            Self::Terms(extra) => {
                extra.terms().iter().filter(|term| !has(error_model, term)).map(coefficient).collect()
            }
            Self::Effect(extension) => extension.parameters(experiment, error_model),
        }
    }

    /// What it adds to newtonometer `i`, in the letters of `docs/notation.md`.
    pub fn formula(self) -> &'static str {
        match self {
            Self::Terms(Extra::CrossProducts) => "f_j f_k, j < k",
            Self::Terms(Extra::CrossCubes) => "f_j^3, j != i",
            Self::Terms(Extra::CubicProducts) => "f_j^2 f_k, j != k; f_1 f_2 f_3",
            Self::Terms(Extra::OwnSquares) => "f_i^2",
            Self::Terms(Extra::CrossSquares) => "f_j^2, j != i",
            Self::Terms(Extra::OwnCubes) => "f_i^3",
            Self::Terms(Extra::OddQuadratic) => "f_i |f_i|",
            Self::Terms(Extra::Asymmetry) => "|f_i|",
            Self::Terms(Extra::FourthPower) => "f_i^4",
            Self::Terms(Extra::FifthPower) => "f_i^5",
            Self::Terms(Extra::Jump) => "sgn f_i",
            Self::Effect(extension) => match extension {
                Extension::ElasticTurn(Law::Speed) => "delta_k Omega^2, by position",
                Extension::ElasticTurn(Law::Load) => "delta_k Omega^2 |R0_1|, by position",
                Extension::ArmStretch(Law::Speed) => "R0_1 kappa Omega^2",
                Extension::ArmStretch(Law::Load) => "R0_1 kappa Omega^2 |R0_1|",
                Extension::SeatStretch(Law::Speed) => "R0_1 kappa Omega^2, by seat",
                Extension::SeatStretch(Law::Load) => "R0_1 kappa Omega^2 |R0_1|, by seat",
                Extension::RadiusScale => "P D R0",
                Extension::SpeedScale => "d f / d ln Omega^2",
                Extension::SpeedOffset => "d f / d |Omega|",
                Extension::EarthRate => "d f / d omega_E",
                Extension::Gravity => "d f / d g",
                Extension::ArmTurn(Law::Speed) => "P tau Omega^2",
                Extension::ArmTurn(Law::Load) => "P tau Omega^2 |R0_1|",
                Extension::SeatRadius => "P D e_1, by seat",
                Extension::SeatLateral => "P D e_2, by seat",
                Extension::PositionShift => "P D e_1, P D e_2, by position",
                Extension::MountingShift => "P D e_1, P D e_2, by mounting",
                Extension::MountingTurn => "delta, by mounting",
                Extension::MountingTilt => "alpha, by mounting",
                Extension::AngleTilt => "alpha, by angle of rest",
                Extension::MountingBias => "df0, by mounting",
                Extension::MountingScale => "f_i, by mounting",
                Extension::RestsBias => "df0, by switch-on of rests",
                Extension::RestsScale => "f_i, by switch-on of rests",
                Extension::RestsUnit => "f_j, by switch-on of rests",
                Extension::RestsTilt => "theta, by rest",
                Extension::AttitudesTilt => "theta, by stated attitude",
                Extension::SpinTurn => "delta while spinning, by position",
                Extension::ProofMasses => "d f / d rho_ji, those taken as exact",
                Extension::Disturbance(course) => course.facts().formula,
                Extension::BiasWander => Course::Wander(1).facts().formula,
                Extension::OneSpeed(_) => "d f / d ln Omega^2 at one set speed",
                Extension::Resonance(_) => "1 at one set speed",
                Extension::OneMounting(Difference::Shift, _) => "P D e_1, P D e_2 in one mounting",
                Extension::OneMounting(Difference::Turn, _) => "delta in one mounting",
                Extension::OneMounting(Difference::Unit, _) => "df0 + Gamma(f) f in one mounting",
            },
        }
    }

    /// Where it is described.
    pub fn source(self) -> &'static str {
        match self {
            Self::Terms(Extra::CrossProducts | Extra::OwnSquares | Extra::OddQuadratic | Extra::Asymmetry) => {
                "IEEE Std 1293"
            }
            Self::Terms(
                Extra::CrossSquares
                | Extra::OwnCubes
                | Extra::CrossCubes
                | Extra::CubicProducts
                | Extra::FourthPower
                | Extra::FifthPower
                | Extra::Jump,
            ) => "power series of the characteristic",
            Self::Effect(extension) => match extension {
                Extension::ElasticTurn(_) | Extension::PositionShift => "the source's abstract and section 3",
                Extension::ArmStretch(_)
                | Extension::SeatStretch(_)
                | Extension::RadiusScale
                | Extension::SpeedScale
                | Extension::SpeedOffset
                | Extension::OneSpeed(_)
                | Extension::EarthRate
                | Extension::Gravity => "IEEE Std 836",
                Extension::ArmTurn(_)
                | Extension::SeatRadius
                | Extension::SeatLateral
                | Extension::MountingShift
                | Extension::MountingTurn
                | Extension::MountingTilt
                | Extension::AngleTilt
                | Extension::RestsTilt
                | Extension::AttitudesTilt
                | Extension::SpinTurn
                | Extension::OneMounting(..) => "mechanics of the arm and the seat",
                Extension::ProofMasses => "the source's section 3",
                Extension::Disturbance(Course::Yield) => "IEEE Std 1293, open loop",
                Extension::MountingBias
                | Extension::MountingScale
                | Extension::RestsBias
                | Extension::RestsScale
                | Extension::RestsUnit
                | Extension::BiasWander
                | Extension::Resonance(_)
                | Extension::Disturbance(_) => "electronics and material of the unit",
            },
        }
    }
}

fn has(error_model: &ErrorModel, term: &Term) -> bool {
    error_model.terms.iter().any(|known| (known.axis, known.monomial) == (term.axis, term.monomial))
}

//! Random numbers, random unknowns and noise-free sessions shared by the test kinds.
#![allow(dead_code, reason = "each kind of test uses its part")]

use centrical::plan::Normalised;
use centrical::position::ThirdPosition;
use centrical::{ErrorModel, Experiment, Extension, Law, MeasurementModel, Observation, PairRelation};
use nalgebra::Matrix3;

/// `rho0` of the rank table (docs/source-and-findings.md), in units of `R*`.
pub fn spread() -> Matrix3<f64> {
    Matrix3::new(0.0, 0.05, 0.04, 0.0, 0.03, -0.02, 0.0, 0.02, -0.03)
}

/// A small generator of its own, so that a test means the same on every machine (SplitMix64, G. L. Steele et al., OOPSLA 2014).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// All 64 bits.
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform among 0, ..., `count - 1`.
    pub fn below(&mut self, count: usize) -> usize {
        usize::try_from(self.next() % count as u64).unwrap()
    }

    /// Uniform on (0, 1).
    pub fn uniform(&mut self) -> f64 {
        ((self.next() >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    /// Puts items into random order, Fisher-Yates.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            items.swap(last, self.below(last + 1));
        }
    }

    /// Standard normal, Box-Muller.
    pub fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// The [K5.5] experiment with proof masses apart, Earth rotation and eight levels up to 200 g.
pub fn experiment(third: ThirdPosition, pair_relation: PairRelation, radii: &[f64]) -> Experiment {
    let plan = Normalised {
        third,
        pair_relation,
        rho: spread(),
        radii: radii.to_vec(),
        levels: vec![0.0, 1.0, 2.0, 4.0, 8.0, 12.0, 16.0, 20.0],
        ..Normalised::default()
    };
    let mut experiment = plan.experiment();
    experiment.site.latitude = Some(0.97);
    experiment
}

pub fn kozlov(experiment: Experiment) -> MeasurementModel {
    MeasurementModel::new(experiment, ErrorModel::kozlov_2017(), &[])
}

/// Every extension and further terms at once: what a Jacobian must get right.
pub fn everything(experiment: Experiment) -> MeasurementModel {
    use centrical::{Group, Monomial, Term};
    let mut error_model = ErrorModel::kozlov_2017();
    for axis in 0..3 {
        for (name, monomial) in
            [("cross", Monomial::product(axis, (axis + 1) % 3)), ("odd", Monomial::odd_square(axis))]
        {
            error_model.terms.push(Term { name: format!("{name}_{axis}"), group: Group::HigherOrder, axis, monomial });
        }
    }
    let extensions = [
        Extension::ElasticTurn(Law::Speed),
        Extension::ElasticTurn(Law::Load),
        Extension::ArmStretch(Law::Load),
        Extension::SeatStretch(Law::Speed),
        Extension::RadiusScale,
        Extension::SpeedScale,
    ];
    MeasurementModel::new(experiment, error_model, &extensions)
}

/// Random parameters of typical magnitude, times `size`.
pub fn truth(model: &MeasurementModel, size: f64, random: &mut Random) -> Vec<f64> {
    model.parameters().iter().map(|p| size * p.typical * random.normal()).collect()
}

/// Noise-free plateau means of the exact model, with a covariance of 10 ug white.
pub fn observations(model: &MeasurementModel, x: &[f64]) -> Vec<Observation> {
    let set_points = &model.experiment().set_points;
    (0..set_points.len())
        .map(|set_point| Observation {
            set_point,
            mean: model.reading(&set_points[set_point], x),
            covariance: Matrix3::identity() * 1e-4_f64.powi(2),
        })
        .collect()
}

//! Random numbers, random unknowns and noise-free sessions shared by the test kinds.
#![allow(dead_code, reason = "each kind of test uses its part")]

pub mod random;
#[path = "../../examples/rank_table.rs"]
pub mod rank_table;

use centrical::ThirdPosition;
use centrical::plan::Normalised;
use centrical::{
    Calibration, Data, ErrorModel, Experiment, Extension, Fit, FitError, LeastSquares, MeasurementModel, Observation,
    PairRelation,
};
use nalgebra::{DMatrix, DVector, Matrix3};
pub use random::Random;
pub use rank_table::spread;

/// The [K5.5] experiment with proof masses apart, Earth rotation and eight levels up to 200 g, speeds to 10 ppm.
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
    experiment.centrifuge.speed_uncertainty = 1e-5;
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
            [("cross", Monomial::product(&[axis, (axis + 1) % 3])), ("odd", Monomial::odd_square(axis))]
        {
            error_model.terms.push(Term { name: format!("{name}_{axis}"), group: Group::HigherOrder, axis, monomial });
        }
    }
    let extensions = Extension::NAMED.map(|(_, extension)| extension);
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

/// A linear regression `min |A x - b|` by the least squares of the fit, the columns in units of their lengths.
pub struct Regression {
    pub x: DVector<f64>,
    /// Of `x`, by the scatter of the residuals.
    pub covariance: DMatrix<f64>,
    /// Sum of squared residuals, and the same per degree of freedom.
    pub sum_of_squares: f64,
    pub variance: f64,
}

impl Regression {
    pub fn of(a: &DMatrix<f64>, b: &DVector<f64>) -> Self {
        let (n, p) = a.shape();
        let sizes = DVector::from_iterator(p, a.column_iter().map(|column| column.norm().recip()));
        let equations = LeastSquares::new(a * DMatrix::from_diagonal(&sizes), sizes);
        let sum_of_squares = equations.redundant(b).norm_squared();
        let variance = sum_of_squares / (n - p) as f64;
        let covariance = equations.covariance() * variance;
        Self { x: equations.solve(b.clone()), covariance, sum_of_squares, variance }
    }
}

/// The fit of plateau means on the exact model.
pub fn exact(model: &MeasurementModel, observations: &[Observation]) -> Result<Fit, FitError> {
    Ok(Calibration::exact(&Data::new(model, observations.to_vec())?)?.into_fit())
}

/// The fit of plateau means on the linear model.
pub fn linear(model: &MeasurementModel, observations: &[Observation]) -> Result<Fit, FitError> {
    Ok(Calibration::linear(&Data::new(model, observations.to_vec())?)?.into_fit())
}

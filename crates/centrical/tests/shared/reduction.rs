//! Reduction of whole sessions against their truth.

use centrical::reduction::{NoiseModel, ReducedMounting};
use nalgebra::{Matrix3, Vector3};

use crate::session::Session;

#[test]
#[ignore = "needs the shared data: set CENTRICAL_SHARED"]
fn clean_session() {
    windows_and_means("clean-csv");
}

#[test]
#[ignore = "needs the shared data: set CENTRICAL_SHARED"]
fn printed_relation_session() {
    windows_and_means("printed-relation");
}

/// Windows lie inside the true ones, and three quarters of each are used. Errors of the means have mean square one in
/// units of their covariance, with three degrees of freedom at rest. While spinning there are two, across the direction
/// in which the plateau's unknown speed error moves the reading. Bounds lie at four standard deviations of chi^2.
fn windows_and_means(name: &str) {
    let session = Session::open(name);
    let reduced: Vec<ReducedMounting> = (0..session.mountings())
        .map(|m| {
            let found = session.record(m).reduce(Some(&session.telemetry(m)), &session.schedule(m));
            found.unwrap_or_else(|error| panic!("{name}, mounting {}: {error}", m + 1))
        })
        .collect();
    let noise = NoiseModel::pool(&reduced);
    let (mut chi_squared, mut freedom) = (0.0, 0.0);
    for (m, reduced) in reduced.iter().enumerate() {
        assert!(reduced.clock_agreement().and_then(|clock| clock.offset).is_some_and(|[_, u]| u < 0.01));
        for (k, mean) in reduced.means(&noise).iter().enumerate() {
            let [start, end] = session.window(m, k);
            let [from, to] = mean.window;
            assert!(from >= start && to <= end, "{name} {m} {k}: {from} to {to} in {start} to {end}");
            assert!(to - from > 0.75 * (end - start), "{name} {m} {k}: {from} to {to} of {start} to {end}");
            let error = mean.mean - session.truth(m, k, 1.0);
            let along = (session.truth(m, k, 1.0 + 1e-6) - session.truth(m, k, 1.0 - 1e-6)) / 2e-6;
            let (square, n) = squared_error(&error, &mean.covariance, &along);
            chi_squared += square;
            freedom += n;
        }
    }
    let ratio: f64 = chi_squared / freedom;
    assert!((ratio - 1.0).abs() < 4.0 * (2.0 / freedom).sqrt(), "{name}: {ratio:.3} on {freedom} degrees of freedom");
}

/// `e^T C^-1 e` with the part along `d` free: the remainder after the best multiple of `d`, and its degrees of
/// freedom.
fn squared_error(e: &Vector3<f64>, c: &Matrix3<f64>, d: &Vector3<f64>) -> (f64, f64) {
    let factor = c.cholesky().expect("a covariance is positive definite");
    let (e_weighted, d_weighted) = (factor.solve(e), factor.solve(d));
    let along = d.dot(&d_weighted);
    if along == 0.0 {
        return (e.dot(&e_weighted), 3.0);
    }
    (e.dot(&e_weighted) - d.dot(&e_weighted).powi(2) / along, 2.0)
}

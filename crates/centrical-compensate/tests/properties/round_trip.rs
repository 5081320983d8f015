use centrical_compensate::{Compensation, reading};
use proptest::prelude::*;

use crate::models::{Model, everything, kozlov, with_points};

/// Largest magnitude of a component.
fn largest(v: [f64; 3]) -> f64 {
    v.iter().fold(0.0, |largest, c| c.abs().max(largest))
}

/// A reading comes back, to a few last places: the reading is rounded once, its
/// terms, a hundredth of it, some ten times, and the inverse of the gain is below 3/2.
fn comes_back(model: &Model, points: &[[f64; 3]]) -> Result<(), TestCaseError> {
    let compensation = Compensation::new(&model.terms, model.range).unwrap();
    for u in points {
        let f = model.at(*u);
        let read = reading(&model.terms, f);
        let back = compensation.apply(read).unwrap();
        let error = largest([0, 1, 2].map(|i| back[i] - f[i]));
        let magnitude = largest(f).max(largest(read));
        prop_assert!(error <= 4.0 * f64::EPSILON * magnitude, "{f:?}: {error:e} of {magnitude:e}");
    }
    Ok(())
}

/// Where the model gives an answer, the answer is in range and reads as it should, whatever came in.
fn is_no_artefact(model: &Model, points: &[[f64; 3]]) -> Result<(), TestCaseError> {
    let compensation = Compensation::new(&model.terms, model.range).unwrap();
    for u in points {
        // From far inside to a thousand times the range.
        let read = model.at(u.map(|u| 1000.0 * u.powi(9)));
        if let Ok(f) = compensation.apply(read) {
            let again = reading(&model.terms, f);
            let error = largest([0, 1, 2].map(|i| again[i] - read[i]));
            prop_assert!(error <= 8.0 * f64::EPSILON * model.range, "{read:?} to {f:?}: {error:e}");
            prop_assert!((0..3).all(|i| f[i].abs() <= model.range * (1.0 + 1e-14)));
        }
    }
    Ok(())
}

proptest! {
    #[test]
    fn kozlov_readings_come_back((model, points) in with_points(kozlov(), 100)) {
        comes_back(&model, &points)?;
    }

    #[test]
    fn readings_of_any_terms_come_back((model, points) in with_points(everything(), 100)) {
        comes_back(&model, &points)?;
    }

    /// The corners and faces of the range belong to it.
    #[test]
    fn the_edge_comes_back((model, points) in with_points(everything(), 10)) {
        let edges: Vec<[f64; 3]> = points.iter().flat_map(|u| [u.map(f64::signum), [u[0].signum(), u[1], u[2]]]).collect();
        comes_back(&model, &edges)?;
        comes_back(&model, &[[0.0; 3]])?;
    }

    #[test]
    fn answers_are_no_artefacts((model, points) in with_points(everything(), 100)) {
        is_no_artefact(&model, &points)?;
    }

    /// A specific force beyond the range is refused, near it or far away.
    #[test]
    fn readings_from_beyond_the_range_are_refused(
        (model, points) in with_points(everything(), 20),
        beyond in 1.000_001..3.0_f64,
        axis in 0..3_usize,
    ) {
        let compensation = Compensation::new(&model.terms, model.range).unwrap();
        for mut u in points {
            u[axis] = beyond.copysign(u[axis]);
            let read = reading(&model.terms, model.at(u));
            let error = compensation.apply(read).unwrap_err();
            prop_assert_eq!((error.reading, error.range), (read, model.range));
        }
    }
}

/// A value that is not a number has no inverse.
#[test]
fn no_numbers_are_refused() {
    let compensation = Compensation::new(&[], 1.0).unwrap();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(compensation.apply([0.0, bad, 0.0]).is_err());
    }
    assert_eq!(compensation.apply([0.5, -1.0, 0.0]), Ok([0.5, -1.0, 0.0]));
}

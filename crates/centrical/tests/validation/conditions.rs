//! The source's sufficient conditions (its section 6, point 3), met by its own experiment, and the finding of
//! docs/source-and-findings.md that they are not necessary: one rest angle instead of two does not lower the rank.

use std::f64::consts::PI;

use centrical::observability::Need;
use centrical::plan::Normalised;
use centrical::{ErrorModel, MeasurementModel, PairRelation, Study, Weight};

use crate::common::spread;

fn study(levels: &[f64], radii: &[f64], rest_angles: &[f64]) -> Study {
    let plan = Normalised {
        pair_relation: PairRelation::Common,
        rho: spread(),
        levels: levels.to_vec(),
        radii: radii.to_vec(),
        rest_angles: rest_angles.to_vec(),
        ..Normalised::default()
    };
    let model = MeasurementModel::new(plan.experiment(), ErrorModel::kozlov_2017(), &[]);
    let weights = Weight::equal(model.experiment().set_points.len(), 1.0);
    Study::at_zero(model, weights).unwrap()
}

/// Rest angles, vertical axes, radii, speeds, directions.
fn checklist(study: &Study) -> Vec<(bool, Need)> {
    study.conditions().iter().map(|condition| (condition.is_met, condition.need)).collect()
}

#[test]
fn the_source_meets_its_own_conditions() {
    let list = checklist(&study(&[0.0, 1.0, 2.0, 3.0], &[1.0, 0.5], &[0.0, PI]));
    assert!(list.iter().all(|(is_met, _)| *is_met));
    // The rank table: without the second radius 45 of 49, without more than one speed 48 of 49.
    assert_eq!(list[2].1, Need::Holds(4));
    assert_eq!(list[3].1, Need::Holds(1));
    // One rest angle does as well.
    assert_eq!(list[0].1, Need::Spare);
}

#[test]
fn one_rest_angle_is_enough() {
    let list = checklist(&study(&[0.0, 1.0, 2.0, 3.0], &[1.0, 0.5], &[0.0]));
    assert_eq!(list[0], (false, Need::Dispensable));
}

#[test]
fn what_is_missing_is_found_missing() {
    assert_eq!(checklist(&study(&[1.0, 2.0, 3.0], &[1.0, 0.5], &[]))[0], (false, Need::WouldBringBack(2)));
    assert_eq!(checklist(&study(&[0.0, 1.0, 2.0, 3.0], &[1.0], &[0.0, PI]))[2], (false, Need::WouldBringBack(4)));
    assert_eq!(checklist(&study(&[0.0, 1.0], &[1.0, 0.5], &[0.0, PI]))[3], (false, Need::WouldBringBack(1)));
}

//! The answers do not depend on units, on the order of rows or of positions, on which position of a pair comes first, or
//! on the weights.

use std::collections::BTreeMap;

use centrical::ThirdPosition::AxisOneDown;
use centrical::plan::Normalised;
use centrical::{ErrorModel, Experiment, MeasurementModel, PairRelation, Study, Weight};
use nalgebra::{Matrix3, Vector3};

use crate::common::{Random, spread};
use crate::observability::random_design;

fn study(experiment: Experiment) -> Study {
    let model = MeasurementModel::new(experiment, ErrorModel::kozlov_2017(), &[]);
    let weights = Weight::equal(model.experiment().set_points.len(), 1e-4);
    Study::at_zero(model, weights).unwrap()
}

fn plans() -> Vec<Normalised> {
    let mut plans = Vec::new();
    for pair_relation in [PairRelation::Common, PairRelation::Opposite, PairRelation::Free] {
        for (levels, radii) in
            [(&[0.0, 1.0, 2.0, 3.0][..], &[1.0, 0.5][..]), (&[0.0, 1.0], &[1.0, 0.5]), (&[0.0, 1.0, 2.0], &[1.0])]
        {
            let (levels, radii, rho) = (levels.to_vec(), radii.to_vec(), spread());
            plans.push(Normalised { third: AxisOneDown, pair_relation, levels, radii, rho, ..Normalised::default() });
        }
    }
    plans
}

/// Estimability by name.
fn estimable(study: &Study) -> BTreeMap<String, bool> {
    let parameters = study.model().parameters().iter().enumerate();
    parameters.map(|(j, p)| (p.name.clone(), study.observability().is_estimable(j))).collect()
}

fn same_seen(a: &Study, b: &Study) {
    assert_eq!(a.observability().rank(), b.observability().rank());
    assert_eq!(estimable(a), estimable(b));
}

fn same_singular_values(a: &Study, b: &Study) {
    let (a, b) = (a.observability().singular_values(), b.observability().singular_values());
    for (x, y) in a.iter().zip(b) {
        assert!((x - y).abs() < 1e-12 * a[0], "{x:e} {y:e}");
    }
}

/// Directions in the second study span the same null space: each, taken over by name with the sign of `sign`, leaves
/// the readings of the first unchanged.
fn same_null_space(a: &Study, b: &Study, sign: impl Fn(&str) -> f64) {
    for direction in b.observability().null_directions() {
        let named = direction.terms().iter().map(|(j, component)| {
            let name = &b.model().parameters()[*j].name;
            (a.model().parameters().find(name).unwrap(), component * sign(name))
        });
        let named: Vec<(usize, f64)> = named.collect();
        let (mut change, mut size) = (0.0_f64, 0.0_f64);
        for linearisation in a.linearisations() {
            let mut sum = Vector3::zeros();
            for (column, derivative) in &linearisation.columns {
                if let Some((_, component)) = named.iter().find(|(j, _)| j == column) {
                    sum += derivative * *component;
                    size = size.max((derivative * *component).amax());
                }
            }
            change = change.max(sum.amax());
        }
        assert!(change <= 1e-8 * size, "{change:e} of {size:e}");
    }
}

/// R* in millimetres, g in units of its own: lengths and times scaled apart.
#[test]
fn units_do_not_matter() {
    for plan in plans() {
        let si = study(plan.experiment());
        let other = study(Normalised { arm: plan.arm * 1e3, gravity: plan.gravity * 2.3e-5, ..plan }.experiment());
        same_seen(&si, &other);
        same_singular_values(&si, &other);
    }
}

#[test]
fn order_of_rows_does_not_matter() {
    let mut random = Random::new(30);
    for plan in plans() {
        let ordered = study(plan.experiment());
        let mut weights = ordered.weights().to_vec();
        for n in (1..weights.len()).rev() {
            weights.swap(n, random.below(n + 1));
        }
        let shuffled = Study::at_zero(ordered.model().clone(), weights).unwrap();
        same_seen(&ordered, &shuffled);
        same_singular_values(&ordered, &shuffled);
        same_null_space(&ordered, &shuffled, |_| 1.0);
        if plan.levels.len() == 4 {
            assert_eq!(ordered.observability().null_directions(), shuffled.observability().null_directions());
        }
    }
}

/// The experiment with its positions in another order, which may put the second of a pair first.
fn reordered(experiment: &Experiment, order: &[usize]) -> Experiment {
    let mut other = experiment.clone();
    other.positions = order.iter().map(|&k| experiment.positions[k].clone()).collect();
    for mounting in &mut other.mountings {
        mounting.position = order.iter().position(|k| *k == mounting.position).unwrap();
    }
    other
}

#[test]
fn order_of_positions_does_not_matter() {
    for plan in plans() {
        let ordered = study(plan.experiment());
        let other = study(reordered(&plan.experiment(), &[4, 0, 2, 5, 3, 1]));
        same_seen(&ordered, &other);
        same_singular_values(&ordered, &other);
        same_null_space(&ordered, &other, |_| 1.0);
    }
}

/// The value of dR belongs to the pair's first position: with the printed relation its sign follows the choice.
#[test]
fn first_of_a_pair_does_not_matter() {
    for plan in plans() {
        let ordered = study(plan.experiment());
        let other = study(reordered(&plan.experiment(), &[1, 0, 2, 3, 5, 4]));
        same_seen(&ordered, &other);
        same_singular_values(&ordered, &other);
        let swapped = |name: &str| ["[A]", "[C]"].iter().any(|pair| name.ends_with(pair));
        let sign = |name: &str| if plan.pair_relation == PairRelation::Opposite && swapped(name) { -1.0 } else { 1.0 };
        same_null_space(&ordered, &other, sign);
    }
}

/// Weights over three decades, correlated axes and a speed error change singular values, not what is seen, as long as the
/// rank is not called doubtful.
#[test]
fn weights_do_not_matter() {
    let mut random = Random::new(31);
    let mut compared = 0;
    for _ in 0..40 {
        let plain = random_design(&mut random);
        let weights = (plain.weights().iter())
            .map(|weight| {
                let factor = Matrix3::from_fn(|_, _| 0.3 * random.normal()) + Matrix3::identity();
                let size = 1e-4 * 10_f64.powf(1.5 * (random.uniform() - 0.5));
                Weight { covariance: factor * factor.transpose() * (size * size), ..*weight }
            })
            .collect();
        let mut experiment = plain.model().experiment().clone();
        experiment.centrifuge.speed_uncertainty = 1e-5;
        let weighted = Study::at_zero(plain.model().in_experiment(experiment), weights).unwrap();
        if !plain.observability().is_doubtful() && !weighted.observability().is_doubtful() {
            same_seen(&plain, &weighted);
            compared += 1;
        }
    }
    assert!(compared > 30, "no power: {compared}");
}

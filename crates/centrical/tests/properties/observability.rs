//! Estimability against an independent decision by Gram-Schmidt, null directions against the exact model, remedies
//! against what they promise, on random designs.

use std::f64::consts::{FRAC_PI_2, PI};

use centrical::Position;
use centrical::observability::{Addition, Cause, CorrelatedGroup};
use centrical::{
    Centrifuge, Combination, ErrorModel, Experiment, Extension, Extra, History, Law, MeasurementModel, Mounting,
    PairRelation, ReferencePoint, Rival, SetPoint, Site, Study, Unit, Weight, rotation,
};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::validity::source_model;
use crate::common::{Random, spread};

/// A design of one to seven positions along the arm axes or oblique, one to three radii, up to three speeds, up to two
/// rest angles, some set points left out, any pair relation and convention, sometimes with extensions and further terms.
pub fn random_design(random: &mut Random) -> Study {
    let positions = random_positions(random);
    let mut mountings = Vec::new();
    for k in 0..positions.len() {
        for n in 0..=random.below(3) {
            let transverse = if random.below(4) == 0 { 0.02 } else { 0.0 };
            mountings.push(Mounting { position: k, arm_y: Vector3::new(0.5 / (n + 1) as f64, transverse, 0.0) });
        }
    }
    let speeds = random.below(4);
    let angles = random.below(3);
    let mut set_points = Vec::new();
    for mounting in 0..mountings.len() {
        for angle in [0.0, FRAC_PI_2].into_iter().take(angles) {
            set_points.push(SetPoint::at_rest(mounting, angle));
        }
        for n in 0..speeds {
            set_points.push(SetPoint::spinning(mounting, 14.0 * ((n + 1) as f64).sqrt()));
        }
    }
    set_points.retain(|_| random.below(8) > 0);
    if set_points.is_empty() {
        set_points.push(SetPoint::spinning(0, 14.0));
    }
    let experiment = Experiment {
        centrifuge: Centrifuge::default(),
        site: Site { gravity: 9.81, latitude: (random.below(2) == 0).then_some(0.97) },
        unit: Unit {
            rho_z: if random.below(2) == 0 { spread() * 0.5 } else { Matrix3::zeros() },
            reference: [ReferencePoint::FirstProofMass, ReferencePoint::OwnAxes][random.below(2)],
        },
        positions,
        pair_relation: [PairRelation::Common, PairRelation::Opposite, PairRelation::Free][random.below(3)],
        mountings,
        set_points,
    };
    let mut error_model = ErrorModel::kozlov_2017();
    for extra in [Extra::CrossProducts, Extra::OddQuadratic] {
        if random.below(4) == 0 {
            error_model = error_model.with(extra);
        }
    }
    let extensions: Vec<Extension> =
        (random.below(3) == 0).then(|| Extension::NAMED[random.below(8)].1).into_iter().collect();
    let model = MeasurementModel::new(experiment, error_model, &extensions);
    let count = model.experiment().set_points.len();
    Study::at_zero(model, Weight::equal(count, 1e-4)).unwrap()
}

fn random_positions(random: &mut Random) -> Vec<Position> {
    (0..=random.below(7))
        .map(|k| {
            let quarter_turns = Vector3::from([0; 3].map(|_| random.below(4) as f64 * FRAC_PI_2));
            let p_zy = rotation(&Vector3::new(quarter_turns.x, 0.0, 0.0))
                * rotation(&Vector3::new(0.0, quarter_turns.y, 0.0))
                * rotation(&Vector3::new(0.0, 0.0, quarter_turns.z));
            let tidy = p_zy.map(f64::round);
            let oblique = rotation(&Vector3::new(random.normal(), random.normal(), random.normal()));
            let p_zy = if random.below(4) == 0 { oblique } else { tidy };
            Position::on_arm((k + 1).to_string(), p_zy, format!("P{}", random.below(4)))
        })
        .collect()
}

/// The exact model's Jacobian at zero, columns scaled to unit length: not the code path of the study.
fn scaled_design(study: &Study) -> DMatrix<f64> {
    let model = study.model();
    let p = model.parameters().len();
    let mut rows = DMatrix::zeros(3 * study.weights().len(), p);
    for (n, weight) in study.weights().iter().enumerate() {
        let linearisation = model.linearise(&model.experiment().set_points[weight.set_point], &vec![0.0; p]);
        // What is only rounding of cos(90 deg) at the exact attitudes is zero in H.
        let largest = model.experiment().site.gravity;
        for (column, derivative) in linearisation.columns {
            let derivative = derivative.map(|d| if d.abs() < 1e-13 * largest { 0.0 } else { d });
            rows.fixed_view_mut::<3, 1>(3 * n, column).copy_from(&derivative);
        }
    }
    for mut column in rows.column_iter_mut() {
        let norm = column.norm();
        if norm > 0.0 {
            column /= norm;
        }
    }
    rows
}

/// Distance of column `j` from the span of all others, by Gram-Schmidt with pivoting and reorthogonalisation.
fn distance_from_others(design: &DMatrix<f64>, j: usize) -> f64 {
    let mut target: DVector<f64> = design.column(j).into_owned();
    let mut others: Vec<DVector<f64>> =
        (0..design.ncols()).filter(|&other| other != j).map(|other| design.column(other).into_owned()).collect();
    loop {
        let lengths: Vec<f64> = others.iter().map(nalgebra::Matrix::norm).collect();
        let Some(longest) = (0..others.len()).max_by(|&a, &b| lengths[a].total_cmp(&lengths[b])) else { break };
        // Far below what can matter and far above rounding: the designs looked at are not doubtful.
        if lengths[longest] < 1e-10 {
            break;
        }
        let unit = others.swap_remove(longest) / lengths[longest];
        for v in others.iter_mut().chain([&mut target]) {
            for _ in 0..2 {
                let share = unit.dot(v);
                v.axpy(-share, &unit, 1.0);
            }
        }
    }
    target.norm()
}

/// A parameter is called estimable exactly when no change of the others makes up for a change of it: when its column
/// stands off the span of the others. Each null direction leaves all predicted data unchanged, and there are as many as
/// are lost. The multiple correlations of the correlated groups are those distances too.
#[test]
fn estimable_means_nothing_else_makes_up_for_it() {
    let mut random = Random::new(20);
    let (mut estimable, mut lost, mut doubtful, mut correlated) = (0, 0, 0, 0);
    for _ in 0..60 {
        let study = random_design(&mut random);
        let seen = study.observability();
        if seen.is_doubtful() {
            doubtful += 1;
            continue;
        }
        let design = scaled_design(&study);
        let groups = seen.correlated_groups();
        for j in 0..seen.columns() {
            let distance = distance_from_others(&design, j);
            let name = &study.model().parameters()[j].name;
            assert_eq!(seen.is_estimable(j), distance > 1e-9, "{name}: {distance:e}, {:?}", seen.smallest_relative());
            *(if seen.is_estimable(j) { &mut estimable } else { &mut lost }) += 1;
            let group = groups.iter().find(|group| group.parameters.contains(&j));
            if let Some((group, n)) = group.and_then(|g| Some((g, g.parameters.iter().position(|&k| k == j)?))) {
                let multiple = group.multiple_correlations[n];
                assert!(multiple >= CorrelatedGroup::STRONG);
                assert!((multiple * multiple + distance * distance - 1.0).abs() < 1e-9, "{name}");
                correlated += 1;
            }
        }
        assert_eq!(seen.null_directions().len(), seen.lost());
        for direction in seen.null_directions() {
            assert!(unchanged(&study, direction.terms()), "{}", direction.text(study.model().parameters(), 9.81));
        }
    }
    assert!(estimable > 500 && lost > 500 && correlated > 50, "no power: {estimable} {lost} {correlated}");
    assert!(doubtful < 6, "{doubtful} of 60 designs are doubtful");
}

/// Whether moving along the direction changes no predicted reading to first order, against the terms by themselves.
fn unchanged(study: &Study, direction: &[(usize, f64)]) -> bool {
    let model = study.model();
    let zero = vec![0.0; model.parameters().len()];
    let (mut change, mut by_terms) = (0.0_f64, 0.0_f64);
    for weight in study.weights() {
        let linearisation = model.linearise(&model.experiment().set_points[weight.set_point], &zero);
        let mut sum = Vector3::zeros();
        for &(j, component) in direction {
            let term: Vector3<f64> =
                linearisation.columns.iter().filter(|(column, _)| *column == j).map(|(_, d)| d * component).sum();
            by_terms = by_terms.max(term.amax());
            sum += term;
        }
        change = change.max(sum.amax());
    }
    // A lost column of its own may be rounding of cos(90 deg) in the exact model: 1e-16 of gravity per radian.
    // Null vectors are known to rounding over the gap that separates them from what is seen.
    let gap = study.observability().smallest_relative().unwrap_or(1.0);
    change <= (1e-10_f64).max(1e-14 / gap) * by_terms || change < 1e-12
}

/// A combination of parameters is seen exactly when no null direction changes it: rows of the design are, and so are
/// their sums; a null direction itself is not, nor is it with anything seen added.
#[test]
fn combinations_are_seen_when_no_null_direction_changes_them() {
    let mut random = Random::new(21);
    let mut directions = 0;
    for _ in 0..60 {
        let study = random_design(&mut random);
        let seen = study.observability();
        if seen.is_doubtful() {
            continue;
        }
        for linearisation in study.linearisations().iter().step_by(7) {
            for i in 0..3 {
                let row = linearisation.columns.iter().map(|(j, derivative)| (*j, derivative[i]));
                let row = Combination::new(row);
                assert!(seen.sees(&row));
                for direction in seen.null_directions() {
                    let size = |&(j, c): &(usize, f64)| (j, c / study.model().parameters()[j].typical.powi(2));
                    let along: Vec<(usize, f64)> = direction.terms().iter().map(size).collect();
                    assert!(!seen.sees(&Combination::new(along.clone())));
                    assert!(!seen.sees(&Combination::new(along.into_iter().chain(row.terms().iter().copied()))));
                    directions += 1;
                }
            }
        }
    }
    assert!(directions > 500, "no power: {directions}");
}

/// Every step of every remedy brings back what it promises when it is applied, by a study made anew; what is said to
/// restore the rank does; the list is in order of cost. Something is offered wherever a measurable dimension is lost.
#[test]
fn remedies_keep_their_promise() {
    let mut random = Random::new(22);
    let (mut restoring, mut raising, mut chains) = (0, 0, 0);
    for _ in 0..12 {
        let start = random_design(&mut random);
        let remedies = start.remedies();
        assert_eq!(remedies.is_empty(), start.observability().lost() == 0);
        for remedy in &remedies {
            let mut study = start.clone();
            for step in &remedy.steps {
                let next = step.addition.apply(&study).unwrap();
                let next = Study::at_zero(next.model().clone(), next.weights().to_vec()).unwrap();
                assert_eq!(study.observability().lost() - next.observability().lost(), step.gain, "{}", step.text);
                assert!(step.gain > 0);
                study = next;
            }
            assert_eq!(study.observability().lost() == 0, remedy.restores_rank());
            chains += usize::from(remedy.steps.len() > 1);
            *(if remedy.restores_rank() { &mut restoring } else { &mut raising }) += 1;
        }
        let singles: Vec<_> = remedies.iter().filter(|r| r.steps.len() == 1 && r.restores_rank()).collect();
        assert!(singles.is_sorted_by_key(|remedy| remedy.steps[0].addition.cost()));
    }
    assert!(restoring > 5 && raising > 25 && chains > 2, "no power: {restoring} {raising} {chains}");
}

/// An addition keeps the set points in the order of mountings, and every plateau its weight.
#[test]
fn additions_keep_order_and_weights() {
    let mut random = Random::new(23);
    for _ in 0..20 {
        let mut study = random_design(&mut random);
        let weights: Vec<Weight> = (study.weights().iter())
            .map(|w| Weight { covariance: w.covariance * (1.0 + w.set_point as f64), ..*w })
            .collect();
        study = Study::at_zero(study.model().clone(), weights).unwrap();
        let mountings = (0..study.model().experiment().mountings.len()).collect();
        let addition = Addition::Rest { mountings, angle: PI };
        let after = addition.apply(&study).unwrap();
        let (old, new) = (study.model().experiment(), after.model().experiment());
        // What came before a plateau is another thing after an addition.
        let set = |s: &SetPoint| SetPoint { history: History::default(), ..*s };
        assert!(new.set_points.is_sorted_by_key(|s| s.mounting));
        assert_eq!(new.set_points.len(), old.set_points.len() + old.mountings.len());
        for weight in study.weights() {
            let set_point = set(&old.set_points[weight.set_point]);
            let kept = after
                .weights()
                .iter()
                .find(|w| set(&new.set_points[w.set_point]) == set_point && w.covariance == weight.covariance);
            assert!(kept.is_some());
        }
    }
}

/// Every lost combination has its reason in a sentence that names it.
#[test]
fn reasons_name_every_null_direction() {
    let mut random = Random::new(24);
    let mut sums = 0;
    for _ in 0..40 {
        let study = random_design(&mut random);
        let reasons = study.reasons();
        assert_eq!(reasons.len(), study.observability().lost());
        for reason in reasons {
            let sentence = reason.sentence(&study);
            let first = &study.model().parameters()[reason.direction.terms()[0].0].name;
            assert!(sentence.contains(first.as_str()), "{sentence}");
            // A sum that a newtonometer feels does not change along the direction, as far as that is known.
            let is_well_known = study.observability().smallest_relative().is_some_and(|gap| gap > 1e-4);
            for sight in reason.sights.iter().filter(|sight| is_well_known && sight.is_one_sum) {
                let terms = sight.terms.iter().map(|(j, c)| c * reason.direction.component(*j));
                let (sum, size) = terms.fold((0.0, 0.0_f64), |(sum, size), t| (sum + t, size.max(f64::abs(t))));
                assert!(f64::abs(sum) <= 1e-6 * size, "{sum:e} of {size:e}: {sentence}");
                sums += 1;
            }
        }
    }
    assert!(sums > 100, "no power: {sums}");
}

/// Another radius is called a cause where it parts what one radius leaves together, and not where each mounting has a shift of its own, which
/// the mountings at the further radius would have too.
#[test]
fn another_radius_is_a_cause_where_it_parts() {
    let study = |model: MeasurementModel| {
        let count = model.experiment().set_points.len();
        Study::at_zero(model, Weight::equal(count, 1e-4)).unwrap()
    };
    let names_radius = |study: &Study| study.reasons().iter().any(|reason| reason.causes.contains(&Cause::Radius));
    let further = |study: &Study| {
        let positions = (0..study.model().experiment().positions.len()).collect();
        Addition::Radius { positions, radius: 0.4 }.apply(study).unwrap()
    };
    let two_radii = source_model();
    let mut experiment = two_radii.experiment().clone();
    for mounting in &mut experiment.mountings {
        mounting.arm_y.x = 0.5;
    }
    let one_radius = study(two_radii.in_experiment(experiment));
    assert!(
        names_radius(&one_radius) && further(&one_radius).observability().lost() < one_radius.observability().lost()
    );
    let shifting = study(two_radii.with_rivals(&[Rival::Effect(Extension::MountingShift)]));
    assert!(shifting.observability().lost() > 0 && !names_radius(&shifting));
    assert!(further(&shifting).observability().lost() >= shifting.observability().lost());
}

/// Deformations and scales by name, each alone: rank is full with the common relation except for the load's turn.
#[test]
fn extensions_by_name() {
    for (name, extension) in Extension::NAMED {
        assert_eq!(Extension::named(name), Some(extension));
    }
    assert_eq!(Extension::named("elastic-turn-load"), Some(Extension::ElasticTurn(Law::Load)));
    assert_eq!(Extension::named("elastic turn"), None);
}

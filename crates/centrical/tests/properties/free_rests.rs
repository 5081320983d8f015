//! Rests in attitudes that only gravity shows: the model, what they determine, and what they add to a centrifuge session.

use centrical::ThirdPosition::AxisOneUp;
use centrical::fit::Follower;
use centrical::observability::Addition;
use centrical::uncertainty::{Level, RivalTest, Rivals};
use centrical::{
    Calibration, Combination, Data, ErrorModel, Experiment, Fit, Kind, MeasurementModel, Mounting, Observation,
    PairRelation, Position, Rival, SetPoint, Source, Study, TypeB, Weight, unwatched,
};
use nalgebra::{Matrix3, Vector3};

use crate::common::{Random, exact, experiment, kozlov, truth};

/// Of a rest of a minute [m/s^2].
const NOISE: f64 = 1e-4;

/// The six faces, twelve edges and eight corners of a cube.
fn cube() -> Vec<Vector3<f64>> {
    let steps = || [-1.0, 0.0, 1.0].into_iter();
    let all = steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| Vector3::new(x, y, z))));
    all.filter(|direction| *direction != Vector3::zeros()).map(|direction| direction.normalize()).collect()
}

fn faces() -> Vec<Vector3<f64>> {
    cube().into_iter().filter(|direction| direction.amax() > 0.99).collect()
}

fn random_directions(count: usize, random: &mut Random) -> Vec<Vector3<f64>> {
    (0..count).map(|_| Vector3::from_fn(|_, _| random.normal()).normalize()).collect()
}

/// `experiment` with a rest for each direction of the specific force.
fn with_rests(mut experiment: Experiment, directions: &[Vector3<f64>]) -> Experiment {
    for (n, direction) in directions.iter().enumerate() {
        let mounting = experiment.mountings.len();
        let position = experiment.positions.len();
        experiment.mountings.push(Mounting { position, arm_y: Vector3::zeros() });
        experiment.positions.push(Position::free(format!("r{}", n + 1), direction));
        experiment.set_points.push(SetPoint::at_rest(mounting, 0.0));
    }
    experiment
}

/// `experiment` with its free attitudes known to `uncertainty` [rad].
fn known(mut experiment: Experiment, uncertainty: f64) -> Experiment {
    for position in experiment.positions.iter_mut().filter(|position| position.is_free) {
        position.attitude_uncertainty = Some(uncertainty);
    }
    experiment
}

/// Rests without a centrifuge.
fn rests_alone(directions: &[Vector3<f64>], terms: usize) -> MeasurementModel {
    let mut empty = experiment(AxisOneUp, PairRelation::Common, &[1.0]);
    empty.positions.clear();
    empty.mountings.clear();
    empty.set_points.clear();
    let mut error_model = ErrorModel::kozlov_2017();
    error_model.terms.retain(|term| usize::from(term.monomial.degree()) < terms);
    MeasurementModel::new(with_rests(empty, directions), error_model, &[])
}

fn observed(model: &MeasurementModel, truth: &[f64], random: &mut Random) -> Vec<Observation> {
    let set_points = model.experiment().set_points.iter().enumerate();
    let noise = |random: &mut Random| Vector3::from_fn(|_, _| NOISE * random.normal());
    set_points
        .map(|(set_point, at)| Observation {
            set_point,
            mean: model.reading(at, truth) + noise(random),
            covariance: Matrix3::identity() * NOISE * NOISE,
        })
        .collect()
}

/// Unknowns of the instrument that the rests show.
fn shown(model: &MeasurementModel) -> Vec<String> {
    let zero = vec![0.0; model.parameters().len()];
    let fit = exact(model, &observed(model, &zero, &mut Random::new(1))).unwrap();
    let seen = fit.observability();
    let parameters = model.parameters().iter().enumerate();
    let of_instrument = parameters.filter(|(_, p)| p.is_of_instrument());
    of_instrument.filter(|(j, _)| seen.is_estimable(*j)).map(|(_, p)| p.name.clone()).collect()
}

#[test]
fn the_derivatives_are_those_of_the_reading() {
    let free = with_rests(experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]), &cube());
    the_derivatives_are_those_of(&kozlov(known(free.clone(), 1e-3)));
    the_derivatives_are_those_of(&kozlov(free));
}

fn the_derivatives_are_those_of(model: &MeasurementModel) {
    let x = truth(model, 3.0, &mut Random::new(5));
    for set_point in &model.experiment().set_points {
        let mut difference = vec![Vector3::zeros(); x.len()];
        for (j, parameter) in model.parameters().iter().enumerate() {
            let step = 0.1 * parameter.typical;
            let at = |factor: f64| {
                let mut moved = x.clone();
                moved[j] += factor * step;
                model.reading(set_point, &moved)
            };
            difference[j] = (at(1.0) - at(-1.0)) / (2.0 * step) * parameter.typical;
        }
        let mut columns = vec![Vector3::zeros(); x.len()];
        for (j, column) in model.linearise(set_point, &x).columns {
            columns[j] = column * model.parameters()[j].typical;
        }
        for (j, (column, difference)) in columns.iter().zip(&difference).enumerate() {
            let name = &model.parameters()[j].name;
            assert!((column - difference).norm() < 1e-6 * (1.0 + difference.norm()), "{name}: {column} {difference}");
        }
    }
}

/// The linear model is the exact one at zero.
#[test]
fn the_linear_model_is_the_exact_one_at_zero() {
    let free = with_rests(experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]), &cube());
    the_linear_model_is_the_exact_one_of(&kozlov(known(free.clone(), 1e-3)));
    the_linear_model_is_the_exact_one_of(&kozlov(free));
}

fn the_linear_model_is_the_exact_one_of(model: &MeasurementModel) {
    let zero = vec![0.0; model.parameters().len()];
    for set_point in model.experiment().set_points.iter().filter(|s| !model.experiment().is_on_arm(s.mounting)) {
        let (linear, exact) = (model.linearise_at_zero(set_point), model.linearise(set_point, &zero));
        assert!((linear.reading - exact.reading).norm() < 1e-12);
        let mut difference = vec![Vector3::zeros(); zero.len()];
        linear.columns.iter().for_each(|(j, column)| difference[*j] += column);
        exact.columns.iter().for_each(|(j, column)| difference[*j] -= column);
        for (j, difference) in difference.iter().enumerate() {
            assert!(difference.norm() < 1e-9, "{}: {difference}", model.parameters()[j].name);
        }
    }
}

/// Six faces show bias and scale; edges misalignment too; squares need corners besides. Bias and own square are one on faces.
#[test]
fn what_a_cube_shows() {
    let bias_and_scale = ["df_1", "df_2", "df_3", "G0_11", "G0_22", "G0_33"];
    assert_eq!(shown(&rests_alone(&faces(), 2)), bias_and_scale);
    assert_eq!(shown(&rests_alone(&cube(), 2)).len(), 9);
    let squares = shown(&rests_alone(&faces(), 3));
    assert_eq!(squares, ["G0_11", "G0_22", "G0_33"]);
    // Nothing of an arm is asked for without an arm.
    let model = rests_alone(&faces(), 2);
    let names: Vec<&str> = model.parameters().iter().map(|p| p.name.as_str()).collect();
    assert!(names.iter().all(|name| name.starts_with("theta") || name.starts_with("df") || name.starts_with("G0")));
}

/// The estimates of many made tumbles against their covariance, with gravity uncertain too.
#[test]
fn errors_are_as_large_as_stated() {
    const RUNS: usize = 200;
    let mut random = Random::new(8);
    let (mut sum, mut count) = (0.0, 0);
    for run in 0..RUNS {
        let directions = random_directions(18 + run % 12, &mut random);
        let model = rests_alone(&directions, 2);
        let truth = truth(&model, 3.0, &mut random);
        let gravity = 1e-3;
        // Readings of a place where gravity is another.
        let mut elsewhere = model.experiment().clone();
        elsewhere.site.gravity += gravity * random.normal();
        let observations = observed(&model.in_experiment(elsewhere), &truth, &mut random);
        let model = model.with_stated(TypeB { gravity, ..TypeB::default() });
        let fit = exact(&model, &observations).unwrap();
        let (squared, unknowns) = squared_error(&model, &fit, &truth);
        sum += squared;
        count += unknowns;
    }
    let ratio = sum / count as f64;
    // Four standard deviations of a mean of squares.
    assert!((ratio - 1.0).abs() < 4.0 * (2.0 / count as f64).sqrt(), "{ratio}");
}

/// Rests beside an arm that are of another switch-on, temperature or unit are named, and not a mounting of the arm.
#[test]
fn rests_that_contradict_the_arm_are_named() {
    let model = kozlov(with_rests(experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]), &cube()));
    for (seed, name) in
        [(1, "rests-bias"), (2, "rests-scale"), (3, "rests-unit"), (4, "rests-scale"), (5, "rests-unit")]
    {
        let mut random = Random::new(500 + seed);
        let usual = truth(&model, 0.3, &mut random);
        let richer = model.with_rivals(&[Rival::named(name).unwrap()]);
        let further = richer.parameters().iter().skip(usual.len());
        let other = further.map(|p| p.typical * random.normal());
        let with: Vec<f64> = usual.iter().copied().chain(other).collect();
        let data = Data::new(&model, observed(&richer, &with, &mut random)).unwrap();
        let calibration = Calibration::exact(&data).unwrap();
        let rivals = Rivals::of(&calibration, &unwatched).unwrap();
        let suspects = rivals.suspects(Level::Objection.probability());
        assert_eq!(suspects.shown[0].rival.name(), name);
        // A scale is one of the terms of another unit.
        let are_of_rests = |test: &RivalTest| test.rival.name().starts_with("rests-");
        assert!(suspects.shown[..suspects.alike].iter().all(are_of_rests), "{name}");
    }
}

/// Rests within a milliradian of six faces show a misalignment to some hundredths of a radian only, and its square shifts the scale
/// by more than the linear covariance says: a mean of 2.5 and 43 at most without the curvature.
#[test]
fn errors_are_as_large_as_stated_where_a_misalignment_is_poorly_shown() {
    const RUNS: usize = 100;
    let mut random = Random::new(28);
    let mut ratios = Vec::new();
    for _ in 0..RUNS {
        let laid = |face: &Vector3<f64>, random: &mut Random| {
            (face + 1e-3 * Vector3::from_fn(|_, _| random.normal())).normalize()
        };
        let directions: Vec<_> = faces().iter().chain(&faces()).map(|face| laid(face, &mut random)).collect();
        let model = rests_alone(&directions, 2);
        let truth = truth(&model, 3.0, &mut random);
        let fit = exact(&model, &observed(&model, &truth, &mut random)).unwrap();
        let (squared, unknowns) = squared_error(&model, &fit, &truth);
        ratios.push(squared / unknowns as f64);
    }
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    assert!((0.5..1.2).contains(&mean), "{mean}");
}

/// Squared error of the unknowns of the instrument over their covariance, and their number.
fn squared_error(model: &MeasurementModel, fit: &Fit, truth: &[f64]) -> (f64, usize) {
    let own: Vec<usize> = (0..truth.len()).filter(|&j| model.parameters()[j].is_of_instrument()).collect();
    let error = nalgebra::DVector::from_fn(own.len(), |a, _| fit.value(own[a]).unwrap() - truth[own[a]]);
    let covariance = nalgebra::DMatrix::from_fn(own.len(), own.len(), |a, b| fit.covariance(own[a], own[b]).unwrap());
    (error.dot(&covariance.cholesky().unwrap().solve(&error)), own.len())
}

/// Eliminated attitudes leave the uncertainties after the last rest as those of the fit.
#[test]
fn uncertainties_by_rests_converge_to_those_of_the_fit() {
    let mut random = Random::new(62);
    let model = rests_alone(&cube(), 2);
    let truth = vec![0.0; model.parameters().len()];
    let data = Data::new(&model, observed(&model, &truth, &mut random)).unwrap();
    let calibration = Calibration::exact(&data).unwrap();
    let stages = calibration.convergence(60).unwrap();
    assert_eq!(stages.len(), 26);
    for (j, sigma) in stages.last().unwrap().standard_uncertainty.iter().enumerate() {
        let is_attitude = matches!(model.parameters()[j].kind, Kind::Attitude { .. });
        assert_eq!(sigma.is_none(), is_attitude, "{j}");
        let of_fit = calibration.fit().standard_uncertainty(j).unwrap();
        assert!(sigma.is_none_or(|sigma| (sigma / of_fit - 1.0).abs() < 1e-4), "{j}: {sigma:?} {of_fit}");
    }
}

/// Eliminated attitudes leave a fit as it is: the filter holds them as unknowns like all others.
#[test]
fn elimination_of_attitudes_changes_no_estimate() {
    let mut random = Random::new(7);
    let arm = experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]);
    let gravity = TypeB { gravity: 1e-3, ..TypeB::default() };
    let known_alone = |directions: &[Vector3<f64>]| {
        let model = rests_alone(directions, 2);
        model.in_experiment(known(model.experiment().clone(), 1e-3))
    };
    let models = [
        rests_alone(&cube(), 2).with_stated(gravity),
        rests_alone(&faces(), 2),
        known_alone(&cube()).with_stated(gravity),
        known_alone(&faces()),
        kozlov(with_rests(arm.clone(), &faces())).with_stated(gravity),
        kozlov(known(with_rests(arm, &cube()), 1e-3)),
    ];
    for (n, model) in models.iter().enumerate() {
        let truth = truth(model, 1.0, &mut random);
        let data = Data::new(model, observed(model, &truth, &mut random)).unwrap();
        let (eliminated, held) = (Calibration::exact(&data).unwrap(), Calibration::recursive(&data).unwrap());
        assert_eq!(eliminated.fit().observability().rank(), held.fit().observability().rank(), "{n}");
        let determined = eliminated.fit().observability().lost() == 0;
        for (j, parameter) in model.parameters().iter().enumerate() {
            let [a, b] = [&eliminated, &held].map(|c| c.fit().standard_uncertainty(j));
            assert_eq!(a.is_some(), b.is_some(), "{n}: {}", parameter.name);
            // What is lost is held; the doubt that it leaves in the others is only as large as the hold.
            let (Some(a), Some(b), true) = (a, b, determined) else { continue };
            let off = (eliminated.fit().value(j).unwrap() - held.fit().value(j).unwrap()) / a;
            assert!((a / b - 1.0).abs() < 1e-6 && off.abs() < 1e-4, "{n}, {}: {a} {b} {off}", parameter.name);
        }
        let [a, b] = [&eliminated, &held].map(|c| c.fit().chi_squared);
        assert!((a - b).abs() < 1e-6 * (1.0 + b) || !determined, "{n}: {a} {b}");
    }
}

/// Known attitudes show on six faces what gravity alone does not: the misalignments, and the turn against the case, no better than the
/// attitudes are known.
#[test]
fn faces_in_known_attitudes_show_the_whole_linear_model() {
    let uncertainty = 1e-3;
    let model = rests_alone(&faces(), 2);
    let model = model.in_experiment(known(model.experiment().clone(), uncertainty));
    assert_eq!(shown(&model).len(), 9);
    let mut random = Random::new(30);
    let truth = truth(&model, 1.0, &mut random);
    let fit = exact(&model, &observed(&model, &truth, &mut random)).unwrap();
    let u = |name: &str| fit.standard_uncertainty(model.parameters().find(name).unwrap()).unwrap();
    // Each element of the matrix is read on two opposite faces, each tilted by its own `theta`.
    let element = uncertainty / 2.0_f64.sqrt();
    // The elements (i, j) and (j, i) make the misalignment and the turn.
    for (name, expected) in [("case_turn_1", element), ("case_turn_2", element), ("G0_32", element * 2.0_f64.sqrt())] {
        assert!((u(name) / expected - 1.0).abs() < 0.02, "{name}: {} of {expected}", u(name));
    }
    for name in ["G0_11", "G0_22", "G0_33"] {
        assert!(u(name) < 1e-5, "{name}: {}", u(name));
    }
}

/// On each face once, two readings give a bias and a scale: their errors leave no residual. On each face twice they do; on the cube's edges and
/// corners too.
#[test]
fn biases_and_scales_of_one_visit_to_each_face_are_unchecked() {
    let unchecked = |directions: &[Vector3<f64>]| -> Vec<String> {
        let model = rests_alone(directions, 2);
        let model = model.in_experiment(known(model.experiment().clone(), 1e-3));
        let mut random = Random::new(33);
        let truth = truth(&model, 1.0, &mut random);
        let data = Data::new(&model, observed(&model, &truth, &mut random)).unwrap();
        let unchecked = Calibration::exact(&data).unwrap().unchecked().unwrap();
        unchecked.iter().map(|j| model.parameters()[*j].name.clone()).collect()
    };
    let once = faces();
    assert_eq!(unchecked(&once), ["df_1", "df_2", "df_3", "G0_11", "G0_22", "G0_33"]);
    assert!(unchecked(&[once.clone(), once].concat()).is_empty());
    assert!(unchecked(&cube()).is_empty());
}

/// As above for known attitudes, each set with its own errors about the attitudes stated; the turn against the case is one of the
/// estimates.
#[test]
fn errors_in_known_attitudes_are_as_large_as_stated() {
    const RUNS: usize = 200;
    const UNCERTAINTY: f64 = 2e-3;
    let mut random = Random::new(9);
    let (mut sum, mut count) = (0.0, 0);
    for run in 0..RUNS {
        let model = rests_alone(&random_directions(6 + run % 12, &mut random), 2);
        let model = model.in_experiment(known(model.experiment().clone(), UNCERTAINTY));
        let mut truth = truth(&model, 3.0, &mut random);
        for (j, parameter) in model.parameters().iter().enumerate() {
            match parameter.kind {
                Kind::Attitude { .. } => truth[j] = UNCERTAINTY * random.normal(),
                Kind::CaseTurn(_) => truth[j] = 0.02 * random.normal(),
                _ => {}
            }
        }
        let fit = exact(&model, &observed(&model, &truth, &mut random)).unwrap();
        let is_own = |j: &usize| !matches!(model.parameters()[*j].kind, Kind::Attitude { .. });
        let own: Vec<usize> = (0..truth.len()).filter(is_own).collect();
        let error = nalgebra::DVector::from_fn(own.len(), |a, _| fit.value(own[a]).unwrap() - truth[own[a]]);
        let covariance =
            nalgebra::DMatrix::from_fn(own.len(), own.len(), |a, b| fit.covariance(own[a], own[b]).unwrap());
        sum += error.dot(&covariance.cholesky().unwrap().solve(&error));
        count += own.len();
    }
    assert_eq!(count, 12 * RUNS);
    let ratio = sum / count as f64;
    assert!((ratio - 1.0).abs() < 4.0 * (2.0 / count as f64).sqrt(), "{ratio}");
}

/// In one fit with the centrifuge the rests sharpen what gravity shows: axes 2 and 3 by far, axis 1 less, since its turns and
/// theirs are free.
#[test]
fn rests_sharpen_a_centrifuge_session() {
    let session = || experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]);
    let mut random = Random::new(3);
    let uncertainty = |experiment: Experiment, random: &mut Random| {
        let model = kozlov(experiment);
        let truth = truth(&model, 1.0, random);
        let fit = exact(&model, &observed(&model, &truth, random)).unwrap();
        let names = ["df_1", "G0_11", "df_2", "G0_22", "df_3", "G0_33", "G0_32"];
        names.map(|name| fit.standard_uncertainty(model.parameters().find(name).unwrap()).unwrap())
    };
    let alone = uncertainty(session(), &mut random);
    let together = uncertainty(with_rests(session(), &cube()), &mut random);
    let gains: Vec<f64> = alone.iter().zip(&together).map(|(alone, together)| alone / together).collect();
    assert!(gains[..2].iter().all(|gain| (1.2..2.5).contains(gain)), "{gains:?}");
    assert!(gains[2..].iter().all(|gain| *gain > 2.5), "{gains:?}");
}

/// In one fit the errors of the whole instrument are as large as stated.
#[test]
fn errors_of_one_fit_are_as_large_as_stated() {
    const RUNS: usize = 40;
    let mut session = experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]);
    session.centrifuge.speed_uncertainty = 0.0;
    let model = kozlov(with_rests(session, &cube()));
    let mut random = Random::new(12);
    let (mut sum, mut count) = (0.0, 0);
    for _ in 0..RUNS {
        let truth = truth(&model, 1.0, &mut random);
        let fit = exact(&model, &observed(&model, &truth, &mut random)).unwrap();
        let parameters = model.parameters().iter().enumerate();
        let own: Vec<usize> = parameters.filter(|(_, p)| p.is_of_instrument()).map(|(j, _)| j).collect();
        let error = nalgebra::DVector::from_fn(own.len(), |a, _| fit.value(own[a]).unwrap() - truth[own[a]]);
        let covariance =
            nalgebra::DMatrix::from_fn(own.len(), own.len(), |a, b| fit.covariance(own[a], own[b]).unwrap());
        // In units of the uncertainties: coefficients of squares and cubes are small numbers.
        let unit = nalgebra::DVector::from_fn(own.len(), |a, _| covariance[(a, a)].sqrt());
        let scaled = nalgebra::DMatrix::from_fn(own.len(), own.len(), |a, b| covariance[(a, b)] / (unit[a] * unit[b]));
        let error = error.component_div(&unit);
        sum += error.dot(&scaled.cholesky().unwrap().solve(&error));
        count += own.len();
    }
    assert_eq!(count, 21 * RUNS);
    let ratio = sum / count as f64;
    assert!((ratio - 1.0).abs() < 4.0 * (2.0 / count as f64).sqrt(), "{ratio}");
}

/// What a study of rests recommends, tried by adding it: each step brings back what it says until nothing does. Three edges or corners
/// complete six faces. Of all squares, three sums are lost for good: `f_1^2 + f_2^2 + f_3^2` is `g^2` in every attitude.
#[test]
fn the_next_attitude_brings_back_what_it_says() {
    let study = |directions: &[Vector3<f64>], terms: usize| {
        let model = rests_alone(directions, terms);
        let set_points = 0..model.experiment().set_points.len();
        let weights = set_points.map(|set_point| Weight { set_point, covariance: Matrix3::identity() * NOISE * NOISE });
        Study::at_zero(model.clone(), weights.collect()).unwrap()
    };
    for (terms, steps, lost_for_good) in [(2, 3, 0), (3, 9, 3)] {
        let mut directions = faces();
        for _ in 0..steps {
            let before = study(&directions, terms);
            let next = before.next_attitude().unwrap();
            directions.push(next.up_z);
            let after = study(&directions, terms).observability().lost();
            assert_eq!(after, before.observability().lost() - next.gain, "{next:?}");
        }
        let complete = study(&directions, terms);
        assert_eq!(complete.observability().lost(), lost_for_good);
        assert_eq!(complete.next_attitude().is_none(), lost_for_good > 0);
    }
}

/// The ratios of a study with nothing lost are those of the uncertainties with the attitude added, type B included; by noise alone none
/// of the 26 leaves a smaller ellipsoid of the coefficients, and of the turn against the case.
#[test]
fn the_next_attitude_improves_as_it_says_and_no_other_does_better() {
    let exact = TypeB::default();
    for (uncertainty, stated) in [(None, exact), (Some(1e-3), exact), (None, TypeB { gravity: 0.02, ..exact })] {
        the_next_attitude_improves_as_it_says(uncertainty, &stated);
    }
}

fn the_next_attitude_improves_as_it_says(uncertainty: Option<f64>, stated: &TypeB) {
    let directions = random_directions(14, &mut Random::new(17));
    let study = |directions: &[Vector3<f64>], stated: &TypeB| {
        let mut model = rests_alone(directions, 2);
        if let Some(uncertainty) = uncertainty {
            model = model.in_experiment(known(model.experiment().clone(), uncertainty));
        }
        let set_points = 0..model.experiment().set_points.len();
        let weights = set_points.map(|set_point| Weight { set_point, covariance: Matrix3::identity() * NOISE * NOISE });
        Study::at_zero(model.with_stated(*stated), weights.collect()).unwrap()
    };
    let with = |direction: Vector3<f64>| [directions.clone(), vec![direction]].concat();
    let before = study(&directions, stated);
    let next = before.next_attitude().unwrap();
    let after = study(&with(next.up_z), stated);
    let ratios: Vec<f64> = (before.model().parameters().iter().enumerate())
        .filter(|(_, parameter)| parameter.is_of_instrument())
        .map(|(j, parameter)| {
            let same = after.model().parameters().find(&parameter.name).unwrap();
            after.standard_uncertainty(same).unwrap() / before.standard_uncertainty(j).unwrap()
        })
        .collect();
    let mean = (ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len() as f64).exp();
    let least = ratios.iter().copied().fold(1.0, f64::min);
    assert!((mean - next.factor).abs() < 1e-9 && mean < 1.0, "{mean} {next:?}");
    assert!((least - next.most.unwrap().1).abs() < 1e-9, "{least} {next:?}");
    let volumes: Vec<(Vector3<f64>, f64)> =
        cube().into_iter().map(|d| (d, volume(&study(&with(d), &TypeB::default())))).collect();
    let smallest = volumes.iter().map(|(_, volume)| *volume).fold(f64::INFINITY, f64::min);
    let (_, chosen) = volumes.iter().find(|(direction, _)| (direction - next.up_z).norm() < 1e-9).unwrap();
    assert!((chosen - smallest).abs() < 1e-9, "{chosen} {smallest}");
}

/// Logarithm of the volume of the ellipsoid of all that the rests share.
fn volume(study: &Study) -> f64 {
    let parameters = study.model().parameters().iter().enumerate();
    let shared: Vec<usize> =
        parameters.filter(|(_, p)| !matches!(p.kind, Kind::Attitude { .. })).map(|(j, _)| j).collect();
    let variance = |a: &[(usize, f64)]| {
        study.observability().standard_uncertainty(&Combination::new(a.iter().copied())).unwrap().powi(2)
    };
    let covariance = nalgebra::DMatrix::from_fn(shared.len(), shared.len(), |i, j| {
        let (i, j) = (shared[i], shared[j]);
        if i == j {
            variance(&[(i, 1.0)])
        } else {
            0.25 * (variance(&[(i, 1.0), (j, 1.0)]) - variance(&[(i, 1.0), (j, -1.0)]))
        }
    });
    0.5 * covariance.determinant().ln()
}

/// Remedies of rests alone do not ask for speeds.
#[test]
fn remedies_of_rests_are_attitudes() {
    let model = rests_alone(&faces(), 2);
    let weights: Vec<Weight> =
        (0..6).map(|set_point| Weight { set_point, covariance: Matrix3::identity() * NOISE * NOISE }).collect();
    let study = Study::at_zero(model, weights).unwrap();
    let remedies = study.remedies();
    assert!(remedies.iter().any(centrical::observability::Remedy::restores_rank));
    assert!(remedies.iter().flat_map(|r| &r.steps).all(|step| matches!(step.addition, Addition::Attitude(_))));
    assert!(study.conditions().is_empty());
    assert!(study.reasons().iter().all(|reason| reason.sentence(&study).contains("other attitudes would")));
}

/// Rests beside the arm are at no radius and at no angle of the arm: conditions on these stay unmet.
#[test]
fn rests_beside_the_arm_meet_no_condition_of_the_arm() {
    let mut one_radius = experiment(AxisOneUp, PairRelation::Common, &[1.0]);
    one_radius.set_points.retain(|set_point| !set_point.is_rest() || set_point.angle < 1.0);
    let model = kozlov(with_rests(one_radius, &faces()));
    let count = model.experiment().set_points.len();
    let weights = (0..count).map(|set_point| Weight { set_point, covariance: Matrix3::identity() * NOISE * NOISE });
    let conditions = Study::at_zero(model, weights.collect()).unwrap().conditions();
    let found: Vec<(&str, bool)> = conditions.iter().map(|c| (c.found.as_str(), c.is_met)).collect();
    assert_eq!((found[0], found[2]), (("1 angle at rest", false), ("1 radius", false)), "{found:?}");
}

/// What the budget says of a change of bias is what rests do to the estimates that were read with another bias.
#[test]
fn a_change_of_bias_is_what_a_refit_shows() {
    const CHANGE: f64 = 2e-4;
    let experiment = with_rests(experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]), &cube());
    let model = kozlov(experiment).with_stated(TypeB { bias_change: CHANGE, ..TypeB::default() });
    let truth = truth(&model, 3.0, &mut Random::new(21));
    let read = observed(&model, &truth, &mut Random::new(22));
    let data = Data::new(&model, read.clone()).unwrap();
    let budget = Calibration::exact(&data).unwrap().budget().unwrap();
    let stated = budget.contributions().iter().find(|c| c.source == Source::BiasChange).unwrap();
    let estimates = |axis: usize, sign: f64| {
        let mut read = read.clone();
        for rest in &mut read {
            let mounting = model.experiment().set_points[rest.set_point].mounting;
            if !model.experiment().is_on_arm(mounting) {
                rest.mean[axis] += sign * CHANGE;
            }
        }
        exact(&model, &read).unwrap().state().to_vec()
    };
    let shifts: Vec<Vec<f64>> = (0..3)
        .map(|axis| {
            let (up, down) = (estimates(axis, 1.0), estimates(axis, -1.0));
            up.iter().zip(down).map(|(up, down)| 0.5 * (up - down)).collect()
        })
        .collect();
    for (j, parameter) in model.parameters().iter().enumerate() {
        let shifted = shifts.iter().map(|shift| shift[j].powi(2)).sum::<f64>().sqrt();
        let (stated, u) = (stated.standard_uncertainty(j), budget.standard_uncertainty(j).unwrap());
        assert!((stated - shifted).abs() < 1e-3 * u, "{}: {stated:e} {shifted:e} of {u:e}", parameter.name);
    }
    let bias = model.parameters().find("df_2").unwrap();
    assert!(stated.standard_uncertainty(bias) > 0.1 * budget.standard_uncertainty(bias).unwrap());
}

/// A follower determines what a fit of the same plateaus determines, and stands where that stands. Rests come before the plateaus on
/// the arm, after them or between them, in attitudes that are known or not.
#[test]
fn a_follower_of_rests_stands_where_a_fit_stands() {
    let mut random = Random::new(23);
    let free =
        with_rests(experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]), &random_directions(14, &mut random));
    let stated = TypeB { gravity: 1e-5, ..TypeB::default() };
    let models = [kozlov(free.clone()), kozlov(known(free.clone(), 1e-3)), kozlov(free).with_stated(stated)];
    for (k, model) in models.iter().enumerate() {
        let mut data = observed(model, &truth(model, 0.5, &mut random), &mut random);
        let (arm, rests) = (data.len() - 14, 14);
        match k {
            0 => random.shuffle(&mut data),
            1 => data.rotate_left(arm),
            _ => data.truncate(arm + rests),
        }
        let mut follower = Follower::new(model);
        let (mut squared, mut degrees_of_freedom) = (0.0, 0);
        for n in 0..data.len() {
            let arrival = follower.test(&data[n]).unwrap();
            squared += arrival.innovation.statistic;
            degrees_of_freedom += arrival.innovation.degrees_of_freedom;
            follower.take(arrival).unwrap();
            if n % 9 == 4 || n + 1 == data.len() {
                let fit = exact(model, &data[..=n]).unwrap();
                let progress = follower.progress().unwrap();
                assert_eq!(progress.rank, fit.observability().rank(), "{k}, {n}");
                assert_eq!(degrees_of_freedom, fit.degrees_of_freedom, "{k}, {n}");
                for (j, estimate) in progress.estimates.iter().enumerate() {
                    let name = &model.parameters()[j].name;
                    assert_eq!(estimate.is_some(), fit.value(j).is_some(), "{k}, {n}, {name}");
                    let Some((value, uncertainty)) = estimate.filter(|_| fit.observability().lost() == 0) else {
                        continue;
                    };
                    let expected = fit.standard_uncertainty(j).unwrap();
                    assert!((value - fit.value(j).unwrap()).abs() < 0.1 * expected, "{k}, {n}, {name}");
                    assert!((uncertainty / expected - 1.0).abs() < 0.01, "{k}, {n}, {name}");
                }
                // The first tests are made where the point has yet to move.
                let tolerance = if n + 1 == data.len() { 0.01 } else { 0.1 };
                assert!((squared - fit.chi_squared).abs() < tolerance * (1.0 + fit.chi_squared), "{k}, {n}: {squared}");
            }
        }
        let point = follower.point().to_vec();
        let reference = (follower.reference(), follower.referenced());
        let resumed = Follower::resume(model, follower.taken().to_vec(), &point, reference).unwrap();
        assert_eq!(resumed.progress().unwrap(), follower.progress().unwrap());
    }
}

/// A case that sits turned in its fixture by several degrees turns the attitudes that are known with it, and a follower stands where a fit
/// stands.
#[test]
fn a_follower_of_rests_in_a_turned_case() {
    const TURN: [f64; 3] = [0.09, -0.05, 0.07];
    let mut random = Random::new(31);
    let free =
        with_rests(experiment(AxisOneUp, PairRelation::Common, &[1.0, 0.5]), &random_directions(20, &mut random));
    let model = kozlov(known(free, 5e-3));
    let mut x = truth(&model, 0.5, &mut random);
    for (x, parameter) in x.iter_mut().zip(model.parameters().iter()) {
        match parameter.kind {
            Kind::CaseTurn(axis) => *x = TURN[axis],
            Kind::Attitude { .. } => *x = 5e-3 * random.normal(),
            _ => {}
        }
    }
    let mut data = observed(&model, &x, &mut random);
    let arm = data.len() - 20;
    data.rotate_left(arm);
    let mut follower = Follower::new(&model);
    for n in 0..data.len() {
        let arrival = follower.test(&data[n]).unwrap();
        follower.take(arrival).unwrap();
        if ![19, 60, data.len() - 1].contains(&n) {
            continue;
        }
        let (fit, progress) = (exact(&model, &data[..=n]).unwrap(), follower.progress().unwrap());
        for (j, estimate) in progress.estimates.iter().enumerate() {
            let (Some((value, u)), Some(expected)) = (estimate, fit.value(j)) else { continue };
            assert!((value - expected).abs() < 0.05 * u, "{n}, {}", model.parameters()[j].name);
        }
    }
}

/// Biases that step between two rests, or warm up, are named so where rests are alone: in each of 20 sessions of 26 rests, by the first effect or
/// those that the data cannot tell from it.
#[test]
fn biases_that_step_or_warm_up_are_named() {
    const CHANGE: f64 = 1e-2;
    let mut random = Random::new(61);
    for run in 0..20_u32 {
        let model = rests_alone(&random_directions(26, &mut random), 2);
        let x = truth(&model, 0.1, &mut random);
        let first = 9 + run as usize % 10;
        let step = |n: usize| f64::from(u8::from(n >= first));
        let warm_up = |n: usize| (-(n as f64) / 5.0).exp();
        let courses: [(&str, &dyn Fn(usize) -> f64); 2] =
            [(&format!("bias-step[{}]", first + 1), &step), ("bias-wander", &warm_up)];
        for (name, course) in courses {
            let mut readings = observed(&model, &x, &mut random);
            for (n, reading) in readings.iter_mut().enumerate() {
                reading.mean += Vector3::new(1.0, -1.0, 1.0) * CHANGE * course(n);
            }
            let data = Data::new(&model, readings).unwrap();
            let calibration = Calibration::exact(&data).unwrap();
            let found = Rivals::of(&calibration, &unwatched).unwrap().suspects(Level::Objection.probability());
            let names: Vec<String> = found.shown[..found.alike].iter().map(|test| test.rival.name()).collect();
            assert!(names.iter().any(|named| named == name), "{run}: {names:?}, expected {name}");
        }
    }
}

//! What the source says beside its rank: known radii, small coefficients, the Coriolis term, the error of a radius, the saving
//! of the filter, the coarse calibration, and the geometry that is "estimated or excluded". Docs: "What else the source says".

use centrical::ThirdPosition::{AxisOneDown, AxisOneUp};
use centrical::fit::filter::Lifetimes;
use centrical::plan::Normalised;
use centrical::{
    Calibration, Data, ErrorModel, Experiment, Extension, Group, LeastSquares, MeasurementModel, Observation,
    PairRelation, STANDARD_GRAVITY, Site, Termination,
};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use crate::common::{Random, kozlov, spread, truth};

/// Noise of a plateau mean: 10 ug [m/s^2].
const NOISE: f64 = 1e-4;

/// Levels to 30 g, as in the rank table, and to 200 g.
const LEVELS: [&[f64]; 2] = [&[0.0, 1.0, 2.0, 3.0], &[0.0, 1.0, 2.0, 4.0, 8.0, 12.0, 16.0, 20.0]];

fn experiment(levels: &[f64], pair_relation: PairRelation, rho: Matrix3<f64>, speed_uncertainty: f64) -> Experiment {
    let plan = Normalised { levels: levels.to_vec(), pair_relation, rho, ..Normalised::default() };
    let mut experiment = plan.experiment();
    experiment.centrifuge.speed_uncertainty = speed_uncertainty;
    experiment
}

/// The design at zero, each plateau's rows whitened by its noise and the error of its speed, with a further column if one is
/// given.
fn whitened(noise: f64, model: &MeasurementModel, further: Option<&[Vector3<f64>]>) -> DMatrix<f64> {
    let set_points = &model.experiment().set_points;
    let p = model.parameters().len();
    let mut rows = DMatrix::zeros(3 * set_points.len(), p + usize::from(further.is_some()));
    for (n, set_point) in set_points.iter().enumerate() {
        let at_zero = model.linearise_at_zero(set_point);
        let covariance =
            Matrix3::identity() * noise.powi(2) + at_zero.setting_error * at_zero.setting_error.transpose();
        let factor = covariance.cholesky().unwrap().l();
        let mut columns = at_zero.columns;
        columns.extend(further.map(|further| (p, further[n])));
        for (j, column) in columns {
            let whitened = factor.solve_lower_triangular(&column).unwrap();
            rows.fixed_view_mut::<3, 1>(3 * n, j).copy_from(&whitened);
        }
    }
    rows
}

/// Least squares with the columns in units of their lengths.
fn least_squares(rows: &DMatrix<f64>) -> LeastSquares {
    let sizes = DVector::from_iterator(rows.ncols(), rows.column_iter().map(|column| column.norm().recip()));
    LeastSquares::new(rows * DMatrix::from_diagonal(&sizes), sizes)
}

/// Singular values of the column-scaled design above 1e-10 of the largest.
fn rank(rows: &DMatrix<f64>) -> usize {
    let mut scaled = rows.clone();
    scaled.column_iter_mut().for_each(|mut column| column /= column.norm());
    let values = scaled.singular_values();
    values.iter().filter(|value| **value > 1e-10 * values.max()).count()
}

fn of_instrument(model: &MeasurementModel) -> Vec<usize> {
    (0..model.parameters().len()).filter(|&j| model.parameters()[j].is_of_instrument()).collect()
}

/// Derivative of every reading by the radius of the second seat, in its mountings: `P D e_1`, by central differences of the
/// exact model.
fn by_second_radius(experiment: &Experiment) -> Vec<Vector3<f64>> {
    const STEP: f64 = 1e-3;
    let at = |step: f64| {
        let mut moved = experiment.clone();
        let radius = moved.mountings[1].arm_y.x;
        for mounting in moved.mountings.iter_mut().filter(|mounting| mounting.arm_y.x == radius) {
            mounting.arm_y.x += step;
        }
        kozlov(moved)
    };
    let (plus, minus) = (at(STEP), at(-STEP));
    let x = vec![0.0; plus.parameters().len()];
    let difference = |n: usize| {
        let read = |model: &MeasurementModel| model.reading(&model.experiment().set_points[n], &x);
        (read(&plus) - read(&minus)) / (2.0 * STEP)
    };
    (0..experiment.set_points.len()).map(difference).collect()
}

/// "Two positions at different distances with a known difference": not necessary where the proof masses are apart. Where they
/// are together and the shift belongs to the seat, a scale of the unit and of all radii is lost, and with it the instrument.
#[test]
fn the_difference_of_the_radii_need_not_be_known() {
    for third in [AxisOneUp, AxisOneDown] {
        for (relation, rho, expected) in [
            (PairRelation::Common, spread(), 50),
            (PairRelation::Opposite, spread(), 48),
            (PairRelation::Common, Matrix3::zeros(), 49),
            (PairRelation::Opposite, Matrix3::zeros(), 48),
        ] {
            let experiment = Normalised { third, pair_relation: relation, rho, ..Normalised::default() }.experiment();
            let rows = whitened(NOISE, &kozlov(experiment.clone()), Some(&by_second_radius(&experiment)));
            assert_eq!((rows.ncols(), rank(&rows)), (50, expected), "{third:?} {relation:?} {}", rho.amax());
        }
    }
}

/// The lost direction of proof masses together, common relation: every scale by one part, every `dR_1` by `-R*` and the second
/// radius by `R*/2` of it, all biases by one g of it; turns and misalignments hide the biases. With the difference of the radii
/// known it is their common scale.
#[test]
fn a_scale_of_all_is_lost_with_proof_masses_together() {
    let experiment = experiment(LEVELS[0], PairRelation::Common, Matrix3::zeros(), 0.0);
    let model = kozlov(experiment.clone());
    let rows = whitened(NOISE, &model, Some(&by_second_radius(&experiment)));
    let lengths: Vec<f64> = rows.column_iter().map(|column| column.norm()).collect();
    let mut scaled = rows.clone();
    scaled.column_iter_mut().zip(&lengths).for_each(|(mut column, length)| column /= *length);
    let right = scaled.svd(false, true).v_t.unwrap();
    let lost = |name: &str| {
        let j = model.parameters().find(name).unwrap_or(49);
        right[(49, j)] / lengths[j]
    };
    let part = lost("G0_11");
    for (name, expected) in [
        ("G0_22", 1.0),
        ("G0_33", 1.0),
        ("dR_1[A]", -0.5),
        ("dR_1[B]", -0.5),
        ("dR_1[C]", -0.5),
        ("radius of the second seat", 0.25),
        ("df_1", -STANDARD_GRAVITY),
        ("df_3", -STANDARD_GRAVITY),
        ("G1_11", 0.0),
        ("alpha_1", 0.0),
    ] {
        assert!((lost(name) / part - expected).abs() < 1e-9, "{name}: {}", lost(name) / part);
    }
    for (rho, expected) in [(spread(), 50), (Matrix3::zeros(), 49)] {
        let experiment = self::experiment(LEVELS[0], PairRelation::Common, rho, 0.0);
        let scaled = MeasurementModel::new(experiment, ErrorModel::kozlov_2017(), &[Extension::RadiusScale]);
        assert_eq!(rank(&whitened(NOISE, &scaled, None)), expected);
    }
}

/// What a free second radius costs the instrument's worst coefficient: little with speeds held to 1e-5, much with exact ones.
#[test]
fn the_price_of_a_free_second_radius() {
    for (levels, speed, stated) in
        [(LEVELS[0], 1e-5, 1.19), (LEVELS[1], 1e-5, 1.07), (LEVELS[0], 0.0, 5.70), (LEVELS[1], 0.0, 17.37)]
    {
        let experiment = experiment(levels, PairRelation::Common, spread(), speed);
        let model = kozlov(experiment.clone());
        let known = least_squares(&whitened(NOISE, &model, None)).standard_uncertainties();
        let free = whitened(NOISE, &model, Some(&by_second_radius(&experiment)));
        let free = least_squares(&free).standard_uncertainties();
        let price = of_instrument(&model).into_iter().map(|j| free[j] / known[j]).fold(0.0, f64::max);
        // Half of the last digit that is stated.
        assert!((price - stated).abs() < 0.005, "{} levels, speeds {speed:e}: {price}", levels.len());
    }
}

/// "Small coefficients, of no essential influence on the accuracy": true of exact speeds. With speeds held to 1e-5 the
/// distances of the proof masses are what tells the bias of newtonometer 1 from its scale.
#[test]
fn small_coefficients_matter_with_speeds_held_to_1e_5() {
    let ratios = |levels: &[f64], noise: f64, speed: f64| -> Vec<(String, f64)> {
        let [apart, together] =
            [spread(), Matrix3::zeros()].map(|rho| kozlov(experiment(levels, PairRelation::Common, rho, speed)));
        let [a, b] =
            [&apart, &together].map(|model| least_squares(&whitened(noise, model, None)).standard_uncertainties());
        of_instrument(&apart).into_iter().map(|j| (apart.parameters()[j].name.clone(), b[j] / a[j])).collect()
    };
    for (levels, noise, stated) in [
        (LEVELS[0], NOISE, 2.8),
        (LEVELS[1], NOISE, 5.1),
        (LEVELS[0], 0.1 * NOISE, 23.3),
        (LEVELS[1], 0.1 * NOISE, 47.8),
    ] {
        let ratios = ratios(levels, noise, 1e-5);
        let (worst, ratio) = ratios.iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        assert!(
            worst == "df_1" && (ratio - stated).abs() < 0.05,
            "{} levels, {noise:e}: {worst} {ratio}",
            levels.len()
        );
    }
    for levels in LEVELS {
        for (name, ratio) in ratios(levels, NOISE, 0.0) {
            assert!((0.5..2.1).contains(&ratio), "{name}: {ratio}");
        }
    }
}

/// "A rough calibration beforehand, so that errors are much less than one": from errors of 10 % of everything at full scale,
/// and even of 50 %, the exact fit converges to the unit that was read.
#[test]
fn a_calibration_to_ten_percent_is_coarse_enough() {
    let full = 200.0 * STANDARD_GRAVITY;
    let model = kozlov(experiment(LEVELS[1], PairRelation::Common, spread(), 1e-5));
    let own = of_instrument(&model);
    for (size, most) in [(0.1, 4), (0.5, 5)] {
        let mut random = Random::new(71);
        for _ in 0..20 {
            let mut x = truth(&model, 1.0, &mut random);
            for &j in &own {
                let at_full_scale = match model.parameters()[j].group {
                    Group::Bias => STANDARD_GRAVITY,
                    Group::Scale | Group::Misalignment => 1.0,
                    Group::Cubic => full.powi(-2),
                    _ => full.recip(),
                };
                x[j] = size * at_full_scale * (2.0 * random.uniform() - 1.0);
            }
            let data = Data::new(&model, crate::common::observations(&model, &x)).unwrap();
            let fit = Calibration::exact(&data).unwrap().into_fit();
            assert!(fit.termination == Termination::Converged && fit.iterations <= most, "{size}: {}", fit.iterations);
            for &j in &own {
                let off = (fit.value(j).unwrap() - x[j]).abs() / fit.standard_uncertainty(j).unwrap();
                // The last place of a reading of 200 g is 2e-9 of the noise; a few hundred of them.
                assert!(off < 1e-6, "{size}: {} off by {off}", model.parameters()[j].name);
            }
        }
    }
}

/// "An error of 0.5 mm is 0.1 % of what is measured, two orders worse than the machine": its speed is held to 0.001 %, and the force
/// goes with the square, so it is 50 times.
#[test]
fn half_a_millimetre_is_fifty_times_the_error_of_the_machine() {
    let mut experiment = experiment(LEVELS[1], PairRelation::Common, Matrix3::zeros(), 1e-5);
    experiment.site.gravity = STANDARD_GRAVITY;
    let columns = by_second_radius(&experiment);
    let model = kozlov(experiment);
    for (n, set_point) in
        model.experiment().set_points.iter().enumerate().filter(|(_, s)| s.omega > 0.0 && s.mounting % 2 == 1)
    {
        // The second seat is at half of the arm of 0.5 m: there 0.25 mm is 0.1 %.
        let of_radius = columns[n].norm() * 0.25e-3;
        let ratio = of_radius / model.linearise_at_zero(set_point).setting_error.norm();
        assert!((ratio - 50.0).abs() < 1e-6, "{ratio}");
    }
}

/// "Below 7.3e-5 rad/s x (10 2 pi rad/s x 0.5 m) < 2.5e-3 m/s^2": the Coriolis acceleration is twice that, along the axis of
/// rotation at the equator, once per revolution.
#[test]
fn the_printed_bound_of_the_coriolis_term_lacks_a_factor_two() {
    let mut experiment = experiment(LEVELS[1], PairRelation::Common, Matrix3::zeros(), 0.0);
    experiment.site.latitude = Some(0.0);
    let model = kozlov(experiment);
    let x = vec![0.0; model.parameters().len()];
    let speed = 20.0 * std::f64::consts::PI;
    let vertical = |step: u32| {
        let angle = std::f64::consts::TAU * f64::from(step) / 360.0;
        model.reading_at(0, &x, [angle, speed, 0.0]).z
    };
    let (low, high) = (0..360).map(vertical).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), f| (a.min(f), b.max(f)));
    let amplitude = 0.5 * (high - low);
    assert!((amplitude / (2.0 * Site::EARTH_RATE * speed * 0.5) - 1.0).abs() < 1e-6, "{amplitude}");
    let printed = 7.3e-5 * speed * 0.5;
    assert!(printed < 2.5e-3 && amplitude > 1.8 * 2.5e-3, "{amplitude} against {printed}");
}

/// "By 19 components, that is almost twofold": 30 of 49 remain, 39 % fewer.
#[test]
fn nineteen_of_forty_nine_is_39_percent() {
    let model = kozlov(experiment(LEVELS[0], PairRelation::Common, spread(), 1e-5));
    let order: Vec<usize> = (0..model.experiment().set_points.len()).collect();
    let (all, carried) = (model.parameters().len(), Lifetimes::new(&model, &order).states());
    assert_eq!((all, carried), (49, 30));
    assert_eq!((100.0 * (all - carried) as f64 / all as f64).round(), 39.0);
}

/// "Estimated with the others, or excluded from the equations": combinations of the readings in which no geometry appears give
/// the coefficients and the covariance of the joint estimate, and so does the filter, which drops a position's unknowns with it.
#[test]
fn geometry_excluded_is_geometry_estimated() {
    let mut random = Random::new(72);
    let model = kozlov(experiment(LEVELS[1], PairRelation::Common, spread(), 1e-5));
    let x = truth(&model, 0.1, &mut random);
    let at_zero: Vec<_> = model.experiment().set_points.iter().map(|s| model.linearise_at_zero(s)).collect();
    let observations: Vec<Observation> = (0..at_zero.len())
        .map(|set_point| {
            let signal: Vector3<f64> = at_zero[set_point].columns.iter().map(|(j, column)| column * x[*j]).sum();
            let noise = Vector3::from_fn(|_, _| NOISE * random.normal());
            let covariance = Matrix3::identity() * NOISE.powi(2);
            Observation { set_point, mean: at_zero[set_point].reading + signal + noise, covariance }
        })
        .collect();
    let data = Data::new(&model, observations.clone()).unwrap();
    let joint = Calibration::linear(&data).unwrap().into_fit();
    let filtered = Calibration::recursive_linear(&data).unwrap().into_fit();

    let misfit: Vec<Vector3<f64>> = (0..at_zero.len()).map(|n| observations[n].mean - at_zero[n].reading).collect();
    let p = model.parameters().len();
    let rows = whitened(NOISE, &model, Some(&misfit));
    let own = of_instrument(&model);
    let geometry: Vec<usize> = (0..p).filter(|j| !own.contains(j)).collect();
    let eliminator = least_squares(&rows.select_columns(&geometry));
    let free_of_geometry = |j: usize| eliminator.redundant(&rows.column(j).into_owned());
    let columns: Vec<DVector<f64>> = own.iter().map(|&j| free_of_geometry(j)).collect();
    let equations = least_squares(&DMatrix::from_columns(&columns));
    let excluded = equations.solve(free_of_geometry(p));
    let covariance = equations.covariance();

    assert_eq!((own.len(), geometry.len()), (21, 28));
    for (a, &i) in own.iter().enumerate() {
        let u = joint.standard_uncertainty(i).unwrap();
        for other in [excluded[a], filtered.value(i).unwrap()] {
            assert!((other - joint.value(i).unwrap()).abs() < 1e-6 * u, "{}", model.parameters()[i].name);
        }
        for (b, &j) in own.iter().enumerate() {
            let scale = u * joint.standard_uncertainty(j).unwrap();
            for other in [covariance[(a, b)], filtered.covariance(i, j).unwrap()] {
                assert!((other - joint.covariance(i, j).unwrap()).abs() < 1e-8 * scale);
            }
        }
    }
}

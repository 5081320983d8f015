//! The coefficients of the normalised experiment [K5.5]. In its units (R*, g) the source says the coefficients of `H` are
//! "zeros, numbers of the form +-1, +-1/2, +-(10 m)^(1,2,3), +-1/g, and small coefficients".

use centrical::ThirdPosition::{AxisOneDown, AxisOneUp};
use centrical::plan::Normalised;
use centrical::{ErrorModel, MeasurementModel, PairRelation};

/// `R* Omega*^2 / g = 10`, `Omega = Omega* sqrt(m)`, radii R* and R*/2, rest at 0 and pi.
#[test]
fn the_experiment_is_the_one_described() {
    let plan = Normalised { levels: (0..=20).map(f64::from).collect(), ..Normalised::default() };
    let experiment = plan.experiment();
    assert_eq!(experiment.positions.len(), 6);
    assert_eq!(experiment.mountings.len(), 12);
    assert_eq!(experiment.set_points.len(), 12 * (2 + 20));
    let load = plan.arm * plan.unit_speed().powi(2) / plan.gravity;
    assert!((load - 10.0).abs() < 1e-14 * 10.0);
    for (mounting, chunk) in experiment.set_points.chunks(22).enumerate() {
        assert!(chunk.iter().all(|s| s.mounting == mounting));
        assert_eq!((chunk[0].omega, chunk[0].angle), (0.0, 0.0));
        assert_eq!((chunk[1].omega, chunk[1].angle), (0.0, std::f64::consts::PI));
        for (m, s) in (1..=20).zip(&chunk[2..]) {
            assert!((s.omega.powi(2) / plan.unit_speed().powi(2) - f64::from(m)).abs() < 1e-13);
        }
        let radius = if mounting % 2 == 0 { plan.arm } else { plan.arm / 2.0 };
        assert_eq!(experiment.mountings[mounting].arm_y.x, radius);
    }
}

/// With no spread of the proof masses every coefficient is of the printed form. `z` is in g and lengths in R*, so the
/// columns of lengths are divided by R*, those of df, G1, G2 by powers of g; a mounting radius of 1/2 brings its powers.
#[test]
fn coefficients_are_of_the_printed_form() {
    for third in [AxisOneUp, AxisOneDown] {
        for pair_relation in [PairRelation::Opposite, PairRelation::Common, PairRelation::Free] {
            let plan = Normalised { third, pair_relation, ..Normalised::default() };
            let model = MeasurementModel::new(plan.experiment(), ErrorModel::kozlov_2017(), &[]);
            let mut printed: Vec<f64> = vec![0.0, 1.0];
            for m in [10.0, 20.0, 30.0] {
                for radius in [1.0, 0.5_f64] {
                    printed.extend((1..=3).map(|power| (m * radius).powi(power)));
                }
            }
            for set_point in &model.experiment().set_points {
                for (j, derivative) in model.linearise_at_zero(set_point).columns {
                    let parameter = &model.parameters()[j];
                    let length = if parameter.unit == "m" { plan.arm } else { 1.0 };
                    let unit = length * plan.gravity.powi(parameter.power_of_acceleration - 1);
                    for coefficient in &derivative {
                        let value = (coefficient * unit).abs();
                        let nearest = printed.iter().map(|p| (value - p).abs()).fold(f64::INFINITY, f64::min);
                        assert!(nearest <= 1e-13 * value.max(1e-2), "{}: {value}", parameter.name);
                    }
                }
            }
        }
    }
}

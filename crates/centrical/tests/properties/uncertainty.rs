use centrical::ThirdPosition::AxisOneUp;
use centrical::uncertainty::{Budget, Degrees, MonteCarlo, Settings};
use centrical::{
    Calibration, Data, Experiment, Fit, MeasurementModel, Observation, PairRelation, Rival, Source, TypeB, rotation,
    unwatched,
};
use nalgebra::Vector3;

use crate::common::{Random, experiment, kozlov, observations, truth};

const SPEED: f64 = 1e-5;

/// What a good laboratory states.
pub const STATED: TypeB = TypeB {
    gravity: 1e-6,
    latitude: 1e-5,
    radius: 20e-6,
    radius_difference: Some(3e-6),
    speed_scale: 1e-6,
    rest_angle: 5e-5,
    proof_masses: 20e-6,
    attitude: 2e-5,
    bias_change: 0.0,
    mounting_bias: 0.0,
    mounting_scale: 0.0,
    resolution: 1e-5,
    reading_noise: 0.0,
    doubt: 0.0,
    effects: [0.0; Rival::COUNT],
};

pub struct Case {
    pub model: MeasurementModel,
    pub truth: Vec<f64>,
    pub observations: Vec<Observation>,
}

impl Case {
    pub fn new(relation: PairRelation) -> Self {
        let model = kozlov(experiment(AxisOneUp, relation, &[1.0, 0.5]));
        let truth = truth(&model, 1.0, &mut Random::new(1));
        let observations = observations(&model, &truth);
        Self { model, truth, observations }
    }

    fn fit(&self) -> Fit {
        crate::common::exact(&self.model, &self.observations).unwrap()
    }

    fn budget(&self, stated: &TypeB) -> Budget {
        budget_of(&self.model, &self.observations, stated)
    }

    pub fn monte_carlo(&self, runs: usize, stated: &TypeB, is_linear: bool) -> MonteCarlo {
        let settings = Settings { runs, seed: 1, coverage: 0.95, is_linear };
        let model = self.model.clone().with_stated(*stated);
        let data = Data::new(&model, self.observations.clone()).unwrap();
        MonteCarlo::of(&data, &self.truth, &settings, &unwatched).unwrap()
    }
}

fn budget_of(model: &MeasurementModel, observations: &[Observation], stated: &TypeB) -> Budget {
    let model = model.clone().with_stated(*stated);
    let data = Data::new(&model, observations.to_vec()).unwrap();
    Calibration::exact(&data).unwrap().budget().unwrap()
}

/// With nothing stated the budget is the covariance of the fit, split into noise and speed.
#[test]
fn budget_of_the_weights_is_the_covariance_of_the_fit() {
    for (relation, determined) in [(PairRelation::Common, 49), (PairRelation::Opposite, 43)] {
        let case = Case::new(relation);
        let (fit, budget) = (case.fit(), case.budget(&TypeB::default()));
        assert_eq!(budget.contributions().len(), 2);
        let pairs: Vec<(usize, usize)> = (0..49).flat_map(|i| (0..49).map(move |j| (i, j))).collect();
        let compared = pairs.iter().filter(|&&(i, j)| {
            let (Some(own), Some(fitted)) = (budget.covariance(i, j), fit.covariance(i, j)) else {
                assert_eq!(budget.covariance(i, j), fit.covariance(i, j));
                return false;
            };
            let scale = fit.standard_uncertainty(i).unwrap() * fit.standard_uncertainty(j).unwrap();
            // The speed's effect is a difference over one standard uncertainty here, a derivative there.
            assert!((own - fitted).abs() < 1e-6 * scale, "{i} {j}: {own:e} {fitted:e}");
            true
        });
        assert_eq!(compared.count(), determined * determined);
    }
}

/// One quantity of the experiment, off by a number of standard uncertainties.
type Influence = Box<dyn Fn(&mut Experiment, f64)>;

/// Every source that the budget knows and the independent influences that it is made of, written anew.
fn sources(experiment: &Experiment) -> Vec<(Source, Vec<Influence>)> {
    fn influence(change: impl Fn(&mut Experiment, f64) + 'static) -> Influence {
        Box::new(change)
    }
    let one = |change: fn(&mut Experiment, f64)| vec![influence(change)];
    let difference = STATED.radius_difference.unwrap();
    let plateaus = |rest: bool| (0..experiment.set_points.len()).filter(move |n| (n % 9 == 0 || n % 9 == 1) == rest);
    assert!(plateaus(true).all(|n| experiment.set_points[n].is_rest()));
    assert!(plateaus(false).all(|n| !experiment.set_points[n].is_rest()));
    let of_plateau = |n: usize| influence(move |e, sign| e.set_points[n].omega *= 1.0 + sign * SPEED);
    let of_rest = |n: usize| influence(move |e, sign| e.set_points[n].angle += sign * STATED.rest_angle);
    let of_seat = |radius: f64| {
        influence(move |e, sign| {
            let on_seat = e.mountings.iter_mut().filter(|m| (m.arm_y.x - radius).abs() < 0.1);
            on_seat.for_each(|m| m.arm_y.x += sign * difference / 2.0_f64.sqrt());
        })
    };
    // Proof mass 1 is the reference; the own coordinates of 2 and 3 are unknowns of the fit.
    let of_mass = |(i, j): (usize, usize)| influence(move |e, sign| e.unit.rho_z[(i, j)] += sign * STATED.proof_masses);
    let of_attitude = |k: usize, axis: usize| {
        influence(move |e, sign| {
            let turn = rotation(&Vector3::ith(axis, sign * STATED.attitude));
            e.positions[k].p_zy = turn * e.positions[k].p_zy;
        })
    };
    vec![
        (Source::PlateauSpeed, plateaus(false).map(of_plateau).collect()),
        (Source::Gravity, one(|e, sign| e.site.gravity += sign * STATED.gravity)),
        (Source::Latitude, one(|e, sign| e.site.latitude = e.site.latitude.map(|l| l + sign * STATED.latitude))),
        (
            Source::Radius,
            one(|e, sign| {
                let common = STATED.radius.powi(2) - 0.5 * STATED.radius_difference.unwrap().powi(2);
                e.mountings.iter_mut().for_each(|m| m.arm_y.x += sign * common.sqrt());
            }),
        ),
        (Source::RadiusDifference, [0.5, 0.25].map(of_seat).into()),
        (
            Source::SpeedScale,
            one(|e, sign| e.set_points.iter_mut().for_each(|s| s.omega *= 1.0 + sign * STATED.speed_scale)),
        ),
        (Source::RestAngle, plateaus(true).map(of_rest).collect()),
        (Source::ProofMasses, [(0, 1), (2, 1), (0, 2), (1, 2)].map(of_mass).into()),
        (Source::Attitude, (0..6).flat_map(|k| (0..3).map(move |axis| of_attitude(k, axis))).collect()),
    ]
}

/// A contribution is what really happens to the estimates: the plateaus of an experiment that is off by one standard
/// uncertainty are fitted as if it were not, for every influence of every source.
#[test]
fn contributions_are_what_a_refit_shows() {
    let case = Case::new(PairRelation::Common);
    let stating = case.model.clone().with_stated(STATED);
    let shift = |change: &Influence| -> Vec<f64> {
        let estimate = |sign: f64| {
            let mut experiment = case.model.experiment().clone();
            change(&mut experiment, sign);
            let readings = observations(&case.model.in_experiment(experiment), &case.truth);
            crate::common::exact(&stating, &readings).unwrap().state().to_vec()
        };
        estimate(1.0).iter().zip(estimate(-1.0)).map(|(up, down)| 0.5 * (up - down)).collect()
    };
    let budget = case.budget(&STATED);
    let of = |source: Source| budget.contributions().iter().find(|c| c.source == source).unwrap();
    let sources = sources(case.model.experiment());
    // All that there are but noise and resolution (below), and priors, effects, changes of bias and slow rotation, which this model
    // lacks.
    assert_eq!(sources.len() + 2, budget.contributions().len());
    assert_eq!(sources.len() + 6, Source::ALL.len());
    for (source, influences) in sources {
        let shifts: Vec<Vec<f64>> = influences.iter().map(shift).collect();
        for j in 0..49 {
            let shifted = shifts.iter().map(|shift| shift[j].powi(2)).sum::<f64>().sqrt();
            let (stated, u) = (of(source).standard_uncertainty(j), budget.standard_uncertainty(j).unwrap());
            assert!((stated - shifted).abs() < 1e-4 * u, "{source:?} {j}: {stated:e} {shifted:e} of {u:e}");
        }
    }
    // Resolution is a rectangular error of each mean, whose noise is 1e-4 m/s^2 here.
    for j in 0..49 {
        let ratio = of(Source::Resolution).standard_uncertainty(j) / of(Source::Noise).standard_uncertainty(j);
        assert!((ratio / (STATED.resolution / 12.0_f64.sqrt() / 1e-4) - 1.0).abs() < 1e-9, "{j}: {ratio}");
    }
}

/// What the radii leave is judged by what is stated of them: a radius error common to all seats is a shift of `dR_1`
/// and of nothing else, a difference is not.
#[test]
fn radii_are_common_and_different() {
    let case = Case::new(PairRelation::Common);
    let budget = case.budget(&STATED);
    let of = |source| budget.contributions().iter().find(|c| c.source == source).unwrap();
    for (j, parameter) in case.model.parameters().iter().enumerate() {
        let (common, u) = (of(Source::Radius).standard_uncertainty(j), budget.standard_uncertainty(j).unwrap());
        if parameter.name.starts_with("dR_1") {
            assert!((common / STATED.radius - 1.0).abs() < 0.02, "{}", parameter.name);
        } else {
            assert!(common < 1e-6 * u, "{}: {common:e} of {u:e}", parameter.name);
        }
    }
    let scale = case.model.parameters().find("G2_33").unwrap();
    assert!(
        of(Source::RadiusDifference).standard_uncertainty(scale) > 0.1 * budget.standard_uncertainty(scale).unwrap()
    );
}

/// A source that is perfect brings what its improvement promises, or more: the fit then weighs the data anew.
#[test]
fn improvements_are_kept() {
    let case = Case::new(PairRelation::Common);
    let budget = case.budget(&STATED);
    let instrument: Vec<usize> = (28..49).collect();
    let improvements = budget.improvements(&instrument);
    assert!(improvements.windows(2).all(|w| w[0].share >= w[1].share));
    let total: f64 = improvements.iter().map(|i| i.share).sum();
    assert!((total - 1.0).abs() < 1e-9, "{total}");
    let without = case.budget(&TypeB { radius_difference: Some(0.0), ..STATED });
    let promised = improvements.iter().find(|i| i.source == Source::RadiusDifference).unwrap();
    let ratio = |j| without.standard_uncertainty(j).unwrap() / budget.standard_uncertainty(j).unwrap();
    assert!(ratio(promised.most) < promised.most_factor + 1e-6);
    let mean = instrument.iter().map(|&j| ratio(j)).sum::<f64>() / 21.0;
    assert!(mean < promised.mean_factor + 1e-6, "{mean} {}", promised.mean_factor);
}

/// Degrees of freedom: infinite when everything is taken as exact; those of the fit when the residuals scale type A
/// and nothing is stated; from the doubt of type B otherwise.
#[test]
fn degrees_of_freedom_follow_what_is_known() {
    let case = Case::new(PairRelation::Common);
    let mut noisy = case.observations.clone();
    let mut random = Random::new(5);
    for o in &mut noisy {
        o.mean += nalgebra::Vector3::from_fn(|_, _| 1e-4 * random.normal());
    }
    let fit = crate::common::exact(&case.model, &noisy).unwrap();
    let budget = |stated: &TypeB| budget_of(&case.model, &noisy, stated);
    assert_eq!(budget(&STATED).degrees_of_freedom(30), Some(Degrees::Infinite));
    let scaled = budget(&TypeB::default()).scaled_by_residuals(&fit);
    let Some(Degrees::Finite(nu)) = scaled.degrees_of_freedom(30) else { panic!("finite") };
    assert!((nu - 275.0).abs() < 1e-9, "{nu}");
    let ratio = scaled.standard_uncertainty(30).unwrap() / budget(&TypeB::default()).standard_uncertainty(30).unwrap();
    assert!((ratio - fit.reduced_chi_squared().unwrap().sqrt()).abs() < 1e-12);
    // delta_1[5] is nearly all attitude, so nearly 8 degrees of freedom at a doubt of a quarter.
    let turn = case.model.parameters().find("delta_1[5]").unwrap();
    let doubtful = budget(&TypeB { doubt: 0.25, ..STATED });
    let Some(Degrees::Finite(nu)) = doubtful.degrees_of_freedom(turn) else { panic!("finite") };
    assert!((8.0..8.02).contains(&nu), "{nu}");
}

/// The outcome is the same to the bit for any number of threads, and another for another seed.
#[test]
fn monte_carlo_does_not_depend_on_threads() {
    let case = Case::new(PairRelation::Opposite);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| case.monte_carlo(300, &STATED, false))
    };
    let one = on(1);
    assert_eq!(one.runs, 300);
    assert_eq!(one.parameters.iter().flatten().count(), 43);
    assert_eq!(one, on(3));
    let settings = Settings { runs: 300, seed: 2, coverage: 0.95, is_linear: false };
    let stating = case.model.clone().with_stated(STATED);
    let data = Data::new(&stating, case.observations.clone()).unwrap();
    let other = MonteCarlo::of(&data, &case.truth, &settings, &unwatched).unwrap();
    assert_ne!(one, other);
}

/// Priors are a contribution of their own, with which the budget is the covariance of the fit again; and where the true
/// values come from the prior, the intervals cover them.
#[test]
fn priors_are_part_of_the_budget() {
    let mut case = Case::new(PairRelation::Opposite);
    case.model = case.model.clone().with_prior("drho", 1e-4).unwrap();
    let (fit, budget) = (case.fit(), case.budget(&TypeB::default()));
    assert!(budget.contributions().iter().any(|c| c.source == Source::Priors));
    for j in 0..49 {
        let ratio = budget.standard_uncertainty(j).unwrap() / fit.standard_uncertainty(j).unwrap();
        assert!((ratio - 1.0).abs() < 1e-6, "{j}: {ratio}");
    }
    let monte_carlo = case.monte_carlo(300, &TypeB::default(), false);
    for p in monte_carlo.parameters.iter().flatten() {
        // Five standard deviations of chance.
        assert!((p.standard_deviation / p.stated - 1.0).abs() < 5.0 / 600.0_f64.sqrt(), "{p:?}");
        assert!((p.coverage - 0.95).abs() < 5.0 * (0.95 * 0.05 / 300.0_f64).sqrt(), "{p:?}");
    }
}

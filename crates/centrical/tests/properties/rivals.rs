use centrical::uncertainty::{Level, Rivals, Suspects};
use centrical::{
    Calibration, Data, Difference, Extension, MeasurementModel, Observation, Parameter, Rival, SetPoint, unwatched,
};
use nalgebra::Vector3;
use rayon::prelude::*;

use super::uncertainty::STATED;
use super::validity::{session, source_model};
use crate::common::{Random, observations, truth};

/// Size of an effect: best test of one parameter on the redundant residuals, in standard deviations.
const SIGMAS: f64 = 8.0;
/// Sessions of each effect.
const SESSIONS: u64 = 20;

/// Every rival of a session with an arm, each difference of one mounting, and one speed.
fn catalogue() -> Vec<Rival> {
    let differences = [Difference::Shift, Difference::Turn, Difference::Unit];
    let of_one = differences.map(|difference| Rival::Effect(Extension::OneMounting(difference, 3)));
    let common = Rival::COMMON.into_iter().filter(|rival| *rival != Rival::Effect(Extension::BiasWander));
    common.chain(of_one).chain([Extension::OneSpeed(1), Extension::Resonance(1)].map(Rival::Effect)).collect()
}

/// The suspects of `observations` by the fit of `model`.
fn suspects(model: &MeasurementModel, observations: Vec<Observation>) -> Suspects {
    let data = Data::new(model, observations).unwrap();
    let calibration = Calibration::exact(&data).unwrap();
    Rivals::of(&calibration, &unwatched).unwrap().suspects(Level::Reported.probability())
}

/// The model with a rival, and unknowns of typical errors with a random mixture of the rival's, so large that it leaves chi^2
/// of `SIGMAS^2` without noise; `None` where the unknowns of `model` follow the rival.
fn afflicted(model: &MeasurementModel, rival: Rival, random: &mut Random) -> Option<(MeasurementModel, Vec<f64>)> {
    let richer = model.with_rivals(&[rival]);
    let own: Vec<String> = model.parameters().iter().map(|p| p.name.clone()).collect();
    let usual = truth(model, 0.3, random);
    let is_new = |p: &Parameter| !own.contains(&p.name);
    let mixture: Vec<f64> = richer.parameters().iter().map(|p| p.typical * random.normal()).collect();
    let at = |size: f64| -> Vec<f64> {
        let value = |(j, p): (usize, &Parameter)| {
            if is_new(p) { size * mixture[j] } else { usual[own.iter().position(|name| *name == p.name).unwrap()] }
        };
        richer.parameters().iter().enumerate().map(value).collect()
    };
    let left = |size: f64| {
        let data = Data::new(model, observations(&richer, &at(size))).unwrap();
        Calibration::exact(&data).unwrap().fit().chi_squared
    };
    let many = rival.parameters(model.experiment(), model.error_model()).len() > 30;
    let (mut size, sigmas) = (1e-3, if many { 1.5 * SIGMAS } else { SIGMAS });
    for _ in 0..6 {
        let root = left(size).sqrt();
        if root < 1e-6 {
            return None;
        }
        size *= sigmas / root;
        if (root / sigmas - 1.0).abs() < 1e-2 {
            break;
        }
    }
    Some((richer.clone(), at(size)))
}

/// Sessions in which a rival is shown, those in which it is named, and what is named instead.
type Outcome = (u64, u64, Vec<String>);

/// How often a rival is shown, and named first or among those which the data cannot tell from the first.
fn named(model: &MeasurementModel, rival: Rival) -> Option<Outcome> {
    let (mut told, mut named, mut instead) = (0, 0, Vec::new());
    for seed in 0..SESSIONS {
        let mut random = Random::new(1000 + seed);
        let (richer, x) = afflicted(model, rival, &mut random)?;
        let suspects = suspects(model, session(&richer, &x, &mut random));
        told += u64::from(!suspects.shown.is_empty());
        if suspects.shown[..suspects.alike].iter().any(|test| test.rival == rival) {
            named += 1;
        } else {
            instead.extend(suspects.shown.first().map(|test| test.rival.name()));
        }
    }
    Some((told, named, instead))
}

/// Each effect of the catalogue, at random mixtures of its unknowns whose best test of one parameter has 8 standard deviations:
/// shown, and named, in at least 19 of 20 sessions: of eighteen unknowns one in a hundred is missed by chance. An effect of more than thirty unknowns has 12, or chi^2 is twice its degrees of freedom
/// and chance as large.
#[test]
fn every_effect_is_shown_and_named() {
    let model = source_model();
    let outcomes: Vec<(Rival, Option<Outcome>)> =
        catalogue().into_par_iter().map(|rival| (rival, named(&model, rival))).collect();
    let mut followed = Vec::new();
    for (rival, outcome) in outcomes {
        let Some((told, named, instead)) = outcome else {
            followed.push(rival.name());
            continue;
        };
        println!("{:<22} told {told} named {named} of {SESSIONS} {instead:?}", rival.name());
        assert!(told + 1 >= SESSIONS, "{}: {told}", rival.name());
        assert!(named + 1 >= SESSIONS, "{}: {named}, instead {instead:?}", rival.name());
    }
    // The source's model has the squares; its experiment states a latitude, and no rests beside the arm. The lateral place of a seat acts as the bias of two newtonometers and turns do: no session of this plan
    // can show it.
    assert_eq!(
        followed,
        [
            "own-squares",
            "cross-squares",
            "own-cubes",
            "earth-rate",
            "seat-lateral",
            "rests-bias",
            "rests-scale",
            "rests-unit",
            "rests-tilt",
            "attitudes-tilt"
        ]
    );
}

/// A session of a laboratory that states `STATED`, with every stated deviation drawn.
fn with_drawn_deviations(model: &MeasurementModel, x: &[f64], random: &mut Random) -> Vec<Observation> {
    let deviations = model.influences().iter().map(|_| random.normal()).collect();
    let deviated = model.clone().deviated(deviations);
    let mut readings = session(model, x, random);
    for reading in &mut readings {
        let set = model.experiment().set_points[reading.set_point];
        let angle = set.angle + STATED.rest_angle * random.normal();
        reading.mean += deviated.reading(&SetPoint { angle, ..set }, x) - model.reading(&set, x);
        reading.mean += Vector3::from_fn(|_, _| STATED.rounding() * random.normal());
    }
    readings
}

/// Sound sessions, half of them with every stated deviation drawn: none is objected to, by rivals, outliers or chi^2, and no more
/// rivals are reported than the level says.
#[test]
fn sound_sessions_are_left_alone() {
    let plain = source_model();
    let stating = plain.clone().with_stated(STATED);
    let judged: Vec<(f64, f64)> = (0..300_u64)
        .into_par_iter()
        .map(|seed| {
            let mut random = Random::new(9000 + seed);
            let x = truth(&plain, 1.0, &mut random);
            let (model, readings) = if seed % 2 == 0 {
                (&plain, session(&plain, &x, &mut random))
            } else {
                (&stating, with_drawn_deviations(&stating, &x, &mut random))
            };
            let data = Data::new(model, readings).unwrap();
            let calibration = Calibration::exact(&data).unwrap();
            let validity = calibration.validity().unwrap();
            let shown = Rivals::of(&calibration, &unwatched).unwrap().suspects(Level::Reported.probability()).shown;
            let outlier = validity.plateaus.iter().map(|p| p.test.probability).fold(1.0, f64::min);
            let others = validity.probability.min(outlier * validity.plateaus.len() as f64);
            (shown.iter().map(|test| test.family_wise).fold(1.0, f64::min), others)
        })
        .collect();
    let rivals = |level: Level| judged.iter().filter(|(p, _)| level.is_passed_by(*p)).count();
    let others = judged.iter().filter(|(_, p)| Level::Objection.is_passed_by(*p)).count();
    println!("{} of 300 reported, {} and {others} objected to", rivals(Level::Reported), rivals(Level::Objection));
    assert_eq!((rivals(Level::Objection), others), (0, 0));
    // 8 %: Holm keeps 5 %, which three standard deviations of chance in 300 sessions make 8.8 %.
    assert!(rivals(Level::Reported) <= 24);
}

/// One speed of the schedule that is typed wrong in every mounting, by 30 ppm to 3 %, is named among those that explain most, and first where
/// it is large.
#[test]
fn a_speed_typed_wrong_is_named() {
    let model = source_model();
    let speeds = model.experiment().set_speeds();
    for (seed, error) in [(1, 5e-5), (2, 1e-3), (3, 0.03), (4, -0.03)] {
        let mut random = Random::new(300 + seed);
        let readings = session(&model, &truth(&model, 0.3, &mut random), &mut random);
        for (k, (first, count)) in speeds.iter().enumerate().filter(|(_, (_, count))| *count > 1) {
            let mut experiment = model.experiment().clone();
            let right = experiment.set_points[*first].omega;
            let typed = experiment.set_points.iter_mut().filter(|s| s.omega.abs() == right.abs());
            assert_eq!(typed.map(|s| s.omega *= 1.0 + error).count(), *count);
            let found = suspects(&model.in_experiment(experiment), readings.clone());
            let names: Vec<String> = found.shown[..found.alike].iter().map(|test| test.rival.name()).collect();
            assert!(names.contains(&format!("one-speed[{}]", k + 1)), "{error}: {names:?}");
            assert!(error.abs() < 1e-4 || names.len() == 1, "{error}: {names:?}");
        }
    }
}

/// A result does not rest on the absence of what the laboratory states: the budget includes it.
#[test]
fn what_is_stated_is_not_rested_on() {
    let model = source_model();
    let readings = session(&model, &truth(&model, 0.3, &mut Random::new(79)), &mut Random::new(80));
    let rested_on = |model: &MeasurementModel| -> Vec<String> {
        let data = Data::new(model, readings.clone()).unwrap();
        let calibration = Calibration::exact(&data).unwrap();
        let unseen = Rivals::of(&calibration, &unwatched).unwrap().rests_on(&unwatched).unwrap();
        unseen.iter().map(|effect| effect.rival.name()).collect()
    };
    let (exact, stated) = (rested_on(&model), rested_on(&model.clone().with_stated(STATED)));
    for name in ["gravity", "speed-scale", "proof-masses"] {
        assert!(
            exact.contains(&name.to_owned()) && !stated.contains(&name.to_owned()),
            "{name}: {exact:?}, {stated:?}"
        );
    }
    assert!(stated.contains(&"arm-turn-load".to_owned()), "{stated:?}");
}

/// What a result rests on is true: a session with an effect of the smallest size shown is objected to in 80 % of all cases, and the
/// effect moves the parameter, left out, by what is said.
#[test]
fn unseen_effects_do_what_is_said() {
    let model = source_model();
    let x = truth(&model, 0.3, &mut Random::new(77));
    let perfect = Data::new(&model, observations(&model, &x)).unwrap();
    let calibration = Calibration::exact(&perfect).unwrap();
    let mut noisy = Random::new(78);
    let data = Data::new(&model, session(&model, &x, &mut noisy)).unwrap();
    let of_session = Calibration::exact(&data).unwrap();
    let unseen = Rivals::of(&of_session, &unwatched).unwrap().rests_on(&unwatched).unwrap();
    for name in [
        "arm-turn-load",
        "spin-step",
        "odd-quadratic",
        "yield",
        "elastic-turn-speed",
        "one-mounting-turn[4]",
        "one-speed[2]",
        "resonance[2]",
        "heating-load",
    ] {
        let effect = unseen.iter().find(|effect| effect.rival.name() == name).unwrap();
        let richer = model.with_rivals(&[effect.rival]);
        let mut with: Vec<f64> = vec![0.0; richer.parameters().len()];
        for (j, parameter) in richer.parameters().iter().enumerate() {
            if let Some(own) = model.parameters().find(&parameter.name) {
                with[j] = x[own];
            }
        }
        with[richer.parameters().find(&effect.unknown.name).unwrap()] = effect.size.unwrap();
        let afflicted = Data::new(&model, observations(&richer, &with)).unwrap();
        let moved = Calibration::exact(&afflicted).unwrap();
        let j = effect.parameter;
        let shift = moved.fit().value(j).unwrap() - calibration.fit().value(j).unwrap();
        let is_told = |seed: &u64| {
            let mut random = Random::new(5000 + seed);
            let data = Data::new(&model, session(&richer, &with, &mut random)).unwrap();
            let calibration = Calibration::exact(&data).unwrap();
            !Rivals::of(&calibration, &unwatched).unwrap().suspects(Level::Objection.probability()).shown.is_empty()
        };
        let told = (0..200_u64).into_par_iter().filter(is_told).count();
        println!("{name} {}: {:.1} u, told {told} of 200", effect.unknown.name, effect.standard_uncertainties);
        // 80 ± 8 %.
        assert!((144..=176).contains(&told), "{name}: {told} of 200");
        assert!((shift / effect.shift - 1.0).abs() < 0.1, "{name}: {shift:e} {:e}", effect.shift);
    }
}

/// The price of an effect is what a fit with it as an unknown pays, and there is no price where that fit loses a parameter of the instrument.
#[test]
fn the_price_of_an_effect_is_that_of_a_fit() {
    let model = source_model();
    let mut random = Random::new(79);
    let x = truth(&model, 0.3, &mut random);
    let observed = session(&model, &x, &mut random);
    let data = Data::new(&model, observed.clone()).unwrap();
    let calibration = Calibration::exact(&data).unwrap();
    let unseen = Rivals::of(&calibration, &unwatched).unwrap().rests_on(&unwatched).unwrap();
    assert!(unseen.len() > 60, "{}", unseen.len());
    let mut without_price = Vec::new();
    for effect in &unseen {
        let richer = model.with_rivals(&[effect.rival]);
        let data = Data::new(&richer, observed.clone()).unwrap();
        let fit = Calibration::exact(&data).unwrap().into_fit();
        let uncertainty =
            |j: usize| fit.standard_uncertainty(richer.parameters().find(&model.parameters()[j].name).unwrap());
        let name = effect.rival.name();
        let mut instrument = (0..model.parameters().len()).filter(|&j| model.parameters()[j].is_of_instrument());
        let loses = instrument.any(|j| uncertainty(j).is_none());
        assert_eq!(effect.price.is_none(), loses, "{name}: {:?}", effect.price);
        let Some(price) = effect.price else {
            without_price.push(name);
            continue;
        };
        let paid =
            uncertainty(effect.parameter).unwrap() / calibration.fit().standard_uncertainty(effect.parameter).unwrap();
        println!("{name}: {price:.3} said, {paid:.3} paid");
        assert!((price / paid - 1.0).abs() < 0.1, "{name}: {price} said, {paid} paid");
    }
    println!("without a price: {without_price:?}");
    assert!(!without_price.is_empty());
}

use centrical::plan::{
    Candidates, Costs, Criterion, Effort, Goal, NextPlateau, Noise, Plan, PlanError, Prediction, Rationale, Robustness,
    Scenario, Schedule, Visit,
};
use centrical::reduction::{NoiseModel, Record, ScheduledPlateau};
use centrical::simulate::{Machine, Recorder, Sensor, Simulation};
use centrical::uncertainty::{Compensated, MonteCarlo, Settings};
use centrical::{
    Centrifuge, Data, ErrorModel, Experiment, Extension, Law, MeasurementModel, Monomial, Mounting, Observation,
    PairRelation, Parameter, ReferencePoint, SetPoint, Site, Term, Unit, Weight, unwatched,
};
use centrical::{Position, ThirdPosition};
use nalgebra::{DMatrix, Matrix3, Vector3};

use crate::common::{Random, spread, truth};
use crate::uncertainty::STATED;

/// One that expects a unit without errors.
pub fn scenario(model: MeasurementModel, noise: Noise) -> Scenario {
    let nominal = vec![0.0; model.parameters().len()];
    Scenario { model, nominal, noise, weight: 1.0 }
}

/// A few plateaus of one to three mountings, a unit of four to six coefficients, costs and durations by chance.
fn small(random: &mut Random) -> Candidates {
    let positions = Position::kozlov_2017(ThirdPosition::AxisOneUp);
    let count = 1 + random.below(3);
    let mountings: Vec<Mounting> = (0..count)
        .map(|m| Mounting { position: m / 2, arm_y: Vector3::x() * (0.2 + 0.5 * random.uniform()) })
        .collect();
    let used = mountings.iter().map(|m| m.position + 1).max().unwrap();
    let set_points: Vec<SetPoint> = (0..mountings.len())
        .flat_map(|mounting| (0..5 - count.min(3)).map(move |n| (mounting, n)))
        .map(|(mounting, n)| match n {
            0 => SetPoint::at_rest(mounting, 6.0 * random.uniform()),
            _ => SetPoint::spinning(mounting, 10.0 + 40.0 * random.uniform()),
        })
        .collect();
    let mut experiment = Experiment {
        site: Site { gravity: 9.81, latitude: None },
        unit: Unit { rho_z: spread() * 0.5, reference: ReferencePoint::FirstProofMass },
        centrifuge: Centrifuge::default(),
        positions: positions[..used].to_vec(),
        pair_relation: PairRelation::Common,
        mountings,
        set_points,
    };
    let mut terms = vec![Term::new(0, Monomial::ONE), Term::new(0, Monomial::power(0, 1))];
    for _ in 0..2 + random.below(3) {
        terms
            .push(Term::new(random.below(3), Monomial::power(random.below(3), u8::try_from(random.below(4)).unwrap())));
    }
    terms.dedup();
    let noise = Noise { density: 1e-4 * (1.0 + random.uniform()), floor: 1e-5 * random.uniform() };
    let position = 300.0 * random.uniform();
    experiment.centrifuge.speed_uncertainty = 1e-5 * random.uniform();
    let model = MeasurementModel::new(experiment, ErrorModel { terms }, &[]);
    Candidates {
        scenarios: vec![scenario(model, noise)],
        robustness: Robustness::Mean,
        durations: vec![20.0 + 40.0 * random.uniform(), 100.0 + 100.0 * random.uniform()],
        repeats: 1,
        costs: Costs {
            position,
            seat: position * random.uniform(),
            ramp: 60.0 * random.uniform(),
            turn: 20.0 * random.uniform(),
            run_up: 30.0 * random.uniform(),
            ..Costs::default()
        },
    }
}

/// The covariance by one factorisation of all rows in typical units, each visit by itself: another way to the same numbers.
fn covariance(scenario: &Scenario, visits: &[Visit]) -> DMatrix<f64> {
    let model = &scenario.model;
    let p = model.parameters().len();
    let mut rows = DMatrix::zeros(p + 3 * visits.len(), p);
    rows.fill_diagonal(1.0 / Parameter::NULL_HOLD);
    for prior in model.priors() {
        // One row for the hold and the prior of the same parameter.
        let (j, typical) = (prior.parameter, model.parameters()[prior.parameter].typical);
        rows[(j, j)] = (typical / prior.standard_uncertainty).hypot(1.0 / Parameter::NULL_HOLD);
    }
    for (n, visit) in visits.iter().enumerate() {
        let l = model.linearise(&model.experiment().set_points[visit.candidate], &scenario.nominal);
        let sigma = Matrix3::identity() * scenario.noise.variance(visit.duration)
            + l.setting_error * l.setting_error.transpose();
        let whitener = sigma.cholesky().unwrap().l().try_inverse().unwrap();
        for (j, column) in &l.columns {
            let typical = model.parameters()[*j].typical;
            rows.fixed_view_mut::<3, 1>(p + 3 * n, *j).copy_from(&(whitener * column * typical));
        }
    }
    let root = rows.qr().r().try_inverse().unwrap();
    let typical =
        DMatrix::from_diagonal(&nalgebra::DVector::from_iterator(p, model.parameters().iter().map(|p| p.typical)));
    let root = typical * root;
    &root * root.transpose()
}

/// The criterion from its definition, the mean of its logarithm over the scenarios or the worst.
fn value(criterion: &Criterion, candidates: &Candidates, visits: &[Visit]) -> f64 {
    let values: Vec<f64> = candidates.scenarios.iter().map(|s| value_in(s, criterion, visits)).collect();
    match candidates.robustness {
        Robustness::Mean => (values.iter().map(|v| v.ln()).sum::<f64>() / values.len() as f64).exp(),
        Robustness::Worst => values.into_iter().fold(0.0, f64::max),
    }
}

fn value_in(scenario: &Scenario, criterion: &Criterion, visits: &[Visit]) -> f64 {
    let model = &scenario.model;
    let all = covariance(scenario, visits);
    let instrument: Vec<usize> = (0..all.nrows()).filter(|&j| model.parameters()[j].is_of_instrument()).collect();
    let c = all.select_rows(&instrument).select_columns(&instrument);
    let typical = |n: usize| model.parameters()[instrument[n]].typical;
    let s = instrument.len();
    let reading = |range: &f64| model.reading_uncertainty(*range, &c).powi(2);
    match criterion {
        Criterion::Determinant => {
            let scaled = DMatrix::from_fn(s, s, |i, j| c[(i, j)] / (typical(i) * typical(j)));
            scaled.determinant().powf(1.0 / s as f64)
        }
        Criterion::Average => (0..s).map(|n| c[(n, n)] / typical(n).powi(2)).sum::<f64>() / s as f64,
        Criterion::Reading(range) => reading(range),
        Criterion::Worst(goals) => goals
            .iter()
            .map(|goal| match goal {
                Goal::Parameter { name, uncertainty } => {
                    let j = model.parameters().find(name).unwrap();
                    all[(j, j)] / (uncertainty * uncertainty)
                }
                Goal::Reading { range, uncertainty } => reading(range) / (uncertainty * uncertainty),
            })
            .fold(0.0, f64::max),
    }
}

/// All sets of visits, one of each plateau at most, that fit into the time.
fn enumerated(candidates: &Candidates, time: f64, visit: &mut dyn FnMut(&[Visit])) {
    let options = candidates.durations.len() + 1;
    let count = options.pow(u32::try_from(candidates.len()).unwrap());
    for code in 0..count {
        let mut rest = code;
        let mut visits = Vec::new();
        for candidate in 0..candidates.len() {
            if rest % options > 0 {
                visits.push(Visit { candidate, duration: candidates.durations[rest % options - 1] });
            }
            rest /= options;
        }
        if !visits.is_empty() && candidates.time_of(&visits) <= time {
            visit(&visits);
        }
    }
}

const RANGE: f64 = 500.0;

fn criterion(number: usize, model: &MeasurementModel) -> Criterion {
    let goal = |p: &centrical::Parameter| Goal::Parameter { name: p.name.clone(), uncertainty: 1e-3 * p.typical };
    match number {
        0 => Criterion::Determinant,
        1 => Criterion::Average,
        2 => Criterion::Reading(RANGE),
        _ => {
            let mut goals: Vec<Goal> = model.parameters().iter().filter(|p| p.is_of_instrument()).map(goal).collect();
            goals.push(Goal::Reading { range: RANGE, uncertainty: 1e-3 });
            Criterion::Worst(goals)
        }
    }
}

/// On small cases nine plans of ten are the best of all that there are, and no plan is below its bound.
#[test]
fn small_plans_are_mostly_the_best_of_all() {
    let found = compared_with_all(11, 60, &mut |candidates, _| candidates);
    assert!(found.len() >= 55, "{}", found.len());
}

/// So it is for several scenarios, none the worst for all plans: much white noise; little of it but a floor that
/// longer plateaus do not lower; an elastic turn; a unit with errors.
#[test]
fn small_plans_are_mostly_the_best_in_the_worst_case() {
    let found = compared_with_all(12, 48, &mut |mut candidates, random| {
        let first = candidates.scenarios[0].clone();
        let noise = Noise { density: 0.2 * first.noise.density, floor: (2.0 + 3.0 * random.uniform()) * 1e-5 };
        let coloured = scenario(first.model.clone(), noise);
        let elastic = MeasurementModel::new(
            first.model.experiment().clone(),
            first.model.error_model().clone(),
            &[Extension::ElasticTurn(Law::Speed)],
        );
        let quiet = Noise { density: 0.3 * first.noise.density, ..first.noise };
        let mut with_errors = first.clone();
        with_errors.nominal = truth(&first.model, 1.0, random);
        candidates.scenarios = vec![first, coloured, scenario(elastic, quiet), with_errors];
        candidates.robustness = if random.below(4) == 0 { Robustness::Mean } else { Robustness::Worst };
        candidates
    });
    assert!(found.len() >= 40, "{}", found.len());
    // No scenario is always the worst, so they have to be weighed.
    let is_worst = |s: usize| {
        let worst = |plan: &&Plan| plan.by_scenario.iter().all(|value| *value <= plan.by_scenario[s]);
        found.iter().filter(worst).count()
    };
    let counts = [0, 1, 2, 3].map(is_worst);
    println!("{counts:?} plans are worst in each scenario");
    assert!(counts.iter().filter(|count| **count >= 5).count() >= 2, "{counts:?}");
}

/// The same candidates and some rests beside the arm, in free attitudes or in known ones; in one case of four the rests alone.
fn with_rests(candidates: Candidates, random: &mut Random) -> Candidates {
    let Scenario { model, noise, .. } = &candidates.scenarios[0];
    let mut experiment = model.experiment().clone();
    if random.below(4) == 0 {
        experiment.positions.clear();
        experiment.mountings.clear();
        experiment.set_points.clear();
    }
    let is_known = random.below(2) == 0;
    for n in 0..3 {
        let up = Vector3::from_fn(|_, _| random.uniform() - 0.5);
        let id = format!("r{n}");
        let rest = if is_known { Position::known(id, &up, 1e-3) } else { Position::free(id, &up) };
        let mounting = Mounting { position: experiment.positions.len(), arm_y: Vector3::zeros() };
        experiment.set_points.push(SetPoint::at_rest(experiment.mountings.len(), 0.0));
        experiment.positions.push(rest);
        experiment.mountings.push(mounting);
    }
    let model = MeasurementModel::new(experiment, model.error_model().clone(), &[]);
    let costs = Costs { table: 400.0 * random.uniform(), attitude: 40.0 * random.uniform(), ..candidates.costs };
    Candidates { scenarios: vec![scenario(model, *noise)], costs, ..candidates }
}

/// Rests beside the arm have one set-up together, which the arm does without, and they without the arm.
#[test]
fn small_plans_with_rests_are_mostly_near_the_best_of_all() {
    let (found, ratios) = enumerated_and_found(13, 24, &mut with_rests);
    assert!(found.len() >= 20, "{}", found.len());
    let near = ratios.iter().filter(|ratio| **ratio < 1.01).count();
    assert!(near * 10 >= found.len() * 9, "{near}, {ratios:.4?}");
}

/// A rest beside the arm is visited once, however often a plateau on the arm may be.
#[test]
fn rests_beside_the_arm_are_visited_once() {
    let mut random = Random::new(14);
    let mut rests = 0;
    for case in 0..12 {
        let mut candidates = with_rests(small(&mut random), &mut random);
        candidates.repeats = 3;
        let is_rest = |v: &&Visit| {
            let experiment = candidates.experiment();
            !experiment.is_on_arm(experiment.set_points[v.candidate].mounting)
        };
        let time = 0.5 * candidates.time_of(&visits_of_all(&candidates));
        let criterion = criterion(case % 4, &candidates.scenarios[0].model);
        let Ok(plan) = candidates.best_for_time(&criterion, time, Effort::FAIR, &unwatched) else { continue };
        let mut chosen: Vec<usize> = plan.schedule.visits.iter().filter(is_rest).map(|v| v.candidate).collect();
        rests += chosen.len();
        let count = chosen.len();
        chosen.dedup();
        assert_eq!(chosen.len(), count, "case {case}");
        assert!((candidates.time_of(&plan.schedule.visits) - plan.schedule.time).abs() < 1e-9);
    }
    assert!(rests > 0);
}

/// Every candidate as often as it may be visited, for the longest duration.
fn visits_of_all(candidates: &Candidates) -> Vec<Visit> {
    let visits = |candidate: usize| {
        let visit = Visit { candidate, duration: candidates.durations[1] };
        std::iter::repeat_n(visit, candidates.most_visits(candidate))
    };
    (0..candidates.len()).flat_map(visits).collect()
}

/// A rest beside the arm that precedes a mounting on it is refused: the place of a mounting says which set-up it needs.
#[test]
fn rests_precede_no_mounting() {
    let candidates = small(&mut Random::new(11));
    let model = &candidates.scenarios[0].model;
    let mut experiment = model.experiment().clone();
    experiment.positions[0] = Position::free("r", &Vector3::x());
    experiment.mountings.push(Mounting { position: experiment.positions.len(), arm_y: Vector3::x() });
    experiment.positions.push(Position::kozlov_2017(ThirdPosition::AxisOneUp)[5].clone());
    let model = MeasurementModel::new(experiment, model.error_model().clone(), &[]);
    let noise = candidates.scenarios[0].noise;
    let wrong = Candidates { scenarios: vec![scenario(model, noise)], ..candidates };
    let refused = wrong.best_for_time(&Criterion::Determinant, 1e5, Effort::QUICK, &unwatched);
    assert_eq!(refused.unwrap_err(), PlanError::RestsFirst);
}

/// Plans of small cases; nine of ten are the best of all.
fn compared_with_all(
    seed: u64,
    cases: usize,
    changed: &mut dyn FnMut(Candidates, &mut Random) -> Candidates,
) -> Vec<Plan> {
    let (plans, ratios) = enumerated_and_found(seed, cases, changed);
    let best = ratios.iter().filter(|ratio| **ratio < 1.0 + 1e-6).count();
    assert!(best * 10 >= plans.len() * 9, "{best}, {ratios:.4?}");
    plans
}

/// Enumerates all plans of small cases and compares the best with the one that is found: the plans found, and their
/// uncertainties over the smallest, rising.
fn enumerated_and_found(
    seed: u64,
    cases: usize,
    changed: &mut dyn FnMut(Candidates, &mut Random) -> Candidates,
) -> (Vec<Plan>, Vec<f64>) {
    let mut random = Random::new(seed);
    let mut enumerated_plans = 0;
    let (mut plans, mut ratios) = (Vec::new(), Vec::new());
    for case in 0..cases {
        let candidates = small(&mut random);
        let candidates = changed(candidates, &mut random);
        let criterion = criterion(case % 4, &candidates.scenarios[0].model);
        let all: Vec<Visit> =
            (0..candidates.len()).map(|candidate| Visit { candidate, duration: candidates.durations[1] }).collect();
        let time = candidates.time_of(&all) * (0.4 + 0.5 * random.uniform());
        let mut best = (f64::INFINITY, Vec::new());
        enumerated(&candidates, time, &mut |visits| {
            enumerated_plans += 1;
            let value = value(&criterion, &candidates, visits);
            if value < best.0 {
                best = (value, visits.to_vec());
            }
        });
        if best.1.is_empty() {
            continue;
        }
        let plan = candidates.best_for_time(&criterion, time, Effort::CERTIFIED, &unwatched).unwrap();
        let found = value(&criterion, &candidates, &plan.schedule.visits);
        assert!((plan.criterion / found - 1.0).abs() < 1e-6, "case {case}: {} {found}", plan.criterion);
        assert!(plan.schedule.time <= time * (1.0 + 1e-12), "case {case}");
        // However early the search ends, no schedule is below its bound.
        let ends = [1, 2, 3, 5, 9].map(|nodes| Effort { nodes, ..Effort::QUICK });
        for effort in ends.into_iter().chain([Effort::CERTIFIED]) {
            let early = candidates.best_for_time(&criterion, time, effort, &unwatched).unwrap();
            assert!(early.bound <= best.0 * (1.0 + 1e-9), "case {case}, {effort:?}: {:e} {:e}", early.bound, best.0);
            assert!(early.bound > 0.0 && early.criterion >= best.0 * (1.0 - 1e-6), "case {case}, {effort:?}");
        }
        ratios.push((found / best.0).sqrt());
        plans.push(plan);
    }
    ratios.sort_by(f64::total_cmp);
    let best = ratios.iter().filter(|ratio| **ratio < 1.0 + 1e-6).count();
    let most = ratios[ratios.len() - 1];
    println!("{enumerated_plans} plans enumerated, {best} of {} found are the best, the worst {most:.4}", plans.len());
    (plans, ratios)
}

/// Mounting by mounting, and no plateau twice running.
fn schedule_is_sorted(schedule: &Schedule, candidates: &Candidates) -> bool {
    let mounting = |v: &Visit| candidates.experiment().set_points[v.candidate].mounting;
    schedule.visits.windows(2).all(|w| mounting(&w[0]) <= mounting(&w[1]) && w[0].candidate != w[1].candidate)
}

/// However few plateaus a mounting has and however often each may be visited, another one lies between two visits of it; and the speed
/// climbs by little more on the way than once to the fastest and from a neighbour for each further visit.
#[test]
fn another_plateau_lies_between_two_visits_of_one() {
    let mut random = Random::new(18);
    let mut repeated = 0;
    for case in 0..40 {
        let candidates = Candidates { repeats: 2 + random.below(4), ..small(&mut random) };
        let criterion = criterion(case % 4, &candidates.scenarios[0].model);
        let all: Vec<Visit> =
            (0..candidates.len()).map(|c| Visit { candidate: c, duration: candidates.durations[1] }).collect();
        let time = candidates.time_of(&all) * (0.5 + 4.0 * random.uniform());
        let Ok(plan) = candidates.best_for_time(&criterion, time, Effort::QUICK, &unwatched) else { continue };
        assert!(schedule_is_sorted(&plan.schedule, &candidates), "case {case}: {:?}", plan.schedule.visits);
        assert!(plan.schedule.time <= time * (1.0 + 1e-12), "case {case}");
        let found = value(&criterion, &candidates, &plan.schedule.visits);
        assert!((plan.criterion / found - 1.0).abs() < 1e-6, "case {case}: {} {found}", plan.criterion);
        let of = |c: usize| plan.schedule.visits.iter().filter(|v| v.candidate == c).count();
        repeated += usize::from((0..candidates.len()).any(|c| of(c) > 1));
        let goal = Goal::Reading {
            range: RANGE,
            uncertainty: 0.7 * value(&Criterion::Reading(RANGE), &candidates, &all).sqrt(),
        };
        let goals = Criterion::Worst(vec![goal]);
        if let Ok(shortest) = candidates.shortest_for_goals(&goals, 0.01, Effort::QUICK, &unwatched) {
            assert!(schedule_is_sorted(&shortest.schedule, &candidates), "case {case}: {:?}", shortest.schedule.visits);
        }
    }
    assert!(repeated > 20, "{repeated}");
    // Three visits of each of four speeds and two rests: a way of small steps.
    let candidates = large(4, &[30.0]);
    let visits = (0..6).flat_map(|candidate| [Visit { candidate, duration: 30.0 }; 3]).collect();
    let schedule = candidates.schedule(visits);
    assert!(schedule_is_sorted(&schedule, &candidates) && schedule.visits.len() == 18);
    let speeds: Vec<f64> =
        schedule.visits.iter().map(|v| candidates.experiment().set_points[v.candidate].omega.abs()).collect();
    let fastest = speeds.iter().copied().fold(0.0, f64::max);
    let climbed: f64 = speeds[0] + speeds.windows(2).map(|pair| (pair[1] - pair[0]).max(0.0)).sum::<f64>();
    assert!(climbed < 3.0 * fastest, "{climbed} {fastest} {speeds:?}");
}

/// A machine's worth of candidates: six positions, two radii, speeds by load.
pub fn large(speeds: usize, durations: &[f64]) -> Candidates {
    let mut experiment = crate::common::experiment(ThirdPosition::AxisOneUp, PairRelation::Common, &[1.0, 0.5]);
    let top = (200.0 * 9.80665 / 0.5_f64).sqrt();
    experiment.set_points = (0..experiment.mountings.len())
        .flat_map(|mounting| {
            let rest = (0..2).map(move |n| SetPoint::at_rest(mounting, std::f64::consts::PI * f64::from(n)));
            let spin = (1..=speeds).map(move |n| SetPoint::spinning(mounting, top * (n as f64 / speeds as f64).sqrt()));
            rest.chain(spin)
        })
        .collect();
    let model = MeasurementModel::new(experiment, ErrorModel::kozlov_2017(), &[]);
    let noise = Noise { density: 20e-6 * 9.80665, floor: 1e-6 * 9.80665 };
    Candidates {
        scenarios: vec![scenario(model, noise)],
        robustness: Robustness::Mean,
        durations: durations.to_vec(),
        repeats: 2,
        costs: Costs { position: 1200.0, seat: 600.0, ramp: 30.0, turn: 10.0, run_up: 60.0, ..Costs::default() },
    }
}

#[test]
fn large_plans_are_certified() {
    for (number, time) in [(2, 4.0), (2, 6.0), (0, 8.0), (1, 8.0), (3, 8.0)] {
        let candidates = large(8, &[30.0, 60.0, 120.0]);
        let criterion = criterion(number, &candidates.scenarios[0].model);
        let plan = candidates.best_for_time(&criterion, time * 3600.0, Effort::usual(&candidates), &unwatched).unwrap();
        assert!(schedule_is_sorted(&plan.schedule, &candidates));
        // The continuous design within 0.2 % of the optimum; the schedule, where there is more time to fill than set-ups take,
        // within 0.2 % of it; and of the best on any mountings within 1 % of the uncertainty.
        println!("{number}, {time} h: {:.2e} {:.2e}, {} nodes", plan.gap(), plan.rounding(), plan.nodes);
        assert!(plan.continuous.gap() < 2e-3, "{number}: {}", plan.continuous.gap());
        assert!(plan.rounding() < if time > 4.0 { 2e-3 } else { 0.02 }, "{number}: {}", plan.rounding());
        assert!((1.0 + plan.gap()).sqrt() < 1.01, "{number}: {}", plan.gap());
    }
}

/// Of many candidates a part is searched and all are bounded: the plan is as good as that of few loads, which lie among the many, or
/// better, and its bound lies below both.
#[test]
fn plans_of_many_loads_are_certified() {
    let [few, many] = [10, 100].map(|speeds| large(speeds, &[60.0]));
    assert!(many.len() > 1000 && few.len() < 1000);
    let plan = |candidates: &Candidates| {
        let criterion = criterion(2, &candidates.scenarios[0].model);
        candidates.best_for_time(&criterion, 8.0 * 3600.0, Effort::usual(candidates), &unwatched).unwrap()
    };
    let [of_few, of_many] = [&few, &many].map(plan);
    println!("gaps {:.2e}, {:.2e}", of_few.gap(), of_many.gap());
    assert!(of_many.bound <= of_few.criterion);
    assert!(of_many.criterion < 1.002 * of_few.criterion, "{} {}", of_many.criterion, of_few.criterion);
    assert!(of_many.continuous.gap() < 2e-3, "{}", of_many.continuous.gap());
    assert!((1.0 + of_many.gap()).sqrt() < 1.01, "{}", of_many.gap());
}

/// A plan of two durations for the tests of what is predicted.
fn planned() -> (Candidates, Schedule) {
    let candidates = large(5, &[20.0, 40.0]);
    let criterion = Criterion::Reading(200.0 * 9.80665);
    let plan = candidates.best_for_time(&criterion, 5.5 * 3600.0, Effort::QUICK, &unwatched).unwrap();
    (candidates, plan.schedule)
}

/// What is predicted of a plan, type A and B, is what repeated calibrations show: within four standard deviations of chance in every
/// parameter, and 3 % in the mean.
#[test]
fn predictions_are_what_monte_carlo_shows() {
    const RUNS: usize = 1000;
    let (candidates, schedule) = planned();
    let (experiment, weights) = candidates.experiment_of(&schedule);
    let scenario = &candidates.scenarios[0];
    let model = scenario.model.in_experiment(experiment).with_stated(STATED);
    let zero = vec![0.0; model.parameters().len()];
    let prediction = Prediction::of(&model, &weights, &zero).unwrap();
    let observations: Vec<Observation> = weights
        .iter()
        .map(|w| Observation {
            set_point: w.set_point,
            mean: model.reading(&model.experiment().set_points[w.set_point], &zero),
            covariance: w.covariance,
        })
        .collect();
    let settings = Settings { runs: RUNS, seed: 3, coverage: 0.95, is_linear: false };
    let data = Data::new(&model, observations).unwrap();
    let shown = MonteCarlo::of(&data, &zero, &settings, &unwatched).unwrap();
    let mut ratios = Vec::new();
    for (j, statistics) in shown.parameters.iter().enumerate() {
        let (Some(statistics), Some(u)) = (statistics, prediction.budget().standard_uncertainty(j)) else { continue };
        let ratio = statistics.standard_deviation / u;
        // The standard deviation of one ratio is 1 / sqrt(2 runs), 2.2 %.
        assert!((ratio - 1.0).abs() < 4.0 / (2.0 * RUNS as f64).sqrt(), "{}: {ratio}", model.parameters()[j].name);
        ratios.push(ratio);
    }
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    let (least, most) = ratios.iter().fold((f64::MAX, 0.0_f64), |(a, b), r| (a.min(*r), b.max(*r)));
    println!("{} parameters: ratio {mean:.4}, {least:.4} to {most:.4}", ratios.len());
    assert_eq!(ratios.len(), 49);
    assert!((mean - 1.0).abs() < 0.03);
}

/// What is predicted of a plan is the scatter of calibrations of whole simulated sessions about the truth, within their
/// sampling error.
#[test]
fn predictions_are_the_scatter_of_simulated_sessions() {
    const SESSIONS: u64 = 24;
    const RATE: f64 = 50.0;
    let (mut candidates, _) = planned();
    candidates.durations = vec![40.0];
    candidates.repeats = 1;
    let every = (0..candidates.len()).map(|candidate| Visit { candidate, duration: 40.0 }).collect();
    let (experiment, _) = candidates.experiment_of(&candidates.schedule(every));
    let model = candidates.scenarios[0].model.in_experiment(experiment);
    // Noise of 20 ug/sqrt(Hz) at this rate.
    let white = 20e-6 * 9.80665 * (0.5 * RATE).sqrt();
    let settings = centrical::simulate::Equipment {
        machine: Machine { plateau: 40.0, speed_error: 1e-5, ..Machine::default() },
        sensor: Sensor { white, ..Sensor::default() },
        recorder: Recorder { rate: RATE, ..Recorder::default() },
        ..Default::default()
    };
    let noise = Noise { density: 20e-6 * 9.80665, floor: 0.0 };
    let weights: Vec<Weight> = (0..model.experiment().set_points.len()).map(|n| noise.weight(n, 40.0)).collect();
    let truth = truth(&model, 1.0, &mut Random::new(100));
    let prediction = Prediction::of(&model, &weights, &truth).unwrap();
    let p = model.parameters().len();
    let scale = nalgebra::DVector::from_fn(p, |j, _| prediction.budget().standard_uncertainty(j).unwrap());
    let correlation = DMatrix::from_fn(p, p, |i, j| prediction.budget().correlation(i, j).unwrap());
    let factor = correlation.cholesky().unwrap();
    let mut squares = nalgebra::DVector::zeros(p);
    let mut weighted = 0.0;
    for seed in 0..SESSIONS {
        let observations = calibration_means(&model, &truth, &settings, seed);
        let fit = crate::common::exact(&model, &observations).unwrap();
        let error = nalgebra::DVector::from_fn(p, |j, _| (fit.value(j).unwrap() - truth[j]) / scale[j]);
        squares += error.component_mul(&error) / SESSIONS as f64;
        weighted += factor.solve(&error).dot(&error);
    }
    let mean = weighted / SESSIONS as f64;
    println!(
        "weighted square {mean:.2} of {p}; by parameter {:.2} to {:.2}",
        squares.min().sqrt(),
        squares.max().sqrt()
    );
    // chi^2 with p degrees of freedom in each session, four standard deviations.
    assert!((mean - p as f64).abs() < 4.0 * (2.0 * p as f64 / SESSIONS as f64).sqrt(), "{mean} of {p}");
    // One ratio scatters by 1 / sqrt(2 n); four of it over 49 parameters.
    for (j, square) in squares.iter().enumerate() {
        let ratio = square.sqrt();
        assert!((ratio - 1.0).abs() < 4.0 / (2.0 * SESSIONS as f64).sqrt(), "{}: {ratio}", model.parameters()[j].name);
    }
}

/// The plateau means of a simulated session, from its records.
fn calibration_means(
    model: &MeasurementModel,
    truth: &[f64],
    settings: &centrical::simulate::Equipment,
    seed: u64,
) -> Vec<Observation> {
    let simulation = Simulation::new(model, truth, settings, seed).unwrap();
    let experiment = model.experiment();
    let reduced: Vec<_> = (0..experiment.mountings.len())
        .map(|m| {
            let record = simulation.mounting(m).records().fold(Record::default(), |mut whole, stretch| {
                whole.t.extend(stretch.t);
                whole.f_z.iter_mut().zip(stretch.f_z).for_each(|(column, values)| column.extend(values));
                whole
            });
            let there = experiment.set_points.iter().filter(|s| s.mounting == m);
            let scheduled = |s: &SetPoint| ScheduledPlateau { omega: s.omega, nominal_z: experiment.nominal(s) };
            record.reduce(None, &there.map(scheduled).collect::<Vec<_>>()).unwrap()
        })
        .collect();
    let pooled = NoiseModel::pool(&reduced);
    let means = reduced.iter().flat_map(|mounting| mounting.means(&pooled));
    means.enumerate().map(|(set_point, mean)| mean.observation(set_point)).collect()
}

/// The mean over the range is the mean over forces drawn by chance, and the worst goal weighs it as stated.
#[test]
fn reading_criterion_is_the_mean_over_forces() {
    let (candidates, schedule) = planned();
    let (experiment, weights) = candidates.experiment_of(&schedule);
    let model = candidates.scenarios[0].model.in_experiment(experiment);
    let zero = vec![0.0; model.parameters().len()];
    let prediction = Prediction::of(&model, &weights, &zero).unwrap();
    let [_, cubature] = prediction.reading(RANGE).unwrap();
    let first = model.parameters().find("df_1").unwrap();
    let covariance = DMatrix::from_fn(21, 21, |i, j| prediction.budget().covariance(first + i, first + j).unwrap());
    let compensated = Compensated::new(ErrorModel::kozlov_2017().with_coefficients(&[0.0; 21]), covariance).unwrap();
    let mut random = Random::new(9);
    let draws = 40_000;
    let mut squares = Vec::with_capacity(draws);
    for _ in 0..draws {
        let direction = Vector3::from_fn(|_, _| random.normal()).normalize();
        let force = direction * (RANGE * random.uniform());
        squares.push(compensated.covariance(&force).unwrap().trace() / 3.0);
    }
    let mean = squares.iter().sum::<f64>() / draws as f64;
    let scatter =
        (squares.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / draws as f64).sqrt() / (draws as f64).sqrt();
    assert!((cubature * cubature - mean).abs() < 4.0 * scatter, "{} {mean} {scatter}", cubature * cubature);
    assert!(scatter < 0.02 * mean);
}

/// The shortest plan keeps every goal, and no continuous design does in a time shorter by its gap.
#[test]
fn shortest_plans_keep_their_goals() {
    let candidates = large(5, &[30.0, 120.0]);
    let of_reading = Criterion::Reading(200.0 * 9.80665);
    let known = candidates.best_for_time(&of_reading, 6.0 * 3600.0, Effort::QUICK, &unwatched).unwrap();
    let goal = |factor: f64| {
        Criterion::Worst(vec![Goal::Reading { range: 200.0 * 9.80665, uncertainty: factor * known.criterion.sqrt() }])
    };
    // What six hours reach is reached in six hours, and no less by more than the search's resolution and gaps.
    let shortest = candidates.shortest_for_goals(&goal(1.0), 0.01, Effort::QUICK, &unwatched).unwrap();
    assert!(shortest.criterion <= 1.0, "{}", shortest.criterion);
    let hours = shortest.schedule.time / 3600.0;
    assert!(hours < 6.0 * 1.02 && hours > 5.0, "{hours} h");
    let error = candidates.shortest_for_goals(&goal(0.1), 0.01, Effort::QUICK, &unwatched).unwrap_err();
    assert!(matches!(error, PlanError::OutOfReach { factor } if factor > 1.0), "{error}");
}

/// No plan of a small case that keeps its goal is shorter than the time in which none is said to, and the one found is hardly
/// longer than the shortest of all.
#[test]
fn least_times_for_goals_are_below_all_that_keep_them() {
    let mut random = Random::new(17);
    let (mut cases, mut ratios, mut bounds) = (0, Vec::new(), Vec::new());
    while cases < 24 {
        let candidates = small(&mut random);
        let longest = |candidate| Visit { candidate, duration: candidates.durations[1] };
        let everything: Vec<Visit> = (0..candidates.len()).map(longest).collect();
        let reached = value(&Criterion::Reading(RANGE), &candidates, &everything).sqrt();
        let uncertainty = reached * (1.02 + random.uniform());
        let goal = Criterion::Worst(vec![Goal::Reading { range: RANGE, uncertainty }]);
        let plan = candidates.shortest_for_goals(&goal, 0.01, Effort::CERTIFIED, &unwatched).unwrap();
        let mut shortest = f64::INFINITY;
        enumerated(&candidates, plan.schedule.time, &mut |visits| {
            let time = candidates.time_of(visits);
            if time < shortest && value(&goal, &candidates, visits) <= 1.0 {
                shortest = time;
            }
        });
        let least = plan.least_time.unwrap();
        assert!(plan.criterion <= 1.0 && shortest <= plan.schedule.time * (1.0 + 1e-9));
        assert!(least <= shortest * (1.0 + 1e-9), "said {least}, found {shortest}");
        ratios.push(plan.schedule.time / shortest);
        bounds.push(least / shortest);
        cases += 1;
    }
    for list in [&mut ratios, &mut bounds] {
        list.sort_by(f64::total_cmp);
    }
    println!("times over the shortest {ratios:.3?}, bounds over it {bounds:.3?}");
    assert!(ratios[ratios.len() / 2] < 1.02 && bounds[bounds.len() / 2] > 0.75);
}

/// Where time hardly suffices for the set-ups, whole visits do not lose what they are there for: some mountings are tried that
/// lose a parameter to rounding.
#[test]
fn plans_of_little_time_see_what_they_are_to_see() {
    let candidates = large(8, &[30.0, 60.0]);
    let criterion = Criterion::Reading(RANGE);
    let plan = candidates.best_for_time(&criterion, 2.4 * 3600.0, Effort::usual(&candidates), &unwatched).unwrap();
    println!("{:.2e} {:.2e}, {} nodes", plan.gap(), plan.rounding(), plan.nodes);
    assert!((1.0 + plan.gap()).sqrt() < 1.1, "{}", plan.gap());
    let more = candidates.best_for_time(&criterion, 2.6 * 3600.0, Effort::usual(&candidates), &unwatched).unwrap();
    assert!(more.criterion < plan.criterion && more.bound < plan.bound);
}

/// The plateau that is said to be the best next one is that after which the uncertainty is least, by a design of its own.
#[test]
fn next_best_is_the_best() {
    let candidates = large(4, &[60.0]);
    let model = &candidates.scenarios[0].model;
    let noise = &candidates.scenarios[0].noise;
    let all: Vec<Weight> = (0..candidates.len()).map(|n| noise.weight(n, 60.0)).collect();
    let (taken, rest) = all.split_at(candidates.len() - 6);
    let criterion = Criterion::Reading(RANGE);
    let mut next = NextPlateau::new(model, &criterion).unwrap();
    // As they come: the first ones at once, then one by one.
    next.take(&taken[..9]).unwrap();
    taken[9..].iter().for_each(|weight| next.take(&[*weight]).unwrap());
    let benefits = next.benefits(rest).unwrap();
    assert_eq!(benefits.len(), 6);
    let zero = vec![0.0; model.parameters().len()];
    let reading = |weights: &[Weight]| Prediction::of(model, weights, &zero).unwrap().reading(RANGE).unwrap()[1];
    let before = reading(taken);
    for pair in benefits.windows(2) {
        assert!(pair[0].1 <= pair[1].1);
    }
    for &(set_point, benefit) in &benefits {
        let with: Vec<Weight> = taken.iter().copied().chain([all[set_point]]).collect();
        let factor = reading(&with) / before;
        assert!((factor - benefit).abs() < 1e-4, "{set_point}: {factor} {benefit}");
        assert!(benefit < 1.0);
    }
}

/// A rationale states the value of the plan without the visit.
#[test]
fn rationales_are_what_is_lost() {
    let (candidates, schedule) = planned();
    let criterion = Criterion::Average;
    let (by_visit, _) = Rationale::of(&candidates, &criterion, &schedule, &unwatched).unwrap();
    assert_eq!(by_visit.len(), schedule.visits.len());
    let with = value(&criterion, &candidates, &schedule.visits);
    for n in (0..schedule.visits.len()).step_by(7) {
        let mut without = schedule.visits.clone();
        without.remove(n);
        let rise = value(&criterion, &candidates, &without) / with - 1.0;
        let reason = &by_visit[n];
        assert!((reason.rise - rise).abs() < 1e-6 * (1.0 + rise), "{n}: {} {rise}", reason.rise);
        assert!(reason.rise > 0.0 && reason.factor >= 1.0);
        assert!(candidates.scenarios[0].model.parameters()[reason.parameter].is_of_instrument());
    }
}

/// The bound is below any plan: also below a uniform plan, at every time of a frontier, and the best plan is below it too.
#[test]
fn no_usual_plan_is_below_the_bound() {
    let candidates = large(6, &[30.0, 60.0, 120.0]);
    let criterion = Criterion::Reading(RANGE);
    let mut compared = 0;
    for hours in [3.4, 4.0, 5.5, 7.0] {
        let time = hours * 3600.0;
        let plan = candidates.best_for_time(&criterion, time, Effort::usual(&candidates), &unwatched).unwrap();
        let Some((schedule, uniform)) = candidates.uniform(&criterion, time).unwrap() else { continue };
        assert!(schedule.time <= time, "{hours} h: {}", schedule.time);
        assert!(schedule.visits.iter().all(|visit| candidates.durations.contains(&visit.duration)));
        assert!(
            plan.bound <= plan.criterion && plan.criterion < uniform,
            "{} {} {uniform}",
            plan.bound,
            plan.criterion
        );
        let (filled, _) = candidates.filled(&criterion, time).unwrap().unwrap();
        assert!((filled.time - time).abs() < 1e-6);
        compared += 1;
    }
    assert!(compared >= 2, "only {compared} times suffice for a uniform plan");
}

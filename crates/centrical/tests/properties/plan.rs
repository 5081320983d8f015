use centrical::plan::{Candidates, Costs, Criterion, Effort, Goal, Noise, ReadingRange, Scenario, Schedule, Visit};
use centrical::plan::{best_for_time, shortest_for_goals};
use centrical::position::{ThirdPosition, kozlov_2017};
use centrical::{
    ErrorModel, Experiment, MeasurementModel, Monomial, Mounting, PairRelation, ReferencePoint, SetPoint, Site, Term,
    Unit, fit,
};
use nalgebra::{DMatrix, Matrix3, Vector3};

use crate::common::{Random, spread};

/// A few plateaus of one to three mountings, a unit of four to six coefficients, costs and durations by chance.
fn small(random: &mut Random) -> Candidates {
    let positions = kozlov_2017(ThirdPosition::AxisOneUp);
    let count = 1 + random.below(3);
    let mountings: Vec<Mounting> = (0..count)
        .map(|m| Mounting { position: m / 2, arm_y: Vector3::x() * (0.2 + 0.5 * random.uniform()) })
        .collect();
    let used = mountings.iter().map(|m| m.position + 1).max().unwrap();
    let set_points: Vec<SetPoint> = (0..mountings.len())
        .flat_map(|mounting| (0..5 - count.min(3)).map(move |n| (mounting, n)))
        .map(|(mounting, n)| match n {
            0 => SetPoint { mounting, omega: 0.0, angle: 6.0 * random.uniform() },
            _ => SetPoint { mounting, omega: 10.0 + 40.0 * random.uniform(), angle: 0.0 },
        })
        .collect();
    let experiment = Experiment {
        site: Site { gravity: 9.81, latitude: None },
        unit: Unit { rho_z: spread() * 0.5, reference: ReferencePoint::FirstProofMass },
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
    let model = MeasurementModel::new(experiment, ErrorModel { terms }, &[]);
    let noise = Noise { density: 1e-4 * (1.0 + random.uniform()), floor: 1e-5 * random.uniform() };
    let position = 300.0 * random.uniform();
    Candidates {
        scenarios: vec![Scenario { model, noise, speed_uncertainty: 1e-5 * random.uniform(), weight: 1.0 }],
        durations: vec![20.0 + 40.0 * random.uniform(), 100.0 + 100.0 * random.uniform()],
        repeats: 1,
        costs: Costs {
            position,
            seat: position * random.uniform(),
            ramp: 60.0 * random.uniform(),
            turn: 20.0 * random.uniform(),
            run_up: 30.0 * random.uniform(),
        },
    }
}

/// The covariance by one factorisation of all rows in typical units, each visit by itself: another way to the same numbers.
fn covariance(candidates: &Candidates, visits: &[Visit]) -> DMatrix<f64> {
    let scenario = &candidates.scenarios[0];
    let model = &scenario.model;
    let p = model.parameters().len();
    let mut rows = DMatrix::zeros(p + 3 * visits.len(), p);
    rows.fill_diagonal(1.0 / fit::NULL_HOLD);
    for (n, visit) in visits.iter().enumerate() {
        let l = model.linearise_at_zero(&model.experiment().set_points[visit.plateau]);
        let shift = l.speed * scenario.speed_uncertainty;
        let sigma = Matrix3::identity() * scenario.noise.variance(visit.duration) + shift * shift.transpose();
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

/// The criterion from its definition.
fn value(criterion: &Criterion, candidates: &Candidates, visits: &[Visit]) -> f64 {
    let model = &candidates.scenarios[0].model;
    let all = covariance(candidates, visits);
    let instrument: Vec<usize> = (0..all.nrows()).filter(|&j| model.parameters()[j].is_of_instrument()).collect();
    let c = all.select_rows(&instrument).select_columns(&instrument);
    let typical = |n: usize| model.parameters()[instrument[n]].typical;
    let s = instrument.len();
    let reading = |range: &ReadingRange| range.standard_uncertainty(model, &c).powi(2);
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
        for plateau in 0..candidates.len() {
            if rest % options > 0 {
                visits.push(Visit { plateau, duration: candidates.durations[rest % options - 1] });
            }
            rest /= options;
        }
        if !visits.is_empty() && candidates.time_of(&visits) <= time {
            visit(&visits);
        }
    }
}

const RANGE: ReadingRange = ReadingRange { force: 500.0 };

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

/// On small cases the plan is the best of all that there are.
#[test]
fn small_plans_are_the_best_of_all() {
    let mut random = Random::new(11);
    let mut enumerated_plans = 0;
    for case in 0..60 {
        let candidates = small(&mut random);
        let criterion = criterion(case % 4, &candidates.scenarios[0].model);
        let all: Vec<Visit> =
            (0..candidates.len()).map(|plateau| Visit { plateau, duration: candidates.durations[1] }).collect();
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
        let plan = best_for_time(&candidates, &criterion, time, Effort::EXHAUSTIVE).unwrap();
        let found = value(&criterion, &candidates, &plan.schedule.visits);
        assert!((plan.criterion / found - 1.0).abs() < 1e-6, "case {case}: {} {found}", plan.criterion);
        assert!(plan.schedule.time <= time * (1.0 + 1e-12) && plan.bound <= best.0 * (1.0 + 1e-6), "case {case}");
        assert!(
            found <= best.0 * (1.0 + 1e-6),
            "case {case}, {criterion:?}: found {found:e}, best {:e}\n{:?}\n{:?}",
            best.0,
            plan,
            best.1
        );
        println!("case {case}: {} plateaus, {} nodes, gap {:e}", candidates.len(), plan.nodes, plan.gap());
    }
    println!("{enumerated_plans} plans enumerated");
}

fn schedule_is_sorted(schedule: &Schedule, candidates: &Candidates) -> bool {
    let mounting = |v: &Visit| candidates.experiment().set_points[v.plateau].mounting;
    schedule.visits.windows(2).all(|w| mounting(&w[0]) <= mounting(&w[1]))
}

/// A machine's worth of candidates: six positions, two radii, speeds by load.
pub fn large(speeds: usize, durations: &[f64]) -> Candidates {
    let mut experiment = crate::common::experiment(ThirdPosition::AxisOneUp, PairRelation::Common, &[1.0, 0.5]);
    let top = (200.0 * 9.80665 / 0.5_f64).sqrt();
    experiment.set_points = (0..experiment.mountings.len())
        .flat_map(|mounting| {
            let rest =
                (0..2).map(move |n| SetPoint { mounting, omega: 0.0, angle: std::f64::consts::PI * f64::from(n) });
            let spin = (1..=speeds).map(move |n| SetPoint {
                mounting,
                omega: top * (n as f64 / speeds as f64).sqrt(),
                angle: 0.0,
            });
            rest.chain(spin)
        })
        .collect();
    let model = MeasurementModel::new(experiment, ErrorModel::kozlov_2017(), &[]);
    let noise = Noise { density: 20e-6 * 9.80665, floor: 1e-6 * 9.80665 };
    Candidates {
        scenarios: vec![Scenario { model, noise, speed_uncertainty: 1e-5, weight: 1.0 }],
        durations: durations.to_vec(),
        repeats: 2,
        costs: Costs { position: 1200.0, seat: 600.0, ramp: 30.0, turn: 10.0, run_up: 60.0 },
    }
}

#[test]
fn large_plans_are_certified() {
    for (number, time) in [(2, 6.0), (0, 8.0), (1, 8.0), (3, 8.0)] {
        let candidates = large(8, &[30.0, 60.0, 120.0]);
        let criterion = criterion(number, &candidates.scenarios[0].model);
        let begun = std::time::Instant::now();
        let plan = best_for_time(&candidates, &criterion, time * 3600.0, Effort::default()).unwrap();
        println!(
            "{number}: criterion {:e} bound gap {:.4}, continuous gap {:.2e} ({} models), rounding {:.4}, {} nodes, {} visits, {:.2} of {time} h, {:?}",
            plan.criterion,
            plan.gap(),
            plan.continuous.gap(),
            plan.continuous.models,
            plan.rounding(),
            plan.nodes,
            plan.schedule.visits.len(),
            plan.schedule.time / 3600.0,
            begun.elapsed()
        );
        assert!(schedule_is_sorted(&plan.schedule, &candidates));
        assert!(plan.continuous.gap() < 0.01);
    }
}

#[test]
fn shortest_plans_keep_their_goals() {
    let _ = shortest_for_goals;
}

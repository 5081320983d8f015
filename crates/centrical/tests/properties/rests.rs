//! Records of a unit that is turned by hand or on a table: the rests that are found, and the calibration by them.

use centrical::reduction::{Record, coarse_scale, reduce_rests};
use centrical::{
    Centrifuge, ErrorModel, Experiment, MeasurementModel, Mounting, Observation, PairRelation, Position,
    ReferencePoint, SetPoint, Site, Unit,
};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use crate::common::{Random, exact};

const GRAVITY: f64 = 9.815;
const RATE: f64 = 100.0;

/// A unit that is turned again and again.
struct Made {
    record: Record,
    /// From, to of each rest [s].
    rests: Vec<[f64; 2]>,
    /// `df_1..3`, then `G0` row by row of its lower triangle.
    truth: [f64; 9],
}

/// How a record is made.
#[derive(Clone, Copy)]
struct Making {
    rests: usize,
    /// Shortest and longest rest [s].
    lasting: [f64; 2],
    /// White noise of a sample [m/s^2].
    white: Vector3<f64>,
    /// Noise of a correlation time of a second [m/s^2].
    slow: f64,
    /// Tremor of the attitude [rad].
    tremor: f64,
    /// Chance that a rest is bumped.
    bumps: f64,
}

const BY_HAND: Making = Making {
    rests: 22,
    lasting: [2.0, 6.0],
    white: Vector3::new(0.02, 0.02, 0.03),
    slow: 3e-4,
    tremor: 2e-3,
    bumps: 0.1,
};

const ON_A_TABLE: Making = Making {
    rests: 26,
    lasting: [5.0, 8.0],
    white: Vector3::new(1e-3, 1e-3, 1e-3),
    slow: 3e-4,
    tremor: 0.0,
    bumps: 0.0,
};

/// First-order Markov noise of unit variance.
struct Markov {
    keep: f64,
    value: Vector3<f64>,
}

impl Markov {
    fn new(seconds: f64, random: &mut Random) -> Self {
        Self { keep: (-1.0 / (RATE * seconds)).exp(), value: Vector3::from_fn(|_, _| random.normal()) }
    }

    fn next(&mut self, random: &mut Random) -> Vector3<f64> {
        let fresh = (1.0 - self.keep * self.keep).sqrt();
        self.value = self.value * self.keep + Vector3::from_fn(|_, _| fresh * random.normal());
        self.value
    }
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts of samples from lengths of time")]
fn made(making: &Making, random: &mut Random) -> Made {
    let sizes = [0.05, 0.05, 0.05, 3e-3, 3e-3, 3e-3, 3e-3, 3e-3, 3e-3];
    let truth = sizes.map(|size| size * random.normal());
    let [b1, b2, b3, k11, k21, k22, k31, k32, k33] = truth;
    let gain = Matrix3::identity() + Matrix3::new(k11, 0.0, 0.0, k21, k22, 0.0, k31, k32, k33);
    let bias = Vector3::new(b1, b2, b3);
    let direction = |random: &mut Random| Vector3::from_fn(|_, _| random.normal()).normalize();
    let mut slow = Markov::new(1.0, random);
    let mut tremor = Markov::new(0.3, random);
    let mut record = Record::default();
    let mut add = |u: Vector3<f64>, random: &mut Random| {
        let white = making.white.map(|sigma| sigma * random.normal());
        let reading = gain * u * GRAVITY + bias + white + slow.next(random) * making.slow;
        record.t.push(record.t.len() as f64 / RATE);
        (0..3).for_each(|axis| record.f_z[axis].push(reading[axis]));
        record.t.len()
    };
    let mut rests = Vec::new();
    let mut before = direction(random);
    let mut length = 0;
    for rest in 0..making.rests {
        let next = direction(random);
        let steps = (RATE * (0.8 + random.uniform())) as usize;
        let shake = direction(random) * 0.4;
        for step in (0..steps).filter(|_| rest > 0) {
            let part = 0.5 - 0.5 * (std::f64::consts::PI * step as f64 / steps as f64).cos();
            let on_the_way = before * (1.0 - part) + next * part + shake * (std::f64::consts::PI * part).sin();
            length = add(on_the_way.normalize() * (1.0 + 0.1 * random.normal()), random);
        }
        let lasting = making.lasting[0] + (making.lasting[1] - making.lasting[0]) * random.uniform();
        let from = length as f64 / RATE;
        let bump = if random.uniform() < making.bumps { lasting * RATE * random.uniform() } else { f64::INFINITY };
        for step in 0..(RATE * lasting) as usize {
            let shaken = (next + next.cross(&tremor.next(random)) * making.tremor).normalize();
            let is_bumped = (bump..bump + 5.0).contains(&(step as f64));
            let bump = if is_bumped { Vector3::from_fn(|_, _| 0.3 * random.normal()) } else { Vector3::zeros() };
            length = add(shaken + bump, random);
        }
        rests.push([from, length as f64 / RATE]);
        before = next;
    }
    Made { record, rests, truth }
}

/// The model of rests that point along `means`, and the means as observations of it.
fn problem(means: &[(Vector3<f64>, Matrix3<f64>)]) -> (MeasurementModel, Vec<Observation>) {
    let mut experiment = Experiment {
        site: Site { gravity: GRAVITY, latitude: None },
        unit: Unit { rho_z: Matrix3::zeros(), reference: ReferencePoint::OwnAxes },
        centrifuge: Centrifuge::default(),
        positions: Vec::new(),
        pair_relation: PairRelation::Free,
        mountings: Vec::new(),
        set_points: Vec::new(),
    };
    for (n, (mean, _)) in means.iter().enumerate() {
        experiment.positions.push(Position::free(n.to_string(), mean));
        experiment.mountings.push(Mounting { position: n, arm_y: Vector3::zeros() });
        experiment.set_points.push(SetPoint::at_rest(n, 0.0));
    }
    let mut error_model = ErrorModel::kozlov_2017();
    error_model.terms.retain(|term| term.monomial.degree() < 2);
    let observation = |(set_point, (mean, covariance)): (usize, &(Vector3<f64>, Matrix3<f64>))| Observation {
        set_point,
        mean: *mean,
        covariance: *covariance,
    };
    (MeasurementModel::new(experiment, error_model, &[]), means.iter().enumerate().map(observation).collect())
}

/// Squared errors of the nine coefficients over their covariance, in all.
fn squared_error(made: &Made) -> f64 {
    let rests = reduce_rests(&[made.record.as_slice()]).unwrap().concat();
    let means: Vec<_> = rests.iter().map(|rest| (rest.mean, rest.covariance)).collect();
    let (model, observations) = problem(&means);
    let fit = exact(&model, &observations).unwrap();
    let names = ["df_1", "df_2", "df_3", "G0_11", "G0_21", "G0_22", "G0_31", "G0_32", "G0_33"];
    let own = names.map(|name| model.parameters().find(name).unwrap());
    let error = DVector::from_fn(9, |a, _| fit.value(own[a]).unwrap() - made.truth[a]);
    let covariance = DMatrix::from_fn(9, 9, |a, b| fit.covariance(own[a], own[b]).unwrap());
    error.dot(&covariance.cholesky().unwrap().solve(&error))
}

/// Every rest is found, none is invented, and each lies within the one that was made.
#[test]
fn rests_are_found_as_they_were_made() {
    let mut random = Random::new(4);
    for making in [BY_HAND, ON_A_TABLE, Making { bumps: 0.0, lasting: [1.2, 2.0], ..BY_HAND }] {
        for _ in 0..10 {
            let made = made(&making, &mut random);
            let found = reduce_rests(&[made.record.as_slice()]).unwrap().concat();
            // A bump may part one rest in two.
            let bumped = if making.bumps > 0.0 { making.rests / 4 } else { 0 };
            assert!((making.rests..=making.rests + bumped).contains(&found.len()), "{}", found.len());
            for rest in &found {
                let within = |made: &&[f64; 2]| rest.window[0] > made[0] - 0.15 && rest.window[1] < made[1] + 0.15;
                assert!(made.rests.iter().any(|made| within(&made)), "{:?} in {:?}", rest.window, made.rests);
            }
        }
    }
}

/// A record without motion is one rest; one in motion throughout has none.
#[test]
fn neither_rests_nor_motion_are_invented() {
    let mut random = Random::new(6);
    let still = made(&Making { rests: 1, lasting: [60.0, 60.0], bumps: 0.0, ..BY_HAND }, &mut random);
    assert_eq!(reduce_rests(&[still.record.as_slice()]).unwrap().concat().len(), 1);
    let count = 6000;
    let t: Vec<f64> = (0..count).map(|i| f64::from(i) / RATE).collect();
    let turned = |phase: f64| t.iter().map(|t| GRAVITY * (1.7 * t + phase).sin() + 0.01 * random.normal()).collect();
    let mut turned = turned;
    let moving = Record { f_z: [turned(0.0), turned(1.6), turned(0.3)], t: t.clone() };
    assert!(reduce_rests(&[moving.as_slice()]).unwrap().concat().is_empty());
}

/// Readings in counts: scale and bias to what misalignment leaves, from the rests alone.
#[test]
fn counts_become_accelerations() {
    let mut random = Random::new(9);
    let mut made = made(&ON_A_TABLE, &mut random);
    let (scale, bias) = ([415.0, -0.2, 21.0], [33_123.0, 4.0, -600.0]);
    for (axis, values) in made.record.f_z.iter_mut().enumerate() {
        for value in values {
            *value = *value * scale[axis] + bias[axis];
        }
    }
    let means: Vec<_> =
        reduce_rests(&[made.record.as_slice()]).unwrap().concat().iter().map(|rest| rest.mean).collect();
    assert_eq!(means.len(), ON_A_TABLE.rests);
    let coarse = coarse_scale(&means, GRAVITY).unwrap();
    for axis in 0..3 {
        let own = scale[axis].abs() * (1.0 + made.truth[[3, 5, 8][axis]]);
        assert!((coarse.scale[axis] / own - 1.0).abs() < 0.01, "{axis}: {}", coarse.scale[axis]);
        let off = (coarse.bias[axis] - bias[axis]) / own;
        assert!(off.abs() < 0.2, "{axis}: {off}");
    }
    // Five rests, or all on one side, show no ellipsoid.
    assert!(coarse_scale(&means[..5], GRAVITY).is_none());
}

/// Errors are as large as stated, by hand and on a table.
#[test]
fn errors_are_as_large_as_stated() {
    const RUNS: usize = 100;
    for (seed, making) in [(1, BY_HAND), (2, ON_A_TABLE)] {
        let mut random = Random::new(seed);
        let mean: f64 = (0..RUNS).map(|_| squared_error(&made(&making, &mut random))).sum::<f64>() / (9 * RUNS) as f64;
        // Weights of few rests are themselves estimates: four standard deviations of the mean, and 5 % for them.
        assert!((mean - 1.0).abs() < 4.0 * (2.0 / (9 * RUNS) as f64).sqrt() + 0.05, "{mean}");
    }
}

//! Mistakes in how a record was taken down: newtonometers exchanged, signs reversed, a wrong unit, a wrong sense of
//! rotation. What they read is right by another reading of the schedule, and so they are recognised: by comparing
//! likelihoods, not by limits.
//!
//! The nominal readings of one mounting lie on a line, `f = a + Omega^2 c`: gravity and the centripetal part. A record
//! tells both. Of every hypothesis `k S` (48 signed permutations `S` of the axes, three factors `k` of the unit) it is
//! computed how far `k S a` and `k S c` are from what was seen, in half-widths of the law by which real units differ from
//! their nominal ones; two numbers, whatever the number of plateaus, since the errors of a unit are the same on all.

use std::fmt;
use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use super::alignment::level;
use super::blocks::Blocks;
use super::evidence::{Evidence, LEVEL};
use super::{ReductionError, ScheduledPlateau};
use crate::experiment::STANDARD_GRAVITY;

/// Odds that a record was taken down by mistake, against that it was not.
pub(super) const ODDS: f64 = 1e-6;

/// Odds of one more mistake in the same record.
const FURTHER: f64 = 1e-2;

/// How readings differ from what they are taken for: `found = factor permutation expected`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mistake {
    /// Newtonometer that reading `i` is really of.
    pub source: [u8; 3],
    /// Its sign.
    pub sign: [i8; 3],
    /// Size of the readings over that of the expected ones.
    pub factor: f64,
}

/// Refuses a record that is decisively better explained by a mistake than as it stands.
///
/// `cores` are the plateaus as found, or none if they were not.
pub(super) fn recognise(
    blocks: &Blocks,
    schedule: &[ScheduledPlateau],
    cores: Option<&[Range<usize>]>,
    align: impl Fn(&[ScheduledPlateau]) -> Option<Vec<Range<usize>>>,
) -> Result<(), ReductionError> {
    let Some(nominal) = Line::through(schedule.iter().map(|p| (p.omega, p.nominal_z))) else { return Ok(()) };
    let seen = |cores: &[Range<usize>]| {
        Line::through(schedule.iter().zip(cores).map(|(p, core)| (p.omega, level(blocks, core))))
    };
    let likeliest = |seen: &Line| {
        let all = Mistake::all().into_iter().map(|m| (m, m.log_prior() + seen.log_likelihood(&nominal.under(&m))));
        all.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|best| best.1 > seen.log_likelihood(&nominal))
    };
    let found = match cores {
        Some(cores) => seen(cores).and_then(|seen| likeliest(&seen)).map(|(mistake, _)| (mistake, cores.to_vec())),
        // Nothing was found by the schedule as it stands: is it found by another reading of it?
        None => by_levels(blocks, schedule).into_iter().find_map(|mistake| {
            let other: Vec<ScheduledPlateau> = schedule.iter().map(|p| mistake.scheduled(p)).collect();
            let cores = align(&other)?;
            let (confirmed, _) = likeliest(&seen(&cores)?)?;
            (confirmed == mistake).then_some((mistake, cores))
        }),
    };
    let Some((mistake, cores)) = found else { return Ok(()) };
    // Shown where the mistake shows most.
    let off = |k: &usize| (level(blocks, &cores[*k]) - schedule[*k].nominal_z).norm();
    let index = (0..schedule.len()).max_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
    let ScheduledPlateau { omega, nominal_z } = schedule[index];
    let mistake = Box::new(mistake);
    Err(ReductionError::Mistaken { mistake, index, omega, level_z: nominal_z, found_z: level(blocks, &cores[index]) })
}

/// Mistakes by which more of the record's steady stretches have a level of the schedule than as it stands, the best
/// first.
fn by_levels(blocks: &Blocks, schedule: &[ScheduledPlateau]) -> Vec<Mistake> {
    const TRIED: usize = 4;
    let levels: Vec<Vector3<f64>> =
        Evidence::new(blocks).steady_stretches().iter().map(|stretch| level(blocks, stretch)).collect();
    let near = |expected: &[Vector3<f64>]| -> f64 {
        let best = |f: &Vector3<f64>| expected.iter().map(|e| log_density(f, e)).fold(f64::NEG_INFINITY, f64::max);
        levels.iter().map(best).sum()
    };
    let expected: Vec<Vector3<f64>> = schedule.iter().map(|p| p.nominal_z).collect();
    let as_it_stands = near(&expected);
    let score = |m: Mistake| (m, near(&expected.iter().map(|e| m.reading(e)).collect::<Vec<_>>()) + m.log_prior());
    let mut better: Vec<(Mistake, f64)> =
        Mistake::all().into_iter().map(score).filter(|(_, score)| *score > as_it_stands).collect();
    better.sort_by(|a, b| b.1.total_cmp(&a.1));
    better.into_iter().take(TRIED).map(|(mistake, _)| mistake).collect()
}

/// Readings of one mounting over the square of the speed.
pub(super) struct Line {
    /// At rest [m/s^2].
    pub a: Vector3<f64>,
    /// Per square of the speed [m].
    pub c: Vector3<f64>,
    /// Largest square of the speed [rad^2/s^2].
    fastest: f64,
}

impl Line {
    /// Through the slowest and the fastest plateau. `None` of one speed only.
    pub fn through(plateaus: impl Iterator<Item = (f64, Vector3<f64>)>) -> Option<Self> {
        let squares: Vec<(f64, Vector3<f64>)> = plateaus.map(|(omega, f)| (omega * omega, f)).collect();
        let slowest = squares.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        let fastest = squares.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
        let c = (fastest.1 - slowest.1) / (fastest.0 - slowest.0);
        (fastest.0 > slowest.0).then(|| Self { a: slowest.1 - c * slowest.0, c, fastest: fastest.0 })
    }

    fn under(&self, mistake: &Mistake) -> Self {
        Self { a: mistake.reading(&self.a), c: mistake.reading(&self.c), fastest: self.fastest }
    }

    /// Logarithm of the density of this line if `expected` is the nominal one.
    fn log_likelihood(&self, expected: &Self) -> f64 {
        log_density(&self.a, &expected.a) + log_density(&(self.c * self.fastest), &(expected.c * self.fastest))
    }
}

/// Cauchy's law in three dimensions about the nominal reading, of the half-width that alignment takes: logarithm.
fn log_density(found: &Vector3<f64>, expected: &Vector3<f64>) -> f64 {
    let width = LEVEL.0 * expected.norm() + LEVEL.1;
    let distance = (found - expected).norm() / width;
    -3.0 * width.ln() - 2.0 * (1.0 + distance * distance).ln()
}

impl Mistake {
    /// Every one but none.
    fn all() -> Vec<Self> {
        const ORDERS: [[u8; 3]; 6] = [[0, 1, 2], [1, 0, 2], [0, 2, 1], [2, 1, 0], [1, 2, 0], [2, 0, 1]];
        let mut all = Vec::with_capacity(144);
        for source in ORDERS {
            for signs in 0..8_u8 {
                let sign = [0, 1, 2].map(|axis| if signs >> axis & 1 == 1 { -1 } else { 1 });
                for factor in [1.0, 1.0 / STANDARD_GRAVITY, STANDARD_GRAVITY] {
                    all.push(Self { source, sign, factor });
                }
            }
        }
        all.retain(|mistake| mistake.count() > 0);
        all
    }

    /// Exchanges, reversed signs and wrong units.
    fn count(&self) -> i32 {
        let moved = (0..3).filter(|axis| usize::from(self.source[*axis]) != *axis).count();
        let reversed = self.sign.iter().filter(|sign| **sign < 0).count();
        let units = usize::from(self.factor != 1.0);
        i32::try_from(moved.saturating_sub(1) + reversed + units).unwrap_or(i32::MAX)
    }

    /// Whether the unit turned otherwise would read so: a proper rotation, in the right unit.
    fn is_turn(&self) -> bool {
        let row = |i: usize| Vector3::ith(usize::from(self.source[i]), f64::from(self.sign[i]));
        self.factor == 1.0 && Matrix3::from_columns(&[row(0), row(1), row(2)]).determinant() > 0.0
    }

    /// Logarithm of its odds against no mistake: [`ODDS`] shared among the mistakes of one kind, the fewer the likelier.
    fn log_prior(&self) -> f64 {
        ODDS.ln() + f64::from(self.count() - 1) * FURTHER.ln()
    }

    /// What is read where `f_z` is expected.
    fn reading(&self, f_z: &Vector3<f64>) -> Vector3<f64> {
        let row = |i: usize| Vector3::ith(usize::from(self.source[i]), self.factor * f64::from(self.sign[i]));
        Matrix3::from_columns(&[row(0), row(1), row(2)]).transpose() * f_z
    }

    fn scheduled(&self, plateau: &ScheduledPlateau) -> ScheduledPlateau {
        ScheduledPlateau { nominal_z: self.reading(&plateau.nominal_z), ..*plateau }
    }
}

impl fmt::Display for Mistake {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let moved: Vec<usize> = (0..3).filter(|axis| usize::from(self.source[*axis]) != *axis).collect();
        let mut parts = Vec::new();
        if let [i, j] = moved[..] {
            parts.push(format!("axes {0} and {1} exchanged (f{1} as f{0} and f{0} as f{1})", i + 1, j + 1));
        } else if !moved.is_empty() {
            let named = moved.iter().map(|i| format!("f{} as f{}", self.source[*i] + 1, i + 1));
            parts.push(format!("axes exchanged in turn ({})", named.collect::<Vec<_>>().join(", ")));
        }
        for axis in (0..3).filter(|axis| self.sign[*axis] < 0) {
            parts.push(format!("f{} with the sign reversed", axis + 1));
        }
        if self.factor < 1.0 {
            parts.push("the unit g taken for m/s^2".to_owned());
        } else if self.factor > 1.0 {
            parts.push("the unit m/s^2 taken for g".to_owned());
        }
        if self.is_turn() {
            parts.push("or another mounting of the unit".to_owned());
        }
        out.write_str(&parts.join(", "))
    }
}

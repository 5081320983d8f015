//! Recognition of recording mistakes: exchanged axes, reversed signs, a wrong unit. The readings are right by another reading
//! of the schedule, and so a mistake is recognised by comparing likelihoods, not by limits.
//!
//! The nominal readings of one mounting lie on a line, `f = a + Omega^2 c`: gravity and the centripetal part. A record
//! shows both. A hypothesis `k S` is one of 48 signed permutations `S` of the axes with one of three factors `k` of the
//! unit. Of each the distances of `k S a` and `k S c` from the observed line are computed, in half-widths of the law by
//! which real units differ from nominal ones. These are two numbers, whatever the number of plateaus: a unit has the
//! same errors on all.

use std::ops::Range;

use nalgebra::Vector3;

use super::evidence::{Evidence, level_width};
use crate::reduction::error::ReductionError;
use crate::reduction::mistake::Mistake;
use crate::reduction::plateau::ScheduledPlateau;
use crate::reduction::survey::Blocks;

/// Odds of a recording mistake against none.
pub(super) const ODDS: f64 = 1e-6;

/// Odds of one more mistake in the same record.
const FURTHER: f64 = 1e-2;

/// Refuses a record that is decisively better explained by a mistake than as it stands.
///
/// `cores` are the plateaus as found, `None` if they were not.
pub(super) fn recognise(
    blocks: &Blocks,
    schedule: &[ScheduledPlateau],
    cores: Option<&[Range<usize>]>,
    align: impl Fn(&[ScheduledPlateau]) -> Option<Vec<Range<usize>>>,
) -> Result<(), ReductionError> {
    let Some(nominal) = Line::through(schedule.iter().map(|p| (p.omega, p.nominal_z))) else { return Ok(()) };
    let seen = |cores: &[Range<usize>]| {
        Line::through(schedule.iter().zip(cores).map(|(p, core)| (p.omega, blocks.level(core))))
    };
    let likeliest = |seen: &Line| {
        let all = Mistake::all().into_iter().map(|m| (m, log_prior(&m) + seen.log_likelihood(&nominal.under(&m))));
        all.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|best| best.1 > seen.log_likelihood(&nominal))
    };
    let found = match cores {
        Some(cores) => seen(cores).and_then(|seen| likeliest(&seen)).map(|(mistake, _)| (mistake, cores.to_vec())),
        // The plateaus were not found by the schedule as it stands: they may be by another reading of it.
        None => by_levels(blocks, schedule).into_iter().find_map(|mistake| {
            let other: Vec<ScheduledPlateau> = schedule.iter().map(|p| mistake.scheduled(p)).collect();
            let cores = align(&other)?;
            let (confirmed, _) = likeliest(&seen(&cores)?)?;
            (confirmed == mistake).then_some((mistake, cores))
        }),
    };
    let Some((mistake, cores)) = found else { return Ok(()) };
    // The message shows the plateau where the mistake is largest.
    let off = |k: &usize| (blocks.level(&cores[*k]) - schedule[*k].nominal_z).norm();
    let index = (0..schedule.len()).max_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
    let ScheduledPlateau { omega, nominal_z } = schedule[index];
    let mistake = Box::new(mistake);
    Err(ReductionError::Mistaken { mistake, index, omega, level_z: nominal_z, found_z: blocks.level(&cores[index]) })
}

/// Mistakes by which more of the record's steady stretches have a level of the schedule than as it stands, the best
/// first.
fn by_levels(blocks: &Blocks, schedule: &[ScheduledPlateau]) -> Vec<Mistake> {
    const TRIED: usize = 4;
    let levels: Vec<Vector3<f64>> =
        Evidence::new(blocks).steady_stretches().iter().map(|stretch| blocks.level(stretch)).collect();
    let near = |expected: &[Vector3<f64>]| -> f64 {
        let best = |f: &Vector3<f64>| expected.iter().map(|e| log_density(f, e)).fold(f64::NEG_INFINITY, f64::max);
        levels.iter().map(best).sum()
    };
    let expected: Vec<Vector3<f64>> = schedule.iter().map(|p| p.nominal_z).collect();
    let as_it_stands = near(&expected);
    let score = |m: Mistake| (m, near(&expected.iter().map(|e| m.reading(e)).collect::<Vec<_>>()) + log_prior(&m));
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
    /// Through the slowest and the fastest plateau. `None` if all have the same speed.
    pub fn through(plateaus: impl Iterator<Item = (f64, Vector3<f64>)>) -> Option<Self> {
        let squares: Vec<(f64, Vector3<f64>)> = plateaus.map(|(omega, f)| (omega * omega, f)).collect();
        let slowest = squares.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        let fastest = squares.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
        let c = (fastest.1 - slowest.1) / (fastest.0 - slowest.0);
        (fastest.0 > slowest.0).then(|| Self { a: slowest.1 - c * slowest.0, c, fastest: fastest.0 })
    }

    /// Square of the speed at which a plateau reads `f` [rad^2/s^2].
    pub fn square(&self, f: &Vector3<f64>) -> f64 {
        (f - self.a).dot(&self.c) / self.c.norm_squared()
    }

    fn under(&self, mistake: &Mistake) -> Self {
        Self { a: mistake.reading(&self.a), c: mistake.reading(&self.c), fastest: self.fastest }
    }

    /// Logarithm of the density of this line if `expected` is the nominal one.
    pub fn log_likelihood(&self, expected: &Self) -> f64 {
        log_density(&self.a, &expected.a) + log_density(&(self.c * self.fastest), &(expected.c * self.fastest))
    }
}

/// Cauchy's law in three dimensions about the nominal reading, of the half-width that alignment uses: logarithm.
fn log_density(found: &Vector3<f64>, expected: &Vector3<f64>) -> f64 {
    let width = level_width(expected);
    let distance = (found - expected).norm() / width;
    -3.0 * width.ln() - 2.0 * (1.0 + distance * distance).ln()
}

/// Logarithm of a mistake's odds against no mistake: [`ODDS`] shared among the mistakes of one kind, the fewer the likelier.
fn log_prior(mistake: &Mistake) -> f64 {
    ODDS.ln() + f64::from(mistake.count() - 1) * FURTHER.ln()
}

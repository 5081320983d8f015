//! The blocks of a record that belong to each scheduled plateau: by order, level and steadiness.

use std::ops::Range;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::evidence::{Candidate, Evidence};
use super::path::Trellis;
use super::{band, hypothesis, rotation};
use crate::reduction::error::{ReductionError, Stretch};
use crate::reduction::plateau::ScheduledPlateau;
use crate::reduction::survey::Blocks;

/// Farthest relative distance of the strongest plateau from its nominal level. The scale of an uncalibrated unit is off by some percent.
const FAR: f64 = 0.1;

/// More rounds than are needed.
const ROUNDS: usize = 8;

/// The core of each scheduled plateau, in blocks; an error for a record with a recording mistake.
pub(super) fn align(blocks: &Blocks, schedule: &[ScheduledPlateau]) -> Result<Vec<Range<usize>>, ReductionError> {
    let other = |schedule: &[ScheduledPlateau]| by_schedule(blocks, schedule).ok();
    let retried = |error| as_seen(blocks, schedule).and_then(|seen| by_schedule(blocks, &seen).ok()).ok_or(error);
    match by_schedule(blocks, schedule).or_else(retried) {
        Ok(cores) => {
            hypothesis::recognise(blocks, schedule, Some(&cores), other)?;
            rotation::check(blocks, schedule, &cores)?;
            Ok(cores)
        }
        Err(error) => {
            hypothesis::recognise(blocks, schedule, None, other)?;
            Err(error)
        }
    }
}

/// The core of each scheduled plateau, in blocks.
fn by_schedule(blocks: &Blocks, schedule: &[ScheduledPlateau]) -> Result<Vec<Range<usize>>, ReductionError> {
    let evidence = Evidence::new(blocks);
    let mut candidates: Vec<Candidate> = schedule.par_iter().map(|plateau| evidence.of(plateau)).collect();
    let between = evidence.in_transition();
    let on = |k: usize, from: usize, density: &mut [f64]| candidates[k].density(evidence.noise(), from, density);
    let mut cores = band::best_path(&evidence.steady_stretches(), schedule.len(), &between, on);
    if let Some(index) = missing(&cores) {
        let ScheduledPlateau { omega, nominal_z } = schedule[index];
        let stretches = evidence.steady_stretches().into_iter();
        let seen: Vec<Stretch> = stretches.map(|range| stretch(blocks, range, &cores, &candidates)).collect();
        let least = blocks.least(omega) as f64 * blocks.width;
        let is_too_short = |s: &&Stretch| s.plateau == Some(index) && s.window[1] - s.window[0] < least;
        if let Some(&Stretch { window, .. }) = seen.iter().find(is_too_short) {
            return Err(ReductionError::PlateauTooShort { index, window, least });
        }
        let count = schedule.len();
        return Err(ReductionError::PlateauNotFound { index, count, omega, level_z: nominal_z, least, seen });
    }
    for (k, candidate) in candidates.iter_mut().enumerate() {
        let neighbours = [k.checked_sub(1), Some(k + 1)].into_iter().flatten().filter_map(|k| schedule.get(k));
        let level_z = blocks.level(&cores[k]);
        neighbours.for_each(|neighbour| candidate.leave_to(neighbour, &schedule[k], &level_z));
    }
    // With the plateaus located, the changes on each give their own noise, far below that of a sample. This is repeated
    // until the noise holds no part of the ramps. A plateau stays between its neighbours.
    let mut trellis = Trellis::new(&between_neighbours(&cores, blocks.len()), blocks.len());
    for _ in 0..ROUNDS {
        let own = candidates.par_iter().zip(&cores).map(|(candidate, core)| candidate.noise_of_change(core));
        let own: Vec<Vector3<f64>> = own.collect();
        let on = |k: usize, from: usize, density: &mut [f64]| candidates[k].density(&own[k], from, density);
        let next = trellis.best_path(&between, on);
        if next == cores || missing(&next).is_some() {
            break;
        }
        cores = next;
    }
    Ok(cores)
}

/// From the begin of the plateau before to the end of the plateau after, of each.
fn between_neighbours(cores: &[Range<usize>], blocks: usize) -> Vec<Range<usize>> {
    let start = |k: usize| k.checked_sub(1).map_or(0, |before| cores[before].start);
    let end = |k: usize| cores.get(k + 1).map_or(blocks, |after| after.end);
    (0..cores.len()).map(|k| start(k)..end(k)).collect()
}

/// The schedule on the line that the record shows, through its strongest steady stretch: nominal levels go from rest along
/// `Omega^2 c`. Loads may be closer to each other than the unit is to nominal. Then a plateau is nearer to the nominal level of its
/// neighbour than to its own, and the path by nominal levels omits the first plateau or the last. `None` where the stretch cannot be the
/// strongest plateau.
fn as_seen(blocks: &Blocks, schedule: &[ScheduledPlateau]) -> Option<Vec<ScheduledPlateau>> {
    let strongest = schedule.iter().max_by(|a, b| a.omega.abs().total_cmp(&b.omega.abs()))?;
    let stretches = Evidence::new(blocks).steady_stretches();
    let levels = stretches.iter().map(|stretch| blocks.level(stretch));
    let seen_z = levels.max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
    let off_z = seen_z - strongest.nominal_z;
    let along = |p: &ScheduledPlateau| {
        let share = (p.omega / strongest.omega).powi(2);
        ScheduledPlateau { nominal_z: p.nominal_z + off_z * share, ..*p }
    };
    let is_near = strongest.omega != 0.0 && off_z.norm() < FAR * strongest.nominal_z.norm();
    is_near.then(|| schedule.iter().map(along).collect())
}

/// A plateau that was passed over, or matched only the turn of a ramp.
fn missing(cores: &[Range<usize>]) -> Option<usize> {
    cores.iter().position(|core| core.len() < 3)
}

/// A steady stretch, and the plateau it was taken for.
fn stretch(blocks: &Blocks, range: Range<usize>, cores: &[Range<usize>], candidates: &[Candidate]) -> Stretch {
    let half = 0.5 * blocks.width;
    let middle = usize::midpoint(range.start, range.end);
    Stretch {
        window: [blocks.t[range.start] - half, blocks.t[range.end - 1] + half],
        level_z: blocks.level(&range),
        plateau: cores.iter().position(|core| core.contains(&middle)),
        resembles: (0..cores.len()).filter(|k| candidates[*k].has_level(middle)).collect(),
    }
}

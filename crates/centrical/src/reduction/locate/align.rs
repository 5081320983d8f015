//! The blocks of a record that belong to each scheduled plateau: by order, level and steadiness.

use std::borrow::Cow;
use std::ops::Range;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::evidence::{Candidate, Evidence};
use super::hypothesis::Line;
use super::path::{Band, Trellis};
use super::{hypothesis, rotation};
use crate::reduction::error::{ReductionError, Stretch};
use crate::reduction::plateau::ScheduledPlateau;
use crate::reduction::survey::Blocks;

/// Farthest relative distance of the strongest plateau from its nominal level. The scale of an uncalibrated unit is off by some percent.
const FAR: f64 = 0.1;

/// More rounds than are needed.
const ROUNDS: usize = 8;

/// Noise that is tried where plateaus are not found by that of a sample, in units of it: vibration at one speed, a speed that hunts.
const LOUDER: [f64; 4] = [4.0, 16.0, 64.0, 256.0];

/// A schedule found in a record.
pub(super) struct Aligned {
    /// The core of each scheduled plateau, in blocks.
    pub cores: Vec<Range<usize>>,
    /// Plateaus that the schedule does not have, from and to [s].
    pub unscheduled: Vec<[f64; 2]>,
}

/// The core of each scheduled plateau, and what the schedule does not have; an error for a record with a recording mistake.
pub(super) fn align(blocks: &Blocks, schedule: &[ScheduledPlateau]) -> Result<Aligned, ReductionError> {
    let quiet = Evidence::new(blocks);
    let other = |schedule: &[ScheduledPlateau]| first_path(&quiet, schedule.into()).ok().map(FirstPath::settled);
    match by_schedule(&quiet, schedule) {
        Ok(cores) => {
            hypothesis::recognise(blocks, schedule, Some(&cores), other)?;
            rotation::check(blocks, schedule, &cores)?;
            Ok(Aligned { unscheduled: unscheduled(&quiet, schedule, &cores), cores })
        }
        Err(error) => {
            hypothesis::recognise(blocks, schedule, None, other)?;
            Err(error)
        }
    }
}

/// The core of each scheduled plateau, in blocks, by the noise of a sample, or by louder noise if that leaves a plateau out or cuts it short.
fn by_schedule(quiet: &Evidence, schedule: &[ScheduledPlateau]) -> Result<Vec<Range<usize>>, ReductionError> {
    let path = either_path(quiet, schedule);
    if path.as_ref().is_ok_and(FirstPath::is_long_enough) {
        return path.map(FirstPath::settled);
    }
    let louder = LOUDER.iter().find_map(|times| by_louder_noise(quiet, schedule, *times));
    louder.map_or_else(|| path.map(FirstPath::settled), Ok)
}

/// The same where changes are noise that is a number of `times` louder than that of a sample. By loud noise a ramp is steady too: each core must
/// be long enough to be averaged, and its level go up as well as down.
fn by_louder_noise(quiet: &Evidence, schedule: &[ScheduledPlateau], times: f64) -> Option<Vec<Range<usize>>> {
    let evidence = quiet.louder(times);
    if !shows_more(&evidence, quiet) {
        return None;
    }
    let path = either_path(&evidence, schedule).ok()?;
    let is_long = path.is_long_enough();
    let cores = path.settled();
    let goes_up_and_down =
        |(plateau, core): (&ScheduledPlateau, &Range<usize>)| evidence.of(plateau).goes_up_and_down(core);
    (is_long && schedule.iter().zip(&cores).all(goes_up_and_down)).then_some(cores)
}

/// Whether louder noise makes as many blocks steady in a stretch as a plateau has.
fn shows_more(louder: &Evidence, quiet: &Evidence) -> bool {
    let blocks = quiet.blocks();
    let mut is_steady = vec![false; blocks.len()];
    quiet.steady_stretches().into_iter().for_each(|stretch| is_steady[stretch].fill(true));
    let more = |stretch: Range<usize>| is_steady[stretch].iter().filter(|is_steady| !**is_steady).count();
    louder.steady_stretches().into_iter().any(|stretch| more(stretch) >= blocks.least(0.0))
}

/// Spans [s] of steady stretches outside all cores that are under load and half as long as the shortest core or longer: plateaus that the
/// schedule does not have.
fn unscheduled(quiet: &Evidence, schedule: &[ScheduledPlateau], cores: &[Range<usize>]) -> Vec<[f64; 2]> {
    /// Load of the slowest scheduled plateau from which on a stretch is not at rest.
    const UNDER_LOAD: f64 = 0.1;
    let blocks = quiet.blocks();
    let seen = schedule.iter().zip(cores).map(|(plateau, core)| (plateau.omega, blocks.level(core)));
    let slowest = schedule.iter().map(|plateau| plateau.omega.powi(2)).filter(|square| *square > 0.0).reduce(f64::min);
    let (Some(line), Some(slowest)) = (Line::through(seen), slowest) else { return Vec::new() };
    let least = cores.iter().map(Range::len).min().unwrap_or(0).div_ceil(2);
    let is_outside = |range: &Range<usize>| cores.iter().all(|core| range.end <= core.start || core.end <= range.start);
    let is_under_load = |range: &Range<usize>| line.square(&blocks.level(range)) > UNDER_LOAD * slowest;
    let stretches = quiet.steady_stretches().into_iter();
    let found = stretches.filter(|range| range.len() >= least && is_outside(range) && is_under_load(range));
    found.map(|range| span(blocks, &range)).collect()
}

/// From the begin of the first block to the end of the last [s].
fn span(blocks: &Blocks, range: &Range<usize>) -> [f64; 2] {
    let half = 0.5 * blocks.width;
    [blocks.t[range.start] - half, blocks.t[range.end - 1] + half]
}

/// The most probable path of a record through a schedule, by one noise for all plateaus.
struct FirstPath<'a> {
    evidence: &'a Evidence<'a>,
    candidates: Vec<Candidate<'a>>,
    schedule: Cow<'a, [ScheduledPlateau]>,
    /// In transition, logarithm of the density of each block.
    between: Vec<f64>,
    cores: Vec<Range<usize>>,
}

/// The path through the schedule by its nominal levels; if that omits a plateau, by the levels of [`as_seen`].
fn either_path<'a>(evidence: &'a Evidence, schedule: &'a [ScheduledPlateau]) -> Result<FirstPath<'a>, ReductionError> {
    let seen = |error| as_seen(evidence, schedule).and_then(|seen| first_path(evidence, seen.into()).ok()).ok_or(error);
    first_path(evidence, schedule.into()).or_else(seen)
}

/// The path through a schedule; an error if a plateau is passed over.
fn first_path<'a>(
    evidence: &'a Evidence,
    schedule: Cow<'a, [ScheduledPlateau]>,
) -> Result<FirstPath<'a>, ReductionError> {
    let blocks = evidence.blocks();
    let candidates: Vec<Candidate> = schedule.par_iter().map(|plateau| evidence.of(plateau)).collect();
    let between = evidence.in_transition();
    let noise = vec![*evidence.noise(); candidates.len()];
    let mut band = Band::new(&evidence.steady_stretches(), blocks.len(), candidates.len());
    let search = |band: &Band| best_path(&band.within(), &between, &candidates, &noise);
    let mut cores = search(&band);
    while !band.holds(&cores) {
        band.reach *= 2;
        cores = search(&band);
    }
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
    Ok(FirstPath { evidence, candidates, schedule, between, cores })
}

impl FirstPath<'_> {
    /// Whether all cores are long enough to be averaged.
    fn is_long_enough(&self) -> bool {
        let least = |plateau: &ScheduledPlateau| self.evidence.blocks().least(plateau.omega);
        self.schedule.iter().zip(&self.cores).all(|(plateau, core)| core.len() >= least(plateau))
    }

    /// The cores by the noise of each plateau. With the plateaus located, the changes on each give their own noise, far below that of a
    /// sample. This is repeated until the noise holds no part of the ramps. A plateau stays between its neighbours.
    fn settled(self) -> Vec<Range<usize>> {
        let Self { evidence, mut candidates, schedule, between, mut cores } = self;
        let blocks = evidence.blocks();
        for (k, candidate) in candidates.iter_mut().enumerate() {
            let neighbours = [k.checked_sub(1), Some(k + 1)].into_iter().flatten().filter_map(|k| schedule.get(k));
            let level_z = blocks.level(&cores[k]);
            neighbours.for_each(|neighbour| candidate.leave_to(neighbour, &schedule[k], &level_z));
        }
        let within = between_neighbours(&cores, blocks.len());
        for _ in 0..ROUNDS {
            let own = candidates.par_iter().zip(&cores).map(|(candidate, core)| candidate.noise_of_change(core));
            let own: Vec<Vector3<f64>> = own.collect();
            let next = best_path(&within, &between, &candidates, &own);
            if next == cores || missing(&next).is_some() {
                break;
            }
            cores = next;
        }
        cores
    }
}

/// The best path through plateaus that may each be `within` some blocks: by the densities in transition, and those on each candidate by
/// its noise.
fn best_path(
    within: &[Range<usize>],
    between: &[f64],
    candidates: &[Candidate],
    noise: &[Vector3<f64>],
) -> Vec<Range<usize>> {
    let mut trellis = Trellis::new(within, between.len());
    while let Some(from) = trellis.next_layer() {
        trellis.plateaus().for_each(|(k, density)| candidates[k].density(&noise[k], from, density));
        trellis.take(between);
    }
    trellis.best_path()
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
fn as_seen(evidence: &Evidence, schedule: &[ScheduledPlateau]) -> Option<Vec<ScheduledPlateau>> {
    let strongest = schedule.iter().max_by(|a, b| a.omega.abs().total_cmp(&b.omega.abs()))?;
    let stretches = evidence.steady_stretches();
    let levels = stretches.iter().map(|stretch| evidence.blocks().level(stretch));
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
    let middle = usize::midpoint(range.start, range.end);
    Stretch {
        window: span(blocks, &range),
        level_z: blocks.level(&range),
        plateau: cores.iter().position(|core| core.contains(&middle)),
        resembles: (0..cores.len()).filter(|k| candidates[*k].has_level(middle)).collect(),
    }
}

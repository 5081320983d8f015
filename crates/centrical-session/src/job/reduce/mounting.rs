//! The mountings of a session side by side, the record of each in two passes: where its plateaus are, then what they read.

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use centrical::reduction::{
    Located, PulseTrain, ReducedMounting, ReductionError, ScheduledPlateau, SpeedTrace, Survey,
};
use centrical::{Experiment, OnProgress};
use centrical_table::{Extent, estimate_rows};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use crate::error::{Error, Instead};
use crate::experiment::{Session, axes_text};
use crate::record::{MemoryBudget, RecordFile, RecordOverview, SampleCache};
use crate::reduced::MountingFindings;

/// A mounting's number, and its plateaus or why they are missing.
type Numbered = (usize, Result<OfRecord, Error>);

/// Hands out the mountings of a session in their order, to as many lanes as their samples fit into memory.
pub(super) struct Scheduler<'a> {
    session: &'a Session,
    progress: OnProgress<'a>,
    budget: MemoryBudget,
    /// The next mounting.
    next: AtomicUsize,
}

impl<'a> Scheduler<'a> {
    /// Begins with the first mounting.
    pub fn new(session: &'a Session, progress: OnProgress<'a>) -> Self {
        Self { session, progress, budget: MemoryBudget::default(), next: AtomicUsize::new(0) }
    }

    /// Reduces all mountings. Where the files do not show their length, the first record is read on all threads, and shows it.
    pub fn run(&self) -> Result<Vec<OfRecord>, Error> {
        let mut done = Vec::new();
        let lanes = match (mountings_in_flight(), self.estimate_samples()) {
            (1, _) => 1,
            (most, Some(samples)) => self.budget.capacity(samples).min(most),
            (most, None) => {
                let mut cache = SampleCache::new(&self.budget);
                done.extend(self.reduce_next(&mut cache));
                cache.capacity().min(most)
            }
        };
        done.par_extend((0..lanes).into_par_iter().flat_map_iter(|_| self.lane()));
        done.sort_by_key(|(number, _)| *number);
        done.into_iter().map(|(_, reduced)| reduced).collect()
    }

    /// Reduces one mounting after the other, with the same memory, to the last.
    fn lane(&self) -> Vec<Numbered> {
        let mut cache = SampleCache::new(&self.budget);
        std::iter::from_fn(|| self.reduce_next(&mut cache)).collect()
    }

    /// Reduces the next mounting; none after the last.
    fn reduce_next(&self, cache: &mut SampleCache) -> Option<Numbered> {
        let count = self.session.mountings.len();
        let number = self.next.fetch_add(1, Ordering::Relaxed);
        let reduced = (number < count).then(|| reduce_mounting(self.session, number, self.progress, cache))?;
        if reduced.is_err() {
            // Those before it are in flight: which error is the first does not depend on the threads.
            self.next.store(count, Ordering::Relaxed);
        }
        Some((number, reduced))
    }

    /// Samples of the longest record, if all files show them.
    fn estimate_samples(&self) -> Option<u64> {
        let numbers = 0..self.session.mountings.len();
        let rows = |number| estimate_rows(self.session.open_record(number).ok()?.first()?);
        let samples = numbers.map(rows);
        samples.collect::<Option<Vec<_>>>()?.into_iter().max()
    }
}

/// Mountings reduced at a time: while one is searched for its plateaus, which threads cannot share well, the other is
/// read. Per-thread buffers grow with the thread count; above two threads only one mounting fits.
fn mountings_in_flight() -> usize {
    if rayon::current_num_threads() > 2 { 1 } else { 2 }
}

/// What the record of a mounting comes down to.
pub(super) struct OfRecord {
    pub reduced: ReducedMounting,
    pub findings: MountingFindings,
}

impl OfRecord {
    /// A mounting whose plateaus are averaged, and what its record shows beside.
    pub fn new(number: usize, survey: &Survey, reduced: ReducedMounting, interpolated: Option<[u64; 3]>) -> Self {
        let findings = MountingFindings {
            overview: RecordOverview::of(number + 1, &survey.extremes().collect::<Vec<_>>()),
            settling_time: reduced.settling_time(),
            agreement: reduced.clock_agreement(),
            interpolated,
            unscheduled: reduced.unscheduled().to_vec(),
        };
        Self { reduced, findings }
    }
}

/// Reduces the record of a mounting, its samples kept in `cache` between the passes.
fn reduce_mounting(
    session: &Session,
    number: usize,
    progress: OnProgress,
    cache: &mut SampleCache,
) -> Result<OfRecord, Error> {
    let record = RecordFile::new(session.open_record(number)?, &session.columns, progress);
    let file = session.record_file(number)?;
    let refused = |source| Error::reduction(file, number, source);
    let (survey, interpolated) = record.survey(cache)?;
    let survey = survey.with_resolution(session.type_b.resolution);
    let pulses = if session.speeds.counts_pulses() { session.pulses(number, Extent::Whole)? } else { None };
    let speeds = ShownSpeeds { telemetry: session.telemetry(number, Extent::Whole)?, pulses };
    let located = located(session, number, file, &survey, &speeds)?;
    let means = record.means(cache, &located)?.into_iter().collect::<Result<_, _>>().map_err(refused)?;
    Ok(OfRecord::new(number, &survey, ReducedMounting::new(located, means), interpolated))
}

/// What shows the speeds of a mounting.
#[derive(Default)]
pub(crate) struct ShownSpeeds {
    pub telemetry: Option<SpeedTrace>,
    pub pulses: Option<PulseTrain>,
}

impl ShownSpeeds {
    /// Takes the speeds of the plateaus from the pulses, otherwise from the telemetry.
    pub fn time(&self, located: &mut Located) {
        if let Some(telemetry) = &self.telemetry {
            located.time_telemetry(telemetry);
        }
        if let Some(pulses) = &self.pulses {
            located.time_pulses(pulses);
        }
    }
}

/// Finds the plateaus of a mounting in the survey of its record, with the speeds that are shown.
///
/// # Errors
/// [`Error`] names the `file` and, where a plateau is missing, what the record fits instead.
pub(crate) fn located(
    session: &Session,
    number: usize,
    file: &Path,
    survey: &Survey,
    speeds: &ShownSpeeds,
) -> Result<Located, Error> {
    let located = survey.locate(&ScheduledPlateau::of_mounting(&session.experiment, number));
    let mut located = located.map_err(|source| {
        let instead = fits_instead(session, number, survey, &source);
        Error::reduction(file, number, source).with_instead(instead)
    })?;
    speeds.time(&mut located);
    Ok(located)
}

/// What else has all plateaus of a record that was refused by its levels: another mounting of its session, another place, or another attitude; of
/// several the likeliest.
fn fits_instead(session: &Session, number: usize, survey: &Survey, refused: &ReductionError) -> Option<Instead> {
    if !matches!(refused, ReductionError::PlateauNotFound { .. } | ReductionError::Mistaken { .. }) {
        return None;
    }
    let experiment = &session.experiment;
    let likelihood = |schedule: Vec<ScheduledPlateau>| survey.locate(&schedule).ok()?.log_likelihood();
    let all = mountings(experiment, number).chain(places(experiment, number)).chain(attitudes(experiment, number));
    let fit = all.filter_map(|(instead, schedule)| Some((instead, likelihood(schedule)?)));
    let likelier = |best: (Instead, f64), next: (Instead, f64)| if next.1 > best.1 { next } else { best };
    fit.reduce(likelier).map(|(instead, _)| instead)
}

/// The first mounting of a session in each other position and place, with its plateaus.
fn mountings(experiment: &Experiment, number: usize) -> impl Iterator<Item = (Instead, Vec<ScheduledPlateau>)> {
    let all = &experiment.mountings;
    let is_other = move |k: usize| all[k] != all[number] && !all[..k].contains(&all[k]);
    all.iter().enumerate().filter(move |(k, _)| is_other(*k)).map(|(other, mounting)| {
        let position = experiment.positions[mounting.position].id.clone();
        let instead = Instead::Mounting { number: other + 1, position, arm: mounting.arm_y.into() };
        (instead, ScheduledPlateau::of_mounting(experiment, other))
    })
}

/// The other places of a session, with the plateaus that a mounting would have there.
fn places(experiment: &Experiment, number: usize) -> impl Iterator<Item = (Instead, Vec<ScheduledPlateau>)> {
    let all = &experiment.mountings;
    let is_first = move |k: usize| !all[..k].iter().any(|before| before.arm_y == all[k].arm_y);
    let others = (0..all.len()).filter(move |k| is_first(*k) && all[*k].arm_y != all[number].arm_y);
    others.map(move |other| {
        let arm_y = all[other].arm_y;
        let mut experiment = experiment.clone();
        experiment.mountings[number].arm_y = arm_y;
        (Instead::Arm { arm: arm_y.into() }, ScheduledPlateau::of_mounting(&experiment, number))
    })
}

/// The 24 attitudes with every instrument axis along an arm axis, with the plateaus that a mounting would have in them.
fn attitudes(experiment: &Experiment, number: usize) -> impl Iterator<Item = (Instead, Vec<ScheduledPlateau>)> {
    let along = |k: usize| Vector3::ith(k / 2, if k.is_multiple_of(2) { 1.0 } else { -1.0 });
    let pairs = (0..36).map(move |k| (along(k / 6), along(k % 6))).filter(|(first, second)| first.dot(second) == 0.0);
    pairs.map(move |(first, second)| {
        let rows = [first, second, first.cross(&second)];
        let p_zy = Matrix3::from_rows(&rows.map(|row| row.transpose()));
        let mut experiment = experiment.clone();
        let position = experiment.mountings[number].position;
        experiment.positions[position].p_zy = p_zy;
        let axes = axes_text(&rows.map(|row| (row.iamax(), row.sum())));
        (Instead::Attitude { axes }, ScheduledPlateau::of_mounting(&experiment, number))
    })
}

#[cfg(test)]
mod tests {
    use std::fs::{self, File};
    use std::path::PathBuf;

    use centrical::unwatched;
    use flate2::{Compression, write::GzEncoder};

    use super::*;

    /// A record read once, again by its index, and again from start to end.
    #[test]
    fn plateaus_are_the_same_from_the_cache_or_read_again() {
        let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/ta-200");
        let mut session = Session::read(&example).unwrap();
        let plain = session.record_file(0).unwrap().to_owned();
        let folder = tempfile::tempdir().unwrap();
        let packed = folder.path().join("m01.csv.gz");
        let mut encoder = GzEncoder::new(File::create(&packed).unwrap(), Compression::fast());
        std::io::copy(&mut fs::File::open(&plain).unwrap(), &mut encoder).unwrap();
        encoder.finish().unwrap();
        let mut reduced = |file: &PathBuf, bytes: usize| {
            session.mountings[0].records = vec![file.clone()];
            let budget = MemoryBudget::of(bytes);
            let mounting = reduce_mounting(&session, 0, &unwatched, &mut SampleCache::new(&budget)).unwrap();
            (format!("{:?}", mounting.reduced), mounting.findings)
        };
        let cached = reduced(&plain, 1 << 30);
        assert!(reduced(&plain, 0) == cached && reduced(&packed, 0) == cached && reduced(&packed, 1 << 30) == cached);
    }
}

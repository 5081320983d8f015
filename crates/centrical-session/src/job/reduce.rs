//! From a session's files to plateau means: the part of the work that is proportional to the data.

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use centrical::linear;
use centrical::reduction::{
    Averaging, Located, NoiseModel, PlateauFit, RecordSlice, ReducedMounting, ReductionError, ScheduledPlateau, Survey,
    locate, plateau_means,
};
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

use crate::error::Error;
use crate::experiment::Session;
use crate::record::{Input, Kept, RecordFile, RecordOverview, Room, Windows};
use crate::reduced::{MountingFindings, Reduced, ReducedPlateau};

/// Reads and reduces the records of a session, or takes its plateau table. `progress` is told of bytes of records as
/// they are read, from any thread, twice of nearly each; the outcome does not depend on the number of threads.
///
/// # Errors
/// [`Error`] naming the file, the place, what was found and what was expected.
pub fn reduce(session: &Session, progress: &(dyn Fn(u64) + Sync)) -> Result<Reduced, Error> {
    let mut reduced = reduce_without_inputs(session, progress)?;
    let folder = session.file.parent().unwrap_or(Path::new(""));
    let inputs = session.files().into_par_iter().map(|file| Input::of(folder, file));
    reduced.inputs = inputs.collect::<Result<_, _>>()?;
    Ok(reduced)
}

/// The same without the hashes of the files, where nobody asks for them.
///
/// # Errors
/// As [`reduce`].
pub fn reduce_without_inputs(session: &Session, progress: &(dyn Fn(u64) + Sync)) -> Result<Reduced, Error> {
    match &session.plateaus {
        Some(table) => Ok(Reduced::of_table(&table.rows)),
        None => from_records(session, progress),
    }
}

/// The mountings, then the noise of all of them together, then the covariances.
fn from_records(session: &Session, progress: &(dyn Fn(u64) + Sync)) -> Result<Reduced, Error> {
    let mountings = by_few_threads(|| all_mountings(session, progress))?;
    let (reduced, records): (Vec<ReducedMounting>, Vec<RecordOverview>) = mountings.into_iter().unzip();
    let noise = NoiseModel::pool(&reduced);
    let means = reduced.iter().flat_map(|mounting| plateau_means(mounting, &noise));
    let findings =
        |m: &ReducedMounting| MountingFindings { settling_time: m.settling_time(), clock_offset: m.clock_offset() };
    Ok(Reduced {
        plateaus: means.map(ReducedPlateau::from).collect(),
        mountings: reduced.iter().map(findings).collect(),
        records,
        held_out: Vec::new(),
        inputs: Vec::new(),
    })
}

/// Does a work on so many threads that they have enough to do, or on fewer if there are not so many: each holds some MB that it
/// has worked with, and a batch of pieces does not give work to more.
fn by_few_threads<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    const FEW: usize = 6;
    let few = (rayon::current_num_threads() > FEW).then(|| ThreadPoolBuilder::new().num_threads(FEW).build());
    match few {
        Some(Ok(few)) => few.install(work),
        // Without more threads there is still this one.
        _ => work(),
    }
}

/// Mountings under way at a time: while one is searched for its plateaus, which threads cannot share well, the other is
/// read. What every thread holds beside grows with their number: more of them have room for one mounting.
fn at_a_time() -> usize {
    if rayon::current_num_threads() > 2 { 1 } else { 2 }
}

/// As many mountings side by side as there is room for. Where the files do not tell at a glance, the first record is read
/// on all threads, and tells.
fn all_mountings(
    session: &Session,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Vec<(ReducedMounting, RecordOverview)>, Error> {
    let count = session.experiment.mountings.len();
    if count == 0 {
        return Ok(Vec::new());
    }
    let room = Room::default();
    let mut kept = Kept::new(&room);
    let (begun, lanes) = if at_a_time() == 1 {
        (None, 1)
    } else if let Some(rows) = most_rows_at_a_glance(session) {
        (None, room.holds(rows).min(at_a_time()))
    } else {
        let first = Mounting::of(session, 0, progress)?;
        let survey = first.record.survey(&mut kept)?;
        (Some((first, survey)), kept.fit_in().min(at_a_time()))
    };
    let next = AtomicUsize::new(usize::from(begun.is_some()));
    let lane = |(mut kept, begun): (Kept, Option<(Mounting, Survey)>)| {
        let mut done: Vec<_> = begun.map(|(first, survey)| (0, first.reduced(&survey, &kept))).into_iter().collect();
        loop {
            if done.iter().any(|(_, reduced)| reduced.is_err()) {
                // Those before it are under way: which error is the first does not depend on the threads.
                next.store(count, Ordering::Relaxed);
            }
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= count {
                return done;
            }
            let reduced = Mounting::of(session, number, progress)
                .and_then(|mounting| mounting.reduced(&mounting.record.survey(&mut kept)?, &kept));
            done.push((number, reduced));
        }
    };
    let others = (1..lanes).map(|_| (Kept::new(&room), None));
    let lanes: Vec<_> = std::iter::once((kept, begun)).chain(others).collect();
    let mut reduced: Vec<_> = lanes.into_par_iter().map(lane).collect::<Vec<_>>().into_iter().flatten().collect();
    reduced.sort_by_key(|(number, _)| *number);
    reduced.into_iter().map(|(_, reduced)| reduced).collect()
}

/// Samples of the longest record, if all files tell at a glance.
fn most_rows_at_a_glance(session: &Session) -> Option<u64> {
    let count = session.experiment.mountings.len();
    let rows = (0..count).map(|number| centrical_table::rows_at_a_glance(session.record_file(number).ok()?));
    rows.collect::<Option<Vec<_>>>()?.into_iter().max()
}

/// A mounting and its record.
struct Mounting<'a> {
    session: &'a Session,
    number: usize,
    record: RecordFile<'a>,
}

impl<'a> Mounting<'a> {
    fn of(session: &'a Session, number: usize, progress: &'a (dyn Fn(u64) + Sync)) -> Result<Self, Error> {
        let record = RecordFile::new(session.record_file(number)?, &session.columns, progress);
        Ok(Self { session, number, record })
    }

    /// The record being surveyed: where the plateaus are and, by the samples that are kept or the record once more, what they read.
    fn reduced(&self, survey: &Survey, kept: &Kept) -> Result<(ReducedMounting, RecordOverview), Error> {
        let Self { session, number, record } = self;
        let experiment = &session.experiment;
        let schedule: Vec<ScheduledPlateau> = (experiment.set_points.iter())
            .filter(|set_point| set_point.mounting == *number)
            .map(|set_point| ScheduledPlateau {
                omega: set_point.omega,
                nominal_z: linear::nominal(experiment, set_point),
            })
            .collect();
        let file = record.file();
        let refused =
            |source| Error::Reduction { file: file.to_owned(), mounting: number + 1, source: Box::new(source) };
        let telemetry = session.telemetry(*number)?;
        let located = locate(survey, telemetry.as_ref(), &schedule).map_err(refused)?;
        let averaged = record.windows(kept, &&located)?;
        let averaged = averaged.into_iter().collect::<Result<_, _>>().map_err(refused)?;
        let overview = RecordOverview::of(number + 1, &survey.extremes().collect::<Vec<_>>());
        Ok((ReducedMounting::new(located, averaged), overview))
    }
}

/// A plateau under way, or what was wrong with it.
impl<'a> Windows for &'a Located {
    type Window = Result<Averaging<'a>, ReductionError>;
    type Mean = Result<PlateauFit, ReductionError>;

    fn parts(&self) -> Vec<Vec<[f64; 2]>> {
        (0..self.windows().len()).map(|plateau| Located::parts(self, plateau)).collect()
    }

    fn begin(&self, window: usize) -> Self::Window {
        Ok(Averaging::new(self, window))
    }

    fn add(&self, window: &mut Self::Window, part: [f64; 2], samples: RecordSlice, repeated: usize) {
        let added = window.as_mut().map(|plateau| plateau.add(part, samples, repeated));
        if let Ok(Err(error)) = added {
            *window = Err(error);
        }
    }

    fn end(&self, window: Self::Window) -> Self::Mean {
        window.and_then(Averaging::finish)
    }
}

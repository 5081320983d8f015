//! From a session's files to plateau means: the part of the work that is proportional to the data.

mod in_memory;
mod mounting;
mod own_readings;
mod rests;

use std::borrow::Cow;

use centrical::OnProgress;
use centrical::reduction::{MeasuredSpeed, NoiseModel, PlateauMean, ReducedMounting};
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

pub use self::in_memory::Recorded;
use self::in_memory::reduce_mountings;
use self::mounting::{OfRecord, Scheduler};
pub(crate) use self::mounting::{ShownSpeeds, located};
use self::own_readings::refuse_shared_readings;
pub(crate) use self::own_readings::{refuse_copies, refuse_repeated_rests};
pub(crate) use self::rests::{find_rests, is_of_gravity, mean_size, with_all_rests};
use crate::error::{Error, Place};
use crate::experiment::Session;
use crate::record::Input;
use crate::reduced::{MountingFindings, Reduced, ReducedPlateau};
use crate::units::rpm;

/// A measured speed farther than this from the one that was set, relative, is in another unit. The record bears out the
/// schedule better than that, or its plateaus would not be found.
const OTHER_UNIT: f64 = 0.1;

/// Reads and reduces the records of a session, or takes its plateau table. The session that comes back has the rests that were
/// found in its records, and is the one to which the means belong. `progress` is called with the number of bytes read, from any
/// thread; most bytes are read twice. The outcome does not depend on the number of threads.
///
/// # Errors
/// [`Error`] naming the file, the place, what was found and what was expected.
pub fn reduce<'s>(session: &'s Session, progress: OnProgress) -> Result<(Cow<'s, Session>, Reduced), Error> {
    let before = session.folder.marks().and(session.files());
    let (session, mut reduced) = reduce_without_inputs(session, progress)?;
    let folder = &session.folder;
    let input = |file| Input::of(folder.path(), &folder.open(file, Input::EXPECTED)?, progress);
    let inputs = session.files().into_par_iter().map(input);
    reduced.inputs = inputs.collect::<Result<_, _>>()?;
    before.refuse_changed()?;
    refuse_shared_readings(&session, &reduced)?;
    let mut files_of_rests = session.rest_tables.iter().filter_map(|table| table.files().next());
    refuse_repeated_rests(&session, &reduced, files_of_rests.next_back().unwrap_or(&session.file))?;
    Ok((session, reduced))
}

/// The same without the hashes of the files, where nobody asks for them.
///
/// # Errors
/// As [`reduce`].
pub fn reduce_without_inputs<'s>(
    session: &'s Session,
    progress: OnProgress,
) -> Result<(Cow<'s, Session>, Reduced), Error> {
    session.refuse_planned_rests()?;
    let reduced = match &session.plateaus {
        Some(table) => Reduced::of_table(&table.rows),
        None if session.mountings.is_empty() => Reduced::default(),
        None => pooled(session, with_thread_limit(|| Scheduler::new(session, progress).run())?)?,
    };
    let (session, rests) = with_all_rests(session, progress)?;
    Ok((session, reduced.with_rests(rests)))
}

/// Reduces the mountings of a session from memory, one of `recorded` for each; the numbers are those of [`reduce`] on files with
/// the same values. The session that comes back has the rests that were found in its records, which are files. `progress` is
/// called with the number of mountings reduced.
///
/// # Errors
/// [`Error`] naming the mounting, what was found and what was expected; [`Error::Stopped`].
pub fn reduce_recorded<'s>(
    session: &'s Session,
    recorded: Vec<Recorded>,
    progress: OnProgress<usize>,
) -> Result<(Cow<'s, Session>, Reduced), Error> {
    session.refuse_planned_rests()?;
    let reduced = pooled(session, reduce_mountings(session, recorded, progress)?)?;
    let (session, rests) = with_all_rests(session, &|_| progress(0))?;
    Ok((session, reduced.with_rests(rests)))
}

/// Does some work on a limited number of threads: each holds some MB that it has worked with, and a batch of pieces does not
/// occupy more.
fn with_thread_limit<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    const LIMIT: usize = 6;
    let few = (rayon::current_num_threads() > LIMIT).then(|| ThreadPoolBuilder::new().num_threads(LIMIT).build());
    match few {
        Some(Ok(few)) => few.install(work),
        // If no pool can be made, this thread remains.
        _ => work(),
    }
}

/// From the mountings to the noise of all of them together, then to the covariances.
fn pooled(session: &Session, mountings: Vec<OfRecord>) -> Result<Reduced, Error> {
    let (reduced, mountings): (Vec<ReducedMounting>, Vec<MountingFindings>) =
        mountings.into_iter().map(|mounting| (mounting.reduced, mounting.findings)).unzip();
    let noise = NoiseModel::pool(&reduced);
    let means: Vec<Vec<PlateauMean>> = reduced.iter().map(|mounting| mounting.means(&noise)).collect();
    refuse_copies(session, means.len(), &|| Cow::Borrowed(&means))?;
    let experiment = &session.experiment;
    let on_arm = experiment.set_points.iter().filter(|set_point| experiment.is_on_arm(set_point.mounting));
    let set: Vec<f64> = on_arm.map(|set_point| set_point.omega).collect();
    let speeds = MeasuredSpeed::of_all(&set, &reduced);
    refuse_other_units(session, &speeds)?;
    Ok(Reduced {
        speeds,
        plateaus: means.into_iter().flatten().map(ReducedPlateau::from).collect(),
        mountings,
        ..Reduced::default()
    })
}

/// Refuses measured speeds that cannot be those of the plateaus: a wrong unit, or a wrong number of pulses.
fn refuse_other_units(session: &Session, speeds: &[Option<MeasuredSpeed>]) -> Result<(), Error> {
    if !session.speeds.is_in_files() {
        return Ok(());
    }
    let pairs =
        session.experiment.set_points.iter().zip(speeds).filter_map(|(set, speed)| Some((set, speed.as_ref()?)));
    let Some((set, speed)) =
        pairs.into_iter().find(|(set, speed)| (speed.speed / set.omega.abs() - 1.0).abs() > OTHER_UNIT)
    else {
        return Ok(());
    };
    let of_mounting = session.mountings.get(set.mounting);
    let file = of_mounting.and_then(|m| m.pulses.as_deref().or(m.telemetry.as_deref())).unwrap_or(&session.file);
    let found = format!("{:.2} rpm", rpm(speed.speed));
    let expected = format!(
        "about {:.2} rpm, the speed that is set (speed_unit in [columns], pulses_per_revolution in [centrifuge])",
        rpm(set.omega.abs())
    );
    Err(Error::content(file, Place::Whole, found, expected))
}

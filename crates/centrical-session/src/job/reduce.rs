//! From a session's files to plateau means: the part of the work that is proportional to the data.

mod in_memory;
mod mounting;
mod own_readings;
mod pooling;
mod rests;

use std::borrow::Cow;

use centrical::OnProgress;
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

pub use self::in_memory::{Recorded, reduce_recorded};
use self::mounting::Scheduler;
pub(crate) use self::mounting::{ShownSpeeds, located};
use self::own_readings::refuse_shared_readings;
pub(crate) use self::own_readings::{refuse_copies, refuse_repeated_rests};
use self::pooling::pooled;
pub(crate) use self::rests::{find_rests, is_of_gravity, mean_size, with_all_rests};
use crate::error::Error;
use crate::experiment::Session;
use crate::record::Input;
use crate::reduced::Reduced;

/// Reads and reduces the records of a session, or takes its plateau table. The session that comes back has the rests that were
/// found in its records, and is the one to which the means belong. `progress` is called with the number of bytes read, from any
/// thread; most bytes are read twice. The outcome does not depend on the number of threads.
///
/// # Errors
/// [`Error`] naming the file, the place, what was found and what was expected.
pub fn reduce<'s>(session: &'s Session, progress: OnProgress) -> Result<(Cow<'s, Session>, Reduced), Error> {
    let (session, mut reduced) = reduce_without_inputs(session, progress)?;
    let folder = &session.folder;
    let input = |file| Input::of(folder.path(), &folder.open(file, Input::EXPECTED)?, progress);
    let inputs = session.files().into_par_iter().map(input);
    reduced.inputs = inputs.collect::<Result<_, _>>()?;
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
        None if session.mountings.is_empty() => Reduced::of_table(&[]),
        None => from_records(session, progress)?,
    };
    let (session, rests) = with_all_rests(session, progress)?;
    Ok((session, reduced.with_rests(rests)))
}

fn from_records(session: &Session, progress: OnProgress) -> Result<Reduced, Error> {
    pooled(session, with_thread_limit(|| Scheduler::new(session, progress).run())?)
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

//! A mounting's record in two passes: where its plateaus are, then what they read.

use std::path::Path;

use centrical::OnProgress;
use centrical::reduction::{Located, PulseTrain, ReducedMounting, ScheduledPlateau, SpeedTrace, Survey};

use super::instead::fits_instead;
use crate::error::Error;
use crate::experiment::{Session, SpeedSource};
use crate::record::{RecordFile, RecordOverview, SampleCache};

/// What the record of a mounting comes down to.
pub(super) struct OfRecord {
    pub reduced: ReducedMounting,
    pub overview: RecordOverview,
    /// Readings of newtonometers 1, 2, 3 that were interpolated to the stamps of another one, if their files have stamps of their own.
    pub interpolated: Option<[u64; 3]>,
}

/// Reduces the record of a mounting, its samples kept in `cache` between the passes.
pub(super) fn reduce_mounting(
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
    let speeds = ShownSpeeds { telemetry: session.telemetry(number)?, pulses: counted_pulses(session, number)? };
    let located = located(session, number, file, &survey, &speeds)?;
    let means = record.means(cache, &located)?.into_iter().collect::<Result<_, _>>().map_err(refused)?;
    let overview = RecordOverview::of(number + 1, &survey.extremes().collect::<Vec<_>>());
    Ok(OfRecord { reduced: ReducedMounting::new(located, means), overview, interpolated })
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

/// The pulses of a mounting, where they measure the speed.
fn counted_pulses(session: &Session, number: usize) -> Result<Option<PulseTrain>, Error> {
    if counts_pulses(session) { session.pulses(number) } else { Ok(None) }
}

/// Whether pulses measure the speed.
pub(super) fn counts_pulses(session: &Session) -> bool {
    session.speeds.measured.is_some_and(|measured| measured.source == SpeedSource::Pulses)
}

#[cfg(test)]
mod tests {
    use std::fs::{self, File};
    use std::path::PathBuf;

    use centrical::unwatched;
    use flate2::{Compression, write::GzEncoder};

    use super::*;
    use crate::record::MemoryBudget;

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
            session.mountings[0].record = Some(file.clone());
            let budget = MemoryBudget::of(bytes);
            let mounting = reduce_mounting(&session, 0, &unwatched, &mut SampleCache::new(&budget)).unwrap();
            (format!("{:?}", mounting.reduced), mounting.overview)
        };
        let cached = reduced(&plain, 1 << 30);
        assert!(reduced(&plain, 0) == cached && reduced(&packed, 0) == cached && reduced(&packed, 1 << 30) == cached);
    }
}

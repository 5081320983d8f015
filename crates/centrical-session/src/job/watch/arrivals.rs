//! Which plateaus of a session folder are complete while the laboratory is still adding records.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, SystemTime};

use centrical::Observation;
use centrical::reduction::{
    MeasuredSpeed, NoiseModel, Record, ReducedMounting, ReductionError, ScheduledPlateau, Survey,
};
use centrical_table::Extent;

use super::changed::{over, reads_otherwise};
use super::growth::Growth;
use super::note::Note;
use super::quiet::{Quiet, Sight, until};
use super::rests;
use crate::error::Error;
use crate::experiment::{Session, SpeedSource};
use crate::job::reduce::{ShownSpeeds, located, refuse_copies};

/// A session folder that is looked into again and again.
///
/// A plateau is complete when a different plateau of its schedule has begun after it, or when the record of its mounting is
/// finished. A record is finished after the quiet time, or when it shows its whole schedule and a record of a later mounting
/// exists. Plateaus that read alike, such as rests, follow each other unseen: a piece of one would pass for the next.
#[derive(Debug, Clone)]
pub struct Watch<'s> {
    session: &'s Session,
    quiet: Quiet,
    /// Whether the rests in attitudes of their own have come.
    has_rests: bool,
    /// Mountings whose plateaus have all come.
    finished: Vec<ReducedMounting>,
    /// What their records looked like when they were read, and the last time.
    taken: Vec<[Look; 2]>,
    /// The plateaus that have come, by set point, as they read then.
    arrived: BTreeMap<usize, Observation>,
    /// Measured speeds of the plateaus that have come, by set point.
    speeds: BTreeMap<usize, MeasuredSpeed>,
    /// Plateaus of the mounting after them that have come.
    come: usize,
    /// What the record of that mounting looked like the last time.
    seen: Option<Look>,
    /// The record of that mounting, or of the one before until it comes.
    growth: Option<Growth>,
    /// The telemetry, or the pulses, that has not come or is not whole yet.
    awaited_speeds: Option<PathBuf>,
    note: Option<Note>,
}

/// What a record looks like from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Look {
    bytes: u64,
    written: Option<SystemTime>,
    /// Unchanged for the time called quiet: what it is now it stays.
    left_alone: bool,
    /// A later mounting has a record: this one grows no more, but what was written may still be on its way.
    followed: bool,
}

impl Look {
    /// Whether the record was not written to between two looks.
    fn is_as(&self, other: &Self) -> bool {
        (self.bytes, self.written) == (other.bytes, other.written)
    }
}

impl<'s> Watch<'s> {
    /// Before the first look at the records of `session`, or before the only one.
    pub fn new(session: &'s Session, quiet: Duration, looks_once: bool) -> Self {
        Self::having_seen(session, Quiet::new(quiet, looks_once))
    }

    /// The same after an earlier watch has seen its files.
    pub(super) fn having_seen(session: &'s Session, quiet: Quiet) -> Self {
        Self {
            session,
            quiet,
            has_rests: false,
            finished: Vec::new(),
            taken: Vec::new(),
            arrived: BTreeMap::new(),
            speeds: BTreeMap::new(),
            come: 0,
            seen: None,
            growth: None,
            awaited_speeds: None,
            note: None,
        }
    }

    /// What it has seen of files.
    pub(super) fn quiet(&mut self) -> &mut Quiet {
        &mut self.quiet
    }

    /// Whether all plateaus of the schedule have come, with the telemetry, and all rests in attitudes of their own.
    pub fn is_complete(&self) -> bool {
        self.has_arm() && self.awaited_speeds.is_none() && rests::awaited(self.session).is_none()
    }

    /// Whether all plateaus on the arm have come.
    fn has_arm(&self) -> bool {
        self.session.plateaus.is_some() && self.come > 0 || self.finished.len() == self.session.mountings.len()
    }

    /// What is waited for, if something is.
    pub fn note(&self) -> Option<String> {
        self.note.as_ref().map(Note::text)
    }

    /// The file that is waited for, if the note is of one.
    pub fn awaited(&self) -> Option<&Path> {
        self.note.as_ref().and_then(Note::awaited)
    }

    /// What a look would find if a record that has just changed counted as finished, for who looks only once.
    pub fn without_quiet(&self, stop: &AtomicBool) -> Option<String> {
        let quiet = Quiet::new(Duration::ZERO, true);
        let mut hasty = Self { quiet, seen: None, note: None, ..self.clone() };
        let changed = format!("records changed within the last {} s; with --quiet 0", self.quiet.after.as_secs_f64());
        match hasty.look(stop) {
            Ok(more) => {
                let plateaus = match more.len() {
                    0 => None,
                    1 => Some("1 more plateau would count as arrived".to_owned()),
                    count => Some(format!("{count} more plateaus would count as arrived")),
                };
                let end = hasty.is_complete().then(|| "the schedule would be complete".to_owned());
                let would: Vec<String> = plateaus.into_iter().chain(end).collect();
                (!would.is_empty()).then(|| format!("{changed}, {}", would.join(", and ")))
            }
            Err(error) => Some(format!("{changed}, they would be refused: {error}")),
        }
    }

    /// The measured speed of a plateau that has come, where speeds are measured and the telemetry or the pulses had come too.
    pub fn speed(&self, set_point: usize) -> Option<MeasuredSpeed> {
        self.speeds.get(&set_point).copied()
    }

    /// The record of the mounting on the arm as it stands, or the last one.
    pub fn growth(&self) -> Option<&Growth> {
        self.growth.as_ref()
    }

    /// Measured speeds of the plateaus that have come, by set point.
    pub fn speeds(&self) -> &BTreeMap<usize, MeasuredSpeed> {
        &self.speeds
    }

    /// Plateaus that have come since the last look: rests in attitudes of their own, with the first look, and those on the arm in the order of
    /// the schedule, each with the noise of its own and the earlier mountings. Those of a record that was replaced come again if they read
    /// otherwise. A record that cannot be made out and has not been left alone yet is waited for, with a [`Watch::note`]. Where `stop` is
    /// raised, the record that is read and those after it wait for another look.
    ///
    /// # Errors
    /// [`Error`] when a record that has been left alone is wrong.
    pub fn look(&mut self, stop: &AtomicBool) -> Result<Vec<Observation>, Error> {
        let mut arrivals = if self.has_rests { Vec::new() } else { rests::observations(self.session) };
        self.has_rests = true;
        if let Some(table) = &self.session.plateaus {
            let fresh = table.rows.iter().enumerate().skip(self.come);
            arrivals.extend(fresh.map(|(set_point, row)| row.observation(set_point)));
            self.come = table.rows.len();
        } else {
            self.look_at_finished(stop, &mut arrivals)?;
            let is_wanted = |finished: usize| finished < self.session.mountings.len() && !stop.load(Ordering::Relaxed);
            while is_wanted(self.finished.len()) && self.look_at_current(stop, &mut arrivals)? {}
            let telemetry = self.session.mountings.iter().flat_map(|m| m.telemetry.iter().chain(&m.pulses));
            self.awaited_speeds = self.quiet.awaited(telemetry);
        }
        let awaited = self.awaited_speeds.as_ref().or_else(|| rests::awaited(self.session));
        if let Some(file) = awaited.filter(|_| self.has_arm()) {
            self.note = Some(Note::WaitingFor(file.to_owned()));
        }
        let arrived = &mut self.arrived;
        arrivals.retain(|now| arrived.get(&now.set_point).is_none_or(|before| reads_otherwise(before, now)));
        arrived.extend(arrivals.iter().map(|now| (now.set_point, now.clone())));
        Ok(arrivals)
    }

    /// Reads finished records again that were replaced since, once they look the same twice or have been left alone.
    fn look_at_finished(&mut self, stop: &AtomicBool, arrivals: &mut Vec<Observation>) -> Result<(), Error> {
        for mounting in 0..self.finished.len() {
            // While it is replaced it may be gone for a moment.
            let Some((look, _)) = self.look_of(mounting) else { continue };
            let [taken, last] = self.taken[mounting];
            if look.is_as(&taken) {
                continue;
            }
            self.taken[mounting][1] = look;
            if !look.left_alone && !look.is_as(&last) {
                continue;
            }
            match self.read(mounting, look, stop).and_then(|record| self.whole(mounting, &record)) {
                Err(Error::Stopped(_)) => return Ok(()),
                Err(error) if !look.left_alone || self.quiet.may_pass(&error) => {
                    self.note = Some(Note::NotYet(error.to_string()));
                }
                Err(error) => return Err(error),
                Ok((reduced, _)) => {
                    self.finished[mounting] = reduced.clone();
                    self.taken[mounting] = [look; 2];
                    self.note_speeds(mounting, &reduced);
                    arrivals.extend(self.observations(mounting, &reduced));
                    self.refuse_copies()?;
                }
            }
        }
        Ok(())
    }

    /// Looks at the record of the first mounting that is not finished; whether it is now.
    fn look_at_current(&mut self, stop: &AtomicBool, arrivals: &mut Vec<Observation>) -> Result<bool, Error> {
        let mounting = self.finished.len();
        let Some(file) = self.session.mountings[mounting].records.first() else {
            // The error of a session that names no record.
            return self.session.record(mounting).map(|_| false);
        };
        let Some((look, sight)) = self.look_of(mounting) else {
            self.note = Some(Note::WaitingFor(file.to_owned()));
            return Ok(false);
        };
        match &mut self.growth {
            Some(growth) if growth.mounting == mounting => growth.look_again(sight),
            growth => *growth = Some(Growth::new(mounting, file, sight)),
        }
        if self.seen == Some(look) {
            return Ok(false);
        }
        if self.seen.is_some_and(|seen| look.bytes < seen.bytes) {
            // Another record: its plateaus come again.
            self.come = 0;
        }
        self.seen = Some(look);
        self.note = None;
        let finished = look.left_alone || look.followed;
        let reduced = self.read(mounting, look, stop).and_then(|record| {
            self.quiet.was_read();
            if let Some(growth) = &mut self.growth {
                growth.show(&record);
            }
            if finished { self.whole(mounting, &record).map(Some) } else { self.begun(mounting, &record) }
        });
        match reduced {
            Err(Error::Stopped(_)) => self.seen = None,
            Err(error) if !look.left_alone => self.note = Some(Note::NotYet(error.to_string())),
            Err(error) if self.quiet.may_pass(&error) => {
                (self.seen, self.note) = (None, Some(Note::NotYet(error.to_string())));
            }
            Err(error) => {
                self.note = (!look.followed).then(|| Note::Silent { file: file.to_owned(), after: self.quiet.after });
                return Err(error);
            }
            Ok(None) => {}
            Ok(Some((reduced, complete))) => {
                let scheduled = ScheduledPlateau::of_mounting(&self.session.experiment, mounting).len();
                if let Some(growth) = &mut self.growth {
                    growth.find(&reduced, scheduled);
                }
                self.arrive(mounting, &reduced, complete, arrivals);
                if finished {
                    self.finished.push(reduced);
                    self.taken.push([look; 2]);
                    self.refuse_copies()?;
                    (self.come, self.seen) = (0, None);
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// Refuses a finished record that is a copy of another.
    fn refuse_copies(&self) -> Result<(), Error> {
        refuse_copies(self.session, self.finished.len(), &|| {
            let noise = NoiseModel::pool(&self.finished);
            self.finished.iter().map(|mounting| mounting.means(&noise)).collect()
        })
    }

    /// `None` while there is no record.
    fn look_of(&mut self, mounting: usize) -> Option<(Look, Sight)> {
        let sight = self.quiet.look(&self.session.mountings[mounting].records)?;
        let mut later = self.session.mountings[mounting + 1..].iter().filter_map(|m| m.records.first());
        let followed = later.any(|file| file.exists());
        let Sight { bytes, written, left_alone, .. } = sight;
        Some((Look { bytes, written, left_alone, followed }, sight))
    }

    /// The record of a mounting. Unless it has been left alone a last line without end is not read: it may have come in part.
    fn read(&self, mounting: usize, look: Look, stop: &AtomicBool) -> Result<Record, Error> {
        let extent = if look.left_alone { Extent::Whole } else { Extent::Growing };
        self.session.record_to(mounting, extent, &|_| until(stop))
    }

    /// All plateaus of a finished mounting.
    fn whole(&self, mounting: usize, record: &Record) -> Result<(ReducedMounting, usize), Error> {
        let file = self.record_file(mounting);
        let survey = self.survey(record).map_err(|source| Error::reduction(file, mounting, source))?;
        let located = located(self.session, mounting, file, &survey, &self.shown_speeds(mounting))?;
        let count = located.windows().len();
        let reduced = located.averaged(record.as_slice());
        Ok((reduced.map_err(|source| Error::reduction(file, mounting, source))?, count))
    }

    /// The plateaus that a growing record shows, and how many of them have come to their end.
    fn begun(&self, mounting: usize, record: &Record) -> Result<Option<(ReducedMounting, usize)>, Error> {
        let schedule = ScheduledPlateau::of_mounting(&self.session.experiment, mounting);
        let (survey, speeds) = (self.survey(record), self.shown_speeds(mounting));
        let reduced = |schedule: &[ScheduledPlateau]| {
            let mut located = survey.as_ref().map_err(Clone::clone)?.locate(schedule)?;
            speeds.time(&mut located);
            located.averaged(record.as_slice())
        };
        let mut count = schedule.len();
        while count > 0 {
            match reduced(&schedule[..count]) {
                Ok(reduced) => return Ok(Some((reduced, over(&schedule[..count])))),
                Err(
                    ReductionError::PlateauNotFound { index, .. }
                    | ReductionError::PlateauTooShort { index, .. }
                    | ReductionError::Unsteady { index, .. },
                ) => count = index.min(count - 1),
                Err(ReductionError::TooShort { .. } | ReductionError::TimeStands { .. }) => return Ok(None),
                Err(source) => return Err(Error::reduction(self.record_file(mounting), mounting, source)),
            }
        }
        Ok(None)
    }

    fn survey(&self, record: &Record) -> Result<Survey, ReductionError> {
        Ok(Survey::of(record.as_slice())?.with_resolution(self.session.type_b.resolution))
    }

    /// The speeds that are measured or witnessed, as far as their file has come.
    fn shown_speeds(&self, mounting: usize) -> ShownSpeeds {
        let measured = self.session.speeds.measured;
        // What is not there yet, or not whole, is read when the session is calibrated at its end.
        match measured.map_or(SpeedSource::Telemetry, |measured| measured.source) {
            SpeedSource::Telemetry => {
                let telemetry = self.session.telemetry(mounting, Extent::Growing).ok().flatten();
                ShownSpeeds { telemetry, pulses: None }
            }
            SpeedSource::Pulses => {
                let pulses = self.session.pulses(mounting, Extent::Growing).ok().flatten();
                ShownSpeeds { telemetry: None, pulses }
            }
            SpeedSource::Plateaus => ShownSpeeds::default(),
        }
    }

    /// Notes the measured speeds of a mounting.
    fn note_speeds(&mut self, mounting: usize, reduced: &ReducedMounting) {
        let set_points = self.session.experiment.set_points.iter().enumerate();
        let (there, set): (Vec<usize>, Vec<f64>) =
            set_points.filter(|(_, s)| s.mounting == mounting).map(|(n, s)| (n, s.omega)).unzip();
        let speeds = MeasuredSpeed::of_all(&set, std::slice::from_ref(reduced));
        self.speeds.extend(there.into_iter().zip(speeds).filter_map(|(n, speed)| Some((n, speed?))));
    }

    /// Notes the plateaus among the first `complete` that have not come before.
    fn arrive(&mut self, mounting: usize, reduced: &ReducedMounting, complete: usize, arrivals: &mut Vec<Observation>) {
        if complete <= self.come {
            return;
        }
        self.note_speeds(mounting, reduced);
        arrivals.extend(self.observations(mounting, reduced).into_iter().take(complete).skip(self.come));
        self.come = complete;
    }

    /// The plateaus of a mounting with the noise of all that are known.
    fn observations(&self, mounting: usize, reduced: &ReducedMounting) -> Vec<Observation> {
        let noise = NoiseModel::pool(self.finished.iter().chain([reduced]));
        let means = reduced.means(&noise);
        let set_points = self.session.experiment.set_points.iter().enumerate();
        let there = set_points.filter(|(_, set_point)| set_point.mounting == mounting).map(|(index, _)| index);
        there.zip(means).map(|(set_point, plateau)| plateau.observation(set_point)).collect()
    }

    fn record_file(&self, mounting: usize) -> &Path {
        self.session.mountings[mounting].records.first().map_or(Path::new(""), PathBuf::as_path)
    }
}

//! What is known after a plateau of a watched session, and what the watch shows to whoever looks at it: written after every look at the folder.

use std::path::PathBuf;
use std::time::{Duration, Instant, SystemTime};

use centrical::fit::Progress;
use centrical::uncertainty::{Level, Rivals};
use centrical::{Calibration, Data, FitError, Group, MeasurementModel, Parameter, Study, Weight, unwatched};

use super::arrivals::Watch;
use crate::document::{
    GroupProgress, LIVE_SCHEMA, LiveBenefit, LiveLost, LivePlateau, LiveReport, LiveSpeed, LiveStatus, PlateauLabel,
    RivalSummary, WatchedPlateau, seconds_since_1970,
};
use crate::error::Error;
use crate::experiment::Session;
use crate::units::customary;

/// What is known after a plateau.
#[derive(Debug)]
pub struct WatchProgress<'a> {
    /// The session.
    pub session: &'a Session,
    /// The unknowns.
    pub model: &'a MeasurementModel,
    /// Plateaus that have arrived, in their order.
    pub plateaus: &'a [WatchedPlateau],
    /// What is known.
    pub now: Progress,
    /// The next set point of the schedule, and what will be known after it.
    pub next: Option<(usize, Progress)>,
    /// The most useful plateau that remains in the mounting on the arm, and that of the other mountings: by the mean
    /// uncertainty of the compensated reading with it over that without, which stands beside its set point. Of plateaus that one look finds, the last one has it.
    pub best: Vec<(usize, f64)>,
}

impl WatchProgress<'_> {
    /// The groups of the unknowns in the order of results, beside `targets`: group, and value in its customary unit.
    pub fn groups(&self, targets: &[(String, f64)]) -> Vec<GroupProgress> {
        self.model.parameters().groups().into_iter().map(|group| self.group(group, targets)).collect()
    }

    fn group(&self, group: Group, targets: &[(String, f64)]) -> GroupProgress {
        let of_group: Vec<&Parameter> = self.model.parameters().iter().filter(|p| p.group == group).collect();
        let unknowns = of_group.len();
        let (determined, largest) = largest(self.model, &self.now, group);
        let target = targets.iter().find(|(name, _)| name == group.name()).map(|(_, target)| *target);
        let (scale, unit) = of_group.first().map_or((1.0, ""), |p| customary(&p.unit, group));
        GroupProgress {
            group,
            names: of_group.iter().map(|p| p.name.clone()).collect(),
            unit: unit.to_owned(),
            scale,
            determined,
            unknowns,
            largest,
            target,
            is_met: target.map(|target| determined == unknowns && largest.is_some_and(|u| u <= target)),
            next: self.next.as_ref().and_then(|(_, next)| self::largest(self.model, next, group).1),
        }
    }
}

/// How many of a group are determined, and the largest standard uncertainty of those in the customary unit.
fn largest(model: &MeasurementModel, progress: &Progress, group: Group) -> (usize, Option<f64>) {
    let of_group = model.parameters().iter().zip(&progress.estimates).filter(|(p, _)| p.group == group);
    let uncertainties = of_group.filter_map(|(p, known)| Some(customary(&p.unit, group).0 * (*known)?.1));
    uncertainties.fold((0, None), |(count, most), u| (count + 1, Some(u.max(most.unwrap_or(0.0)))))
}

/// Lost combinations that are written out.
const MOST_LOST: usize = 12;

/// What is shown of a watch, kept from look to look.
#[derive(Debug)]
pub struct Board<'a> {
    session: &'a Session,
    targets: &'a [(String, f64)],
    file: PathBuf,
    frozen_after: Duration,
    report: LiveReport,
    /// The first look of this run and the number of plateaus then; the last look that brought one.
    pace: Option<(Instant, usize, Instant)>,
    /// Mounting whose rivals were tested last.
    tested: Option<usize>,
}

impl<'a> Board<'a> {
    /// Before the first look, for these target standard uncertainties. `file` is where it is written.
    pub fn new(
        session: &'a Session,
        targets: &'a [(String, f64)],
        file: PathBuf,
        interval: Duration,
        frozen_after: Duration,
    ) -> Self {
        let report = LiveReport {
            schema: LIVE_SCHEMA.to_owned(),
            title: session.title.clone(),
            unit_model: session.unit_model.clone(),
            unit_serial: session.unit_serial.clone(),
            interval: interval.as_secs_f64(),
            plateaus: session.experiment.set_points.len(),
            mounting: 1,
            mountings: session.mountings.len(),
            ..LiveReport::default()
        };
        Self { session, targets, file, frozen_after, report, pace: None, tested: None }
    }

    /// Takes up what is known after the last plateau of a look.
    ///
    /// # Errors
    /// [`Error::Fit`] when numbers overflow.
    pub fn show(&mut self, progress: &WatchProgress) -> Result<(), Error> {
        let session = self.session;
        let plateau = |plateau: &WatchedPlateau| LivePlateau {
            plateau: PlateauLabel::of(session, plateau.set_point),
            innovation: plateau.innovation().into(),
            alarm: plateau.alarm,
            held_out: plateau.held_out,
        };
        self.report.arrived = progress.plateaus.len();
        self.report.last = progress.plateaus.last().map(plateau);
        self.report.alarms = progress.plateaus.iter().filter(|plateau| plateau.alarm).map(plateau).collect();
        self.report.rank = progress.now.rank;
        self.report.unknowns = progress.model.parameters().len();
        self.report.groups = progress.groups(self.targets);
        self.report.next = progress.next.as_ref().map(|(next, _)| PlateauLabel::of(session, *next));
        let benefit =
            |&(set_point, factor): &(usize, f64)| LiveBenefit { plateau: PlateauLabel::of(session, set_point), factor };
        self.report.best = progress.best.iter().map(benefit).collect();
        let fitted = |source| Error::fit(&session.file, source);
        self.report.lost = lost(progress).map_err(fitted)?;
        let mounting = progress.plateaus.last().map(|last| session.experiment.set_points[last.set_point].mounting);
        let is_whole = progress.now.rank == progress.model.parameters().len();
        // A test of all rivals takes as long as a fit: one a mounting.
        if is_whole && (self.tested != mounting || progress.next.is_none()) {
            self.report.rivals = rivals(progress).map_err(fitted)?;
            self.tested = mounting;
        }
        Ok(())
    }

    /// Notes when plateaus arrive, and so when the schedule will end.
    pub fn pace(&mut self, arrived: usize) {
        let now = Instant::now();
        match &mut self.pace {
            None => self.pace = Some((now, arrived, now)),
            Some((_, _, last)) if arrived > self.report.arrived => *last = now,
            Some(_) => {}
        }
    }

    /// Writes it after a look.
    ///
    /// # Errors
    /// [`Error`] when the folder does not take it.
    pub fn write(&mut self, watch: &Watch, status: LiveStatus) -> Result<(), Error> {
        let session = self.session;
        self.report.record = watch.growth().map(|growth| growth.live(self.frozen_after));
        let mounting = watch.growth().map_or(0, |growth| growth.mounting);
        self.report.mounting = mounting + 1;
        let speed = |(&set_point, speed): (&usize, &centrical::reduction::MeasuredSpeed)| LiveSpeed {
            plateau: PlateauLabel::of(session, set_point),
            measured: speed.speed,
            uncertainty: speed.uncertainty,
        };
        self.report.speeds = watch.speeds().iter().map(speed).collect();
        self.report.ends = self.end();
        self.report.awaited = watch.awaited().map(|file| file.display().to_string());
        self.put(status, watch.note())
    }

    /// Writes it with what the watch does.
    ///
    /// # Errors
    /// [`Error`] when the folder does not take it.
    pub fn write_as(&mut self, status: LiveStatus, note: Option<&str>) -> Result<(), Error> {
        self.report.awaited = None;
        self.put(status, note.map(str::to_owned))
    }

    fn put(&mut self, status: LiveStatus, note: Option<String>) -> Result<(), Error> {
        self.report.status = status;
        self.report.note = note;
        self.report.written = seconds_since_1970(SystemTime::now());
        self.report.write(&self.file)
    }

    /// Notes the verdict of the calibration at the end.
    pub fn judge(&mut self, acceptable: bool) {
        self.report.acceptable = Some(acceptable);
    }

    /// When the schedule ends at the pace of this run; `None` before three plateaus of it.
    fn end(&self) -> Option<f64> {
        let (begun, before, last) = self.pace?;
        let come = self.report.arrived.checked_sub(before).filter(|come| *come >= 3)?;
        let left = self.report.plateaus - self.report.arrived;
        let each = (last - begun).as_secs_f64() / come as f64;
        // A plateau that takes longer than the others puts the end off.
        let since = last.elapsed().as_secs_f64().min(each);
        Some(seconds_since_1970(SystemTime::now()) - since + each * left as f64)
    }
}

/// What the plateaus so far do not determine, and why.
fn lost(progress: &WatchProgress) -> Result<Vec<LiveLost>, FitError> {
    if progress.now.rank == progress.model.parameters().len() {
        return Ok(Vec::new());
    }
    let taken = progress.plateaus.iter().filter(|plateau| !plateau.held_out);
    let weights: Vec<Weight> = taken.map(|plateau| Weight::from(&plateau.observation())).collect();
    let study = Study::at_zero(progress.model.clone(), weights)?;
    let parameters = progress.model.parameters();
    let gravity = progress.session.experiment.site.gravity;
    let reasons = study.reasons();
    let lost = reasons.iter().take(MOST_LOST).map(|reason| LiveLost {
        direction: reason.direction.text(parameters, gravity),
        reason: reason.sentence(&study),
        causes: reason.causes.iter().map(|&cause| cause.into()).collect(),
        of_instrument: reason.of_instrument.iter().map(|&j| parameters[j].name.clone()).collect(),
    });
    Ok(lost.collect())
}

/// Effects outside the model that the residuals of the plateaus so far show.
fn rivals(progress: &WatchProgress) -> Result<Vec<RivalSummary>, FitError> {
    let taken = progress.plateaus.iter().filter(|plateau| !plateau.held_out);
    let data = Data::new(progress.model, taken.map(WatchedPlateau::observation).collect())?;
    let calibration = Calibration::exact(&data)?;
    let suspects = Rivals::of(&calibration, &unwatched)?.suspects(Level::Reported.probability());
    Ok(RivalSummary::all(&suspects, progress.model.experiment()))
}

//! A session that is watched: every plateau is tested, taken up or held out, and kept; the calibration when all have arrived.

use std::collections::HashSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use std::{fs, io};

use centrical::fit::{Follower, Progress};
use centrical::plan::{Criterion, NextPlateau, PlanError};
use centrical::reduction::MeasuredSpeed;
use centrical::{FitError, Group, MeasurementModel, Observation, SetPoint, Weight};
use nalgebra::Vector3;

use super::arrivals::Watch;
use super::board::{Board, WatchProgress};
use super::changed::Changed;
use super::quiet::{Quiet, until, wait};
use super::request::{WatchEnd, WatchEvent, WatchRequest};
use super::rests;
use crate::document::{LiveStatus, WatchState, WatchedPlateau, append_history, keep_history, largest_force};
use crate::error::{Error, Place};
use crate::experiment::{PlateauName, Session};
use crate::job::calibrate::calibrate_watched;

/// A session that is watched: the estimates, and where they are kept.
#[derive(Debug)]
pub(super) struct Following<'a> {
    request: &'a WatchRequest,
    session: &'a Session,
    model: &'a MeasurementModel,
    follower: Follower<'a>,
    next: NextPlateau<'a>,
    state: WatchState,
    /// When the state was written last.
    kept: Instant,
    /// Whether each set point has come.
    come: Vec<bool>,
    /// Plateaus that the user holds out, as set points.
    held_out: Vec<usize>,
    changed: Changed,
    /// What is shown of it, if it is.
    board: Option<Board<'a>>,
}

impl<'a> Following<'a> {
    /// Begins, or goes on from `state`, the one in the folder.
    ///
    /// # Errors
    /// [`Error`] when the request names an unknown group or plateau.
    pub fn resume(
        request: &'a WatchRequest,
        session: &'a Session,
        model: &'a MeasurementModel,
        mut state: WatchState,
    ) -> Result<Self, Error> {
        check_groups(&request.groups, session, model)?;
        // Rests that have not come yet can be held out too.
        let is_known =
            |name: &&PlateauName| name.mounting <= session.mountings.len() || rests::awaited(session).is_none();
        let held_out: Vec<usize> =
            request.hold_out.iter().filter(is_known).map(|name| name.set_point(session)).collect::<Result<_, _>>()?;
        keep_history(&request.out.join(HISTORY_FILE), state.plateaus.len())?;
        // One that has been taken up before is held out from now on.
        state.plateaus.iter_mut().for_each(|plateau| plateau.held_out |= held_out.contains(&plateau.set_point));
        let follower = Follower::resume(model, state.taken(), &state.point, state.reference())
            .map_err(|source| Error::fit(&request.out.join(STATE_FILE), source))?;
        let experiment = &session.experiment;
        let planning = |source| Error::planning(&session.file, source);
        let mut next = NextPlateau::new(model, &Criterion::Reading(largest_force(experiment))).map_err(planning)?;
        let taken: Vec<Weight> = follower.taken().iter().map(Weight::from).collect();
        next.take(&taken).map_err(planning)?;
        let mut come = vec![false; experiment.set_points.len()];
        state.plateaus.iter().for_each(|plateau| come[plateau.set_point] = true);
        let mut following = Self {
            request,
            session,
            model,
            follower,
            next,
            state,
            kept: Instant::now(),
            come,
            held_out,
            changed: Changed::default(),
            board: None,
        };
        following.board = following.first_board()?;
        Ok(following)
    }

    /// What is shown before the first look, if the watch is shown.
    fn first_board(&self) -> Result<Option<Board<'a>>, Error> {
        let request = self.request;
        let Some(live) = &request.live else { return Ok(None) };
        let file = request.out.join(LIVE_FILE);
        let mut board = Board::new(self.session, live, file, request.interval, request.frozen);
        if let Some(standing) = self.standing()? {
            board.show(&standing)?;
        }
        board.write_as(LiveStatus::Following, None)?;
        Ok(Some(board))
    }

    /// Polls the session until its schedule is complete or `stop` is raised. Returns `None` if files of further rests have arrived,
    /// or if an accepted plateau has changed. The caller then restarts, after further rests with the session
    /// [`rests::with_rests_there`].
    ///
    /// # Errors
    /// [`Error`] when a finished record is wrong, or the folder does not take the state.
    pub fn run(
        &mut self,
        stop: &AtomicBool,
        quiet: &mut Quiet,
        report: &mut dyn FnMut(WatchEvent),
    ) -> Result<Option<WatchEnd>, Error> {
        let mut board = self.board.take();
        let end = self.follow(stop, quiet, report, board.as_mut());
        if let Some(board) = &mut board {
            match &end {
                // The next watch writes it anew.
                Ok(None) => {}
                Ok(Some(WatchEnd::Stopped { .. })) => board.write_as(LiveStatus::Stopped, None)?,
                Ok(Some(WatchEnd::Complete(result))) => {
                    board.judge(result.objections().is_empty());
                    board.write_as(LiveStatus::Complete, None)?;
                }
                // The first error is the one to return.
                Err(error) => drop(board.write_as(LiveStatus::Failed, Some(&error.to_string()))),
            }
        }
        end
    }

    fn follow(
        &mut self,
        stop: &AtomicBool,
        quiet: &mut Quiet,
        report: &mut dyn FnMut(WatchEvent),
        mut board: Option<&mut Board>,
    ) -> Result<Option<WatchEnd>, Error> {
        let mut watch = Watch::having_seen(self.session, quiet.clone());
        let (mut note, mut is_frozen) = (None, false);
        loop {
            self.session.folder.marks().refuse_replaced()?;
            let arrivals = watch.look(stop);
            if let Some(now) = watch.note().filter(|now| arrivals.is_err() && note.as_ref() != Some(now)) {
                report(WatchEvent::Waiting(&now));
            }
            let arrivals = arrivals?;
            let count = arrivals.len();
            for (k, observation) in arrivals.into_iter().enumerate() {
                if stop.load(Ordering::Relaxed) {
                    self.keep()?;
                    return Ok(Some(self.stopped()));
                }
                let speed = watch.speed(observation.set_point);
                let observation = self.at_set_speed(observation, speed);
                // What is best next is asked once a look: each answer values all plateaus that remain.
                if let Some(progress) = self.arrived(&observation, k + 1 == count)? {
                    report(WatchEvent::Plateau(progress));
                }
            }
            if count > 0 {
                self.keep()?;
            }
            if let Some(note) = self.changed.text(self.session) {
                report(WatchEvent::Waiting(&note));
                self.forget()?;
                quiet.clone_from(watch.quiet());
                return Ok(None);
            }
            if let Some(board) = &mut board {
                board.pace(self.state.plateaus.len());
                if let Some(standing) = (count > 0).then(|| self.standing()).transpose()?.flatten() {
                    board.show(&standing)?;
                }
                board.write(&watch, LiveStatus::Following)?;
            }
            if watch.is_complete() {
                // The calibration reads the records anew, and needs the room of what was kept of them.
                drop(watch);
                return self.finish(stop, report).map(Some);
            }
            if watch.note() != note {
                note = watch.note();
                if let Some(note) = &note {
                    report(WatchEvent::Waiting(note));
                }
            }
            let frozen = watch.growth().and_then(|growth| Some((growth.file(), growth.frozen(self.request.frozen)?)));
            if let Some((file, age)) = frozen.filter(|_| !is_frozen) {
                report(WatchEvent::Frozen { file, age });
            }
            is_frozen = frozen.is_some();
            if self.request.once {
                watch.without_quiet(stop).iter().for_each(|note| report(WatchEvent::Waiting(note)));
                return Ok(Some(self.stopped()));
            }
            if rests::have_come(self.session, watch.quiet()) {
                self.keep()?;
                quiet.clone_from(watch.quiet());
                return Ok(None);
            }
            if stop.load(Ordering::Relaxed) {
                return Ok(Some(self.stopped()));
            }
            wait(self.request.interval, stop);
        }
    }

    /// What a plateau would have read at the speed that was set, where speeds are measured: the set points of the model are
    /// the scheduled ones, each as uncertain as a measured speed. What its speed is more uncertain goes into its covariance.
    fn at_set_speed(&self, observation: Observation, speed: Option<MeasuredSpeed>) -> Observation {
        let speeds = &self.session.speeds;
        let experiment = self.model.experiment();
        let set = experiment.set_points[observation.set_point];
        let Some(measured) = speeds.measured.filter(|_| speeds.is_in_files() && !set.is_rest()) else {
            return observation;
        };
        let point = self.follower.point();
        let by_log_speed = self.model.linearise(&SetPoint { speed_uncertainty: Some(1.0), ..set }, point).setting_error;
        let uncertainty = speed.map_or(speeds.set_uncertainty, |s| s.uncertainty.hypot(measured.uncertainty));
        let at = |omega: f64| self.model.reading(&SetPoint { omega, ..set }, point);
        let change = speed.map_or_else(Vector3::zeros, |s| at(s.speed.copysign(set.omega)) - at(set.omega));
        let further = uncertainty.powi(2) - experiment.speed_uncertainty_of(&set).powi(2);
        Observation {
            mean: observation.mean - change,
            covariance: observation.covariance + by_log_speed * by_log_speed.transpose() * further.max(0.0),
            ..observation
        }
    }

    /// Tests a plateau, takes it up or holds it out, and keeps what is known then; after the last one of a look also the best next.
    fn arrived(&mut self, observation: &Observation, is_last: bool) -> Result<Option<WatchProgress<'_>>, Error> {
        let set_point = observation.set_point;
        if self.has(set_point) {
            if let Some(kept) = self.state.plateaus.iter().find(|plateau| plateau.set_point == set_point) {
                self.changed.compare(kept, observation);
            }
            return Ok(None);
        }
        let arrival = self.fitted(self.follower.test(observation))?;
        let innovation = arrival.innovation;
        let alarm = innovation.is_alarm(self.request.false_alarm, self.session.experiment.set_points.len());
        let held_out = self.held_out.contains(&set_point) || alarm && self.request.hold_out_alarms;
        if !held_out {
            let taken = self.follower.take(arrival);
            self.fitted(taken)?;
            let taken = self.next.take(&[Weight::from(observation)]);
            self.planned(taken)?;
        }
        self.come[set_point] = true;
        self.state.plateaus.push(WatchedPlateau::new(observation, innovation, alarm, held_out));
        self.state.move_to(&self.follower);
        let now = self.fitted(self.follower.progress())?;
        let count = self.state.plateaus.len();
        let entry = self.state.plateaus[count - 1].entry(count, self.model, &now);
        append_history(&self.request.out.join(HISTORY_FILE), &entry)?;
        if self.kept.elapsed() >= KEPT_EACH {
            self.keep()?;
        }
        self.progress(now, observation, is_last).map(Some)
    }

    /// Writes the state. It holds all plateaus: many that come at once are not written one by one. After a kill the history
    /// may be ahead of it, and is cut to it.
    fn keep(&mut self) -> Result<(), Error> {
        self.kept = Instant::now();
        self.state.write(&self.request.out.join(STATE_FILE))
    }

    /// Removes the state: the next watch begins anew.
    fn forget(&self) -> Result<(), Error> {
        let file = self.request.out.join(STATE_FILE);
        match fs::remove_file(&file) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(Error::writing(&file, error)),
            _ => Ok(()),
        }
    }

    /// What is known after the last plateau that has arrived; `None` before the first.
    fn standing(&self) -> Result<Option<WatchProgress<'_>>, Error> {
        let last = self.state.plateaus.last();
        last.map(|last| self.progress(self.fitted(self.follower.progress())?, &last.observation(), true)).transpose()
    }

    fn progress(&self, now: Progress, last: &Observation, is_last: bool) -> Result<WatchProgress<'_>, Error> {
        let next = (0..self.session.experiment.set_points.len()).find(|&set_point| !self.has(set_point));
        let expected = |next| self.follower.expected(next, last.covariance).map(|progress| (next, progress));
        Ok(WatchProgress {
            session: self.session,
            model: self.model,
            plateaus: &self.state.plateaus,
            now,
            next: self.fitted(next.map(expected).transpose())?,
            best: if is_last { self.best_next(last)? } else { Vec::new() },
        })
    }

    /// The best of the plateaus that remain in the mounting on the arm, and of those of later mountings, by what they would
    /// bring if they were as noisy as the last one. Of plateaus that are alike the first is asked for.
    fn best_next(&self, last: &Observation) -> Result<Vec<(usize, f64)>, Error> {
        let set_points = &self.session.experiment.set_points;
        let mut alike = HashSet::new();
        let mut is_new = |s: &SetPoint| alike.insert((s.mounting, s.omega.to_bits(), s.angle.to_bits()));
        let remaining = (0..set_points.len()).filter(|&n| !self.has(n) && is_new(&set_points[n]));
        let remaining: Vec<Weight> =
            remaining.map(|set_point| Weight { set_point, covariance: last.covariance }).collect();
        let benefits = self.planned(self.next.benefits(&remaining))?;
        let on_the_arm = set_points[last.set_point].mounting;
        let is_here = |(set_point, _): &&(usize, f64)| set_points[*set_point].mounting == on_the_arm;
        let here = benefits.iter().find(is_here);
        let elsewhere = benefits.iter().find(|benefit| !is_here(benefit));
        Ok(here.into_iter().chain(elsewhere).copied().collect())
    }

    fn has(&self, set_point: usize) -> bool {
        self.come[set_point]
    }

    fn stopped(&self) -> WatchEnd {
        WatchEnd::Stopped { plateaus: self.state.plateaus.len() }
    }

    /// The calibration, unless `stop` is raised before its end.
    fn finish(&self, stop: &AtomicBool, report: &mut dyn FnMut(WatchEvent)) -> Result<WatchEnd, Error> {
        let held_out = self.state.plateaus.iter().filter(|plateau| plateau.held_out);
        let by_alarm = |plateau: &&WatchedPlateau| plateau.alarm && !self.held_out.contains(&plateau.set_point);
        let set_points = |those: Vec<&WatchedPlateau>| those.into_iter().map(|plateau| plateau.set_point).collect();
        let (alarmed, by_request) = held_out.partition(by_alarm);
        let (alarmed, by_request): (Vec<usize>, Vec<usize>) = (set_points(alarmed), set_points(by_request));
        let alpha = self.request.false_alarm;
        let progress = |_| until(stop);
        let (result, singled_out) = match calibrate_watched(self.session, &by_request, &alarmed, alpha, &progress) {
            Err(Error::Stopped(_)) => return Ok(self.stopped()),
            result => result?,
        };
        if let Some(names) = singled_out {
            let names: Vec<String> = names.iter().map(PlateauName::to_string).collect();
            let instead = match &names[..] {
                [] => "of all plateaus together none stands out, and the result holds none of them out".to_owned(),
                names => format!(
                    "of all plateaus together {} stands out, and the result holds that out instead",
                    names.join(", ")
                ),
            };
            report(WatchEvent::Waiting(&format!(
                "{} plateaus raised an alarm while the session ran; {instead}",
                alarmed.len()
            )));
        }
        result.write(&self.request.out.join("result.json"))?;
        Ok(WatchEnd::Complete(Box::new(result)))
    }

    fn planned<T>(&self, outcome: Result<T, PlanError>) -> Result<T, Error> {
        outcome.map_err(|source| Error::planning(&self.session.file, source))
    }

    fn fitted<T>(&self, outcome: Result<T, FitError>) -> Result<T, Error> {
        outcome.map_err(|source| Error::fit(&self.session.file, source))
    }
}

/// Refuses a group that the model does not have, and one that stands twice.
fn check_groups(wanted: &[String], session: &Session, model: &MeasurementModel) -> Result<(), Error> {
    let groups: Vec<&str> = model.parameters().groups().into_iter().map(Group::name).collect();
    let twice = wanted.iter().enumerate().find(|(n, group)| wanted[..*n].contains(group));
    if let Some((_, twice)) = twice {
        return Err(Error::content(
            &session.file,
            Place::Whole,
            format!("two targets for {twice:?}"),
            "one for each group",
        ));
    }
    match wanted.iter().find(|group| !groups.contains(&group.as_str())) {
        None => Ok(()),
        Some(unknown) => {
            let expected = format!("one of the groups {}", groups.join(", "));
            Err(Error::content(&session.file, Place::Whole, format!("a target for {unknown:?}"), expected))
        }
    }
}

/// Longest time for which plateaus that have come are not in the state on disk.
const KEPT_EACH: Duration = Duration::from_secs(1);

pub(super) const STATE_FILE: &str = "watch.json";

/// What is seen at this moment.
const LIVE_FILE: &str = "watch-live.json";

const HISTORY_FILE: &str = "watch-history.jsonl";

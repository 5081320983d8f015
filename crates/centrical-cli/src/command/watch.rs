//! `centrical watch SESSION`: monitors a session folder while records arrive.

use std::io::{self, IsTerminal, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use centrical::fit::recursive::{Follower, Progress};
use centrical::plan::{Benefit, Criterion, ReadingRange, next_best};
use centrical::{MeasurementModel, Observation, SetPoint, Weight, linear};
use centrical_report::{
    Language, WatchView, WatchedTest, history_figure, objections, states_text, terminal_table, verdict_text,
    watch_table,
};
use centrical_session::{
    Error, HistoryEntry, HistoryEstimate, Method, Place, PlateauName, Session, Watch, WatchState, WatchedPlateau,
    append_history, calibrate_without, create_folder, keep_history, read_history, write_whole,
};

use crate::Outcome;

/// Monitor a session folder while the laboratory is still adding records: after each plateau the uncertainties and the
/// benefit of the next; the calibration when the schedule is complete. After Ctrl-C it resumes when started again.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The session folder, or its experiment.toml
    session: PathBuf,
    /// Folder for watch.json (its state), watch-history.jsonl (a line per plateau), its plot and result.json
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// A target standard uncertainty in the unit of the table, e.g. --target bias=0.01; may be repeated
    #[arg(long, value_name = "GROUP=VALUE", value_parser = target)]
    target: Vec<(String, f64)>,
    /// False-alarm probability per session
    #[arg(long, value_name = "CHANCE", default_value_t = 0.01, value_parser = chance)]
    false_alarm: f64,
    /// Hold out a plateau, e.g. 4:3 for the third of the fourth mounting; may be repeated
    #[arg(long, value_name = "MOUNTING:PLATEAU")]
    hold_out: Vec<PlateauName>,
    /// Hold out every plateau that raises an alarm
    #[arg(long)]
    hold_out_alarms: bool,
    /// Seconds between two readings of the folder
    #[arg(long, value_name = "SECONDS", default_value_t = 2.0, value_parser = seconds)]
    interval: f64,
    /// Seconds without change after which a record counts as finished
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = seconds)]
    quiet: f64,
    /// Process what is present and exit
    #[arg(long)]
    once: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let session = Session::read(&arguments.session)?;
    create_folder(&arguments.out)?;
    let model = session.model()?;
    let mut following = Following::resume(arguments, &session, &model)?;
    let order: Vec<usize> = (0..session.experiment.set_points.len()).collect();
    eprint!("{}", states_text(&model, &order));
    let mut watch = Watch::new(&session, Duration::from_secs_f64(arguments.quiet));
    let stop = stopped_by_ctrl_c();
    let mut note = None;
    loop {
        for observation in watch.look()? {
            if stop.load(Ordering::Relaxed) {
                return following.stopped();
            }
            following.arrived(&observation)?;
        }
        if watch.is_complete() {
            return following.finish();
        }
        if watch.note().map(str::to_owned) != note {
            note = watch.note().map(str::to_owned);
            if let Some(note) = &note {
                eprintln!("{note}");
            }
        }
        if stop.load(Ordering::Relaxed) || arguments.once {
            return following.stopped();
        }
        thread::sleep(Duration::from_secs_f64(arguments.interval));
    }
}

/// A flag that Ctrl-C raises.
fn stopped_by_ctrl_c() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    let raised = Arc::clone(&stop);
    // Without a handler Ctrl-C ends the program at once; the state on disk is whole then as well.
    let _ = ctrlc::set_handler(move || raised.store(true, Ordering::Relaxed));
    stop
}

/// A session that is followed: the estimates, and where they are kept.
struct Following<'a> {
    arguments: &'a Arguments,
    session: &'a Session,
    model: &'a MeasurementModel,
    follower: Follower<'a>,
    state: WatchState,
    /// Plateaus that the user holds out, as set points.
    held_out: Vec<usize>,
}

impl<'a> Following<'a> {
    fn resume(arguments: &'a Arguments, session: &'a Session, model: &'a MeasurementModel) -> Result<Self, Error> {
        check_targets(arguments, session, model)?;
        let held_out: Vec<usize> =
            arguments.hold_out.iter().map(|name| name.set_point(session)).collect::<Result<_, _>>()?;
        let mut state = WatchState::resume(session, &arguments.out.join("watch.json"))?;
        keep_history(&arguments.out.join("watch-history.jsonl"), state.plateaus.len())?;
        // One that has been taken up before is held out from now on.
        state.plateaus.iter_mut().for_each(|plateau| plateau.held_out |= held_out.contains(&plateau.set_point));
        let follower = Follower::resume(model, state.taken(), &state.point)
            .map_err(|source| Error::Fit { file: session.file.clone(), source })?;
        Ok(Self { arguments, session, model, follower, state, held_out })
    }

    /// Tests a plateau, takes it up or holds it out, shows and keeps what is known then.
    fn arrived(&mut self, observation: &Observation) -> Result<(), Error> {
        let set_point = observation.set_point;
        if self.state.plateaus.iter().any(|plateau| plateau.set_point == set_point) {
            return Ok(());
        }
        let innovation = self.fitted(self.follower.test(observation))?;
        let alarm = innovation.is_alarm(self.arguments.false_alarm, self.session.experiment.set_points.len());
        let held_out = self.held_out.contains(&set_point) || alarm && self.arguments.hold_out_alarms;
        if !held_out {
            let taken = self.follower.take(observation.clone());
            self.fitted(taken)?;
        }
        self.state.plateaus.push(WatchedPlateau::new(observation, innovation.into(), alarm, held_out));
        self.state.point = self.follower.point().to_vec();
        if self.follower.taken().is_empty() {
            return self.state.write(&self.arguments.out.join("watch.json"));
        }
        let now = self.fitted(self.follower.progress())?;
        let entry = HistoryEntry {
            plateau: self.state.plateaus.len(),
            set_point,
            innovation: innovation.into(),
            alarm,
            held_out,
            rank: now.rank,
            estimates: HistoryEstimate::all(self.model, &now),
        };
        append_history(&self.arguments.out.join("watch-history.jsonl"), &entry)?;
        self.state.write(&self.arguments.out.join("watch.json"))?;
        self.show(&now, observation)
    }

    fn show(&self, now: &Progress, last: &Observation) -> Result<(), Error> {
        let all = self.session.experiment.set_points.len();
        let come = |set_point: &usize| self.state.plateaus.iter().any(|p| p.set_point == *set_point);
        let next = (0..all).find(|set_point| !come(set_point));
        let expected = next.map(|next| self.fitted(self.follower.expected(next, last.covariance))).transpose()?;
        let best = self.best_next(last)?;
        let tests: Vec<WatchedTest> = self.state.plateaus.iter().map(|plateau| self.tested(plateau)).collect();
        let view = WatchView {
            title: &self.session.title,
            model: self.model,
            plateaus: (self.state.plateaus.len(), all),
            tests: &tests,
            now,
            next: next.map(|next| self.label(next)).zip(expected.as_ref()),
            best,
            targets: &self.arguments.target,
        };
        // On a terminal the table stays in its place.
        let clear = if io::stdout().is_terminal() { "\x1b[2J\x1b[H" } else { "" };
        // A reader that has seen enough (`| head`) is no failure.
        let _ = writeln!(io::stdout(), "{clear}{}", watch_table(&view));
        Ok(())
    }

    /// The plateaus that remain in the mounting on the arm, and those of later mountings, by what they would bring if they
    /// were as noisy as the last one; the best of each.
    fn best_next(&self, last: &Observation) -> Result<Vec<(String, f64)>, Error> {
        let experiment = &self.session.experiment;
        let come = |set_point: usize| self.state.plateaus.iter().any(|p| p.set_point == set_point);
        let remaining: Vec<Weight> = (0..experiment.set_points.len())
            .filter(|&set_point| !come(set_point))
            .map(|set_point| Weight { set_point, covariance: last.covariance })
            .collect();
        let taken: Vec<Weight> = self.follower.taken().iter().map(Weight::from).collect();
        let load = |s: &SetPoint| linear::nominal(experiment, s).norm();
        let force = experiment.set_points.iter().map(load).fold(0.0, f64::max);
        let criterion = Criterion::Reading(ReadingRange { force });
        let benefits = next_best(self.model, &criterion, &taken, &remaining)
            .map_err(|source| Error::Planning { file: self.session.file.clone(), source })?;
        let on_the_arm = experiment.set_points[last.set_point].mounting;
        let is_here = |benefit: &Benefit| experiment.set_points[benefit.set_point].mounting == on_the_arm;
        let here = benefits.iter().find(|benefit| is_here(benefit));
        let elsewhere = benefits.iter().find(|benefit| !is_here(benefit));
        Ok(here.into_iter().chain(elsewhere).map(|benefit| (self.label(benefit.set_point), benefit.factor)).collect())
    }

    fn tested(&self, plateau: &WatchedPlateau) -> WatchedTest {
        WatchedTest {
            plateau: self.label(plateau.set_point),
            innovation: plateau.innovation,
            alarm: plateau.alarm,
            held_out: plateau.held_out,
        }
    }

    /// `4:3, 189.2 rpm`.
    fn label(&self, set_point: usize) -> String {
        let PlateauName { mounting, plateau } = PlateauName::of(self.session, set_point);
        let there = &self.session.experiment.set_points[set_point];
        let set = if there.is_rest() {
            format!("rest at {:.0} deg", there.angle.to_degrees())
        } else {
            format!("{:.1} rpm", there.omega * 30.0 / std::f64::consts::PI)
        };
        format!("{mounting}:{plateau}, {set}")
    }

    /// The history as a plot, beside it.
    fn draw(&self) -> Result<(), Error> {
        let folder = &self.arguments.out;
        let history = folder.join("watch-history.jsonl");
        if !history.exists() {
            return Ok(());
        }
        let group_of = |name: &str| {
            let parameters = self.model.parameters();
            parameters.find(name).map(|j| parameters[j].group)
        };
        if let Some(figure) = history_figure(&read_history(&history)?, &group_of, Language::English) {
            write_whole(&folder.join("watch-history.svg"), figure.drawings.concat().as_bytes())?;
        }
        Ok(())
    }

    fn stopped(&self) -> Result<Outcome, Error> {
        self.draw()?;
        let file = self.arguments.out.join("watch.json");
        eprintln!(
            "Stopped after {} plateaus; the same command goes on from {}",
            self.state.plateaus.len(),
            file.display()
        );
        Ok(Outcome::Done)
    }

    /// The calibration of the complete session, from its files anew.
    fn finish(&self) -> Result<Outcome, Error> {
        let held_out = self.state.plateaus.iter().filter(|plateau| plateau.held_out);
        let held_out: Vec<_> = held_out.map(|plateau| PlateauName::of(self.session, plateau.set_point)).collect();
        let result = calibrate_without(self.session, &held_out, Method::Recursive, &|_| {})?;
        let file = self.arguments.out.join("result.json");
        result.write(&file)?;
        self.draw()?;
        let objections = objections(&result);
        let mut lines = vec![terminal_table(&result), verdict_text(&objections)];
        lines.push(format!("\nThe schedule is complete. Written to {}\n", file.display()));
        let _ = io::stdout().write_all(lines.concat().as_bytes());
        Ok(if objections.is_empty() { Outcome::Done } else { Outcome::NotAcceptable })
    }

    fn fitted<T>(&self, outcome: Result<T, centrical::FitError>) -> Result<T, Error> {
        outcome.map_err(|source| Error::Fit { file: self.session.file.clone(), source })
    }
}

/// Refuses a target for a group that there is not.
fn check_targets(arguments: &Arguments, session: &Session, model: &MeasurementModel) -> Result<(), Error> {
    let mut groups: Vec<&str> = model.parameters().iter().map(|parameter| parameter.group).collect();
    groups.dedup();
    let Some((unknown, _)) = arguments.target.iter().find(|(group, _)| !groups.contains(&group.as_str())) else {
        return Ok(());
    };
    let expected = format!("one of the groups {}", groups.join(", "));
    Err(Error::content(&session.file, Place::Whole, format!("a target for {unknown:?}"), expected))
}

fn target(text: &str) -> Result<(String, f64), String> {
    let wrong = || format!("found {text:?}, expected GROUP=VALUE such as bias=0.01");
    let (group, value) = text.split_once('=').ok_or_else(wrong)?;
    let value: f64 = value.trim().parse().map_err(|_| wrong())?;
    if value > 0.0 { Ok((group.trim().to_owned(), value)) } else { Err(wrong()) }
}

fn chance(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|value| (0.0..1.0).contains(value) && *value > 0.0);
    value.ok_or_else(|| format!("found {text:?}, expected a chance above 0 and below 1"))
}

fn seconds(text: &str) -> Result<f64, String> {
    // A day: longer is no waiting.
    let value = text.parse().ok().filter(|value| (0.0..=86400.0).contains(value));
    value.ok_or_else(|| format!("found {text:?}, expected seconds from 0 to 86400"))
}

//! Plateaus whose files have changed since they were taken up.

use centrical::Observation;
use centrical::reduction::ScheduledPlateau;

use crate::document::WatchedPlateau;
use crate::experiment::{PlateauName, Session};

/// Set points of those plateaus that are not yet reported.
#[derive(Debug, Default)]
pub(super) struct Changed(Vec<usize>);

/// Largest change of a plateau that is read anew, in its standard uncertainties: telemetry that has come since may move its ends.
const LARGEST_CHANGE: f64 = 3.0;

/// Whether a plateau reads otherwise than `before`.
pub(super) fn reads_otherwise(before: &Observation, now: &Observation) -> bool {
    let change = now.mean - before.mean;
    let squared = before.covariance.cholesky().map(|factor| change.dot(&factor.solve(&change)));
    squared.is_some_and(|squared| squared > LARGEST_CHANGE.powi(2))
}

impl Changed {
    /// Compares a plateau with what was kept of it.
    pub fn compare(&mut self, kept: &WatchedPlateau, observation: &Observation) {
        if reads_otherwise(&kept.observation(), observation) {
            self.0.push(observation.set_point);
        }
    }

    /// What to say of them, if there are any.
    pub fn text(&self, session: &Session) -> Option<String> {
        let changed = &self.0;
        let PlateauName { mounting, plateau } = PlateauName::of(session, *changed.first()?);
        let first = match session.rest_of(mounting - 1) {
            Some(rest) => format!("rest {rest}"),
            None => format!("plateau {mounting}:{plateau}"),
        };
        let whole = match changed.len() {
            1 => format!("{first} reads"),
            count => format!("{first} and {} more read", count - 1),
        };
        Some(format!("{whole} otherwise than before; the watch begins anew with the files as they are"))
    }
}

/// How many plateaus of a schedule that was found are over: those before the last one that reads unlike its predecessor.
pub(super) fn over(found: &[ScheduledPlateau]) -> usize {
    /// Relative difference of specific forces that no error of a unit makes up.
    const UNLIKE: f64 = 0.02;
    let is_unlike = |k: &usize| {
        let [before, after] = [&found[k - 1].nominal_z, &found[*k].nominal_z];
        (after - before).norm() > UNLIKE * before.norm().max(after.norm())
    };
    (1..found.len()).rev().find(is_unlike).unwrap_or(0)
}

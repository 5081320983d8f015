//! What is known after a plateau of a watched session.

use centrical::fit::Progress;
use centrical::plan::Benefit;
use centrical::{Group, MeasurementModel, Parameter};

use crate::document::{GroupProgress, WatchedPlateau};
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
    /// uncertainty of the compensated reading with it over that without. Of plateaus that one look finds, the last one has it.
    pub best: Vec<Benefit>,
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

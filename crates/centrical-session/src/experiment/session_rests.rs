//! The rests of a session in free attitudes: with the arm, without it, and alone.

use centrical::{Centrifuge, Experiment, PairRelation};

use super::form::{TermEntry, TermList};
use super::plateaus::PlateauRow;
use super::prior::PriorEntry;
use super::rests::{self, RecordedRests, RestTable};
use super::session::Session;
use super::speeds::Speeds;
use super::terms;
use super::toml_path::TomlPath;
use super::turning::Turning;
use crate::error::Error;

impl Session {
    /// Variance of the means of rests at most, over the one stated, where there are rests alone and it is not 1: on an arm plateaus judge.
    pub(crate) fn noise_at_most(&self) -> Option<f64> {
        let most = self.rest_tables.iter().map(|table| table.noise_at_most).fold(1.0, f64::max);
        (most > 1.0 && !self.experiment.has_arm()).then_some(most)
    }

    /// Slow rotation among its rests.
    pub(crate) fn turning(&self) -> Option<Turning> {
        self.rest_tables.iter().filter_map(|table| table.turning).reduce(Turning::joined)
    }

    /// Adds the rests of `[[tumble]]` to the experiment, behind all that is on the arm.
    pub(crate) fn add_rests(&mut self) {
        rests::add_rests(&mut self.experiment, &self.rest_tables);
        if self.plateaus.is_none() {
            self.durations.extend(self.rest_tables.iter().flat_map(RestTable::durations));
        }
    }

    /// The `[[tumble]]` whose rests are to be found in a record, with their numbers from 0.
    pub(crate) fn rest_records(&self) -> impl Iterator<Item = (usize, &RecordedRests)> {
        self.rest_tables.iter().enumerate().filter_map(|(number, table)| Some((number, table.record()?)))
    }

    /// The session with other tables of rests, such as those that were found in records.
    pub(crate) fn with_rest_tables(mut self, tables: Vec<RestTable>) -> Self {
        self.forget_rests();
        self.rest_tables = tables;
        self.add_rests();
        self
    }

    /// The means of the rests in free attitudes.
    pub fn rests(&self) -> impl Iterator<Item = &PlateauRow> {
        self.rest_tables.iter().flat_map(|table| &table.means)
    }

    /// Number from 1 of the rest in an attitude of its own that is a mounting; `None` on the arm.
    pub fn rest_of(&self, mounting: usize) -> Option<usize> {
        (mounting + 1).checked_sub(self.mountings.len()).filter(|rest| *rest > 0)
    }

    /// Takes away what [`Session::add_rests`] added.
    pub(super) fn forget_rests(&mut self) {
        let on_arm = self.experiment.mountings_on_arm().count();
        self.experiment.positions.retain(|position| !position.is_free);
        self.experiment.set_points.retain(|set_point| set_point.mounting < on_arm);
        self.experiment.mountings.truncate(on_arm);
        self.durations.truncate(self.experiment.set_points.len());
    }

    /// Refuses rests that are still to be measured.
    pub(crate) fn refuse_planned_rests(&self) -> Result<(), Error> {
        let Some(planned) = self.rest_tables.iter().position(RestTable::is_planned) else { return Ok(()) };
        let expected = "a table of rests, in a session that is measured";
        Err(TomlPath::entry(&self.file, "tumble", planned).unexpected("rests", "rests that are planned", expected))
    }

    /// The session without rests in free attitudes.
    #[must_use]
    pub fn on_arm(self) -> Self {
        self.with_rest_tables(Vec::new())
    }

    /// The session without the arm: its rests in free attitudes, and these terms of the error model. What is said of the arm, extensions of
    /// the model and priors go; misalignments that the terms leave out have one.
    ///
    /// # Errors
    /// If it has no such rests that are measured, or a term is unknown.
    pub fn off_arm(self, terms: &[String]) -> Result<Self, Error> {
        self.refuse_planned_rests()?;
        if self.rest_tables.is_empty() {
            let expected = "a table of rests, or a record of a unit that is turned and rests again and again";
            return Err(TomlPath::entry(&self.file, "tumble", 0).unexpected("rests", "no such table", expected));
        }
        let askew = terms::misalignments_left_out(terms);
        let terms = TermList(terms.iter().chain(&askew).cloned().map(TermEntry::Named).collect());
        let error_model = terms::error_model(&self.file, &terms)?;
        let Experiment { site, unit, .. } = self.experiment;
        let experiment = Experiment {
            site,
            unit,
            centrifuge: Centrifuge::default(),
            positions: Vec::new(),
            pair_relation: PairRelation::Free,
            mountings: Vec::new(),
            set_points: Vec::new(),
        };
        let nothing = Self {
            experiment,
            error_model,
            extensions: Vec::new(),
            speeds: Speeds::default(),
            mountings: Vec::new(),
            plateaus: None,
            rest_tables: Vec::new(),
            durations: Vec::new(),
            priors: askew.into_iter().map(PriorEntry::askew).collect(),
            ..self
        };
        Ok(nothing.with_rest_tables(self.rest_tables))
    }
}

//! Which unknowns a filter has to carry at each plateau of an order.
//!
//! An unknown that acts in every position is carried all along, and so is every influence. One that belongs to a
//! position (`delta`), a pair (`dR`) or a seat is carried from the first plateau there to the last, and then retired.
//! With the experiments ordered by position these are 30 of the source's 49 at a time: 19 fewer, 15 `delta` and
//! 4 `dR` (source, section 6).

use crate::model::{Effect, Kind, MeasurementModel, SetPoint};

/// The lifetimes of the unknowns in an order of plateaus.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Lifetimes {
    /// Set points in the order in which they come.
    order: Vec<usize>,
    /// First and last place in the order, per unknown; `None` for one that no plateau of the order sees.
    spans: Vec<Option<(usize, usize)>>,
    /// The most states carried at a time if the same plateaus are grouped by pair and position.
    grouped_states: usize,
}

impl Lifetimes {
    /// The lifetimes of the model's unknowns when its set points come in `order`.
    ///
    /// # Panics
    /// If the order names a set point that the experiment does not have.
    pub fn new(model: &MeasurementModel, order: &[usize]) -> Self {
        let spans = spans(model, order);
        let grouped_states = most_at_a_time(&self::spans(model, &grouped(model, order)));
        Self { order: order.to_vec(), spans, grouped_states }
    }

    /// Set points in the order in which they come.
    pub fn order(&self) -> &[usize] {
        &self.order
    }

    /// Number of unknowns, carried or not.
    pub fn unknowns(&self) -> usize {
        self.spans.len()
    }

    /// The most states carried at a time.
    pub fn states(&self) -> usize {
        most_at_a_time(&self.spans)
    }

    /// What the order costs: states above those of the same plateaus grouped by pair and position.
    pub fn cost(&self) -> usize {
        self.states().saturating_sub(self.grouped_states)
    }

    /// The unknowns carried at a place of the order, those that retire first in front.
    pub fn carried(&self, place: usize) -> Vec<usize> {
        let alive = |(column, span): (usize, &Option<(usize, usize)>)| {
            span.filter(|(first, last)| (*first..=*last).contains(&place)).map(|(_, last)| (last, column))
        };
        let mut carried: Vec<_> = self.spans.iter().enumerate().filter_map(alive).collect();
        carried.sort_unstable();
        carried.into_iter().map(|(_, column)| column).collect()
    }

    /// Whether a lifetime begins at a place of the order, or ends just before it.
    pub(super) fn changes_at(&self, place: usize) -> bool {
        self.spans.iter().flatten().any(|(first, last)| *first == place || *last + 1 == place)
    }

    /// Unknowns that have to be carried at the order's fullest place although they do not act there: they wait for
    /// their position to come back.
    pub fn waiting(&self, model: &MeasurementModel) -> Vec<usize> {
        let count = |place: usize| self.carried(place).len();
        // The first of the fullest places.
        let Some(fullest) = (0..self.order.len()).rev().max_by_key(|&place| count(place)) else { return Vec::new() };
        let set_point = &model.experiment().set_points[self.order[fullest]];
        self.carried(fullest).into_iter().filter(|&column| !belongs(model, column, set_point)).collect()
    }
}

/// First and last place where each unknown belongs.
fn spans(model: &MeasurementModel, order: &[usize]) -> Vec<Option<(usize, usize)>> {
    let set_points = &model.experiment().set_points;
    let span = |column| {
        let there = |&place: &usize| belongs(model, column, &set_points[order[place]]);
        let first = (0..order.len()).find(there)?;
        Some((first, (first..order.len()).rev().find(there)?))
    };
    let influence = (!order.is_empty()).then(|| (0, order.len() - 1));
    let influences = model.influences().iter().map(|_| influence);
    (0..model.parameters().len()).map(span).chain(influences).collect()
}

fn most_at_a_time(spans: &[Option<(usize, usize)>]) -> usize {
    let begins = spans.iter().flatten().map(|(first, _)| *first);
    let carried = |place| spans.iter().flatten().filter(|(first, last)| (*first..=*last).contains(&place)).count();
    // The number carried grows only where a lifetime begins.
    begins.map(carried).max().unwrap_or(0)
}

/// The same plateaus with pairs and positions together, both in the order in which they first come.
fn grouped(model: &MeasurementModel, order: &[usize]) -> Vec<usize> {
    let experiment = model.experiment();
    let position = |s: usize| experiment.mountings[experiment.set_points[s].mounting].position;
    let shift = |s: usize| model.parameters().shift_of(position(s)).map(|shift| shift.column);
    let first = |same: &dyn Fn(usize) -> bool| order.iter().position(|&s| same(s));
    let mut grouped = order.to_vec();
    grouped.sort_by_cached_key(|&s| {
        (first(&|other| shift(other) == shift(s)), first(&|other| position(other) == position(s)))
    });
    grouped
}

/// Whether an unknown acts in the position, the pair or on the seat of a plateau.
fn belongs(model: &MeasurementModel, column: usize, set_point: &SetPoint) -> bool {
    let experiment = model.experiment();
    let position = experiment.mountings[set_point.mounting].position;
    match model.parameters()[column].kind {
        Kind::Turn { position: k, .. } | Kind::Attitude { position: k, .. } => k == position,
        Kind::Shift { axis, .. } => {
            model.parameters().shift_of(position).is_some_and(|shift| shift.column + axis == column)
        }
        // Rounding is common to rests that are repeated in one mounting.
        Kind::Effect(Effect::Rounding { first, .. }) => experiment.set_points[first].mounting == set_point.mounting,
        Kind::Effect(effect) => effect.scope().has(experiment, set_point.mounting),
        Kind::Tilt(_) | Kind::CaseTurn(_) | Kind::ProofMass(_) | Kind::Term(_) => true,
    }
}

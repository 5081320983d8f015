//! Plateaus that have come, linearised once and rotated into triangles.
//!
//! A point of the unknowns that moves makes all linearisations anew, which costs as much as all plateaus so far. But what a
//! plateau adds to them is small. Let `r` be the whitened residuals of the exact model and `A` their derivatives at the
//! reference `x_0`. The triangle is off at `x` by the remainder `r(x) - (r(x_0) - A (x - x_0))`.
//! While its norm is below a hundredth of a standard uncertainty the triangle stands; beyond that the point becomes the
//! reference. As the unknowns become known they move less, and references become rare.
//!
//! Plateaus of one mounting at one speed read alike ([`MeasurementModel::alike`]): they are linearised together, so that a reference
//! costs as much as the different plateaus, however often a campaign repeats them. The remainder is asked for at every
//! plateau, so it may not cost more as they become more: see [`Kin`]. The triangles are of the unknowns that several plateaus contain ([`Global`]).

use std::collections::HashMap;
use std::sync::Arc;

use nalgebra::{DVector, Vector3};

use super::global::{Attitude, Gathered, Global, PlateauEquations};
use super::linearised::Linearised;
use crate::linalg::factor::Factor;
use crate::model::plateau::{Design, Readings};
use crate::model::{FitError, MeasurementModel, Observation};

/// Plateaus linearised at a reference, and at zero.
#[derive(Debug, Clone)]
pub(super) struct Past<'m> {
    model: &'m MeasurementModel,
    global: Arc<Global>,
    /// The first set point that reads as each.
    alike: Arc<[usize]>,
    reference: DVector<f64>,
    /// Plateaus that had come when the reference was set.
    referenced: usize,
    groups: Vec<Linearised>,
    /// The group of each set point that has come, by the first one that reads as it.
    group_of: HashMap<usize, usize>,
    kin: Vec<Kin>,
    /// Where the kin of a group are: by the unknowns that change its reading, and the power of two in its nominal force.
    kin_of: HashMap<(Vec<usize>, u64), usize>,
    at_reference: Gathered,
    /// What no reading takes up of the plateaus that had come when the reference was set.
    rest: f64,
    at_zero: Gathered,
}

/// Plateaus that the same unknowns change, under forces within a factor of two: their readings bend alike. The remainder of all
/// is taken to be that of the group under the largest force, weighted as all of them.
#[derive(Debug, Clone)]
struct Kin {
    /// The group that stands for them, and its nominal force [m/s^2].
    largest: usize,
    force: f64,
    /// The triangle of their readings.
    sum: Factor,
}

impl<'m> Past<'m> {
    /// No plateau yet; the next ones will be linearised at the `reference`.
    pub fn new(model: &'m MeasurementModel, reference: DVector<f64>) -> Self {
        let global = Arc::new(Global::of(model));
        let (alike, none) = (model.alike().into(), Gathered::none(&global));
        Self::none(model, global, alike, none, reference)
    }

    /// No plateau at the reference yet, of those that have come `at_zero`.
    fn none(
        model: &'m MeasurementModel,
        global: Arc<Global>,
        alike: Arc<[usize]>,
        at_zero: Gathered,
        reference: DVector<f64>,
    ) -> Self {
        Self {
            model,
            at_reference: Gathered::none(&global),
            global,
            alike,
            at_zero,
            reference,
            referenced: 0,
            groups: Vec::new(),
            group_of: HashMap::new(),
            kin: Vec::new(),
            kin_of: HashMap::new(),
            rest: 0.0,
        }
    }

    /// The unknowns of the equations.
    pub fn global(&self) -> &Global {
        &self.global
    }

    /// Where the plateaus are linearised.
    pub fn reference(&self) -> &DVector<f64> {
        &self.reference
    }

    /// Plateaus that had come when the reference was set.
    pub fn referenced(&self) -> usize {
        self.referenced
    }

    /// Takes a plateau up.
    ///
    /// # Errors
    /// [`FitError::Covariance`] when its covariance is not positive definite.
    pub fn push(&mut self, observation: &Observation) -> Result<(), FitError> {
        self.at_zero.take(self.equations_at_zero(observation)?);
        let linearised = self.linearised(observation)?;
        self.at_reference.take(self.equations_of(&linearised));
        let Some(&group) = self.group_of.get(&self.alike[observation.set_point]) else {
            self.found(linearised);
            return Ok(());
        };
        self.join(group, &linearised);
        self.groups[group].push(observation)
    }

    /// A plateau at the reference.
    ///
    /// # Errors
    /// As [`Past::push`].
    pub fn linearised(&self, observation: &Observation) -> Result<Linearised, FitError> {
        Linearised::new(self.model, observation, &self.reference)
    }

    /// The same plateaus with `x` for the reference.
    ///
    /// # Errors
    /// As [`Past::push`].
    pub fn linearised_at(&self, x: &DVector<f64>) -> Result<Self, FitError> {
        let (global, alike, at_zero) = (self.global.clone(), self.alike.clone(), self.at_zero.clone());
        let mut past = Self::none(self.model, global, alike, at_zero, x.clone());
        for group in &self.groups {
            let linearised = Linearised::together(self.model, group.observations(), x)?;
            past.at_reference.take(past.equations_of(&linearised));
            past.referenced += group.observations().len();
            past.found(linearised);
        }
        past.rest = past.groups.iter().map(Linearised::rest).sum();
        Ok(past)
    }

    /// Begins a group.
    fn found(&mut self, linearised: Linearised) {
        let group = self.groups.len();
        self.group_of.insert(self.alike[linearised.set_point()], group);
        self.join(group, &linearised);
        self.groups.push(linearised);
    }

    /// Adds plateaus of a group to its kin.
    fn join(&mut self, group: usize, linearised: &Linearised) {
        let experiment = self.model.experiment();
        let force = experiment.nominal(&experiment.set_points[linearised.set_point()]).norm();
        let unknowns = linearised.at().by_unknowns().map(|(unknown, _)| unknown).collect();
        // The bits of a positive number above those of its fraction are the power of two.
        let power = force.to_bits() >> (f64::MANTISSA_DIGITS - 1);
        let new = self.kin.len();
        let place = *self.kin_of.entry((unknowns, power)).or_insert(new);
        if place == new {
            self.kin.push(Kin { largest: group, force, sum: Factor::new(3) });
        }
        let kin = &mut self.kin[place];
        kin.sum.update(&linearised.whitening(), &Vector3::zeros());
        if force > kin.force {
            (kin.largest, kin.force) = (group, force);
        }
    }

    /// Sum of squares of the whitened residuals of the exact model at `x`.
    pub fn squared(&self, x: &DVector<f64>) -> f64 {
        self.groups.iter().map(|group| group.squared(self.model, x)).sum()
    }

    /// Norm of the remainder at `x`, and of that of `newcomer`, a plateau at the reference.
    pub fn remainder(&self, newcomer: &Linearised, x: &DVector<f64>) -> f64 {
        let dx = x - &self.reference;
        let of_kin = |kin: &Kin| self.groups[kin.largest].remainder(&kin.sum, self.model, &dx, x);
        let own = newcomer.remainder(newcomer.sum(), self.model, &dx, x);
        self.kin.iter().map(|kin| of_kin(kin).powi(2)).sum::<f64>().sqrt().hypot(own)
    }

    /// The equations of the reference as equations at the global unknowns `y`, perhaps with those of a plateau more.
    pub fn design(&self, newcomer: Option<&PlateauEquations>, y: &DVector<f64>) -> Design {
        let mut design = self.at_reference.design(newcomer);
        design.rest = design.rest.hypot(self.rest.sqrt());
        design.misfit -= &design.rows * (y - self.global.part(&self.reference));
        design
    }

    /// The equations at zero, on which the rank is decided, perhaps with those of a plateau more.
    pub fn at_zero(&self) -> &Gathered {
        &self.at_zero
    }

    /// The attitudes of the rests that have come, as they follow the global unknowns from the reference.
    pub fn attitudes(&self) -> &[Attitude] {
        self.at_reference.attitudes()
    }

    /// All unknowns where the global ones are `y`, with the attitude of a plateau more. Those that no plateau knows of stay where they are.
    pub fn completed(&self, newcomer: Option<&Attitude>, y: &DVector<f64>) -> DVector<f64> {
        let dy = y - self.global.part(&self.reference);
        let mut x = self.reference.clone();
        self.global.columns().iter().zip(y.iter()).for_each(|(column, value)| x[*column] = *value);
        for attitude in self.attitudes().iter().chain(newcomer) {
            attitude.columns.iter().zip(attitude.change(&dy)).for_each(|(column, change)| x[*column] += change);
        }
        x
    }

    /// The equations of a plateau at the reference.
    pub fn equations_of(&self, linearised: &Linearised) -> PlateauEquations {
        self.global.equations_of(linearised.set_point(), &linearised.readings(), self.reference.as_slice())
    }

    /// The equations of a plateau by the linear model.
    ///
    /// # Errors
    /// As [`Past::push`].
    pub fn equations_at_zero(&self, observation: &Observation) -> Result<PlateauEquations, FitError> {
        let set_point = observation.set_point;
        let at_zero = self.model.linearise_at_zero(&self.model.experiment().set_points[set_point]);
        let readings = Readings::new(observation, &at_zero)?;
        Ok(self.global.equations_of(set_point, &readings, &vec![0.0; self.reference.len()]))
    }
}

//! Why a combination is lost, from the structure of the design: which newtonometer feels which of its terms, only in
//! which sum, and what in the experiment would have to vary for them to part.

use nalgebra::{DMatrix, DVector};

use super::addition::{Addition, positions_text};
use super::combination::sum_text;
use super::direction::NullDirection;
use super::remedy::{new_angle, new_radius, new_speed};
use super::study::Study;
use crate::model::{Group, Linearisation, MeasurementModel};

/// A change of a reading below this part of the largest change by a single term is rounding: null directions are known
/// to 1e-7 (see `TAKES_PART`).
const NO_CHANGE: f64 = 1e-6;

/// A term that changes a reading by less than this part of its largest change of any is not felt there: between the
/// rounding of a quarter turn, `1e-16`, and a cube of 1 g beside one of 200 g, `1e-7`.
const NOT_FELT: f64 = 1e-12;

/// Longest list of sights that is still read.
const READABLE: usize = 8;

/// Why a combination is lost.
#[derive(Debug, Clone, PartialEq)]
pub struct Reason {
    /// The lost combination.
    pub direction: NullDirection,
    /// What the newtonometers feel of its terms: empty when no reading depends on any of them.
    pub sights: Vec<Sight>,
    /// What would part its terms if it varied more; empty when it lies in the positions themselves.
    pub causes: Vec<Cause>,
    /// Indices of the instrument's parameters among its terms.
    pub of_instrument: Vec<usize>,
}

/// The terms of a lost combination that one newtonometer feels in some positions.
#[derive(Debug, Clone, PartialEq)]
pub struct Sight {
    /// Newtonometer, 0 to 2.
    pub newtonometer: usize,
    /// Positions, by index.
    pub positions: Vec<usize>,
    /// The terms. When `is_one_sum`, with the coefficients in which they are felt.
    pub terms: Vec<(usize, f64)>,
    /// Whether all plateaus there feel the terms in one and the same sum.
    pub is_one_sum: bool,
}

/// What does not vary enough.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// The carousel angle at rest, or nothing is read at rest.
    Angle,
    /// The speed.
    Speed,
    /// The radius.
    Radius,
}

impl Study {
    /// The reason for each of the null directions.
    pub fn reasons(&self) -> Vec<Reason> {
        self.observability().null_directions().iter().map(|direction| self.reason(direction)).collect()
    }

    fn reason(&self, direction: &NullDirection) -> Reason {
        let parameters = self.model().parameters();
        let terms = direction.terms().iter().map(|(j, _)| *j);
        Reason {
            direction: direction.clone(),
            sights: self.sights(direction),
            causes: self.causes(direction),
            of_instrument: terms.filter(|&j| parameters[j].is_of_instrument()).collect(),
        }
    }

    /// What each newtonometer feels, positions with the same sum together.
    fn sights(&self, direction: &NullDirection) -> Vec<Sight> {
        let mut sights: Vec<Sight> = Vec::new();
        for newtonometer in 0..3 {
            for k in 0..self.model().experiment().positions.len() {
                let Some((terms, is_one_sum)) = self.felt(direction, newtonometer, k) else { continue };
                let same = |s: &&mut Sight| s.newtonometer == newtonometer && is_same(&s.terms, &terms);
                match sights.iter_mut().find(same) {
                    Some(sight) => {
                        sight.positions.push(k);
                        sight.is_one_sum &= is_one_sum;
                    }
                    None => sights.push(Sight { newtonometer, positions: vec![k], terms, is_one_sum }),
                }
            }
        }
        sights
    }

    /// The terms that a newtonometer feels in position `k`, with the coefficients of their sum if it is always the same.
    fn felt(&self, direction: &NullDirection, newtonometer: usize, k: usize) -> Option<(Vec<(usize, f64)>, bool)> {
        let experiment = self.model().experiment();
        let floors = self.largest_changes(direction) * NOT_FELT;
        let of_position = self.weights().iter().zip(self.linearisations());
        let changes: Vec<DVector<f64>> = of_position
            .filter(|(w, _)| experiment.mountings[experiment.set_points[w.set_point].mounting].position == k)
            .map(|(_, linearisation)| change_by_term(direction, linearisation, newtonometer))
            .map(|change| change.zip_map(&floors, |c, floor| if c.abs() > floor { c } else { 0.0 }))
            .collect();
        let largest = changes.iter().max_by(|a, b| a.norm().total_cmp(&b.norm())).filter(|v| v.amax() > 0.0)?;
        let square = largest.norm_squared();
        let off = |change: &DVector<f64>| (change - largest * (change.dot(largest) / square)).norm();
        let is_one_sum = changes.iter().all(|change| off(change) <= NO_CHANGE * change.norm());
        let felt = |n: &usize| changes.iter().any(|change| change[*n] != 0.0);
        let coefficient = |n: usize| (direction.terms()[n].0, largest[n] / direction.terms()[n].1);
        let terms = (0..largest.len()).filter(felt).map(coefficient).collect();
        Some((NullDirection::in_simple_ratios(terms).terms().to_vec(), is_one_sum))
    }

    /// Largest change of any reading by each term of the direction.
    fn largest_changes(&self, direction: &NullDirection) -> DVector<f64> {
        let mut largest = DVector::zeros(direction.terms().len());
        for linearisation in self.linearisations() {
            for newtonometer in 0..3 {
                largest = largest.sup(&change_by_term(direction, linearisation, newtonometer).abs());
            }
        }
        largest
    }

    /// What would part the terms: the plateaus of an addition feel a change along the direction.
    fn causes(&self, direction: &NullDirection) -> Vec<Cause> {
        let trials =
            [(Cause::Angle, new_angle(self)), (Cause::Speed, new_speed(self)), (Cause::Radius, new_radius(self))];
        let parts = |addition: &Addition| {
            addition.apply(self).is_ok_and(|extended| feels(extended.model(), &extended, direction, self.model()))
        };
        trials
            .into_iter()
            .filter(|(_, addition)| addition.as_ref().is_some_and(parts))
            .map(|(cause, _)| cause)
            .collect()
    }
}

impl Reason {
    /// The reason in a sentence or two.
    pub fn sentence(&self, study: &Study) -> String {
        let (parameters, experiment) = (study.model().parameters(), study.model().experiment());
        let gravity = experiment.site.gravity;
        let name = if experiment.has_arm() {
            self.direction.text(parameters, gravity)
        } else {
            // Each rest takes part with its attitude: a sum too long to be read.
            format!(
                "{} with the attitudes",
                self.direction.of_coefficients(parameters, gravity).text(parameters, gravity)
            )
        };
        let sights = self.sights_text(study);
        let causes = self.causes_text(study);
        let of_instrument = self.of_instrument.iter().map(|&j| study.model().parameters()[j].name.as_str());
        let touched: Vec<&str> = of_instrument.collect();
        let touched = if touched.is_empty() {
            "No parameter of the instrument is touched.".to_owned()
        } else {
            format!("It leaves {} of the instrument undetermined.", touched.join(", "))
        };
        format!("{name}: {sights}; {causes}. {touched}")
    }

    fn sights_text(&self, study: &Study) -> String {
        if self.sights.is_empty() {
            return "no reading of this experiment depends on it".to_owned();
        }
        if self.sights.len() > READABLE {
            let mut newtonometers: Vec<String> = self.sights.iter().map(|s| (s.newtonometer + 1).to_string()).collect();
            newtonometers.dedup();
            return format!("newtonometers {} feel its terms only together", newtonometers.join(", "));
        }
        let mut texts = Vec::new();
        for newtonometer in 0..3 {
            let own: Vec<&Sight> = self.sights.iter().filter(|s| s.newtonometer == newtonometer).collect();
            if !own.is_empty() {
                texts.push(newtonometer_text(&own, study));
            }
        }
        texts.join(", ")
    }

    fn causes_text(&self, study: &Study) -> String {
        let them = if self.direction.terms().len() > 1 { "part them" } else { "show it" };
        if !study.model().experiment().has_arm() {
            return format!("other attitudes would {them}");
        }
        if self.causes.is_empty() {
            return format!("no other speed, radius or angle at rest in these positions would {them}");
        }
        let texts: Vec<&str> = self.causes.iter().map(|cause| cause_text(*cause, study)).collect();
        format!("{} would {them}", texts.join(" or "))
    }
}

/// `newtonometer 2 is seen at one distance only: dR_2[A] + drho_22 in positions 1, 2, dR_1[B] + drho_22 in ...`
fn newtonometer_text(sights: &[&Sight], study: &Study) -> String {
    let (parameters, experiment) = (study.model().parameters(), study.model().experiment());
    let is_distance = sights
        .iter()
        .flat_map(|s| &s.terms)
        .all(|(j, _)| matches!(parameters[*j].group, Group::Shift | Group::ProofMass));
    let lead = if is_distance { "feels nothing but its own distance:" } else { "feels only" };
    let seen: Vec<String> = sights
        .iter()
        .map(|sight| {
            let sum = if sight.is_one_sum {
                sum_text(&sight.terms, parameters)
            } else {
                let names: Vec<&str> = sight.terms.iter().map(|(j, _)| parameters[*j].name.as_str()).collect();
                format!("{} together", names.join(", "))
            };
            format!("{sum} in {}", positions_text(&sight.positions, experiment))
        })
        .collect();
    format!("newtonometer {} {lead} {}", sights[0].newtonometer + 1, seen.join(" and "))
}

fn cause_text(cause: Cause, study: &Study) -> &'static str {
    let set_points = &study.model().experiment().set_points;
    let nothing_at_rest = !study.weights().iter().any(|w| set_points[w.set_point].is_rest());
    match cause {
        Cause::Angle if nothing_at_rest => "a plateau at rest (the experiment has none)",
        Cause::Angle => "another angle at rest",
        Cause::Speed => "another speed",
        Cause::Radius => "another radius",
    }
}

/// Change of a newtonometer's reading by each term of the direction.
fn change_by_term(direction: &NullDirection, linearisation: &Linearisation, newtonometer: usize) -> DVector<f64> {
    let terms = direction.terms();
    let mut changes = DVector::zeros(terms.len());
    for (column, derivative) in &linearisation.columns {
        if let Some(n) = terms.iter().position(|(j, _)| j == column) {
            changes[n] += derivative[newtonometer] * terms[n].1;
        }
    }
    changes
}

/// Whether any plateau of `extended` feels a change along the direction, whose indices are those of `model`, that the unknowns which came
/// with the extension cannot make up: another mounting may have a shift of its own.
fn feels(extended: &MeasurementModel, study: &Study, direction: &NullDirection, model: &MeasurementModel) -> bool {
    let named =
        |&(j, component): &(usize, f64)| Some((extended.parameters().find(&model.parameters()[j].name)?, component));
    let direction = NullDirection::new(direction.terms().iter().filter_map(named).collect());
    let changes: Vec<DVector<f64>> =
        study.linearisations().iter().flat_map(|l| (0..3).map(|i| change_by_term(&direction, l, i))).collect();
    let largest = changes.iter().map(nalgebra::Matrix::amax).fold(0.0, f64::max);
    let change = DVector::from_iterator(changes.len(), changes.iter().map(nalgebra::Matrix::sum));
    let is_new = |j: &usize| model.parameters().find(&extended.parameters()[*j].name).is_none();
    let new: Vec<usize> = (0..extended.parameters().len()).filter(is_new).collect();
    beyond(change, &readings_by(&new, study)).amax() > NO_CHANGE * largest
}

/// Readings of all plateaus per unit of some unknowns, columns of unit length; those that none of them changes are zeros.
fn readings_by(unknowns: &[usize], study: &Study) -> DMatrix<f64> {
    let mut columns = DMatrix::zeros(3 * study.linearisations().len(), unknowns.len());
    for (n, linearisation) in study.linearisations().iter().enumerate() {
        for (column, derivative) in &linearisation.columns {
            if let Ok(k) = unknowns.binary_search(column) {
                let mut readings = columns.fixed_view_mut::<3, 1>(3 * n, k);
                readings += derivative;
            }
        }
    }
    columns.column_iter_mut().for_each(|mut column| {
        column.try_normalize_mut(0.0);
    });
    columns
}

/// The part of `b` that no combination of `columns` of unit length makes up.
fn beyond(b: DVector<f64>, columns: &DMatrix<f64>) -> DVector<f64> {
    /// What rounding leaves of a combination of columns that make each other up.
    const ROUNDING: f64 = 1e-10;
    if columns.is_empty() {
        return b;
    }
    let svd = columns.clone().svd(true, false);
    let Some(u) = svd.u else { return b };
    let independent = u.column_iter().zip(&svd.singular_values).filter(|(_, length)| **length > ROUNDING);
    independent.fold(b, |left, (direction, _)| {
        let along = left.dot(&direction);
        left - direction * along
    })
}

/// Equal terms with coefficients equal to rounding.
fn is_same(a: &[(usize, f64)], b: &[(usize, f64)]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|((i, x), (j, y))| i == j && (x - y).abs() <= NO_CHANGE * x.abs())
}

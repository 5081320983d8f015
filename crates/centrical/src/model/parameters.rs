//! The unknowns of an experiment: their order [K5.4].

use std::ops::Index;

use super::effect::Effect;
use super::error_model::ErrorModel;
use super::experiment::{Experiment, PairRelation, ReferencePoint};
use super::extension::Extension;
use super::group::Group;
use super::parameter::{Kind, Parameter, coefficient, parameter};

/// The unknowns of an experiment in the order of `X` [K5.4]. First come `alpha`, `delta` by position, `dR` by pair (by
/// position when free) and `drho`. Then come `theta` by rest in a free attitude, `case_turn` where such attitudes are
/// known, the coefficients of the error model, and the extensions as asked for. Without an arm `alpha` and `drho` are
/// absent.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    list: Vec<Parameter>,
    tilt: Option<usize>,
    of_position: Vec<OfPosition>,
    proof_mass: Option<usize>,
    terms: usize,
    extensions: usize,
}

/// A column shared by several positions, with the sign it takes in this one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shared {
    pub column: usize,
    pub sign: f64,
}

/// The columns of one position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum OfPosition {
    /// Of a position on the arm.
    OnArm {
        /// First of the three columns of `delta`.
        turn: usize,
        /// First of the two columns of `dR`, and the sign with which they act here.
        shift: Shared,
    },
    /// Of a free attitude.
    Free {
        /// First of the two columns of `theta`.
        attitude: usize,
        /// First of the three columns of `case_turn`, where the attitude is known.
        case_turn: Option<usize>,
    },
}

impl Parameters {
    /// The unknowns of `experiment` with `error_model` and `extensions`.
    pub fn new(experiment: &Experiment, error_model: &ErrorModel, extensions: &[Extension]) -> Self {
        let mut list = Vec::new();
        let has_arm = experiment.has_arm();
        let tilt = has_arm.then_some(list.len());
        for axis in (0..2).filter(|_| has_arm) {
            list.push(parameter(format!("alpha_{}", axis + 1), "rad", Group::Tilt, Kind::Tilt(axis), 1e-3));
        }
        let turn = turns(experiment, &mut list);
        let shift = shifts(experiment, &mut list);
        let has_proof_mass = has_arm && experiment.unit.reference == ReferencePoint::FirstProofMass;
        let proof_mass = has_proof_mass.then(|| {
            let first = list.len();
            for axis in 1..3 {
                let name = format!("drho_{0}{0}", axis + 1);
                list.push(parameter(name, "m", Group::ProofMass, Kind::ProofMass(axis), 5e-4));
            }
            first
        });
        let attitude = attitudes(experiment, &mut list);
        let case_turn = list.len();
        for axis in (0..3).filter(|_| experiment.positions.iter().any(|p| p.attitude_uncertainty.is_some())) {
            let name = format!("case_turn_{}", axis + 1);
            list.push(parameter(name, "rad", Group::CaseTurn, Kind::CaseTurn(axis), 1e-3));
        }
        let of_position = (experiment.positions.iter().enumerate())
            .map(|(k, position)| {
                if position.is_free {
                    let case_turn = position.attitude_uncertainty.map(|_| case_turn);
                    OfPosition::Free { attitude: attitude[k], case_turn }
                } else {
                    OfPosition::OnArm { turn: turn[k], shift: shift[k] }
                }
            })
            .collect();
        let terms = list.len();
        for (index, term) in error_model.terms.iter().enumerate() {
            list.push(Parameter { kind: Kind::Term(index), ..coefficient(term) });
        }
        let first_extension = list.len();
        for extension in extensions {
            list.extend(extension.parameters(experiment, error_model));
        }
        Self { list, tilt, of_position, proof_mass, terms, extensions: first_extension }
    }

    /// Unknowns of typical size with alternating signs: those of a wholly unknown unit.
    pub fn typical_alternating(&self) -> Vec<f64> {
        let sign = |j: usize| if j.is_multiple_of(2) { 1.0 } else { -1.0 };
        self.iter().enumerate().map(|(j, parameter)| sign(j) * parameter.typical).collect()
    }

    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether the list is empty.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// The unknowns in order.
    pub fn iter(&self) -> std::slice::Iter<'_, Parameter> {
        self.list.iter()
    }

    /// Index of a parameter by name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.list.iter().position(|p| p.name == name)
    }

    /// Their groups, each once, in the order of the parameters.
    pub fn groups(&self) -> Vec<Group> {
        let mut groups = Vec::new();
        for parameter in self {
            if !groups.contains(&parameter.group) {
                groups.push(parameter.group);
            }
        }
        groups
    }

    /// Indices of the parameters that `name` stands for: a parameter (`drho_22`), a group (`proof mass`), or the
    /// stem of several (`dR`, `delta_1`, `G1`). Empty when it stands for none.
    pub fn select(&self, name: &str) -> Vec<usize> {
        if let Some(parameter) = self.find(name) {
            return vec![parameter];
        }
        let has_stem = |p: &Parameter| p.name.strip_prefix(name).is_some_and(|rest| rest.starts_with(['_', '[']));
        let columns = self.iter().enumerate();
        columns.filter(|(_, p)| p.group.name() == name || has_stem(p)).map(|(column, _)| column).collect()
    }

    /// Coefficients of the error model's terms within `x`.
    pub(crate) fn coefficients<'x>(&self, x: &'x [f64]) -> &'x [f64] {
        &x[self.terms..self.extensions]
    }

    /// First column of the error model's coefficients.
    pub(crate) fn first_term(&self) -> usize {
        self.terms
    }

    /// First of the two columns of `alpha`, if anything is on an arm.
    pub(crate) fn tilt(&self) -> Option<usize> {
        self.tilt
    }

    /// The columns of a position.
    pub(crate) fn of_position(&self, position: usize) -> OfPosition {
        self.of_position[position]
    }

    /// The columns of `dR` of a position on the arm.
    pub(crate) fn shift_of(&self, position: usize) -> Option<Shared> {
        match self.of_position[position] {
            OfPosition::OnArm { shift, .. } => Some(shift),
            OfPosition::Free { .. } => None,
        }
    }

    /// First of the two columns `drho_22`, `drho_33`, if they are unknown.
    pub(crate) fn proof_mass(&self) -> Option<usize> {
        self.proof_mass
    }

    /// Columns and effects of the extensions.
    pub(crate) fn effects(&self) -> impl Iterator<Item = (usize, Effect)> + '_ {
        self.list.iter().enumerate().skip(self.extensions).filter_map(|(column, parameter)| match parameter.kind {
            Kind::Effect(effect) => Some((column, effect)),
            Kind::Tilt(_)
            | Kind::Turn { .. }
            | Kind::Shift { .. }
            | Kind::Attitude { .. }
            | Kind::CaseTurn(_)
            | Kind::ProofMass(_)
            | Kind::Term(_) => None,
        })
    }
}

impl<'p> IntoIterator for &'p Parameters {
    type Item = &'p Parameter;
    type IntoIter = std::slice::Iter<'p, Parameter>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl Index<usize> for Parameters {
    type Output = Parameter;

    fn index(&self, column: usize) -> &Parameter {
        &self.list[column]
    }
}

fn turns(experiment: &Experiment, list: &mut Vec<Parameter>) -> Vec<usize> {
    let mut first_columns = Vec::with_capacity(experiment.positions.len());
    for (k, position) in experiment.positions.iter().enumerate() {
        first_columns.push(list.len());
        for axis in (0..3).filter(|_| !position.is_free) {
            let name = format!("delta_{}[{}]", axis + 1, position.id);
            list.push(parameter(name, "rad", Group::Turn, Kind::Turn { axis, position: k }, 1e-3));
        }
    }
    first_columns
}

/// The two `theta` of each free attitude; the first of their columns by position.
fn attitudes(experiment: &Experiment, list: &mut Vec<Parameter>) -> Vec<usize> {
    let mut first_columns = Vec::with_capacity(experiment.positions.len());
    for (k, position) in experiment.positions.iter().enumerate() {
        first_columns.push(list.len());
        for axis in (0..2).filter(|_| position.is_free) {
            let name = format!("theta_{}[{}]", axis + 1, position.id);
            list.push(parameter(name, "rad", Group::Attitude, Kind::Attitude { axis, position: k }, 1e-3));
        }
    }
    first_columns
}

/// `dR` by pair, or by position when free; the value belongs to the pair's first position.
fn shifts(experiment: &Experiment, list: &mut Vec<Parameter>) -> Vec<Shared> {
    let mut shared: Vec<Shared> = Vec::with_capacity(experiment.positions.len());
    for (k, position) in experiment.positions.iter().enumerate() {
        if position.is_free {
            shared.push(Shared { column: list.len(), sign: 1.0 });
            continue;
        }
        let first_of_pair = match experiment.pair_relation {
            PairRelation::Free => k,
            _ => experiment.positions.iter().position(|p| p.pair == position.pair).unwrap_or(k),
        };
        if first_of_pair < k {
            let sign = if experiment.pair_relation == PairRelation::Opposite { -1.0 } else { 1.0 };
            shared.push(Shared { sign, ..shared[first_of_pair] });
            continue;
        }
        shared.push(Shared { column: list.len(), sign: 1.0 });
        let id = if experiment.pair_relation == PairRelation::Free { &position.id } else { &position.pair };
        for axis in 0..2 {
            let name = format!("dR_{}[{id}]", axis + 1);
            list.push(parameter(name, "m", Group::Shift, Kind::Shift { axis, position: k }, 5e-4));
        }
    }
    shared
}

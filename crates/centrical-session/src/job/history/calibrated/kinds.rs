//! The lists of parameters that calibrations share.

use std::collections::HashSet;
use std::sync::Arc;

use centrical::Group;
use centrical_compensate::Monomial;

use crate::store::{Row, TermSummary};

/// A parameter.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct CalibratedParameter {
    /// Name.
    pub name: String,
    /// Unit of SI.
    pub unit: String,
    /// bias, scale, misalignment, ...
    pub group: Group,
    /// Whether it belongs to the unit, as a coefficient of the error model and a coordinate of a proof mass do.
    pub is_of_unit: bool,
    /// Newtonometer, 0 to 2, and role of a coefficient of the error model.
    pub coefficient: Option<(usize, Role)>,
}

/// What a coefficient does to a reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Role {
    /// A constant.
    Bias,
    /// A part of the force on its own axis.
    Scale,
    /// Anything else.
    Other,
}

/// Newtonometer and role of a term.
fn coefficient(term: &TermSummary) -> Option<(usize, Role)> {
    let axis = term.axis.checked_sub(1).filter(|axis| *axis < 3)?;
    let role = match term.monomial() {
        Ok(Monomial::ONE) => Role::Bias,
        Ok(monomial) if monomial == Monomial::power(axis, 1) => Role::Scale,
        _ => Role::Other,
    };
    Some((axis, role))
}

/// The lists of parameters that were met: there are a few among thousands of calibrations.
#[derive(Debug, Default)]
pub struct Kinds(HashSet<Arc<Vec<CalibratedParameter>>>);

impl Kinds {
    /// The list of a row.
    pub fn of(&mut self, row: &Row) -> Arc<Vec<CalibratedParameter>> {
        let parameter = |((name, unit), group): ((&String, &String), &Group)| {
            let term = row.terms.iter().find(|term| term.name == *name);
            CalibratedParameter {
                name: name.clone(),
                unit: unit.clone(),
                group: *group,
                is_of_unit: *group == Group::ProofMass || term.is_some(),
                coefficient: term.and_then(coefficient),
            }
        };
        let columns = row.parameters.iter().zip(&row.units).zip(&row.groups);
        let parameters = Arc::new(columns.map(parameter).collect::<Vec<_>>());
        if let Some(known) = self.0.get(&parameters) {
            return Arc::clone(known);
        }
        self.0.insert(Arc::clone(&parameters));
        parameters
    }
}

/// Places of the same parameters in each of a few lists.
pub struct Places(Vec<(Arc<Vec<CalibratedParameter>>, Vec<usize>)>);

impl Places {
    /// Those of `names` in all `lists` that have them.
    pub fn of<'a>(lists: impl Iterator<Item = &'a Arc<Vec<CalibratedParameter>>>, names: &[&str]) -> Self {
        let mut of_lists: Vec<(Arc<Vec<CalibratedParameter>>, Vec<usize>)> = Vec::new();
        for list in lists {
            if !of_lists.iter().any(|(known, _)| Arc::ptr_eq(known, list)) {
                let places = names.iter().filter_map(|name| list.iter().position(|p| p.name == *name));
                of_lists.push((Arc::clone(list), places.collect()));
            }
        }
        Self(of_lists)
    }

    /// In one of them.
    pub fn in_list(&self, list: &Arc<Vec<CalibratedParameter>>) -> &[usize] {
        self.0.iter().find(|(known, _)| Arc::ptr_eq(known, list)).map_or(&[], |(_, places)| places)
    }
}

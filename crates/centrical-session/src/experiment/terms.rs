//! The error model: a preset, or a list of monomial terms written as `f1*f2`, `f2*|f2|`, `f1^3`.

use std::path::Path;

use centrical::{ErrorModel, Extra, Group, Monomial, Term};

use super::form::{TermEntry, TermList, TermTable};
use super::toml_path::TomlPath;
use crate::error::{Error, quoted};

/// Highest degree of a term: the ninth power of 2000 m/s^2 is still far from the end of `f64`.
const HIGHEST_DEGREE: u16 = 9;

/// The terms in the order of the list.
pub(crate) fn error_model(file: &Path, list: &TermList) -> Result<ErrorModel, Error> {
    let at = TomlPath::table(file, "model");
    let mut terms: Vec<Term> = Vec::new();
    for entry in &list.0 {
        for term in expand(&at, entry)? {
            if terms.iter().any(|t| t.axis == term.axis && t.monomial == term.monomial) {
                return Err(at.unexpected("error_model", format!("{} a second time", term.name), "every term once"));
            }
            terms.push(term);
        }
    }
    Ok(ErrorModel { terms })
}

/// The misalignments that a list of terms, as written for rests, leaves out. Between gravity and attitudes that only gravity shows they move a
/// scale by as much as the attitudes are off the faces: ten milliradians of either make 100 ppm.
pub(crate) fn misalignments_left_out(terms: &[String]) -> Vec<String> {
    let preset = ErrorModel::kozlov_2017().terms;
    let is_written = |name: &str| terms.iter().any(|term| term == name || term == "kozlov-2017");
    let names = preset.into_iter().filter(|term| term.group == Group::Misalignment).map(|term| term.name);
    names.filter(|name| !is_written(name)).collect()
}

/// How far newtonometers count as askew by which a list of terms for rests leaves out their misalignment: one part in a hundred, as data sheets
/// of unselected triads have it.
pub(crate) const ASKEW: &str = "10 mrad";

/// The terms one entry stands for.
fn expand(at: &TomlPath, entry: &TermEntry) -> Result<Vec<Term>, Error> {
    let preset = ErrorModel::kozlov_2017().terms;
    match entry {
        TermEntry::Named(name) if name == "kozlov-2017" => Ok(preset),
        TermEntry::Named(name) => {
            let term = || preset.into_iter().find(|t| t.name == *name).map(|t| vec![t]);
            Extra::named(name).map(Extra::terms).or_else(term).ok_or_else(|| {
                let families: Vec<String> = Extra::NAMED.iter().map(|(name, _)| format!("{name:?}")).collect();
                let expected = format!(
                    "\"kozlov-2017\", one of its terms such as \"G0_11\", {}, or {{ axis = 1, term = \"f1*f2\" }}",
                    families.join(", ")
                );
                at.unexpected("error_model", quoted(name.as_bytes()), expected)
            })
        }
        TermEntry::Written(table) => Ok(vec![written(at, table, &preset)?]),
    }
}

/// A term in full, under the preset's name where the preset has it.
fn written(at: &TomlPath, table: &TermTable, preset: &[Term]) -> Result<Term, Error> {
    let TermTable { axis, term } = table;
    if !(1..=3).contains(axis) {
        return Err(at.unexpected("error_model", format!("axis = {axis}"), "axis = 1, 2 or 3"));
    }
    let axis = axis - 1;
    let monomial = Monomial::parse(term).filter(|monomial| monomial.degree() <= HIGHEST_DEGREE).ok_or_else(|| {
        let expected = format!(
            "a product of powers of f1, f2, f3 and at most one of |f1|, |f2|, |f3|, \
            of degree {HIGHEST_DEGREE} at most, such as f1*f2, f2*|f2|, f1^3 or 1"
        );
        at.unexpected("error_model", format!("term = {}", quoted(term.as_bytes())), expected)
    })?;
    if let Some(known) = preset.iter().find(|t| t.axis == axis && t.monomial == monomial) {
        return Ok(known.clone());
    }
    Ok(Term::new(axis, monomial))
}

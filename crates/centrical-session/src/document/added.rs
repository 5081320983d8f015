//! What became of results that were added to a store: schema `centrical-added/1`.

use serde::Serialize;

use super::result::Program;

/// Name of the schema's present version.
pub(crate) const ADDED_SCHEMA: &str = "centrical-added/1";

/// What became of results that were added to a store.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AddedReport {
    /// `centrical-added/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// Results that were not there.
    pub new: usize,
    /// Results that were there.
    pub known: usize,
}

impl AddedReport {
    /// Of `new` results that were not there and `known` ones that were.
    pub fn of(new: usize, known: usize) -> Self {
        Self { schema: ADDED_SCHEMA, program: Program::this(), new, known }
    }
}

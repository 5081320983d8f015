//! Numbers that others have published or computed independently: the source's printed formulas, and the ranks of
//! docs/source-and-findings.md.

#[path = "../common/mod.rs"]
mod common;

mod claims;
mod conditions;
mod control_charts;
mod gum;
mod history;
mod nbs14;
mod normalised;
mod printed;
mod rank_table;
mod square_root;
mod strd;

//! Records written by other programs: `../data/generate.py` says which, and wrote them.

mod formats;
#[path = "../common/record.rs"]
mod record;
mod stamps;

//! What holds for any input.

mod claims;
mod growing;
mod pieces;
#[path = "../common/record.rs"]
mod record;

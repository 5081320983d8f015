//! What holds for any input.

mod claims;
mod encodings;
mod growing;
mod pieces;
#[path = "../common/record.rs"]
mod record;
mod stamps;

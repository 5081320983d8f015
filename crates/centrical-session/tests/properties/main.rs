//! What holds for any input.

mod claims;
mod damage;
mod growing;
mod pieces;
mod predictions;
#[path = "../common/random.rs"]
mod random;
mod record_writer;
mod session_forms;
mod two_passes;
mod watched;

//! What holds for any input.

mod claims;
mod damage;
mod growing;
mod record_writer;
mod session_forms;
mod watched;

//! What holds for any input.

mod columns;
mod in_memory;
mod missing_readings;
mod past_with_priors;
mod predictions;
#[path = "../../../centrical/tests/common/random.rs"]
mod random;
mod record_writer;
mod rest_records;
mod rests;
mod session_forms;
mod stopping;
mod store;
mod three_files;
mod three_recorders;
mod two_passes;
mod watched;

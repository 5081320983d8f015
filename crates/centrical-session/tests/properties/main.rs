//! What holds for any input.

mod columns;
mod in_memory;
mod predictions;
mod record_writer;
mod session_forms;
mod stopping;
mod store;
mod three_files;
mod three_recorders;
mod two_passes;
mod watched;

//! The commands: each is a function that runs one job and gives the JSON text that the command prints.

pub mod calibrate;
pub mod history;
pub mod in_memory;
pub mod measure;
pub mod prepare;
pub mod report;
pub mod tumble;

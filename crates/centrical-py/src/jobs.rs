//! The commands: each is a function that runs one job and gives the JSON text that the command prints.

pub mod assess;
pub mod calibrate;
pub mod compare;
pub mod compensate;
pub mod history;
pub mod in_memory;
pub mod init;
pub mod models;
pub mod montecarlo;
pub mod noise;
pub mod observe;
pub mod plan;
pub mod reduce;
pub mod report;
pub mod schema;
pub mod series;
pub mod simulate;
pub mod tumble;

//! The commands: each has its arguments and a `run`.

pub mod assess;
pub mod calibrate;
pub mod compare;
pub mod compensate;
pub mod completions;
pub mod history;
pub mod init;
pub mod man;
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
#[cfg(feature = "serve")]
pub mod view;
pub mod watch;

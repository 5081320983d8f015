//! The real binary in a temporary folder: what it prints, what it leaves behind, how it ends.

mod calibrate;
mod compensate;
mod observe;
mod reduce;
mod refusal;
mod report;
mod session;
mod simulate;
mod trust;
mod watch;

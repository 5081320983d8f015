//! The real binary in a temporary folder: what it prints, what it leaves behind, how it ends.

mod axes;
mod calibrate;
mod comparisons;
mod compensate;
#[cfg(target_os = "linux")]
mod few_threads;
mod history;
mod history_mistakes;
mod init;
mod init_headers;
mod json;
#[cfg(unix)]
mod killed;
mod layouts;
#[cfg(all(unix, feature = "serve"))]
mod live;
mod noise;
mod observe;
mod overwritten;
mod plan;
mod plant;
#[path = "../common/program.rs"]
mod program;
#[path = "../../../centrical/tests/common/random.rs"]
mod random;
mod reduce;
mod refusal;
mod report;
#[cfg(all(unix, feature = "serve"))]
#[path = "../common/served.rs"]
mod served;
mod session;
mod simulate;
mod simulated_rests;
mod speeds;
mod steadiness;
mod trust;
mod tumble;
mod tumble_made;
mod tumble_mistakes;
mod watch;
mod watched_rests;
mod way_in;
mod whole_sessions;
mod width;

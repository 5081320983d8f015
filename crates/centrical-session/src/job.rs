//! The whole jobs, a file a command: what the binary, a fleet's worker and a notebook all call.

mod calibrate;
mod compensate;
mod noise;
mod observe;
mod plan;
mod reduce;
mod reduced_session;
mod simulate;
mod watch;

pub use self::calibrate::{Method, Problem, calibrate, calibrate_without};
pub use self::compensate::{Compensated, FirstOutside, compensate_record};
pub use self::noise::{Series, analyse_noise};
pub use self::observe::subject;
pub use self::plan::{PlanRequest, USUAL_LEVELS, plan, read_plan, read_planning};
pub use self::reduce::{reduce, reduce_without_inputs};
pub use self::reduced_session::write_reduced;
pub use self::simulate::simulate_session;
pub use self::watch::Watch;

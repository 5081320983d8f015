//! Text for the terminal: a file a command, and what several share.

mod assess;
mod axes;
mod calibrate;
mod compare;
mod compensate;
mod drift;
mod history;
mod models;
mod montecarlo;
mod noise;
mod observe;
mod phrases;
mod plan;
mod prediction;
mod rests;
mod rests_on;
mod screen;
mod table;
mod verdict;
mod watch;

pub use self::assess::assessment_text;
pub use self::compare::comparison_text;
pub use self::compensate::compensation_text;
pub use self::drift::reduction_text;
pub use self::history::{
    chart_text, finding_mark, history_list_text, station_history_text, unit_history_text, units_history_text,
};
pub use self::models::selection_table;
pub use self::montecarlo::monte_carlo_text;
pub use self::noise::{noise_table, noise_warnings};
pub use self::observe::observation_text;
pub use self::plan::plan_text;
pub(crate) use self::screen::Part;
pub use self::screen::{Emphasis, Line, Screen};
pub(crate) use self::table::{Align, Table};
pub use self::verdict::{exact_text, objections_text, result_text, unit_text};
pub use self::watch::{AlarmKind, alarm_text, frozen_text, states_text, watch_table};

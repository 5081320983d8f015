//! Text for the terminal: a file a command, and what several share.

mod alarm;
mod assess;
mod axes;
mod calibrate;
mod chance;
mod compare;
mod compensate;
mod drift;
mod history;
mod models;
mod montecarlo;
mod noise;
mod observe;
mod pattern;
mod plan;
mod prediction;
mod priors;
mod rests;
mod rests_line;
mod rests_on;
mod rivals;
mod screen;
mod short_list;
mod symbols;
mod table;
mod unit;
mod watch;
mod wrap;

pub use self::alarm::{AlarmKind, alarm_text, frozen_text};
pub use self::assess::assessment_text;
pub use self::calibrate::{terminal_table, verdict_text};
pub(crate) use self::compare::comparison_screen;
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
pub use self::unit::unit_text;
pub use self::watch::{states_text, watch_table};

//! What a calibration leaves on paper and screen. Pure functions from data to text, and the
//! files that a command writes of it.
//!
//! Everything is made from a [`centrical_session::CalibrationResult`], and what a certificate says beside it from a
//! [`centrical_session::Laboratory`]. The same data give the same bytes.

mod assessment;
mod certificate;
pub mod codegen;
mod compensate;
mod conformity;
mod customary;
mod dcc;
mod equation;
mod expanded;
mod figures;
mod files;
mod groups;
mod html;
mod language;
mod message;
mod noise;
mod observation;
mod pdf;
mod plan;
pub mod plot;
mod positions_figure;
mod reading_error;
mod steadiness;
mod terminal;
mod trials;
mod verdict;
mod watch;

pub use assessment::assessment_text;
pub use certificate::pdf_certificate;
pub use compensate::compensation_text;
pub use customary::{customary, with_uncertainty};
pub use dcc::digital_certificate;
pub use figures::{Figure, figures, history_figure};
pub use files::{DocumentRequest, write_all_documents, write_documents, write_history_plot, write_noise};
pub use html::{html_report, html_report_with};
pub use language::Language;
pub use noise::{noise_plots, noise_table, noise_warnings};
pub use observation::observation_text;
pub use plan::{frontier_plot, plan_text};
pub use positions_figure::positions_figure;
pub use terminal::{terminal_table, verdict_text};
pub use trials::{comparison_table, monte_carlo_text, selection_table};
pub use verdict::{Objection, objections};
pub use watch::{states_text, watch_table};

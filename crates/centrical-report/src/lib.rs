//! What a calibration leaves on paper and screen. Pure functions from data to text; no files, no network.
//!
//! [`report`] and [`certificate`] say what a document holds, as data; [`html`] and [`pdf`] draw any of them. The same
//! data give the same bytes.

pub mod codegen;
mod dcc;
mod document;
mod evaluation;
mod figure;
mod language;
mod number;
pub mod plot;
mod render;
mod terminal;

pub use dcc::digital_certificate;
pub use document::{
    Align, Block, Column, Document, Fact, Margins, Opening, Row, Section, Table, TableKind, Tone, certificate, report,
};
pub use evaluation::{Objection, objections};
pub use figure::{Figure, figures, frontier_plot, history_figure, noise_plots, positions_figure};
pub use language::Language;
pub use number::with_uncertainty;
pub use render::{html, pdf};
pub use terminal::{
    WatchView, WatchedTest, budget_table, comparison_table, correlation_table, monte_carlo_table, noise_table,
    noise_warnings, observation_text, outliers_text, plan_text, prediction_table, selection_table, states_text,
    terminal_table, validity_text, verdict_text, watch_table,
};

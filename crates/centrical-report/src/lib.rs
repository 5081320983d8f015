//! What a calibration leaves on paper and screen. Pure functions from data to text, and the
//! files that a command writes of it.
//!
//! [`report`] and [`certificate`] say what a document holds, as data; [`html`] and [`pdf`] draw any of them. The same
//! data give the same bytes.

pub mod codegen;
mod dcc;
mod document;
mod evaluation;
mod figure;
mod files;
mod language;
mod number;
mod picture;
pub mod plot;
mod render;
mod terminal;

pub use document::{Block, Document, Row, certificate, objection, report};
pub use evaluation::UnitStatement;
pub use figure::{Figure, chart_plots, comparison_plot, figures, frontier_plot, positions_figure, unit_history_plots};
pub use files::{
    DocumentRequest, Documents, PagesRequest, StorePages, certificates_in, read_issuer, refuse_outputs,
    write_all_documents, write_documents, write_history_pages, write_history_plot, write_noise, write_plots,
};
pub use language::Language;
pub use number::counted;
pub use render::{
    LIVE_SCRIPT, LIVE_STYLE, ListedResult, compared_page, html, live_page, live_panel, not_found, pdf, results_page,
    unchosen_page,
};
pub use terminal::{
    AlarmKind, Emphasis, Line, Screen, alarm_text, assessment_text, chart_text, comparison_text, compensation_text,
    exact_text, frozen_text, history_list_text, monte_carlo_text, noise_table, noise_warnings, objections_text,
    observation_text, plan_text, reduction_text, result_text, selection_table, states_text, station_history_text,
    unit_history_text, unit_text, units_history_text, watch_table,
};

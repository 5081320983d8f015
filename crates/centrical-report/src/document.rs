//! What the documents say: content as data, drawn by the renderers.

mod axes;
mod certificate;
mod conformity;
mod content;
mod drift;
mod objection;
mod reading_error;
mod report;
mod rests_on;
mod switch_on;
mod tables;

pub use self::certificate::{Issuer, certificate};
pub(crate) use self::certificate::{covered, method_text};
pub(crate) use self::conformity::{judged_in_words, rule};
pub use self::content::{
    Align, Attachment, Block, Column, Document, Fact, Layer, Margins, Opening, Picture, Row, Section, Table, TableKind,
    Tone,
};
pub(crate) use self::drift::{
    drift_facts, has_rounded_times, interpolated, not_used, plateaus_drift, session_drifts, tilts_agree, unscheduled,
};
pub use self::objection::objection;
pub(crate) use self::objection::rival;
pub use self::report::report;
pub(crate) use self::report::speeds;
pub(crate) use self::rests_on::{
    condition_of_conformity, counts_as_exact, presuppositions, rests_on_sentence, uncertainty_holds,
};
pub(crate) use self::switch_on::switch_on_sentence;
pub(crate) use self::tables::serial;

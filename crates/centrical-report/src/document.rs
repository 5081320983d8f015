//! What the documents say: content as data, drawn by the renderers.

mod certificate;
mod content;
mod drift;
mod objection;
mod reading_error;
mod report;
mod rests_on;
mod tables;

pub use self::certificate::certificate;
pub use self::content::{Align, Block, Column, Document, Fact, Margins, Opening, Row, Section, Table, TableKind, Tone};
pub(crate) use self::objection::{objection, rival};
pub use self::report::report;
pub(crate) use self::rests_on::rests_on_sentence;

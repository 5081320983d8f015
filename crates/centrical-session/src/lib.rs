//! What stands in the files of a session, and the whole jobs on them: session folders in, results out.
//!
//! Inputs are of any make: nothing in a file can make this crate panic, hang or fill the memory. What is
//! wrong with a file is an [`Error`] with the file, the place, what was found and what was expected.
//!
//! ```
//! use std::path::Path;
//!
//! use centrical_session::{Method, Session, calibrate, unwatched};
//!
//! let session = Session::read(Path::new("../../examples/ta-200"))?;
//! let result = calibrate(&session, &[], Method::Exact, &unwatched)?;
//! let bias = result.parameter("df_1").expect("the error model has a bias");
//! assert!(bias.estimable && bias.standard_uncertainty.is_some_and(|u| u < 1e-3));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Records and telemetry are tables in any format of [`centrical_table`]. Time is a number in a unit, a count of samples at
//! a rate, or (text and Parquet) a stamp. It never decreases; it may stand still.

mod document;
mod error;
mod experiment;
mod job;
mod laboratory;
mod quantity;
mod record;
mod reduced;
mod settings;
mod store;
mod truth;
mod units;

pub use centrical::reduction::{Record, RecordSlice, SpeedTrace};
pub use centrical::stability::Estimator;
pub use centrical::{OnProgress, STANDARD_GRAVITY, Stopped, advance, unwatched};
pub use centrical_table::{
    Bytes, ClaimedFolder, ColumnName, Source, TableFormat, abandon_files, claim_folder, create_folder, harmless,
    harmless_line, write_stream, write_together, write_whole,
};
pub use document::*;
pub use error::*;
pub use experiment::*;
pub use job::*;
pub use laboratory::*;
pub use quantity::*;
pub use record::*;
pub use reduced::*;
pub use store::*;
pub use truth::*;
pub use units::*;

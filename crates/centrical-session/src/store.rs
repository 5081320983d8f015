//! A store of calibrations: a folder with one compact row for each result, `STORE/rows/PART.parquet`, and the results themselves,
//! `STORE/results/KEY.json`.
//!
//! A part is written beside and renamed, under a lock that the system releases when its process ends. A merge of parts writes the
//! new one before it removes the old ones, and readers drop a key that they have seen. So a kill loses nothing and shows nothing twice.

mod contradiction;
mod folder;
mod part;
mod reading;
mod row;
mod schema;
mod writing;

pub(crate) use self::contradiction::{ROUNDING, of_terms};
pub use self::folder::{Store, wait_for_store};
pub use self::reading::{Rows, Selection};
pub use self::row::{Failure, Row, RowPrior, SharedInfluence, Status, TermSummary, sha256};
pub(crate) use self::row::{days_since_1970, packed};
pub use self::schema::Depth;
pub(crate) use self::schema::whole;
pub use self::writing::Added;
pub(crate) use self::writing::RowTable;

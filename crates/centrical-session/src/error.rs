//! What went wrong with a file, in the user's words: where, found, expected.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

pub use centrical_table::Place;
pub(crate) use centrical_table::{quoted, shown_path};

use centrical::plan::PlanError;
use centrical::reduction::ReductionError;
use centrical::stability::NoiseError;
use centrical::{FitError, STANDARD_GRAVITY, Stopped};
use centrical_compensate::NotInvertible;
use centrical_table::Error as TableError;

/// Why a session, a record or a table could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file cannot be read or written, or its content is not what its place calls for.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The experiment file does not follow the form: syntax, type of a value, unknown or missing key.
    #[error("{}{place}: {message}", shown_path(file))]
    Form {
        /// The file.
        file: PathBuf,
        /// Where in the file.
        place: Place,
        /// What the parser says: what it found and what it expected.
        message: String,
    },
    /// A record does not hold what the schedule says.
    #[error("{}, mounting {mounting}: {}{source}", shown_path(file), said_first(instead.as_ref()))]
    Reduction {
        /// The record.
        file: PathBuf,
        /// Number of the mounting, from 1.
        mounting: usize,
        /// What the record fits instead.
        instead: Option<Instead>,
        /// What was looked for and what was seen.
        source: Box<ReductionError>,
    },
    /// The plateau means of a session cannot be fitted.
    #[error("{}: {source}", shown_path(file))]
    Fit {
        /// The experiment file.
        file: PathBuf,
        /// Which plateau, and why.
        source: FitError,
    },
    /// A result does not say how to compensate.
    #[error("{}: {source}", shown_path(file))]
    ErrorModel {
        /// The result.
        file: PathBuf,
        /// Which coefficient, and why.
        source: NoErrorModel,
    },
    /// The error model of a result has no certain inverse over the range asked for.
    #[error("{}: {source}{}", shown_path(file), certain_range(source))]
    NotInvertible {
        /// The result.
        file: PathBuf,
        /// Why, and over what range it has one.
        source: NotInvertible,
    },
    /// There is no plan.
    #[error("{}: {source}", shown_path(file))]
    Planning {
        /// The plan file.
        file: PathBuf,
        /// Why.
        source: PlanError,
    },
    /// A column of readings cannot be analysed for noise.
    #[error("{}, {reading}: {source}", shown_path(file))]
    Noise {
        /// The file.
        file: PathBuf,
        /// The column.
        reading: String,
        /// What was found and what was expected.
        source: NoiseError,
    },
    /// Nothing can be simulated of a truth.
    #[error("{}: {source}", shown_path(file))]
    Simulation {
        /// The truth file.
        file: PathBuf,
        /// Which setting or value, and why.
        source: centrical::simulate::SimulationError,
    },
    /// The caller stopped the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// A document has a value that has no place in JSON.
    #[error("{document}: cannot be written as JSON: {source}")]
    Json {
        /// Its schema or file name.
        document: &'static str,
        /// Which value, and why.
        source: serde_json::Error,
    },
}

/// What kind of thing went wrong, for a program that has to choose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ErrorKind {
    /// There is no such file.
    Missing,
    /// The operating system refused to read or write a file.
    Io,
    /// What a file holds, or what follows from it, is not what was expected.
    Input,
    /// The caller stopped the work.
    Stopped,
    /// A document cannot be written: a fault of the program.
    Internal,
}

/// All plateaus of the record are where this would have them.
#[derive(Debug, Clone, PartialEq)]
pub enum Instead {
    /// Another mounting of the session.
    Mounting {
        /// Its number, from 1.
        number: usize,
        /// The id of its position.
        position: String,
        /// Its nominal place, arm axes [m].
        arm: [f64; 3],
    },
    /// Another attitude at this place.
    Attitude {
        /// Arm axes along which the instrument axes 1, 2, 3 point, as an experiment file has them.
        axes: String,
    },
    /// Another nominal place of the session, in the attitude that is stated.
    Arm {
        /// The place, arm axes [m].
        arm: [f64; 3],
    },
}

impl fmt::Display for Instead {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = |arm: &[f64; 3]| format!("({}, {}, {}) m", arm[0], arm[1], arm[2]);
        match self {
            Self::Mounting { number, position, arm } => write!(
                out,
                "the record shows all plateaus of mounting {number} (position {position:?}, arm {}): files or entries are exchanged, or \
                 the unit was there",
                place(arm)
            ),
            Self::Attitude { axes } => {
                write!(out, "the record shows all plateaus if axes = {axes:?}: the unit was turned, or axes are wrong")
            }
            Self::Arm { arm } => {
                write!(
                    out,
                    "the record shows all plateaus if arm = {}: the unit was there, or arm is wrong",
                    place(arm)
                )
            }
        }
    }
}

/// What a message begins with, if there is anything.
fn said_first(instead: Option<&Instead>) -> String {
    instead.map_or_else(String::new, |instead| format!("{instead}; "))
}

impl Error {
    /// A refused record, with what it fits instead.
    #[must_use]
    pub(crate) fn with_instead(self, fits: Option<Instead>) -> Self {
        match self {
            Self::Reduction { file, mounting, source, .. } => Self::Reduction { file, mounting, instead: fits, source },
            other => other,
        }
    }

    /// What kind of thing went wrong.
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Table(TableError::Missing { .. }) => ErrorKind::Missing,
            Self::Table(TableError::Io { .. }) => ErrorKind::Io,
            Self::Stopped(_) => ErrorKind::Stopped,
            Self::Json { .. } => ErrorKind::Internal,
            Self::Table(TableError::Content { .. })
            | Self::Form { .. }
            | Self::Reduction { .. }
            | Self::Fit { .. }
            | Self::ErrorModel { .. }
            | Self::NotInvertible { .. }
            | Self::Planning { .. }
            | Self::Noise { .. }
            | Self::Simulation { .. } => ErrorKind::Input,
        }
    }

    /// The file, if one is concerned.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::Table(
                TableError::Content { file, .. } | TableError::Missing { file, .. } | TableError::Io { file, .. },
            )
            | Self::Form { file, .. }
            | Self::Reduction { file, .. }
            | Self::Fit { file, .. }
            | Self::ErrorModel { file, .. }
            | Self::NotInvertible { file, .. }
            | Self::Planning { file, .. }
            | Self::Noise { file, .. }
            | Self::Simulation { file, .. } => Some(file),
            Self::Stopped(_) | Self::Json { .. } => None,
        }
    }

    /// The place in the file, if it is not the file as a whole.
    pub fn place(&self) -> Option<&Place> {
        match self {
            Self::Table(TableError::Content { place, .. }) | Self::Form { place, .. } => {
                Some(place).filter(|place| **place != Place::Whole)
            }
            _ => None,
        }
    }

    /// What was found, where it can be separated from the rest of the message.
    pub fn found(&self) -> Option<&str> {
        match self {
            Self::Table(TableError::Content { found, .. }) => Some(found),
            Self::Table(TableError::Missing { .. }) => Some("no such file"),
            _ => None,
        }
    }

    /// What was expected there.
    pub fn expected(&self) -> Option<&str> {
        match self {
            Self::Table(TableError::Content { expected, .. } | TableError::Missing { expected, .. }) => Some(expected),
            _ => None,
        }
    }

    /// The content of `file` at `place` is not what was expected.
    pub fn content(file: &Path, place: Place, found: impl Into<String>, expected: impl Into<String>) -> Self {
        TableError::content(file, place, found, expected).into()
    }

    /// The record in `file` does not hold what the schedule of a mounting, given by its index, says.
    pub(crate) fn reduction(file: &Path, mounting: usize, source: ReductionError) -> Self {
        Self::Reduction { file: file.to_owned(), mounting: mounting + 1, instead: None, source: Box::new(source) }
    }

    /// The plateau means of `file` cannot be fitted, or the caller stopped the fit.
    pub(crate) fn fit(file: &Path, source: FitError) -> Self {
        match source {
            FitError::Stopped(stopped) => stopped.into(),
            source => Self::Fit { file: file.to_owned(), source },
        }
    }

    /// There is no plan of `file`, or the caller stopped the search.
    pub(crate) fn planning(file: &Path, source: PlanError) -> Self {
        match source {
            PlanError::Stopped(stopped) => stopped.into(),
            source => Self::Planning { file: file.to_owned(), source },
        }
    }

    /// The noise of a `reading` of `file` cannot be analysed, or the caller stopped the analysis.
    pub(crate) fn noise(file: &Path, reading: &str, source: NoiseError) -> Self {
        match source {
            NoiseError::Stopped(stopped) => stopped.into(),
            source => Self::Noise { file: file.to_owned(), reading: reading.to_owned(), source },
        }
    }

    /// Reading `file`, which should be `expected`, failed with `source`.
    pub(crate) fn reading(file: &Path, source: io::Error, expected: &str) -> Self {
        TableError::reading(file, source, expected).into()
    }

    /// Writing `file` failed with `source`.
    pub fn writing(file: &Path, source: io::Error) -> Self {
        TableError::writing(file, source).into()
    }
}

/// The range in g that was too large, and the one that could be asked for.
fn certain_range(source: &NotInvertible) -> String {
    let (NotInvertible::TooNonlinear { range, .. }, Some(certain)) = (source, source.certain_range()) else {
        return String::new();
    };
    let [range, certain] = [*range, certain].map(|f| f / STANDARD_GRAVITY);
    format!("; found a range of {range:.3} g, expected one up to {certain:.3} g (--range)")
}

/// Why a result does not say how to compensate.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NoErrorModel {
    /// The data did not determine a coefficient.
    #[error("{name}: found no value, the data do not determine it; expected a number to compensate with")]
    NotEstimable {
        /// Name of the coefficient.
        name: String,
    },
    /// The reading jumps where a component changes its sign.
    #[error(
        "{name}: found a jump of the reading where f{number} changes its sign, expected a model without one: with a jump a model has \
         no unique inverse"
    )]
    Jump {
        /// Name of the coefficient.
        name: String,
        /// The component, from 1.
        number: usize,
    },
    /// A term is of no axis.
    #[error("{name}: found an axis that is not 1, 2 or 3")]
    Axis {
        /// Name of the coefficient.
        name: String,
    },
    /// The turns do not show the attitude of the case.
    #[error(
        "found {positions} positions on an arm whose turns delta_1, delta_2, delta_3 are all determined, and no rests in known \
         attitudes; expected two such positions, since the error of one seat cannot be separated from the attitude of the case, or \
         attitudes of rests (--attitudes of tumble, attitudes under [[tumble]])"
    )]
    Case {
        /// Positions that determine all three turns.
        positions: usize,
    },
    /// The turns of positions and those of rests in known attitudes are of two cases.
    #[error(
        "found the case by positions on the arm and by rests in known attitudes {apart} apart, expected one case, laid in one holder"
    )]
    TwoCases {
        /// Angle between them, and that in standard uncertainties.
        apart: String,
    },
    /// The error model cannot be stated in the axes asked for.
    #[error("found {found}, expected a scale matrix whose newtonometers point along three directions")]
    Axes {
        /// What was found.
        found: String,
    },
}

//! The columns of a row in a part, and how a row becomes cells and comes from them: schema `centrical-rows/2`.

use centrical::Group;
use centrical_table::{Cell, Kind, TypedColumn};

use super::row::{Row, RowPrior, SharedInfluence, Status, TermSummary};
use crate::error::quoted;

/// Name of the schema's present version.
pub const ROWS_SCHEMA: &str = "centrical-rows/2";

/// Key in the footer of a part under which the schema stands.
pub(super) const SCHEMA_NOTE: &str = "centrical_schema";

/// The columns whose cells have a form of their own, see [`misshapen`].
const KEY: &str = "key";
const ROW_VERSION: &str = "row_version";
const STATUS: &str = "status";
const GROUPS: &str = "groups";

/// The schema's present version.
pub(super) const VERSION: i64 = 2;

/// The first version of a row that this program does not know.
const VERSION_BEYOND: i64 = VERSION + 1;

/// How much of a row is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Depth {
    /// What one line of a list shows.
    #[default]
    Summary,
    /// The parameters with their uncertainties and the error model too.
    Values,
    /// Covariances and shared influences too, which a calibration keeps for the parameters of its unit alone, in a kB.
    Errors,
    /// Everything.
    Whole,
}

/// A column and its place in a row.
pub(super) struct Entry {
    pub column: TypedColumn,
    pub depth: Depth,
    pub get: fn(&Row) -> Cell,
    pub set: fn(&mut Row, Read),
}

/// The cell of a column that was read.
#[derive(PartialEq)]
pub(super) struct Read(pub Cell);

/// The columns in the order of the file. A column may be added; none is taken away.
#[rustfmt::skip]
pub(super) const ENTRIES: &[Entry] = &[
    Entry { column: TypedColumn { name: KEY, kind: Kind::Text }, depth: Depth::Summary, get: |r| text(&r.key), set: |r, c| r.key = c.text() },
    Entry { column: TypedColumn { name: ROW_VERSION, kind: Kind::Integer }, depth: Depth::Summary, get: |_| Cell::Integer(VERSION), set: |_, _| () },
    Entry { column: TypedColumn { name: STATUS, kind: Kind::Text }, depth: Depth::Summary, get: |r| text(r.status.word()), set: |r, c| r.status = Status::named(&c.text()).unwrap_or_default() },
    Entry { column: TypedColumn { name: "message", kind: Kind::Text }, depth: Depth::Summary, get: |r| text(&r.failure.message), set: |r, c| r.failure.message = c.text() },
    Entry { column: TypedColumn { name: "file", kind: Kind::Text }, depth: Depth::Summary, get: |r| text(&r.failure.file), set: |r, c| r.failure.file = c.text() },
    Entry { column: TypedColumn { name: "place", kind: Kind::Text }, depth: Depth::Summary, get: |r| text(&r.failure.place), set: |r, c| r.failure.place = c.text() },
    Entry { column: TypedColumn { name: "found", kind: Kind::Text }, depth: Depth::Summary, get: |r| text(&r.failure.found), set: |r, c| r.failure.found = c.text() },
    Entry { column: TypedColumn { name: "expected", kind: Kind::Text }, depth: Depth::Summary, get: |r| text(&r.failure.expected), set: |r, c| r.failure.expected = c.text() },
    Entry { column: TypedColumn { name: "unit_model", kind: Kind::Text }, depth: Depth::Summary, get: |r| text(&r.unit_model), set: |r, c| r.unit_model = c.text() },
    Entry { column: TypedColumn { name: "unit_serial", kind: Kind::Text }, depth: Depth::Summary, get: |r| text(&r.unit_serial), set: |r, c| r.unit_serial = c.text() },
    Entry { column: TypedColumn { name: "title", kind: Kind::Text }, depth: Depth::Summary, get: |r| text(&r.title), set: |r, c| r.title = c.text() },
    Entry { column: TypedColumn { name: "date", kind: Kind::Text }, depth: Depth::Summary, get: |r| text(&r.date), set: |r, c| r.date = c.text() },
    Entry { column: TypedColumn { name: "day", kind: Kind::Integer }, depth: Depth::Summary, get: |r| r.day.map_or(Cell::Null, Cell::Integer), set: |r, c| r.day = c.integer() },
    Entry { column: TypedColumn { name: "station", kind: Kind::Text }, depth: Depth::Summary, get: |r| text(&r.station), set: |r, c| r.station = c.text() },
    Entry { column: TypedColumn { name: "gravity", kind: Kind::Number }, depth: Depth::Summary, get: |r| Cell::Number(r.gravity), set: |r, c| r.gravity = c.number() },
    Entry { column: TypedColumn { name: "program", kind: Kind::Text }, depth: Depth::Summary, get: |r| text(&r.program), set: |r, c| r.program = c.text() },
    Entry { column: TypedColumn { name: "inputs", kind: Kind::Text }, depth: Depth::Summary, get: |r| text(&r.inputs), set: |r, c| r.inputs = c.text() },
    Entry { column: TypedColumn { name: "reference", kind: Kind::Text }, depth: Depth::Summary, get: |r| text(&r.reference), set: |r, c| r.reference = c.text() },
    Entry { column: TypedColumn { name: "range", kind: Kind::Numbers }, depth: Depth::Summary, get: |r| Cell::Numbers(r.range.clone()), set: |r, c| r.range = c.numbers() },
    Entry { column: TypedColumn { name: "termination", kind: Kind::Text }, depth: Depth::Summary, get: |r| text(&r.termination), set: |r, c| r.termination = c.text() },
    Entry { column: TypedColumn { name: "chi_squared", kind: Kind::Number }, depth: Depth::Summary, get: |r| Cell::Number(r.chi_squared), set: |r, c| r.chi_squared = c.number() },
    Entry { column: TypedColumn { name: "degrees_of_freedom", kind: Kind::Integer }, depth: Depth::Summary, get: |r| Cell::Integer(r.degrees_of_freedom), set: |r, c| r.degrees_of_freedom = c.integer().unwrap_or(0) },
    Entry { column: TypedColumn { name: "rank", kind: Kind::Integer }, depth: Depth::Summary, get: |r| Cell::Integer(r.rank), set: |r, c| r.rank = c.integer().unwrap_or(0) },
    Entry { column: TypedColumn { name: "columns", kind: Kind::Integer }, depth: Depth::Summary, get: |r| Cell::Integer(r.columns), set: |r, c| r.columns = c.integer().unwrap_or(0) },
    Entry { column: TypedColumn { name: "acceptable", kind: Kind::Truth }, depth: Depth::Summary, get: |r| Cell::Truth(r.acceptable), set: |r, c| r.acceptable = c.0 == Cell::Truth(true) },
    Entry { column: TypedColumn { name: "objections", kind: Kind::Texts }, depth: Depth::Summary, get: |r| Cell::Texts(r.objections.clone()), set: |r, c| r.objections = c.texts() },
    Entry { column: TypedColumn { name: "shared_known", kind: Kind::Truth }, depth: Depth::Summary, get: |r| Cell::Truth(r.shared_known), set: |r, c| r.shared_known = c.0 == Cell::Truth(true) },
    Entry { column: TypedColumn { name: "priors_known", kind: Kind::Truth }, depth: Depth::Summary, get: |r| Cell::Truth(r.priors_known), set: |r, c| r.priors_known = c.0 == Cell::Truth(true) },
    Entry { column: TypedColumn { name: "parameters", kind: Kind::Texts }, depth: Depth::Values, get: |r| Cell::Texts(r.parameters.clone()), set: |r, c| r.parameters = c.texts() },
    Entry { column: TypedColumn { name: "units", kind: Kind::Texts }, depth: Depth::Values, get: |r| Cell::Texts(r.units.clone()), set: |r, c| r.units = c.texts() },
    Entry { column: TypedColumn { name: GROUPS, kind: Kind::Texts }, depth: Depth::Values, get: |r| Cell::Texts(r.groups.iter().map(|g| g.name().to_owned()).collect()), set: |r, c| r.groups = c.texts().iter().filter_map(|name| group(name)).collect() },
    Entry { column: TypedColumn { name: "values", kind: Kind::Numbers }, depth: Depth::Values, get: |r| Cell::Numbers(r.values.clone()), set: |r, c| r.values = c.numbers() },
    Entry { column: TypedColumn { name: "standard_uncertainties", kind: Kind::Numbers }, depth: Depth::Values, get: |r| Cell::Numbers(r.standard_uncertainties.clone()), set: |r, c| r.standard_uncertainties = c.numbers() },
    Entry { column: TypedColumn { name: "output_unit", kind: Kind::Text }, depth: Depth::Values, get: |r| text(&r.output_unit), set: |r, c| r.output_unit = c.text() },
    Entry { column: TypedColumn { name: "output_scale", kind: Kind::Numbers }, depth: Depth::Values, get: |r| Cell::Numbers(r.output_scale.clone()), set: |r, c| r.output_scale = c.numbers() },
    Entry { column: TypedColumn { name: "output_bias", kind: Kind::Numbers }, depth: Depth::Values, get: |r| Cell::Numbers(r.output_bias.clone()), set: |r, c| r.output_bias = c.numbers() },
    Entry { column: TypedColumn { name: "terms", kind: Kind::Texts }, depth: Depth::Values, get: |r| Cell::Texts(r.terms.iter().map(|t| t.name.clone()).collect()), set: |r, c| r.terms = c.texts().into_iter().map(term).collect() },
    Entry { column: TypedColumn { name: "term_axes", kind: Kind::Integers }, depth: Depth::Values, get: |r| Cell::Integers(r.terms.iter().map(|t| whole(t.axis)).collect()), set: |r, c| set_axes(r, &c.integers()) },
    Entry { column: TypedColumn { name: "term_powers", kind: Kind::Integers }, depth: Depth::Values, get: |r| Cell::Integers(r.terms.iter().flat_map(|t| t.powers.map(i64::from)).collect()), set: |r, c| set_powers(r, &c.integers()) },
    Entry { column: TypedColumn { name: "term_signs", kind: Kind::Integers }, depth: Depth::Values, get: |r| Cell::Integers(r.terms.iter().map(|t| t.sign_of.map_or(0, whole)).collect()), set: |r, c| set_signs(r, &c.integers()) },
    Entry { column: TypedColumn { name: "covariance", kind: Kind::Numbers }, depth: Depth::Errors, get: |r| Cell::Numbers(r.covariance.clone()), set: |r, c| r.covariance = c.numbers() },
    Entry { column: TypedColumn { name: "shared_sources", kind: Kind::Texts }, depth: Depth::Errors, get: |r| Cell::Texts(r.shared.iter().map(|s| s.source.clone()).collect()), set: |r, c| r.shared = c.texts().into_iter().map(influence).collect() },
    Entry { column: TypedColumn { name: "shared_changes", kind: Kind::Numbers }, depth: Depth::Errors, get: |r| Cell::Numbers(r.shared.iter().flat_map(|s| s.changes.clone()).collect()), set: |r, c| share_out(r.shared.iter_mut().map(|s| &mut s.changes), &c.numbers()) },
    Entry { column: TypedColumn { name: "prior_parameters", kind: Kind::Texts }, depth: Depth::Whole, get: |r| Cell::Texts(r.priors.iter().map(|p| p.parameter.clone()).collect()), set: |r, c| r.priors = c.texts().into_iter().map(prior).collect() },
    Entry { column: TypedColumn { name: "prior_means", kind: Kind::Numbers }, depth: Depth::Whole, get: |r| Cell::Numbers(r.priors.iter().map(|p| p.mean).collect()), set: |r, c| r.priors.iter_mut().zip(c.numbers()).for_each(|(p, mean)| p.mean = mean) },
    Entry { column: TypedColumn { name: "prior_uncertainties", kind: Kind::Numbers }, depth: Depth::Whole, get: |r| Cell::Numbers(r.priors.iter().map(|p| p.standard_uncertainty).collect()), set: |r, c| r.priors.iter_mut().zip(c.numbers()).for_each(|(p, u)| p.standard_uncertainty = u) },
    Entry { column: TypedColumn { name: "prior_changes", kind: Kind::Numbers }, depth: Depth::Whole, get: |r| Cell::Numbers(r.priors.iter().flat_map(|p| p.changes.clone()).collect()), set: |r, c| share_out(r.priors.iter_mut().map(|p| &mut p.changes), &c.numbers()) },
];

/// The columns of a part.
pub(super) fn columns() -> Vec<TypedColumn> {
    ENTRIES.iter().map(|entry| entry.column).collect()
}

/// The cells of a row.
pub(super) fn cells(row: &Row) -> Vec<Cell> {
    ENTRIES.iter().map(|entry| (entry.get)(row)).collect()
}

/// What was found in a cell that cannot be read, and what was expected there.
pub(super) fn misshapen(column: &str, cell: &Cell) -> Option<(String, String)> {
    let of_word = |word: &String, expected: String| Some((quoted(word.as_bytes()), expected));
    match (column, cell) {
        (KEY, Cell::Text(key)) if is_key(key) => None,
        (KEY, Cell::Text(key)) => of_word(key, KEY_FORM.to_owned()),
        (KEY, _) => Some(("nothing".to_owned(), KEY_FORM.to_owned())),
        (ROW_VERSION, Cell::Integer(version @ VERSION_BEYOND..)) => {
            let expected = format!("{VERSION} or an older one; a newer program reads newer ones");
            Some((version.to_string(), expected))
        }
        (STATUS, Cell::Text(word)) if Status::named(word).is_none() => {
            of_word(word, "\"done\" or \"failed\"".to_owned())
        }
        (GROUPS, Cell::Texts(words)) => {
            let unknown = words.iter().find(|word| group(word).is_none())?;
            of_word(unknown, format!("one of {}", Group::ALL.map(Group::name).join(", ")))
        }
        _ => None,
    }
}

/// The form of a key.
const KEY_FORM: &str = "a SHA-256 of 64 hexadecimal digits, small letters";

fn is_key(text: &str) -> bool {
    text.len() == 64 && text.bytes().all(|digit| matches!(digit, b'0'..=b'9' | b'a'..=b'f'))
}

fn group(name: &str) -> Option<Group> {
    Group::ALL.into_iter().find(|group| group.name() == name)
}

impl Status {
    /// Its word in files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Failed => "failed",
        }
    }

    /// The one of that word.
    pub fn named(word: &str) -> Option<Self> {
        [Self::Done, Self::Failed].into_iter().find(|status| status.word() == word)
    }
}

impl Read {
    fn text(self) -> String {
        if let Cell::Text(text) = self.0 { text } else { String::new() }
    }

    fn number(self) -> f64 {
        if let Cell::Number(value) = self.0 { value } else { f64::NAN }
    }

    fn integer(self) -> Option<i64> {
        if let Cell::Integer(value) = self.0 { Some(value) } else { None }
    }

    fn texts(self) -> Vec<String> {
        if let Cell::Texts(list) = self.0 { list } else { Vec::new() }
    }

    fn numbers(self) -> Vec<f64> {
        if let Cell::Numbers(list) = self.0 { list } else { Vec::new() }
    }

    fn integers(self) -> Vec<i64> {
        if let Cell::Integers(list) = self.0 { list } else { Vec::new() }
    }
}

fn text(text: &str) -> Cell {
    if text.is_empty() { Cell::Null } else { Cell::Text(text.to_owned()) }
}

/// A number that is counted.
pub(crate) fn whole(number: usize) -> i64 {
    i64::try_from(number).unwrap_or(i64::MAX)
}

/// A term by its name; what else it has is read later.
fn term(name: String) -> TermSummary {
    TermSummary { name, axis: 0, powers: [0; 3], sign_of: None }
}

fn set_axes(row: &mut Row, axes: &[i64]) {
    for (term, axis) in row.terms.iter_mut().zip(axes) {
        term.axis = usize::try_from(*axis).unwrap_or(0);
    }
}

fn set_powers(row: &mut Row, powers: &[i64]) {
    for (term, powers) in row.terms.iter_mut().zip(powers.chunks_exact(3)) {
        term.powers = [0, 1, 2].map(|axis: usize| u8::try_from(powers[axis]).unwrap_or(0));
    }
}

fn set_signs(row: &mut Row, signs: &[i64]) {
    for (term, sign) in row.terms.iter_mut().zip(signs) {
        term.sign_of = usize::try_from(*sign).ok().filter(|sign| *sign > 0);
    }
}

/// An influence with its source alone, before its changes are read.
fn influence(source: String) -> SharedInfluence {
    SharedInfluence { source, changes: Vec::new() }
}

/// Splits the changes of all influences, or of all priors, into equal parts, one for each.
fn share_out<'r>(to: impl ExactSizeIterator<Item = &'r mut Vec<f64>>, changes: &[f64]) {
    let count = changes.len() / to.len().max(1);
    to.zip(changes.chunks(count.max(1))).for_each(|(to, changes)| *to = changes.to_vec());
}

/// A prior with its parameter alone, before the other columns are read.
fn prior(parameter: String) -> RowPrior {
    RowPrior { parameter, mean: 0.0, standard_uncertainty: f64::NAN, changes: Vec::new() }
}

//! Columns of an Arrow schema: which are numbers, and where they stand among the nodes and buffers of a batch.

use std::path::Path;

use polars_arrow_format::ipc::planus::ReadAsRoot;
use polars_arrow_format::ipc::{
    DateUnit, Endianness, FieldRef, MessageHeaderRef, MessageRef, Precision, SchemaRef, TimeUnit, TypeRef,
};

use super::super::arrays::{Array, ArrayColumn, Bytes, Scalar, ScalarKind};
use super::super::columnar::place_of;
use super::super::dates::SECONDS_OF_DAY;
use super::messages::{CONTINUATION, damaged};
use crate::column::{Field, Rule};
use crate::error::{Error, Place};
use crate::stamp::{TickForm, TickUnit};

/// A column that a field asks for.
pub(super) struct ArrowColumn {
    pub name: String,
    /// Its node and its first buffer, that of the missing values.
    pub node: usize,
    pub buffer: usize,
    scalar: Scalar,
    /// How its values are counted.
    pub stamps: Stamps,
}

/// How values are counted that are stamps, dates or times of the day, and the ticks of one of them.
type Stamps = Option<(TickForm, i64)>;

/// Deepest nesting of types, and most of them in all: a damaged schema may contain itself.
const LIMITS: Limits = Limits { depth: 32, count: 1 << 16 };

/// How many types may still be looked at.
struct Limits {
    depth: usize,
    count: usize,
}

/// The names of the columns.
pub(super) fn names(file: &Path, schema: SchemaRef) -> Result<Vec<String>, Error> {
    let fields = schema.fields().map_err(|e| damaged(file, e))?.into_iter().flatten();
    fields
        .map(|field| Ok(field?.name()?.unwrap_or_default().to_owned()))
        .collect::<Flat<_>>()
        .map_err(|e| damaged(file, e))
}

/// The columns that the fields ask for.
pub(super) fn find(file: &Path, schema: SchemaRef, fields: &[Field]) -> Result<Vec<ArrowColumn>, Error> {
    let failed = |e| damaged(file, e);
    let big_endian = schema.endianness().map_err(failed)? == Endianness::Big;
    let listed = schema.fields().map_err(failed)?;
    let columns: Vec<FieldRef> = listed.into_iter().flatten().collect::<Result<_, _>>().map_err(failed)?;
    let names = names(file, schema)?;
    let one = |field: &Field| {
        let wrong = |found: String, expected: &str| {
            Err(Error::content(file, Place::Column(field.name.to_string()), found, expected))
        };
        let place = place_of(file, &names, field)?;
        let (mut node, mut buffer, mut limits) = (0, 0, LIMITS);
        for (column, name) in columns[..place].iter().zip(&names) {
            let Some((nodes, buffers)) = size(column, &mut limits).map_err(failed)? else {
                return wrong(
                    format!("it after {name:?}, a column of nested or viewed values"),
                    "columns of plain types",
                );
            };
            (node, buffer) = (node + nodes, buffer + buffers);
        }
        match numbers(&columns[place], field.rule, big_endian).map_err(failed)? {
            Ok((scalar, stamps)) => Ok(ArrowColumn { name: names[place].clone(), node, buffer, scalar, stamps }),
            Err(other) => wrong(other, &field.expected),
        }
    };
    fields.iter().map(one).collect()
}

impl ArrowColumn {
    /// Its array in a batch.
    pub fn array(&self, rows: u64, bytes: Bytes) -> Array {
        let column = ArrayColumn { name: String::new(), start: 0, scalar: self.scalar };
        Array {
            name: self.name.clone(),
            bytes,
            rows,
            stride: self.scalar.size as u64,
            columns: vec![column],
            halves: Vec::new(),
        }
    }
}

type Flat<T> = Result<T, polars_arrow_format::ipc::planus::Error>;

/// The numbers of a column, and how they are counted if they are stamps; or what it is if it is neither numbers nor, where allowed, stamps.
fn numbers(column: &FieldRef, rule: Rule, big_endian: bool) -> Flat<Result<(Scalar, Stamps), String>> {
    let described = || Ok(Err("a column without numbers".to_owned()));
    let (Some(kind), None) = (column.type_()?, column.dictionary()?) else { return described() };
    let (kind, bits, stamps) = match kind {
        TypeRef::Int(int) if rule.takes_numbers() && int.is_signed()? => (ScalarKind::Signed, int.bit_width()?, None),
        TypeRef::Int(int) if rule.takes_numbers() => (ScalarKind::Unsigned, int.bit_width()?, None),
        TypeRef::FloatingPoint(float) if rule.takes_numbers() => match float.precision()? {
            Precision::Half => (ScalarKind::Float, 16, None),
            Precision::Single => (ScalarKind::Float, 32, None),
            Precision::Double => (ScalarKind::Float, 64, None),
        },
        TypeRef::Timestamp(stamp) if rule == (Rule::Ascending { stamps: true }) => {
            let is_utc = stamp.timezone()?.is_some_and(|zone| !zone.is_empty());
            (ScalarKind::Signed, 64, Some((TickForm { unit: tick_unit(stamp.unit()?), is_utc }, 1)))
        }
        TypeRef::Time(time) if rule == Rule::TimeOfDay => {
            let form = TickForm { unit: tick_unit(time.unit()?), is_utc: false };
            (ScalarKind::Signed, time.bit_width()?, Some((form, 1)))
        }
        TypeRef::Date(date) if rule == Rule::Date => {
            let (bits, unit, ticks) = match date.unit()? {
                DateUnit::Day => (32, TickUnit::Second, SECONDS_OF_DAY),
                DateUnit::Millisecond => (64, TickUnit::Millisecond, 1),
            };
            (ScalarKind::Signed, bits, Some((TickForm { unit, is_utc: false }, ticks)))
        }
        TypeRef::Duration(_) => return Ok(Err("a duration".to_owned())),
        _ => return described(),
    };
    let scalar = usize::try_from(bits / 8).ok().and_then(|size| Scalar::new(kind, size, big_endian));
    Ok(scalar.map(|scalar| (scalar, stamps)).ok_or_else(|| format!("numbers of {bits} bits")))
}

fn tick_unit(unit: TimeUnit) -> TickUnit {
    match unit {
        TimeUnit::Second => TickUnit::Second,
        TimeUnit::Millisecond => TickUnit::Millisecond,
        TimeUnit::Microsecond => TickUnit::Microsecond,
        TimeUnit::Nanosecond => TickUnit::Nanosecond,
    }
}

/// Names of the columns that are durations, of a schema as Parquet files keep it: a message of a stream.
pub(in crate::binary) fn durations(message: &[u8]) -> Vec<String> {
    let schema = || {
        let after_length = message.strip_prefix(&CONTINUATION).unwrap_or(message).get(4..)?;
        match MessageRef::read_as_root(after_length).ok()?.header().ok()?? {
            MessageHeaderRef::Schema(schema) => schema.fields().ok()?,
            _ => None,
        }
    };
    let fields = schema().into_iter().flatten().filter_map(Result::ok);
    let durations = fields.filter(|field| matches!(field.type_(), Ok(Some(TypeRef::Duration(_)))));
    durations.filter_map(|field| field.name().ok()?.map(str::to_owned)).collect()
}

/// Nodes and buffers of a column; none where their number depends on the batch.
fn size(column: &FieldRef, limits: &mut Limits) -> Flat<Option<(usize, usize)>> {
    let (Some(depth), Some(count)) = (limits.depth.checked_sub(1), limits.count.checked_sub(1)) else {
        return Ok(None);
    };
    *limits = Limits { depth, count };
    let own = match column.type_()? {
        _ if column.dictionary()?.is_some() => 2,
        Some(TypeRef::Null(_)) => 0,
        Some(TypeRef::Struct(_) | TypeRef::FixedSizeList(_)) => 1,
        Some(TypeRef::Binary(_) | TypeRef::Utf8(_) | TypeRef::LargeBinary(_) | TypeRef::LargeUtf8(_)) => 3,
        Some(
            TypeRef::Union(_)
            | TypeRef::RunEndEncoded(_)
            | TypeRef::BinaryView(_)
            | TypeRef::Utf8View(_)
            | TypeRef::ListView(_)
            | TypeRef::LargeListView(_),
        )
        | None => return Ok(None),
        Some(_) => 2,
    };
    let mut total = (1, own);
    let children = if column.dictionary()?.is_some() { None } else { column.children()? };
    for child in children.into_iter().flatten() {
        let Some((nodes, buffers)) = size(&child?, limits)? else { return Ok(None) };
        total = (total.0 + nodes, total.1 + buffers);
    }
    limits.depth += 1;
    Ok(Some(total))
}

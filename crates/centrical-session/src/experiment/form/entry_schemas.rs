//! JSON Schemas of the entries that may be written in more than one way.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};

use super::entries::{
    AttitudeList, ColumnEntry, ColumnLabel, ColumnTable, PriorTable, PriorValue, RecordEntry, Steps, StepsTable,
    TermList, TermTable,
};
use crate::quantity::Quantity;

impl JsonSchema for TermList {
    fn schema_name() -> Cow<'static, str> {
        "TermList".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let term = generator.subschema_for::<TermTable>();
        json_schema!({ "anyOf": [{ "type": "string" }, { "type": "array", "items": { "anyOf": [{ "type": "string" }, term] } }] })
    }
}

impl JsonSchema for Steps {
    fn schema_name() -> Cow<'static, str> {
        "Steps".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let list = generator.subschema_for::<Vec<Quantity>>();
        json_schema!({ "anyOf": [list, generator.subschema_for::<StepsTable>()] })
    }
}

impl JsonSchema for ColumnLabel {
    fn schema_name() -> Cow<'static, str> {
        "ColumnLabel".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [{ "type": "string" }, { "type": "integer", "minimum": 1 }] })
    }
}

impl JsonSchema for ColumnEntry {
    fn schema_name() -> Cow<'static, str> {
        "ColumnEntry".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let label = generator.subschema_for::<ColumnLabel>();
        json_schema!({ "anyOf": [label, generator.subschema_for::<ColumnTable>()] })
    }
}

impl JsonSchema for PriorValue {
    fn schema_name() -> Cow<'static, str> {
        "Prior".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let about_zero = generator.subschema_for::<Quantity>();
        json_schema!({ "anyOf": [about_zero, generator.subschema_for::<PriorTable>()] })
    }
}

impl JsonSchema for RecordEntry {
    fn schema_name() -> Cow<'static, str> {
        "Record".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let three = json_schema!({ "type": "array", "items": { "type": "string" }, "minItems": 3, "maxItems": 3 });
        json_schema!({ "anyOf": [{ "type": "string" }, three] })
    }
}

impl JsonSchema for AttitudeList {
    fn schema_name() -> Cow<'static, str> {
        "Attitudes".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let list = generator.subschema_for::<Vec<[f64; 3]>>();
        json_schema!({ "anyOf": [{ "type": "string" }, list] })
    }
}

/// A name, or a number for short.
pub(super) fn name_or_number(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "anyOf": [{ "type": "string" }, { "type": "integer" }] })
}

/// A date, or any text.
pub(super) fn date_or_text(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "string" })
}

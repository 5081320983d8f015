//! Tables, and facts, that several documents have.

use centrical_session::{CalibrationResult, ModelSummary, OutputSummary, ParameterEstimate, SessionSummary, customary};

use super::content::{Align, Block, Row, Table, TableKind};
use crate::evaluation::{Expanded, expanded, is_nearly_infinite, symbol};
use crate::language::Language;

/// The serial number of a unit, or that the session gives none.
pub(crate) fn serial(session: &SessionSummary, language: Language) -> &str {
    if session.unit_serial.is_empty() { language.messages().not_given } else { &session.unit_serial }
}

/// A fact that only an arm has: rests alone leave it empty, and an empty fact is not shown.
pub(super) fn of_arm(model: &ModelSummary, fact: String) -> String {
    if model.has_arm() { fact } else { String::new() }
}

/// Estimates with expanded uncertainties, in customary units and in SI, group by group.
pub(super) fn parameters(result: &CalibrationResult, shown: &[&ParameterEstimate], language: Language) -> Table {
    let messages = language.messages();
    let columns = [
        (messages.parameter, 0.12, Align::Left),
        (messages.value, 0.24, Align::Right),
        (messages.unit, 0.12, Align::Left),
        (messages.coverage_and_degrees, 0.16, Align::Right),
        (messages.value_si, 0.26, Align::Right),
        (messages.unit, 0.1, Align::Left),
    ];
    let rows = rows_by_group(result, shown, language);
    Table { kind: TableKind::Parameters, rows, ..Table::numbers(columns, []) }
}

/// A row for each parameter, those of a group below its name.
pub(super) fn rows_by_group(result: &CalibrationResult, shown: &[&ParameterEstimate], language: Language) -> Vec<Row> {
    let in_group = |of: &[&ParameterEstimate]| {
        let rows = of.iter().map(|parameter| Row::Cells(cells(result, parameter, language)));
        let name = (language.messages().words.group)(of[0].group);
        std::iter::once(Row::Group(name.to_owned())).chain(rows).collect::<Vec<_>>()
    };
    shown.chunk_by(|a, b| a.group == b.group).flat_map(in_group).collect()
}

/// The coefficients of the error model, or all other parameters, by group: groups in the order of their first member.
pub(super) fn by_group(result: &CalibrationResult, coefficients: bool) -> Vec<&ParameterEstimate> {
    let shown: Vec<_> = result.parameters.iter().filter(|p| result.is_coefficient(p) == coefficients).collect();
    let mut sorted = shown.clone();
    sorted.sort_by_key(|parameter| shown.iter().position(|first| first.group == parameter.group));
    sorted
}

/// `axis 1`, `axis 2`, `axis 3`.
pub(super) fn axis_titles(language: Language) -> [String; 3] {
    [1, 2, 3].map(|axis| format!("{} {axis}", language.messages().axis))
}

/// The coverage factor, beside it the effective degrees of freedom where they are finite.
pub(super) fn coverage(expanded: &Expanded, language: Language) -> String {
    let k = language.fixed(expanded.factor, 2);
    let degrees = expanded.degrees_of_freedom.map(|nu| format!("{k} ({})", degrees_of_freedom(nu, language)));
    degrees.unwrap_or(k)
}

/// Effective degrees of freedom, cut to a whole number.
pub(super) fn degrees_of_freedom(nu: f64, language: Language) -> String {
    if is_nearly_infinite(nu) { ">1000".to_owned() } else { language.fixed(nu.floor(), 0) }
}

/// Symbol, value and unit in the customary unit, coverage factor, the same in SI.
fn cells(result: &CalibrationResult, parameter: &ParameterEstimate, language: Language) -> Vec<String> {
    let (factor, unit) = customary(&parameter.unit, parameter.group);
    let [shown, k, si] = match (parameter.value, expanded(result, parameter)) {
        (Some(value), Some(expanded)) => [
            language.plus_minus(value * factor, expanded.uncertainty * factor),
            coverage(&expanded, language),
            language.plus_minus_scientific(value, expanded.uncertainty),
        ],
        _ => [language.messages().not_determined.to_owned(), String::new(), String::new()],
    };
    // A number has no unit.
    let si_unit = if parameter.unit == "1" { String::new() } else { language.unit(&parameter.unit) };
    vec![symbol(&parameter.name), shown, language.unit(unit), k, si, si_unit]
}

/// The nominal scale and bias of a unit that does not put out an acceleration.
pub(super) fn nominal_output(result: &CalibrationResult, language: Language) -> Vec<Block> {
    let messages = language.messages();
    let Some(OutputSummary { unit, scale, bias }) = result.raw_output() else { return Vec::new() };
    let unit = language.unit(unit);
    let row = |name: &str, numbers: &[f64; 3], unit: String| {
        let numbers = numbers.iter().map(|number| language.number(&number.to_string()));
        [name.to_owned(), unit].into_iter().chain(numbers).collect::<Vec<_>>()
    };
    let per_force = format!("{unit}/({})", language.unit("m/s^2"));
    let rows = [row(messages.nominal_scale, scale, per_force), row(messages.nominal_bias, bias, unit)];
    let axes = axis_titles(language);
    let columns = [
        ("", 0.2, Align::Left),
        (messages.unit, 0.14, Align::Left),
        (&axes[0], 0.22, Align::Right),
        (&axes[1], 0.22, Align::Right),
        (&axes[2], 0.22, Align::Right),
    ];
    let found = result.model.nominal_found.then(|| Block::paragraph(messages.nominal_found));
    let blocks = [
        Block::Subheading(messages.nominal_output.to_owned()),
        Block::paragraph(messages.nominal_output_text),
        Block::Table(Table::numbers(columns, rows)),
    ];
    blocks.into_iter().chain(found).collect()
}

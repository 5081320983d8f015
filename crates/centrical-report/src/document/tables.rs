//! Tables of the report.

use centrical_session::{BudgetSource, CalibrationResult, ModelSummary, ParameterEstimate, customary};

use super::content::{Align, Column, Row, Table, TableKind};
use crate::evaluation::{expanded, symbol};
use crate::language::Language;

/// What a source leaves is not shown below this part of the combined uncertainty.
const NEGLIGIBLE: f64 = 1e-3;

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
    let mut table = Table { kind: TableKind::Parameters, ..Table::numbers(columns, []) };
    let mut group = None;
    for parameter in shown {
        if group != Some(parameter.group) {
            group = Some(parameter.group);
            table.rows.push(Row::Group((messages.words.group)(parameter.group).to_owned()));
        }
        table.rows.push(Row::Cells(cells(result, parameter, language)));
    }
    table
}

/// Symbol, value and unit in the customary unit, coverage factor, the same in SI. Effective degrees of freedom stand beside
/// the coverage factor where they are finite.
pub(super) fn cells(result: &CalibrationResult, parameter: &ParameterEstimate, language: Language) -> Vec<String> {
    let (factor, unit) = customary(&parameter.unit, parameter.group);
    let [shown, k, si] = match (parameter.value, expanded(result, parameter)) {
        (Some(value), Some(expanded)) => {
            let k = language.fixed(expanded.factor, 2);
            let degrees = expanded.degrees_of_freedom.map(|nu| format!("{k} ({})", language.fixed(nu, 0)));
            [
                language.plus_minus(value * factor, expanded.uncertainty * factor),
                degrees.unwrap_or(k),
                language.plus_minus_scientific(value, expanded.uncertainty),
            ]
        }
        _ => [language.messages().not_determined.to_owned(), String::new(), String::new()],
    };
    vec![symbol(&parameter.name), shown, language.unit(unit), k, si, language.unit(&parameter.unit)]
}

/// Standard uncertainty by source; `None` if no budget was made.
pub(super) fn budget(result: &CalibrationResult, language: Language) -> Option<Table> {
    let messages = language.messages();
    let budget = result.budget.as_ref()?;
    let mut titles = vec![messages.parameter, messages.unit];
    titles.extend(budget.sources.iter().map(|source| (messages.words.source)(source.name)));
    titles.extend([messages.combined, messages.degrees_word]);
    let share = 1.0 / titles.len() as f32;
    let column = |(n, title): (usize, &str)| {
        let align = if n < 2 { Align::Left } else { Align::Right };
        Column { title: title.to_owned(), share, align }
    };
    let columns = titles.into_iter().enumerate().map(column).collect();
    let row = |(j, parameter): (usize, &ParameterEstimate)| {
        let (factor, unit) = customary(&parameter.unit, parameter.group);
        let shown = |value: Option<f64>| value.map_or(String::new(), |value| language.significant(value * factor, 2));
        let combined = budget.combined.get(j).copied().flatten();
        let negligible = NEGLIGIBLE * combined.unwrap_or(0.0);
        let of_source = |source: &BudgetSource| {
            let value = source.standard_uncertainty.get(j).copied().flatten();
            if value.is_some_and(|value| value < negligible) { "–".to_owned() } else { shown(value) }
        };
        let mut cells = vec![symbol(&parameter.name), language.unit(unit)];
        cells.extend(budget.sources.iter().map(of_source));
        if combined.is_some() {
            let degrees = budget.degrees_of_freedom.get(j).copied().flatten();
            cells.extend([shown(combined), degrees.map_or("∞".to_owned(), |nu| language.fixed(nu.floor(), 0))]);
        } else {
            cells.extend([messages.not_determined.to_owned(), String::new()]);
        }
        Row::Cells(cells)
    };
    let rows = result.parameters.iter().enumerate().map(row).collect();
    Some(Table { kind: TableKind::Numbers, columns, rows })
}

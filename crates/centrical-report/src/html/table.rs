//! Tables of the report.

use std::fmt::Write;

use centrical_session::{BudgetSource, CalibrationResult, ParameterEstimate};

use crate::customary::customary;
use crate::expanded::expanded;
use crate::language::Language;
use crate::plot::Escaped;

/// What a source leaves is not shown below this part of the combined uncertainty.
const NEGLIGIBLE: f64 = 1e-3;

/// A table that grows row by row.
pub(super) struct Table {
    html: String,
}

impl Table {
    /// An empty table of a class of the style sheet.
    pub fn new(class: &str) -> Self {
        Self { html: format!("<div class=\"scroll\"><table class=\"{class}\">") }
    }

    /// The table with names over its columns.
    pub fn with_head(mut self, names: &[String]) -> Self {
        let cells = names.iter().map(|name| format!("<th scope=\"col\">{}</th>", Escaped(name)));
        let _ = write!(self.html, "<thead><tr>{}</tr></thead>", cells.collect::<String>());
        self
    }

    /// One more row.
    pub fn row(&mut self, name: &str, cells: &[String]) {
        let cells = cells.iter().map(|cell| format!("<td>{}</td>", Escaped(cell)));
        let _ = write!(self.html, "<tr><th scope=\"row\">{}</th>{}</tr>", Escaped(name), cells.collect::<String>());
    }

    /// The finished table.
    pub fn into_html(self) -> String {
        self.html + "</table></div>\n"
    }
}

/// Estimates with expanded uncertainties, in customary units and in SI, group by group.
pub(super) fn parameters(result: &CalibrationResult, shown: &[&ParameterEstimate], language: Language) -> String {
    let messages = language.messages();
    let head = [messages.parameter, messages.value, messages.unit, messages.value_si, messages.unit];
    let mut table = Table::new("parameters").with_head(&head.map(str::to_owned));
    let mut group = "";
    for parameter in shown {
        if parameter.group != group {
            group = &parameter.group;
            let name = Escaped(messages.word(group));
            let _ = write!(table.html, "<tr class=\"group\"><th colspan=\"5\" scope=\"rowgroup\">{name}</th></tr>");
        }
        table.row(&parameter.name, &cells(result, parameter, language));
    }
    table.into_html()
}

fn cells(result: &CalibrationResult, parameter: &ParameterEstimate, language: Language) -> [String; 4] {
    let (factor, unit) = customary(&parameter.unit, &parameter.group);
    let (Some(value), Some(expanded)) = (parameter.value, expanded(result, parameter)) else {
        let unknown = language.messages().not_determined.to_owned();
        return [unknown, language.unit(unit), String::new(), language.unit(&parameter.unit)];
    };
    let expanded = expanded.uncertainty;
    [
        language.plus_minus(value * factor, expanded * factor),
        language.unit(unit),
        language.plus_minus_scientific(value, expanded),
        language.unit(&parameter.unit),
    ]
}

/// Standard uncertainty by source; none if no budget was made.
pub(super) fn budget(result: &CalibrationResult, language: Language) -> Option<String> {
    let messages = language.messages();
    let budget = result.budget.as_ref()?;
    let mut head = vec![messages.parameter.to_owned(), messages.unit.to_owned()];
    head.extend(budget.sources.iter().map(|source| messages.word(&source.name).to_owned()));
    head.extend([messages.combined, messages.degrees_word].map(str::to_owned));
    let mut table = Table::new("numbers").with_head(&head);
    for (j, parameter) in result.parameters.iter().enumerate() {
        let (factor, unit) = customary(&parameter.unit, &parameter.group);
        let shown = |value: Option<f64>| value.map_or(String::new(), |value| language.significant(value * factor, 2));
        let mut cells = vec![language.unit(unit)];
        let combined = budget.combined.get(j).copied().flatten();
        let negligible = NEGLIGIBLE * combined.unwrap_or(0.0);
        let of_source = |source: &BudgetSource| {
            let value = source.standard_uncertainty.get(j).copied().flatten();
            if value.is_some_and(|value| value < negligible) { "–".to_owned() } else { shown(value) }
        };
        cells.extend(budget.sources.iter().map(of_source));
        if combined.is_some() {
            let degrees = budget.degrees_of_freedom.get(j).copied().flatten();
            cells.extend([shown(combined), degrees.map_or("∞".to_owned(), |nu| language.fixed(nu, 0))]);
        } else {
            cells.extend([messages.not_determined.to_owned(), String::new()]);
        }
        table.row(&parameter.name, &cells);
    }
    Some(table.into_html())
}

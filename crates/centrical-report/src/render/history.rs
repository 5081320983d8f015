//! The pages of a store: a list of its calibrations, a page for each unit and each station. No network; one short script sorts and
//! filters the list, which is whole without it.

use std::collections::BTreeMap;
use std::fmt::Write;

use centrical_session::{HistoryLine, HistoryList, StationHistoryReport, UnitHistoryReport};

use crate::figure::unit_history_plots;
use crate::plot::Escaped;
use crate::terminal::{Screen, station_history_text, unit_history_text};

const STYLE: &str = include_str!("html/style.css");
const LIST_STYLE: &str = include_str!("html/list.css");
const SCRIPT: &str = include_str!("html/list.js");

/// Where the pages of units and stations are: file by model and serial number, and by name.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct HistoryPages {
    /// Of units: model and serial number.
    pub units: BTreeMap<(String, String), String>,
    /// Of stations.
    pub stations: BTreeMap<String, String>,
}

/// The list of all calibrations.
pub fn history_index(list: &HistoryList, pages: &HistoryPages) -> String {
    let count = list.calibrations.len();
    let mut body = format!(
        "<header><p class=\"kind\">Calibrations</p><h1>{}</h1><p>{count} calibrations</p></header>\n",
        Escaped(&list.store)
    );
    if !pages.stations.is_empty() {
        body.push_str("<nav><h2>Stations</h2><ul>");
        for (station, file) in &pages.stations {
            let name = if station.is_empty() { "without a name" } else { station };
            let _ = write!(body, "<li><a href=\"{}\">{}</a></li>", Escaped(file), Escaped(name));
        }
        body.push_str("</ul></nav>\n");
    }
    body.push_str(
        "<form class=\"filters\" role=\"search\"><label>Serial, model or station <input id=\"words\" type=\"search\"></label>\
         <label>from <input id=\"from\" type=\"date\"></label><label>to <input id=\"to\" type=\"date\"></label>\
         <label>Verdict <select id=\"verdict\"><option value=\"\">all</option><option>acceptable</option><option>not acceptable</option>\
         <option>failed</option></select></label><output id=\"count\"></output></form>\n\
         <div class=\"scroll\"><table id=\"list\"><thead><tr><th scope=\"col\">date</th><th scope=\"col\">model</th><th scope=\"col\">serial</th>\
         <th scope=\"col\">station</th><th scope=\"col\" class=\"number\">chi^2/nu</th><th scope=\"col\">verdict</th></tr></thead><tbody>\n",
    );
    for line in &list.calibrations {
        row(&mut body, line, pages);
    }
    body.push_str("</tbody></table></div>\n");
    let _ = writeln!(body, "<script>{SCRIPT}</script>");
    page("Calibrations", &body)
}

fn row(body: &mut String, line: &HistoryLine, pages: &HistoryPages) {
    let ratio = line.chi_squared.filter(|_| line.degrees_of_freedom > 0).map(|c| c / line.degrees_of_freedom as f64);
    let (verdict, class) = match line.acceptable {
        Some(true) => ("acceptable", "good"),
        Some(false) => ("not acceptable", "bad"),
        None => ("failed", "bad"),
    };
    let why = line.message.clone().unwrap_or_else(|| line.objections.join(", "));
    let serial = Escaped(&line.unit_serial);
    let serial = match pages.units.get(&(line.unit_model.clone(), line.unit_serial.clone())) {
        Some(file) => format!("<a href=\"{}\">{serial}</a>", Escaped(file)),
        None => serial.to_string(),
    };
    let _ = writeln!(
        body,
        "<tr><td>{}</td><td>{}</td><td>{serial}</td><td>{}</td><td class=\"number\">{}</td><td class=\"{class}\">{verdict}<span>{}</span></td></tr>",
        Escaped(&line.date),
        Escaped(&line.unit_model),
        Escaped(&line.station),
        ratio.map_or_else(String::new, |ratio| format!("{ratio:.3}")),
        Escaped(&why)
    );
}

/// The page of a unit.
pub fn history_unit_page(report: &UnitHistoryReport) -> String {
    let title = format!("{}, serial {}", report.unit_model, report.unit_serial);
    let mut body = opening("Unit", &title);
    text(&mut body, &unit_history_text(report));
    body.push_str("<div class=\"panels\">\n");
    for (_, svg) in unit_history_plots(report) {
        let _ = writeln!(body, "<figure>{svg}</figure>");
    }
    body.push_str("</div>\n");
    page(&title, &body)
}

/// The page of a station.
pub fn history_station_page(report: &StationHistoryReport) -> String {
    let name = if report.station.is_empty() { "without a name" } else { &report.station };
    let mut body = opening("Station", name);
    text(&mut body, &station_history_text(report));
    page(name, &body)
}

fn opening(kind: &str, title: &str) -> String {
    format!(
        "<header><p class=\"kind\">{kind}</p><h1>{}</h1><p><a href=\"index.html\">all calibrations</a></p></header>\n",
        Escaped(title)
    )
}

fn text(body: &mut String, screen: &Screen) {
    body.push_str("<pre class=\"text\">");
    for line in screen.text(WIDTH, usize::MAX).lines() {
        let _ = writeln!(body, "{}", Escaped(line));
    }
    body.push_str("</pre>\n");
}

/// Characters in a line: what a laboratory's screen shows beside its margins.
const WIDTH: usize = 150;

fn page(title: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\"><link rel=\"icon\" href=\"data:,\">\
         <title>{}</title><style>{STYLE}{LIST_STYLE}</style></head>\n<body><main class=\"wide\">\n{body}</main></body></html>\n",
        Escaped(title)
    )
}

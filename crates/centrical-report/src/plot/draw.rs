//! The drawing itself.

use std::fmt::Write;

use super::axis::{Ruler, Tick};
use super::series::{Mark, Plot, Point, Series};
use super::svg::{Escaped, Px, Value};
use crate::number::power_of_ten;

/// Lengths of a drawing, px.
struct Sheet {
    class: &'static str,
    width: f64,
    height: f64,
    left: f64,
    /// Width allowed for a letter of the legend.
    letter: f64,
    /// Approximate number of ticks along x and y.
    ticks: [usize; 2],
}

/// Letters wide enough for 18 px, which a telephone is given.
const WHOLE: Sheet = Sheet { class: "plot", width: 760.0, height: 460.0, left: 94.0, letter: 9.6, ticks: [8, 7] };
const PANEL: Sheet = Sheet { class: "plot panel", width: 400.0, height: 320.0, left: 78.0, letter: 7.2, ticks: [5, 6] };
const RIGHT: f64 = 24.0;
const BOTTOM: f64 = 56.0;
/// Room of the label of the ordinate, and between numbers and frame.
const LABEL: f64 = 36.0;
/// Baseline of the title, first row of the legend, height of a legend row.
const TITLE: f64 = 26.0;
const LEGEND: f64 = 50.0;
const ROW: f64 = 20.0;

/// Okabe and Ito's palette without yellow and black, darkened where it would be pale on white and lightened for dark
/// grounds. Plain rules rather than variables, which few renderers other than browsers know.
pub(crate) const STYLE: &str = "\
.plot{font:13px system-ui,sans-serif}.plot .title{font-size:16px;font-weight:600}\
.plot text{fill:#1a1a1a}.plot .ground{fill:#fff}.plot .frame{stroke:#1a1a1a;fill:none}\
.plot .grid{stroke:#d0d0d0;fill:none}.plot .minor{opacity:.45}\
.plot .line{fill:none;stroke-width:1.8;stroke-linejoin:round}.plot .bar{fill:none;stroke-width:1.2}\
.plot .hit{fill:transparent;stroke:none}.plot .mark{fill:currentColor;stroke:none}\
.plot .s0{stroke:#0072b2;color:#0072b2}.plot .s1{stroke:#d55e00;color:#d55e00}\
.plot .s2{stroke:#009e73;color:#009e73}.plot .s3{stroke:#b5508d;color:#b5508d}\
.plot .s4{stroke:#5a3a00;color:#5a3a00}.plot .s5{stroke:#2f8fc4;color:#2f8fc4}\
@media(prefers-color-scheme:dark){\
.plot text{fill:#e8e8e8}.plot .ground{fill:#161616}.plot .frame{stroke:#e8e8e8}.plot .grid{stroke:#484848}\
.plot .s0{stroke:#56b4e9;color:#56b4e9}.plot .s1{stroke:#ff8a3c;color:#ff8a3c}\
.plot .s2{stroke:#2fd0a0;color:#2fd0a0}.plot .s3{stroke:#e39ac4;color:#e39ac4}\
.plot .s4{stroke:#e69f00;color:#e69f00}.plot .s5{stroke:#8fd0f5;color:#8fd0f5}}";
const COLOURS: usize = 6;
const DASHES: [&str; 4] = ["none", "7 4", "2 3", "9 3 2 3"];

/// Where the data are drawn.
struct Frame {
    sheet: Sheet,
    top: f64,
    x: Ruler,
    y: Ruler,
    width: f64,
    height: f64,
}

pub(super) fn plot(plot: &Plot, style: &str) -> String {
    let sheet = sheet(plot);
    let legend = legend_places(&plot.series, &sheet);
    let rows = legend.last().map_or(0.0, |&(_, row)| row + 1.0);
    let frame = Frame::new(plot, sheet, LEGEND - 12.0 + ROW * rows);
    let mut svg = String::new();
    // Writing to a String cannot fail.
    let _ = draw(&mut svg, plot, &frame, &legend, style);
    svg
}

/// The lengths of a drawing, with room for the longest number beside the ordinate.
fn sheet(plot: &Plot) -> Sheet {
    let sheet = if plot.is_panel { PANEL } else { WHOLE };
    let (ticks, _) = Ruler::new(&plot.y, ordinates(plot), sheet.height).ticks(sheet.ticks[1]);
    let longest = ticks.iter().filter_map(|tick| tick.text.as_ref()).map(|text| text.chars().count()).max();
    Sheet { left: sheet.left.max(LABEL + sheet.letter * longest.unwrap_or(0) as f64), ..sheet }
}

fn ordinates(plot: &Plot) -> impl Iterator<Item = f64> {
    plot.series.iter().flat_map(|series| &series.points).flat_map(|point| {
        let (low, high) = point.interval.unwrap_or((point.y, point.y));
        [point.y, low, high]
    })
}

fn draw(svg: &mut String, plot: &Plot, frame: &Frame, legend: &[(f64, f64)], style: &str) -> std::fmt::Result {
    let title = Escaped(&plot.title);
    let (open, close) = if style.is_empty() { ("", "") } else { ("<style>", "</style>") };
    let Sheet { class, width, height, left, .. } = frame.sheet;
    write!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"{class}\" role=\"img\" viewBox=\"0 0 {width} {height}\" \
         aria-label=\"{title}\">{open}{style}{close}\
         <rect class=\"ground\" width=\"{width}\" height=\"{height}\"/>\
         <text class=\"title\" x=\"{left}\" y=\"{TITLE}\">{title}</text>"
    )?;
    for (index, (series, place)) in plot.series.iter().zip(legend).enumerate() {
        legend_entry(svg, index, series, *place)?;
    }
    axes(svg, plot, frame)?;
    // The inner element clips what a given range leaves outside.
    write!(
        svg,
        "<svg x=\"{left}\" y=\"{}\" width=\"{}\" height=\"{}\" overflow=\"hidden\">",
        Px(frame.top),
        Px(frame.width),
        Px(frame.height)
    )?;
    for (index, series) in plot.series.iter().enumerate() {
        draw_series(svg, index, series, frame, plot.has_decimal_comma)?;
    }
    svg.write_str("</svg></svg>\n")
}

impl Frame {
    fn new(plot: &Plot, sheet: Sheet, top: f64) -> Self {
        let (width, height) = (sheet.width - sheet.left - RIGHT, sheet.height - top - BOTTOM);
        let abscissae = plot.series.iter().flat_map(|series| &series.points).map(|point| point.x);
        let x = Ruler::new(&plot.x, abscissae, width);
        Self { sheet, top, x, y: Ruler::new(&plot.y, ordinates(plot), height), width, height }
    }

    /// Place of a point inside the frame, from its upper left corner.
    fn place(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        Some((self.x.position(x)?, self.height - self.y.position(y)?))
    }
}

fn axes(svg: &mut String, plot: &Plot, frame: &Frame) -> std::fmt::Result {
    let bottom = frame.top + frame.height;
    let Sheet { left, ticks: [across, up], .. } = frame.sheet;
    let (x_ticks, x_power) = frame.x.ticks(across);
    let (y_ticks, y_power) = frame.y.ticks(up);
    let class = |tick: &Tick| if tick.text.is_some() { "grid" } else { "grid minor" };
    for tick in &x_ticks {
        let x = Px(left + tick.position);
        write!(svg, "<path class=\"{}\" d=\"M{x} {}V{}\"/>", class(tick), Px(frame.top), Px(bottom))?;
        if let Some(text) = &tick.text {
            let text = with_comma(text.clone(), plot.has_decimal_comma);
            write!(svg, "<text x=\"{x}\" y=\"{}\" text-anchor=\"middle\">{text}</text>", Px(bottom + 18.0))?;
        }
    }
    for tick in &y_ticks {
        let y = bottom - tick.position;
        write!(svg, "<path class=\"{}\" d=\"M{left} {}H{}\"/>", class(tick), Px(y), Px(left + frame.width))?;
        if let Some(text) = &tick.text {
            let text = with_comma(text.clone(), plot.has_decimal_comma);
            write!(svg, "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{text}</text>", Px(left - 8.0), Px(y + 4.5))?;
        }
    }
    let (middle_x, middle_y) = (Px(left + frame.width / 2.0), Px(frame.top + frame.height / 2.0));
    write!(
        svg,
        "<rect class=\"frame\" x=\"{left}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\
         <text x=\"{middle_x}\" y=\"{}\" text-anchor=\"middle\">{}</text>\
         <text transform=\"translate(18 {middle_y})rotate(-90)\" text-anchor=\"middle\">{}</text>",
        Px(frame.top),
        Px(frame.width),
        Px(frame.height),
        Px(bottom + 42.0),
        Escaped(&label(&plot.x.label, x_power)),
        Escaped(&label(&plot.y.label, y_power)),
    )
}

/// The label, with the power of ten that the ticks left out.
fn label(label: &str, power: i32) -> String {
    if power == 0 { label.to_owned() } else { format!("{label} (× {})", power_of_ten(power)) }
}

/// `(x, row)` of each legend entry, wrapped to the plot's width.
fn legend_places(series: &[Series], sheet: &Sheet) -> Vec<(f64, f64)> {
    let mut next = (sheet.left, 0.0);
    let mut places = Vec::with_capacity(series.len());
    for series in series {
        let width = 44.0 + sheet.letter * series.label.chars().count() as f64;
        if next.0 > sheet.left && next.0 + width > sheet.width {
            next = (sheet.left, next.1 + 1.0);
        }
        places.push(next);
        next.0 += width;
    }
    places
}

fn legend_entry(svg: &mut String, index: usize, series: &Series, (x, row): (f64, f64)) -> std::fmt::Result {
    let y = LEGEND + ROW * row;
    write!(svg, "<g class=\"s{}\">", index % COLOURS)?;
    if series.mark != Mark::Markers {
        write!(svg, "<path class=\"line\"{} d=\"M{} {}h26\"/>", dash(index), Px(x), Px(y - 4.0))?;
    }
    if series.mark != Mark::Line {
        write!(svg, "<path class=\"mark\" d=\"{}\"/>", marker(index, x + 13.0, y - 4.0))?;
    }
    write!(svg, "</g><text x=\"{}\" y=\"{}\">{}</text>", Px(x + 32.0), Px(y), Escaped(&series.label))
}

fn draw_series(svg: &mut String, index: usize, series: &Series, frame: &Frame, comma: bool) -> std::fmt::Result {
    /// Largest number of points of a line that answers to hovering.
    const HOVER: usize = 300;
    write!(svg, "<g class=\"s{}\">", index % COLOURS)?;
    if series.mark != Mark::Markers {
        write!(svg, "<path class=\"line\"{} d=\"{}\"/>", dash(index), line(&series.points, frame))?;
    }
    let has_markers = series.mark != Mark::Line;
    if has_markers || series.points.len() <= HOVER {
        for point in &series.points {
            let Some((x, y)) = frame.place(point.x, point.y) else { continue };
            svg.write_str("<g>")?;
            hover(svg, &series.label, point, comma)?;
            if has_markers {
                error_bar(svg, point, x, frame)?;
                write!(svg, "<path class=\"mark\" d=\"{}\"/>", marker(index, x, y))?;
            } else {
                write!(svg, "<circle class=\"hit\" cx=\"{}\" cy=\"{}\" r=\"7\"/>", Px(x), Px(y))?;
            }
            svg.write_str("</g>")?;
        }
    }
    svg.write_str("</g>")
}

fn hover(svg: &mut String, label: &str, point: &Point, comma: bool) -> std::fmt::Result {
    let between = if comma { "; " } else { ", " };
    let mut values = format!("{}{between}{}", Value(point.x), Value(point.y));
    if let Some((low, high)) = point.interval {
        write!(values, " ({} .. {})", Value(low), Value(high))?;
    }
    write!(svg, "<title>{}: {}</title>", Escaped(label), with_comma(values, comma))
}

fn with_comma(text: String, comma: bool) -> String {
    if comma { text.replace(" .. ", " … ").replace('.', ",") } else { text }
}

/// A bar with caps; an end that the scale cannot place lies at the frame's edge.
fn error_bar(svg: &mut String, point: &Point, x: f64, frame: &Frame) -> std::fmt::Result {
    let Some((low, high)) = point.interval else { return Ok(()) };
    let y = |value: f64, edge: f64| frame.y.position(value).map_or(edge, |position| frame.height - position);
    let (bottom, top) = (y(low, frame.height + 9.0), y(high, -9.0));
    write!(svg, "<path class=\"bar\" d=\"M{l} {b}h8m-4 0V{t}m-4 0h8\"/>", l = Px(x - 4.0), b = Px(bottom), t = Px(top))
}

/// The line through the points, no more than four of them to a pixel column: first, lowest, highest, last.
fn line(points: &[Point], frame: &Frame) -> String {
    let mut path = String::new();
    let mut column: Vec<(f64, f64)> = Vec::new();
    let mut is_broken = true;
    for point in points.iter().map(|point| frame.place(point.x, point.y)).chain([None]) {
        let is_same = |(x, _): (f64, f64)| column.first().is_some_and(|(first, _)| first.round() == x.round());
        if !point.is_some_and(is_same) {
            for (x, y) in extremes(&column) {
                let _ = write!(path, "{}{} {}", if is_broken { 'M' } else { 'L' }, Px(x), Px(y));
                is_broken = false;
            }
            column.clear();
        }
        is_broken |= point.is_none();
        column.extend(point);
    }
    path
}

/// Of points in one pixel column, those that show: first, lowest, highest and last, in their order.
fn extremes(column: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let by_height = |a: &usize, b: &usize| column[*a].1.total_cmp(&column[*b].1);
    let mut shown: Vec<usize> = [
        (!column.is_empty()).then_some(0),
        (0..column.len()).min_by(by_height),
        (0..column.len()).max_by(by_height),
        column.len().checked_sub(1),
    ]
    .into_iter()
    .flatten()
    .collect();
    shown.sort_unstable();
    shown.dedup();
    shown.into_iter().map(|k| column[k]).collect()
}

fn dash(index: usize) -> String {
    match DASHES[index % DASHES.len()] {
        "none" => String::new(),
        dashes => format!(" stroke-dasharray=\"{dashes}\""),
    }
}

/// Outline of a marker: disc, square, triangle, diamond by turns.
fn marker(index: usize, x: f64, y: f64) -> String {
    match index % 4 {
        0 => format!("M{} {}a3.5 3.5 0 1 0 7 0a3.5 3.5 0 1 0 -7 0z", Px(x - 3.5), Px(y)),
        1 => format!("M{} {}h6.4v6.4h-6.4z", Px(x - 3.2), Px(y - 3.2)),
        2 => format!("M{} {}l4 7h-8z", Px(x), Px(y - 4.5)),
        _ => format!("M{} {}l4.4 4.4l-4.4 4.4l-4.4 -4.4z", Px(x), Px(y - 4.4)),
    }
}

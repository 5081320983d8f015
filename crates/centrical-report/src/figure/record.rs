//! The records, each with the plateaus that were found in it.

use std::fmt::Write;

use centrical::STANDARD_GRAVITY;
use centrical_session::{CalibrationResult, PlateauSummary, RecordOverview};

use super::drawing::Figure;
use crate::language::Language;
use crate::plot::{Px, opened};

const WIDTH: f64 = 420.0;
const HEIGHT: f64 = 190.0;
const LEFT: f64 = 58.0;
const RIGHT: f64 = 10.0;
const TOP: f64 = 28.0;
const BOTTOM: f64 = 34.0;

const STYLE: &str = "\
.strip text{font:12px system-ui,sans-serif;fill:#1a1a1a}.strip .title{font-size:13px;font-weight:600}\
.strip .ground{fill:#fff}.strip .frame{fill:none;stroke:#8c959f}.strip .zero{stroke:#c0c0c0}\
.strip .found{fill:#8c959f;fill-opacity:.28}.strip .found:hover{fill-opacity:.55}\
.strip .a1{fill:#0072b2;stroke:#0072b2}.strip .a2{fill:#d55e00;stroke:#d55e00}.strip .a3{fill:#009e73;stroke:#009e73}\
.strip path.a1,.strip path.a2,.strip path.a3{stroke-width:1.6;stroke-linejoin:round;fill-opacity:.8}\
@media(prefers-color-scheme:dark){.strip text{fill:#e8e8e8}.strip .ground{fill:#161616}.strip .zero{stroke:#484848}\
.strip .a1{fill:#56b4e9;stroke:#56b4e9}.strip .a2{fill:#ff8a3c;stroke:#ff8a3c}.strip .a3{fill:#2fd0a0;stroke:#2fd0a0}}";

/// One drawing for each record; `None` for a session of plateau means.
pub(super) fn figure(result: &CalibrationResult, language: Language) -> Option<Figure> {
    let messages = language.messages();
    (!result.records.is_empty()).then(|| {
        let drawings = result.records.iter().map(|record| draw(result, record, language)).collect();
        Figure::new("records", messages.records_title, messages.records_caption, drawings)
    })
}

/// From time and reading to the drawing.
struct Frame {
    start: f64,
    length: f64,
    low: f64,
    high: f64,
}

impl Frame {
    fn of(record: &RecordOverview) -> Self {
        let values = || record.low.iter().chain(&record.high).flatten().flatten().map(|value| f64::from(*value));
        let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let margin = 0.05 * (high - low).max(f64::MIN_POSITIVE);
        let length = record.step * record.low[0].len() as f64;
        Self { start: record.start, length, low: low - margin, high: high + margin }
    }

    fn x(&self, t: f64) -> f64 {
        LEFT + (t - self.start) / self.length * (WIDTH - LEFT - RIGHT)
    }

    fn y(&self, value: f64) -> f64 {
        HEIGHT - BOTTOM - (value - self.low) / (self.high - self.low) * (HEIGHT - TOP - BOTTOM)
    }
}

fn draw(result: &CalibrationResult, record: &RecordOverview, language: Language) -> String {
    let messages = language.messages();
    let frame = Frame::of(record);
    let mut svg = opened("strip", STYLE, (WIDTH, HEIGHT), &heading(result, record, language), (8.0, 18.0));
    for axis in 1..=3_u8 {
        let x = WIDTH - RIGHT - 27.0 * f64::from(4 - axis) + 4.0;
        let _ = write!(
            svg,
            "<path class=\"a{axis}\" d=\"M{} 14h12\"/><text x=\"{}\" y=\"18\">{axis}</text>",
            Px(x),
            Px(x + 15.0)
        );
    }
    scale(&mut svg, &frame, language);
    for axis in 0..3 {
        envelope(&mut svg, &frame, record, axis);
    }
    for plateau in result.plateaus.iter().filter(|plateau| plateau.mounting == record.mounting) {
        found(&mut svg, &frame, plateau, language);
    }
    let _ = writeln!(
        svg,
        "<text text-anchor=\"middle\" x=\"{}\" y=\"{}\">{}</text></svg>",
        Px(0.5 * (LEFT + WIDTH - RIGHT)),
        Px(HEIGHT - 4.0),
        messages.time_axis
    );
    svg
}

fn heading(result: &CalibrationResult, record: &RecordOverview, language: Language) -> String {
    let messages = language.messages();
    let mut text = format!("{} {}", messages.mounting_word, record.mounting);
    if let Some(mounting) = record.mounting.checked_sub(1).and_then(|n| result.mountings.get(n)) {
        let radius = language.significant(mounting.arm[0], 3);
        let position = messages.position.to_lowercase();
        let _ = write!(text, ": {position} {}, {} {radius} {}", mounting.position, messages.radius, language.unit("m"));
    }
    text
}

/// Frame, zero line, and the ends of both scales.
fn scale(svg: &mut String, frame: &Frame, language: Language) {
    let (right, bottom) = (WIDTH - RIGHT, HEIGHT - BOTTOM);
    let _ = write!(
        svg,
        "<rect class=\"frame\" x=\"{LEFT}\" y=\"{TOP}\" width=\"{}\" height=\"{}\"/>",
        Px(right - LEFT),
        Px(bottom - TOP)
    );
    if frame.low < 0.0 && frame.high > 0.0 {
        let _ = write!(svg, "<path class=\"zero\" d=\"M{LEFT} {}H{}\"/>", Px(frame.y(0.0)), Px(right));
    }
    for (value, y) in [(frame.high, TOP + 10.0), (frame.low, bottom)] {
        let text = format!("{} g", language.significant(value / STANDARD_GRAVITY, 2));
        let _ = write!(svg, "<text text-anchor=\"end\" x=\"{}\" y=\"{}\">{text}</text>", Px(LEFT - 4.0), Px(y));
    }
    for (time, anchor) in [(frame.start, "start"), (frame.start + frame.length, "end")] {
        let text = language.fixed(time, 0);
        let (x, y) = (Px(frame.x(time)), Px(HEIGHT - 18.0));
        let _ = write!(svg, "<text text-anchor=\"{anchor}\" x=\"{x}\" y=\"{y}\">{text}</text>");
    }
}

/// The band between lowest and highest readings, broken where the record has a gap.
fn envelope(svg: &mut String, frame: &Frame, record: &RecordOverview, axis: usize) {
    let steps: Vec<Option<(f64, f64, f64)>> = (0..record.low[axis].len())
        .map(|k| {
            let (low, high) = (record.low[axis][k]?, (*record.high[axis].get(k)?)?);
            let t = record.start + record.step * (k as f64 + 0.5);
            Some((frame.x(t), frame.y(low.into()), frame.y(high.into())))
        })
        .collect();
    let mut path = String::new();
    for stretch in steps.split(Option::is_none) {
        let upper = stretch.iter().flatten().map(|&(x, _, high)| (x, high));
        let lower = stretch.iter().rev().flatten().map(|&(x, low, _)| (x, low));
        for (n, (x, y)) in upper.chain(lower).enumerate() {
            let _ = write!(path, "{}{} {}", if n == 0 { 'M' } else { 'L' }, Px(x), Px(y));
        }
        if !stretch.is_empty() {
            path.push('z');
        }
    }
    let _ = write!(svg, "<path class=\"a{}\" d=\"{path}\"/>", axis + 1);
}

fn found(svg: &mut String, frame: &Frame, plateau: &PlateauSummary, language: Language) {
    let Some([from, to]) = plateau.window else { return };
    let messages = language.messages();
    let means = plateau.mean.map(|mean| language.fixed(mean / STANDARD_GRAVITY, 4)).join("; ");
    let _ = write!(
        svg,
        "<rect class=\"found\" x=\"{}\" y=\"{TOP}\" width=\"{}\" height=\"{}\"><title>{} {}: {} {}; {means} g; {} {}, \
         {} {}</title></rect>",
        Px(frame.x(from)),
        Px(frame.x(to) - frame.x(from)),
        Px(HEIGHT - TOP - BOTTOM),
        messages.plateau,
        plateau.index + 1,
        language.significant(plateau.speed, 5),
        language.unit("rad/s"),
        plateau.samples,
        messages.samples,
        plateau.rejected,
        messages.rejected
    );
}

//! The correlation matrix as a heat map.

use std::fmt::Write;

use centrical_session::CalibrationResult;

use super::drawing::{Figure, is_charted};
use crate::evaluation::symbol;
use crate::language::Language;
use crate::plot::{Escaped, Px, opened};

const WIDTH: f64 = 760.0;
/// Room for the names on the left, above the map, and below it for the key.
const LEFT: f64 = 84.0;
const TOP: f64 = 40.0;
const BOTTOM: f64 = 34.0;
/// Room right of the map for the name of its last column.
const RIGHT: f64 = 84.0;

/// Two hues that every eye distinguishes; strength is opacity, so the map lives on light and dark grounds.
const STYLE: &str = "\
.map text{font:13px system-ui,sans-serif;fill:#1a1a1a}.map .title{font-size:16px;font-weight:600}\
.map .ground{fill:#fff}.map .p{fill:#0072b2}.map .n{fill:#d55e00}.map .frame{fill:none;stroke:#1a1a1a}\
@media(prefers-color-scheme:dark){.map text{fill:#e8e8e8}.map .ground{fill:#161616}\
.map .p{fill:#56b4e9}.map .n{fill:#ff8a3c}.map .frame{stroke:#e8e8e8}}";

/// The lower triangle of the correlation matrix of the estimable parameters, without the two of each rest in an attitude of its own; `None`
/// if there are fewer than two.
pub(super) fn figure(result: &CalibrationResult, language: Language) -> Option<Figure> {
    let messages = language.messages();
    let shown: Vec<usize> = (0..result.parameters.len()).filter(|&j| is_charted(&result.parameters[j])).collect();
    (shown.len() > 1).then(|| {
        let drawings = vec![draw(result, &shown, language)];
        Figure::new("correlation", messages.correlation_title, messages.correlation_caption, drawings)
    })
}

/// `C_ij / sqrt(C_ii C_jj)`.
fn correlation(result: &CalibrationResult, i: usize, j: usize) -> Option<f64> {
    let entry = |i: usize, j: usize| *result.covariance.get(i)?.get(j)?;
    Some(entry(i, j)? / (entry(i, i)? * entry(j, j)?).sqrt())
}

fn draw(result: &CalibrationResult, shown: &[usize], language: Language) -> String {
    let cell = (WIDTH - LEFT - RIGHT) / shown.len() as f64;
    let (side, height) = (cell * shown.len() as f64, TOP + WIDTH - LEFT - RIGHT + BOTTOM);
    let mut svg = opened("map", STYLE, (WIDTH, height), language.messages().correlation_title, (LEFT, 26.0));
    // Names as high as their rows, as many as fit.
    let every = (9.0 / cell).ceil().max(1.0);
    for (row, &i) in shown.iter().enumerate() {
        let name = &symbol(&result.parameters[i].name);
        let y = TOP + cell * row as f64;
        if (row as f64) % every == 0.0 {
            let size = cell.clamp(8.0, 13.0);
            let baseline = Px(y + 0.5 * cell + 0.36 * size);
            // On the left the name of the row; at the diagonal that of the column below it, where the map leaves room.
            for (x, anchor) in [(LEFT - 6.0, "end"), (LEFT + cell * (row + 1) as f64 + 4.0, "start")] {
                let _ = write!(
                    svg,
                    "<text style=\"font-size:{}px\" text-anchor=\"{anchor}\" x=\"{}\" y=\"{baseline}\">{}</text>",
                    Px(size),
                    Px(x),
                    Escaped(name)
                );
            }
        }
        for (column, &j) in shown.iter().enumerate().take(row + 1) {
            let Some(r) = correlation(result, i, j) else { continue };
            let _ = write!(
                svg,
                "<rect class=\"{}\" opacity=\"{:.2}\" x=\"{}\" y=\"{}\" width=\"{w}\" height=\"{w}\"><title>{}, {}: {}</title></rect>",
                if r < 0.0 { "n" } else { "p" },
                r.abs().min(1.0),
                Px(LEFT + cell * column as f64),
                Px(y),
                Escaped(name),
                Escaped(&symbol(&result.parameters[j].name)),
                language.fixed(r, 3),
                w = Px(cell)
            );
        }
    }
    let _ = write!(svg, "<path class=\"frame\" d=\"M{LEFT} {TOP}V{}H{}\"/>", Px(TOP + side), Px(LEFT + side));
    key(&mut svg, TOP + side + 12.0, language);
    svg.push_str("</svg>\n");
    svg
}

/// What the colours mean.
fn key(svg: &mut String, y: f64, language: Language) {
    for step in -4..=4_i32 {
        let r = f64::from(step) / 4.0;
        let x = LEFT + 60.0 * f64::from(step + 4);
        let class = if r < 0.0 { "n" } else { "p" };
        let _ = write!(
            svg,
            "<rect class=\"{class}\" opacity=\"{:.2}\" x=\"{}\" y=\"{}\" width=\"14\" height=\"14\"/>\
             <text x=\"{}\" y=\"{}\" style=\"font-size:11px\">{}</text>",
            r.abs(),
            Px(x),
            Px(y),
            Px(x + 18.0),
            Px(y + 11.0),
            language.fixed(r, if step % 2 == 0 { 1 } else { 2 })
        );
    }
}

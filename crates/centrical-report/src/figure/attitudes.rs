//! Where the vertical points in rests of a unit, and in the one to add: two hemispheres in an equal-area projection.

use std::f64::consts::{FRAC_PI_4, SQRT_2};
use std::fmt::Write;

use centrical_session::CalibrationResult;

use super::drawing::Figure;
use crate::language::Language;
use crate::plot::Escaped;

/// Radius of a hemisphere, and the place of its centre, px.
const RADIUS: f64 = 110.0;
const CENTRE: (f64, f64) = (145.0, 150.0);
const PANEL: (f64, f64) = (290.0, 310.0);

const STYLE: &str = "<style>\
.attitudes text{font:13px system-ui,sans-serif;fill:#1f2328;text-anchor:middle}\
.attitudes .edge,.attitudes .grid{fill:none;stroke:#59636e}.attitudes .grid{stroke-dasharray:3 4;opacity:.6}\
.attitudes .rest{fill:#0072b2}.attitudes .next{fill:none;stroke:#d55e00;stroke-width:3}\
@media (prefers-color-scheme:dark){.attitudes text{fill:#e6edf3}.attitudes .edge,.attitudes .grid{stroke:#9198a1}\
.attitudes .rest{fill:#58a6ff}.attitudes .next{stroke:#f08c3c}}</style>\n";

/// The attitudes of a result by rests alone.
pub(super) fn attitudes(result: &CalibrationResult, language: Language) -> Option<Figure> {
    let messages = language.messages();
    let free = result.model.positions.iter().filter(|position| position.is_free);
    // The last column takes the vertical to instrument axes.
    let rests: Vec<[f64; 3]> = free.map(|position| [0, 1, 2].map(|i| position.matrix[i][2])).collect();
    if rests.is_empty() || result.model.has_arm() {
        return None;
    }
    let next = result.next_attitude.as_ref();
    let drawing = drawing(&rests, next.map(|next| next.up), language);
    let sentence = next.map(|next| format!(" {}", (messages.words.next_rest)(next))).unwrap_or_default();
    let caption = format!("{}{sentence}", messages.attitudes_caption);
    Some(Figure::new("attitudes", messages.attitudes, &caption, vec![drawing]))
}

fn drawing(rests: &[[f64; 3]], next: Option<[f64; 3]>, language: Language) -> String {
    let messages = language.messages();
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"attitudes\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n{STYLE}",
        2.0 * PANEL.0,
        PANEL.1,
        Escaped(messages.attitudes)
    );
    for (panel, sign) in [1.0, -1.0].into_iter().enumerate() {
        let x = PANEL.0 * panel as f64;
        let _ = writeln!(svg, "<g transform=\"translate({x},0)\">");
        hemisphere(&mut svg, messages.up_of[panel], messages.axis);
        // The rim belongs to both.
        for up in rests.iter().filter(|up| up[2] * sign > -1e-9) {
            mark(&mut svg, "rest", 4.5, up, &hover(messages.rest, up, language));
        }
        if let Some(up) = next.filter(|up| up[2] * sign > -1e-9) {
            mark(&mut svg, "next", 9.0, &up, &hover(messages.next_rest, &up, language));
        }
        svg.push_str("</g>\n");
    }
    svg + "</svg>\n"
}

/// The rim, the circle 45 deg from the pole, and axes 1 and 2.
fn hemisphere(svg: &mut String, title: &str, axis: &str) {
    let (x, y) = CENTRE;
    let _ = writeln!(svg, "<text x=\"{x}\" y=\"16\">{}</text>", Escaped(title));
    let _ = writeln!(svg, "<circle class=\"edge\" cx=\"{x}\" cy=\"{y}\" r=\"{RADIUS}\"/>");
    let half = RADIUS * SQRT_2 * (0.5 * FRAC_PI_4).sin();
    let _ = writeln!(svg, "<circle class=\"grid\" cx=\"{x}\" cy=\"{y}\" r=\"{half:.1}\"/>");
    let _ = writeln!(
        svg,
        "<path class=\"grid\" d=\"M{} {y}h{}M{x} {}v{}\"/>",
        x - RADIUS,
        2.0 * RADIUS,
        y - RADIUS,
        2.0 * RADIUS
    );
    let (right, top) = (x + RADIUS + 12.0, y - RADIUS - 6.0);
    let _ = writeln!(svg, "<text x=\"{right}\" y=\"{:.1}\">1</text><text x=\"{x}\" y=\"{top}\">2</text>", y + 4.5);
    let _ = writeln!(svg, "<title>{} 1, {} 2</title>", Escaped(axis), Escaped(axis));
}

/// What is shown of a direction under the pointer.
fn hover(name: &str, up: &[f64; 3], language: Language) -> String {
    let components = up.map(|component| format!("{component:.2}"));
    let direction = match language {
        Language::English => components.join(", "),
        Language::Russian => components.join("; ").replace('.', ","),
    };
    format!("{name}: {direction}")
}

/// A direction in Lambert's projection, `sqrt 2 sin(theta/2)` of the radius from the pole.
fn mark(svg: &mut String, class: &str, radius: f64, up: &[f64; 3], title: &str) {
    let across = up[0].hypot(up[1]);
    let from_pole = RADIUS * SQRT_2 * (0.5 * across.atan2(up[2].abs())).sin();
    let along = |component: f64| if across > 0.0 { from_pole * component / across } else { 0.0 };
    let (x, y) = (CENTRE.0 + along(up[0]), CENTRE.1 - along(up[1]));
    let _ = writeln!(
        svg,
        "<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\"><title>{}</title></circle>",
        Escaped(title)
    );
}

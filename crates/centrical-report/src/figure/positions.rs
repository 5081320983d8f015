//! Drawing of the mounting positions: the arm, the rotation axis and where the instrument axes point.

use std::fmt::Write;

use centrical::Position;
use centrical_session::CalibrationResult;
use nalgebra::{Matrix3, Vector3};

use super::drawing::Figure;
use crate::language::{Language, Messages};
use crate::plot::Escaped;

/// Panels stand two above each other, so that the positions of a pair share a column.
const ROWS: usize = 2;
const PANEL: (f64, f64) = (250.0, 213.0);
/// Place of the unit along the arm, and half its size, in units of drawing.
const ARM: f64 = 120.0;
const HALF: f64 = 20.0;
const ARROW: f64 = 56.0;

/// The positions as one SVG drawing, in the order given, column by column.
pub fn positions_figure(positions: &[Position], language: Language) -> String {
    let columns = positions.len().div_ceil(ROWS);
    let messages = language.messages();
    let mut svg = opened((PANEL.0 * columns as f64, PANEL.1 * ROWS as f64), messages.positions);
    for (n, position) in positions.iter().enumerate() {
        let (column, row) = (n / ROWS, n % ROWS);
        let _ = writeln!(svg, "<g transform=\"translate({},{})\">", PANEL.0 * column as f64, PANEL.1 * row as f64);
        panel(&mut svg, position, messages);
        svg.push_str("</g>\n");
    }
    svg.push_str("</svg>\n");
    svg
}

/// The drawing of the mounting positions; `None` if the result does not have them.
pub(crate) fn positions(result: &CalibrationResult, language: Language) -> Option<Figure> {
    let messages = language.messages();
    let positions: Vec<Position> = result
        .model
        .positions
        .iter()
        .filter(|position| !position.is_free)
        .map(|position| Position::on_arm(&position.id, Matrix3::from_fn(|i, j| position.matrix[i][j]), &position.pair))
        .collect();
    (!positions.is_empty()).then(|| {
        let draw = |position: &Position| {
            let mut svg = opened(PANEL, &format!("{} {}", messages.position, position.id));
            panel(&mut svg, position, messages);
            svg + "</svg>\n"
        };
        let drawings = positions.iter().map(draw).collect();
        Figure::new("positions", messages.positions, messages.positions_caption, drawings)
    })
}

fn opened((width, height): (f64, f64), label: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"positions\" viewBox=\"0 0 {width} {height}\" role=\"img\" \
         aria-label=\"{}\">\n{STYLE}",
        Escaped(label)
    )
}

const STYLE: &str = "<style>\
.positions text{font:13px system-ui,sans-serif;fill:#1f2328}.positions .soft{fill:#59636e;font-size:12px}\
.positions .arm{stroke:#8c959f;stroke-width:9;stroke-linecap:round}\
.positions .axis{stroke:#59636e;stroke-width:1.5;stroke-dasharray:5 4}\
.positions .turn{stroke:#59636e;stroke-width:1.5;fill:none}\
.positions .box{fill:#d1d9e0;fill-opacity:.75;stroke:#59636e;stroke-linejoin:round}\
.positions .z1{stroke:#d55e00;fill:#d55e00}.positions .z2{stroke:#0072b2;fill:#0072b2}\
.positions .z3{stroke:#009e73;fill:#009e73}.positions line.z1,.positions line.z2,.positions line.z3{stroke-width:3}\
.positions .name{font-weight:600}\
@media (prefers-color-scheme:dark){.positions text{fill:#e6edf3}.positions .soft{fill:#9198a1}\
.positions .box{fill:#3d444d;stroke:#9198a1}.positions .axis,.positions .turn{stroke:#9198a1}\
.positions .arm{stroke:#656c76}.positions .z1{stroke:#f08c3c;fill:#f08c3c}.positions .z2{stroke:#58a6ff;fill:#58a6ff}\
.positions .z3{stroke:#3fb68b;fill:#3fb68b}}</style>\n";

fn panel(svg: &mut String, position: &Position, messages: &Messages) {
    let (foot, hub) = (project(0.0, 0.0, -35.0), project(0.0, 0.0, 0.0));
    let top = project(0.0, 0.0, 75.0);
    let _ = writeln!(svg, "<text x=\"14\" y=\"22\">{} {}</text>", messages.position, Escaped(&position.id));
    let _ =
        writeln!(svg, "<text class=\"soft\" x=\"14\" y=\"38\">{} {}</text>", messages.pair, Escaped(&position.pair));
    line(svg, "axis", foot, top);
    let (x, y) = project(0.0, 0.0, 62.0);
    let _ = writeln!(
        svg,
        "<path class=\"turn\" d=\"M{:.1} {:.1}a13 5 0 1 0 20 -2\"/><path class=\"turn\" d=\"M{:.1} {:.1}l4.5 -4.5l1.5 6.5\"/>",
        x - 10.0,
        y - 2.0,
        x + 7.0,
        y - 3.5
    );
    line(svg, "arm", hub, project(ARM - HALF, 0.0, 0.0));
    // Far arrows behind the unit, near ones before it.
    let mut axes: Vec<(usize, Vector3<f64>)> = (0..3).map(|i| (i, position.p_zy.row(i).transpose())).collect();
    axes.sort_by(|a, b| depth(&a.1).total_cmp(&depth(&b.1)));
    for (i, direction) in axes.iter().filter(|(_, d)| depth(d) < 0.0) {
        arrow(svg, *i, direction);
    }
    cube(svg);
    for (i, direction) in axes.iter().filter(|(_, d)| depth(d) >= 0.0) {
        arrow(svg, *i, direction);
    }
}

/// Oblique projection of arm axes to the panel: 1 to the right, 2 away from the viewer, 3 up.
fn project(y_1: f64, y_2: f64, y_3: f64) -> (f64, f64) {
    (42.0 + y_1 + 0.62 * y_2, 122.0 + 0.10 * y_1 - 0.44 * y_2 - y_3)
}

/// How much a direction points at the viewer.
fn depth(direction: &Vector3<f64>) -> f64 {
    direction.x * 0.1 - direction.y + direction.z * 0.3
}

fn line(svg: &mut String, class: &str, from: (f64, f64), to: (f64, f64)) {
    let _ = writeln!(
        svg,
        "<line class=\"{class}\" x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\"/>",
        from.0, from.1, to.0, to.1
    );
}

/// One instrument axis from the middle of the unit, with its number.
fn arrow(svg: &mut String, axis: usize, direction: &Vector3<f64>) {
    let at = |length: f64| {
        let d = direction * length;
        project(ARM + d.x, d.y, d.z)
    };
    let (from, tip, label) = (at(HALF), at(ARROW), at(ARROW + 13.0));
    let class = ["z1", "z2", "z3"][axis];
    line(svg, class, from, at(ARROW - 6.0));
    let (dx, dy) = (tip.0 - from.0, tip.1 - from.1);
    let length = dx.hypot(dy).max(1.0);
    let (ux, uy) = (dx / length * 9.0, dy / length * 9.0);
    let _ = writeln!(
        svg,
        "<polygon class=\"{class}\" points=\"{:.1},{:.1} {:.1},{:.1} {:.1},{:.1}\"/>",
        tip.0,
        tip.1,
        tip.0 - ux - 0.5 * uy,
        tip.1 - uy + 0.5 * ux,
        tip.0 - ux + 0.5 * uy,
        tip.1 - uy - 0.5 * ux
    );
    let _ = writeln!(
        svg,
        "<text class=\"name\" text-anchor=\"middle\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
        label.0,
        label.1 + 4.5,
        axis + 1
    );
}

/// The unit's case: the three faces that are seen.
fn cube(svg: &mut String) {
    let corner = |a: f64, b: f64, c: f64| project(ARM + HALF * a, HALF * b, HALF * c);
    let faces = [
        [corner(-1.0, -1.0, 1.0), corner(1.0, -1.0, 1.0), corner(1.0, 1.0, 1.0), corner(-1.0, 1.0, 1.0)],
        [corner(1.0, -1.0, -1.0), corner(1.0, 1.0, -1.0), corner(1.0, 1.0, 1.0), corner(1.0, -1.0, 1.0)],
        [corner(-1.0, -1.0, -1.0), corner(1.0, -1.0, -1.0), corner(1.0, -1.0, 1.0), corner(-1.0, -1.0, 1.0)],
    ];
    for face in faces {
        let points: Vec<String> = face.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(svg, "<polygon class=\"box\" points=\"{}\"/>", points.join(" "));
    }
}

//! The rank table of `docs/source-and-findings.md`: `cargo run --release -p centrical --example rank_table`.

use std::f64::consts::PI;
use std::fmt::Write;

use centrical::ThirdPosition;
use centrical::plan::Normalised;
use centrical::{ErrorModel, MeasurementModel, PairRelation, Study, Weight};
use nalgebra::Matrix3;

#[allow(dead_code, reason = "the table is also taken by the test of the document")]
fn main() {
    print!("{}", table());
}

/// One experiment: label, levels m, radii in R*, angles at rest.
pub type Case = (&'static str, std::ops::RangeInclusive<u32>, &'static [f64], &'static [f64]);

/// The rows of the table.
pub const CASES: [Case; 7] = [
    ("m = 0..3, radii 1 and 1/2", 0..=3, &[1.0, 0.5], &[0.0, PI]),
    ("m = 0..20", 0..=20, &[1.0, 0.5], &[0.0, PI]),
    ("m = 0, 1, 2", 0..=2, &[1.0, 0.5], &[0.0, PI]),
    ("m = 0, 1 (one speed)", 0..=1, &[1.0, 0.5], &[0.0, PI]),
    ("m = 0..3, one radius", 0..=3, &[1.0], &[0.0, PI]),
    ("m = 0..3, one rest angle", 0..=3, &[1.0, 0.5], &[0.0]),
    ("m = 1..3, no rest", 1..=3, &[1.0, 0.5], &[]),
];

/// The columns of the table.
pub const RELATIONS: [PairRelation; 3] = [PairRelation::Opposite, PairRelation::Common, PairRelation::Free];

/// The table as Markdown: rank with proof masses apart / together, below 1e-3 with the smallest singular value that
/// counts over the largest.
pub fn table() -> String {
    let mut text =
        "| experiment | opposite, as printed (49) | common (49) | free (55) |\n|---|---|---|---|\n".to_owned();
    for case in &CASES {
        let _ = write!(text, "| {} |", case.0);
        for relation in RELATIONS {
            let cells = [spread(), Matrix3::zeros()].map(|rho| cell(&plan(case, relation, rho)));
            let _ = write!(text, " {} |", cells.join(" / "));
        }
        text.push('\n');
    }
    text
}

/// The experiment of a case with P_3 at its default.
pub fn plan((_, levels, radii, rest_angles): &Case, pair_relation: PairRelation, rho: Matrix3<f64>) -> Normalised {
    Normalised {
        pair_relation,
        rho,
        levels: levels.clone().map(f64::from).collect(),
        radii: radii.to_vec(),
        rest_angles: rest_angles.to_vec(),
        ..Normalised::default()
    }
}

/// `rho0` with the proof masses apart, in units of R*.
pub fn spread() -> Matrix3<f64> {
    Matrix3::new(0.0, 0.05, 0.04, 0.0, 0.03, -0.02, 0.0, 0.02, -0.03)
}

/// The rank, which is the same for both P_3.
fn cell(plan: &Normalised) -> String {
    let cells = [ThirdPosition::AxisOneUp, ThirdPosition::AxisOneDown].map(|third| {
        let experiment = Normalised { third, ..plan.clone() }.experiment();
        let model = MeasurementModel::new(experiment, ErrorModel::kozlov_2017(), &[]);
        let weights = Weight::equal(model.experiment().set_points.len(), 1.0);
        let study = Study::at_zero(model, weights).expect("the experiment is complete");
        let seen = study.observability();
        match seen.smallest_relative() {
            Some(smallest) if smallest < 1e-3 => format!("{} ({smallest:.0e})", seen.rank()),
            _ => seen.rank().to_string(),
        }
    });
    if cells[0] == cells[1] { cells[0].clone() } else { cells.join(" or ") }
}

//! The rank table of docs/source-and-findings.md, every cell for both P_3: computed by an independent program
//! (column-scaled SVD, tolerance 1e-10), with the smallest non-zero singular value over the largest in brackets where it
//! is below 1e-3. The null directions and the ranks with extensions named there.

use std::f64::consts::PI;

use centrical::plan::Normalised;
use centrical::position::ThirdPosition::{self, AxisOneDown, AxisOneUp};
use centrical::{ErrorModel, Extension, Group, Law, MeasurementModel, Observability, PairRelation, Study, Weight};
use nalgebra::Matrix3;

use crate::common::spread;

/// Ranks with proof masses apart and together, and the bracketed singular value of each if one is printed.
type Cell = [(usize, Option<f64>); 2];

const fn plain(apart: usize, together: usize) -> Cell {
    [(apart, None), (together, None)]
}

const fn thread(apart: usize, smallest: f64, together: usize) -> Cell {
    [(apart, Some(smallest)), (together, None)]
}

struct Row {
    case: &'static str,
    levels: std::ops::RangeInclusive<u32>,
    radii: &'static [f64],
    rest_angles: &'static [f64],
    /// Opposite (printed), common, free.
    cells: [Cell; 3],
}

const TWO: &[f64] = &[1.0, 0.5];
const BOTH: &[f64] = &[0.0, PI];

#[rustfmt::skip]
const TABLE: [Row; 7] = [
    Row { case: "m = 0..3, radii 1 and 1/2", levels: 0..=3, radii: TWO, rest_angles: BOTH,
        cells: [plain(47, 47), plain(49, 49), plain(53, 53)] },
    Row { case: "m = 0..20", levels: 0..=20, radii: TWO, rest_angles: BOTH,
        cells: [plain(47, 47), plain(49, 49), plain(53, 53)] },
    Row { case: "m = 0, 1, 2", levels: 0..=2, radii: TWO, rest_angles: BOTH,
        cells: [plain(47, 47), plain(49, 49), plain(53, 53)] },
    Row { case: "m = 0, 1 (one speed)", levels: 0..=1, radii: TWO, rest_angles: BOTH,
        cells: [thread(46, 4e-5, 44), plain(48, 46), thread(50, 9e-5, 47)] },
    Row { case: "m = 0..3, one radius", levels: 0..=3, radii: &[1.0], rest_angles: BOTH,
        cells: [plain(44, 44), thread(45, 3e-4, 43), thread(46, 2e-4, 44)] },
    Row { case: "m = 0..3, one rest angle", levels: 0..=3, radii: TWO, rest_angles: &[0.0],
        cells: [plain(47, 47), plain(49, 49), plain(53, 53)] },
    Row { case: "m = 1..3, no rest", levels: 1..=3, radii: TWO, rest_angles: BOTH,
        cells: [plain(45, 45), plain(47, 47), plain(51, 51)] },
];

const RELATIONS: [PairRelation; 3] = [PairRelation::Opposite, PairRelation::Common, PairRelation::Free];

fn plan(row: &Row, third: ThirdPosition, pair_relation: PairRelation, rho: Matrix3<f64>) -> Normalised {
    Normalised {
        third,
        pair_relation,
        rho,
        radii: row.radii.to_vec(),
        levels: row.levels.clone().map(f64::from).collect(),
        rest_angles: row.rest_angles.to_vec(),
        ..Normalised::default()
    }
}

fn study(plan: &Normalised, extensions: &[Extension]) -> Study {
    let model = MeasurementModel::new(plan.experiment(), ErrorModel::kozlov_2017(), extensions);
    let weights = Weight::equal(model.experiment().set_points.len(), 1.0);
    Study::at_zero(model, weights, 0.0).unwrap()
}

fn is_printed_as(value: f64, printed: f64) -> bool {
    // One digit is printed: half of its unit.
    (value - printed).abs() <= 0.5 * 10_f64.powf(printed.log10().floor())
}

#[test]
fn every_cell() {
    for row in &TABLE {
        for third in [AxisOneUp, AxisOneDown] {
            for (relation, cell) in RELATIONS.into_iter().zip(&row.cells) {
                for (rho, (rank, smallest)) in [spread(), Matrix3::zeros()].into_iter().zip(cell) {
                    let study = study(&plan(row, third, relation, rho), &[]);
                    let seen = study.observability();
                    let cell = format!("{}, {third:?}, {relation:?}, rho0 {}", row.case, rho.amax());
                    assert_eq!(seen.columns(), if relation == PairRelation::Free { 55 } else { 49 }, "{cell}");
                    assert_eq!(seen.rank(), *rank, "{cell}");
                    assert!(!seen.is_doubtful(), "{cell}");
                    let found = seen.smallest_relative().unwrap();
                    match smallest {
                        Some(printed) => assert!(is_printed_as(found, *printed), "{cell}: {found:e} for {printed:e}"),
                        None => assert!(found >= 1e-3, "{cell}: {found:e} is not printed"),
                    }
                }
            }
        }
    }
}

fn directions(study: &Study) -> Vec<String> {
    let gravity = study.model().experiment().site.gravity;
    let text = |d: &centrical::NullDirection| d.text(study.model().parameters(), gravity);
    study.observability().null_directions().iter().map(text).collect()
}

#[test]
fn null_directions_of_the_printed_relation() {
    for row in TABLE[..3].iter().chain([&TABLE[5]]) {
        for rho in [spread(), Matrix3::zeros()] {
            let up = directions(&study(&plan(row, AxisOneUp, PairRelation::Opposite, rho), &[]));
            assert_eq!(up, ["dR_2[A] + dR_1[B] - drho_22", "dR_2[B] + dR_1[C] - drho_33"], "{}", row.case);
            let down = directions(&study(&plan(row, AxisOneDown, PairRelation::Opposite, rho), &[]));
            assert_eq!(down, ["dR_2[A] + dR_1[B] - drho_22", "dR_2[B] - dR_1[C] + drho_33"], "{}", row.case);
        }
    }
}

/// Without rest the tilt is lost as well.
#[test]
fn null_directions_without_rest() {
    let expected = ["alpha_1", "alpha_2", "dR_2[A] + dR_1[B] - drho_22", "dR_2[B] + dR_1[C] - drho_33"];
    assert_eq!(directions(&study(&plan(&TABLE[6], AxisOneUp, PairRelation::Opposite, spread()), &[])), expected);
    assert_eq!(directions(&study(&plan(&TABLE[6], AxisOneUp, PairRelation::Common, spread()), &[])), expected[..2]);
}

/// "In every row with two radii, rest and two or more speeds all 21 instrument parameters are estimable: the null
/// directions lie in dR, drho alone."
#[test]
fn instrument_is_estimable_with_two_radii_rest_and_two_speeds() {
    for row in TABLE[..3].iter().chain([&TABLE[5]]) {
        for relation in RELATIONS {
            for rho in [spread(), Matrix3::zeros()] {
                let study = study(&plan(row, AxisOneUp, relation, rho), &[]);
                for (j, parameter) in study.model().parameters().iter().enumerate() {
                    let may_be_lost = matches!(parameter.group, Group::Shift | Group::ProofMass);
                    assert!(may_be_lost || study.observability().is_estimable(j), "{}: {}", row.case, parameter.name);
                }
                assert!(study.lost_of_instrument().is_empty());
            }
        }
    }
}

fn with(extensions: &[Extension], relation: PairRelation) -> Study {
    study(&plan(&TABLE[0], AxisOneUp, relation, spread()), extensions)
}

fn rank_of_columns(seen: &Observability) -> (usize, usize) {
    (seen.rank(), seen.columns())
}

/// Section 8: growing as Omega^2 the elastic turn is observable, growing with the load it is not, and an instrument
/// parameter is touched.
#[test]
fn elastic_turn() {
    let by_speed = with(&[Extension::ElasticTurn(Law::Speed)], PairRelation::Common);
    assert_eq!(rank_of_columns(by_speed.observability()), (67, 67));
    let by_load = with(&[Extension::ElasticTurn(Law::Load)], PairRelation::Common);
    assert_eq!(rank_of_columns(by_load.observability()), (66, 67));
    assert_eq!(
        directions(&by_load),
        ["delta_3[1] + delta_3[2] + G0_21 - G1_21 + elastic_load_3[1] - elastic_load_3[2] (accelerations in g)"]
    );
    let touched: Vec<&str> =
        by_load.lost_of_instrument().iter().map(|&j| by_load.model().parameters()[j].name.as_str()).collect();
    assert_eq!(touched, ["G0_21", "G1_21"]);
}

/// Section 8: arm stretch 50 of 50 by either law, 51 of 51 for two seats apart or for both laws; one scale of the radii or
/// of the speed 50 of 50; the printed relation loses only its two geometric directions.
#[test]
fn arm_stretch_and_scales() {
    use Extension::{ArmStretch, RadiusScale, SeatStretch, SpeedScale};
    let cases: [(&[Extension], usize); 7] = [
        (&[ArmStretch(Law::Speed)], 50),
        (&[ArmStretch(Law::Load)], 50),
        (&[SeatStretch(Law::Speed)], 51),
        (&[SeatStretch(Law::Load)], 51),
        (&[ArmStretch(Law::Speed), ArmStretch(Law::Load)], 51),
        (&[RadiusScale], 50),
        (&[SpeedScale], 50),
    ];
    for (extensions, columns) in cases {
        let common = with(extensions, PairRelation::Common);
        assert_eq!(rank_of_columns(common.observability()), (columns, columns), "{extensions:?}");
        let printed = with(extensions, PairRelation::Opposite);
        assert_eq!(rank_of_columns(printed.observability()), (columns - 2, columns), "{extensions:?}");
        assert_eq!(directions(&printed), ["dR_2[A] + dR_1[B] - drho_22", "dR_2[B] + dR_1[C] - drho_33"]);
    }
}

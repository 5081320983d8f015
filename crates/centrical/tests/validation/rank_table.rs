//! The rank table of docs/source-and-findings.md, every cell for both P_3: computed by an independent program
//! (column-scaled SVD, tolerance 1e-10), with the smallest non-zero singular value over the largest in brackets where it
//! is below 1e-3. The null directions and the ranks with extensions named there.

use centrical::ThirdPosition::{self, AxisOneDown, AxisOneUp};
use centrical::plan::Normalised;
use centrical::{
    ErrorModel, Extension, Group, Law, MeasurementModel, Observability, PairRelation, Rival, Study, Weight,
};
use nalgebra::Matrix3;

use crate::common::rank_table::{self, CASES, Case, RELATIONS, spread};

/// Ranks with proof masses apart and together, and the bracketed singular value of each if one is printed.
type Cell = [(usize, Option<f64>); 2];

const fn plain(apart: usize, together: usize) -> Cell {
    [(apart, None), (together, None)]
}

const fn thread(apart: usize, smallest: f64, together: usize) -> Cell {
    [(apart, Some(smallest)), (together, None)]
}

/// Of every case: opposite (printed), common, free.
const TABLE: [[Cell; 3]; 7] = [
    [plain(47, 47), plain(49, 49), plain(53, 53)],
    [plain(47, 47), plain(49, 49), plain(53, 53)],
    [plain(47, 47), plain(49, 49), plain(53, 53)],
    [thread(46, 4e-5, 44), plain(48, 46), thread(50, 9e-5, 47)],
    [plain(44, 44), thread(45, 3e-4, 43), thread(46, 2e-4, 44)],
    [plain(47, 47), plain(49, 49), plain(53, 53)],
    [plain(45, 45), plain(47, 47), plain(51, 51)],
];

/// The cases with two radii, rest and two or more speeds.
const COMPLETE: [&Case; 4] = [&CASES[0], &CASES[1], &CASES[2], &CASES[5]];

fn plan(case: &Case, third: ThirdPosition, relation: PairRelation, rho: Matrix3<f64>) -> Normalised {
    Normalised { third, ..rank_table::plan(case, relation, rho) }
}

fn study(plan: &Normalised, extensions: &[Extension]) -> Study {
    let model = MeasurementModel::new(plan.experiment(), ErrorModel::kozlov_2017(), extensions);
    let weights = Weight::equal(model.experiment().set_points.len(), 1.0);
    Study::at_zero(model, weights).unwrap()
}

fn is_printed_as(value: f64, printed: f64) -> bool {
    // One digit is printed: half of its unit.
    (value - printed).abs() <= 0.5 * 10_f64.powf(printed.log10().floor())
}

#[test]
fn every_cell() {
    for (case, row) in CASES.iter().zip(&TABLE) {
        for third in [AxisOneUp, AxisOneDown] {
            for (relation, cell) in RELATIONS.into_iter().zip(row) {
                for (rho, (rank, smallest)) in [spread(), Matrix3::zeros()].into_iter().zip(cell) {
                    let study = study(&plan(case, third, relation, rho), &[]);
                    let seen = study.observability();
                    let cell = format!("{}, {third:?}, {relation:?}, rho0 {}", case.0, rho.amax());
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
    for case in COMPLETE {
        for rho in [spread(), Matrix3::zeros()] {
            let up = directions(&study(&plan(case, AxisOneUp, PairRelation::Opposite, rho), &[]));
            assert_eq!(up, ["dR_2[A] + dR_1[B] - drho_22", "dR_2[B] + dR_1[C] - drho_33"], "{}", case.0);
            let down = directions(&study(&plan(case, AxisOneDown, PairRelation::Opposite, rho), &[]));
            assert_eq!(down, ["dR_2[A] + dR_1[B] - drho_22", "dR_2[B] - dR_1[C] + drho_33"], "{}", case.0);
        }
    }
}

/// Without rest the tilt is lost as well.
#[test]
fn null_directions_without_rest() {
    let expected = ["alpha_1", "alpha_2", "dR_2[A] + dR_1[B] - drho_22", "dR_2[B] + dR_1[C] - drho_33"];
    assert_eq!(directions(&study(&plan(&CASES[6], AxisOneUp, PairRelation::Opposite, spread()), &[])), expected);
    assert_eq!(directions(&study(&plan(&CASES[6], AxisOneUp, PairRelation::Common, spread()), &[])), expected[..2]);
}

/// "In every row with two radii, rest and two or more speeds all 21 instrument parameters are estimable: the null
/// directions lie in dR, drho alone."
#[test]
fn instrument_is_estimable_with_two_radii_rest_and_two_speeds() {
    for case in COMPLETE {
        for relation in RELATIONS {
            for rho in [spread(), Matrix3::zeros()] {
                let study = study(&plan(case, AxisOneUp, relation, rho), &[]);
                for (j, parameter) in study.model().parameters().iter().enumerate() {
                    let may_be_lost = matches!(parameter.group, Group::Shift | Group::ProofMass);
                    assert!(may_be_lost || study.observability().is_estimable(j), "{}: {}", case.0, parameter.name);
                }
                assert!(lost_of_instrument(&study).is_empty());
            }
        }
    }
}

/// Names of the instrument's parameters that are lost.
fn lost_of_instrument(study: &Study) -> Vec<&str> {
    let parameters = study.model().parameters().iter().enumerate();
    let lost = parameters.filter(|(j, p)| p.is_of_instrument() && !study.observability().is_estimable(*j));
    lost.map(|(_, p)| p.name.as_str()).collect()
}

fn with(extensions: &[Extension], relation: PairRelation) -> Study {
    study(&plan(&CASES[0], AxisOneUp, relation, spread()), extensions)
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
    assert_eq!(lost_of_instrument(&by_load), ["G0_21", "G1_21"]);
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

/// The rivals of docs/source-and-findings.md by an independent program: rank with the common and with the printed relation, and
/// how many unknowns there are with the common one.
#[test]
fn rivals() {
    let all = |name: &str| Rival::named(name).unwrap();
    let table: [(&[&str], usize, usize, usize); 20] = [
        (&["odd-quadratic"], 52, 52, 50),
        (&["asymmetry"], 52, 52, 50),
        (&["fourth-power"], 52, 52, 50),
        (&["cross-products"], 58, 58, 54),
        (&["cross-cubes"], 55, 55, 53),
        (&["cubic-products"], 70, 70, 66),
        (&["arm-turn-speed"], 52, 52, 50),
        (&["arm-turn-load"], 52, 52, 50),
        (&["arm-turn-speed", "arm-turn-load"], 55, 55, 53),
        (&["elastic-turn-speed"], 67, 67, 65),
        (&["elastic-turn-load"], 67, 66, 64),
        (&["seat-radius"], 50, 50, 48),
        (&["seat-radius", "radius-scale"], 51, 50, 49),
        (&["mounting-shift"], 67, 58, 58),
        (&["mounting-turn"], 67, 64, 62),
        (&["spin-turn"], 67, 61, 59),
        (&["yield"], 52, 52, 50),
        (&["arm-stretch-speed"], 50, 50, 48),
        (&["earth-rate"], 50, 50, 48),
        (&["angle-tilt"], 51, 51, 49),
    ];
    for (names, columns, common, printed) in table {
        let rivals: Vec<Rival> = names.iter().map(|name| all(name)).collect();
        for (relation, rank) in [(PairRelation::Common, common), (PairRelation::Opposite, printed)] {
            let model = with(&[], relation).model().with_rivals(&rivals);
            let weights = Weight::equal(model.experiment().set_points.len(), 1.0);
            let study = Study::at_zero(model, weights).unwrap();
            assert_eq!(rank_of_columns(study.observability()), (rank, columns), "{names:?}, {relation:?}");
        }
    }
}

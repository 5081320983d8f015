//! Sessions of an independent simulator against ours with the same truth and settings.

use std::fmt::Write;
use std::fs;

use centrical_session::{Session, TableFormat, Truth, reduce, simulate_session, unwatched};
use nalgebra::{Cholesky, Vector3};
use serde_json::Value;

use crate::data;

/// The truth file that says what the session's truth.json says.
fn truth_file(truth: &Value) -> String {
    let number = |value: &Value| value.as_f64().unwrap();
    let g = number(&truth["gravity"]);
    let args = |name: &str| number(&truth["args"][name]);
    let mut text = String::from("[parameters]\n");
    let mut set = |name: String, value: f64| writeln!(text, "\"{name}\" = {value:e}").unwrap();
    for i in 0..3 {
        (0..6).for_each(|k| set(format!("delta_{}[{}]", i + 1, k + 1), number(&truth["delta"][k][i])));
        set(format!("df_{}", i + 1), number(&truth["df"][i]));
        (0..=i).for_each(|j| set(format!("G0_{}{}", i + 1, j + 1), number(&truth["G0"][i][j])));
        (0..3).for_each(|j| set(format!("G1_{}{}", i + 1, j + 1), number(&truth["G1_per_g"][i][j]) / g));
        set(format!("G2_{0}{0}", i + 1), number(&truth["G2_per_g2"][i]) / (g * g));
    }
    for i in 0..2 {
        set(format!("alpha_{}", i + 1), number(&truth["alpha"][i]));
        set(format!("drho_{0}{0}", i + 2), number(&truth["drho"][i]));
        ["A", "B", "C"].iter().enumerate().for_each(|(k, pair)| {
            set(format!("dR_{}[{pair}]", i + 1), number(&truth["dR"][k][i]));
        });
    }
    // The other simulator's time constants, read off its telemetry and the autocovariance of its noise.
    write!(
        text,
        "[machine]\nplateau = {}\nplateau_spread = 1\nramp = {}\nsettling = {}\nsettling_time = 0.4\nspeed_error = {}\n\
         [sensor]\nwhite = {}\ncoloured = {{ deviation = {}, time = 0.5 }}\nquantum = {}\n\
         [recorder]\nrate = {}\nspikes = {{ probability = {}, size = 20 }}\ngaps = {{ probability = {} }}\n",
        args("plateau"),
        args("ramp"),
        args("settle"),
        args("speed_sd"),
        args("noise"),
        args("colour"),
        args("lsb"),
        args("fs"),
        args("spikes"),
        args("gaps"),
    )
    .unwrap();
    text
}

/// Plateau means of the two simulators differ by their noise and by the speed errors of both, which are random.
fn compare(name: &str, seed: u64) {
    let theirs = Session::read(&data(name)).unwrap();
    let truth: Value = serde_json::from_str(&fs::read_to_string(data(name).join("truth.json")).unwrap()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("truth.toml");
    fs::write(&file, truth_file(&truth)).unwrap();
    let truth = Truth::read(&file, &theirs, seed).unwrap();
    let out = folder.path().join("session");
    simulate_session(&truth, seed, TableFormat::Parquet, &out, &unwatched).unwrap();

    let ours = reduce(&Session::read(&out).unwrap(), &unwatched).unwrap().1.observations();
    let theirs = reduce(&theirs, &unwatched).unwrap().1.observations();
    assert_eq!(ours.len(), theirs.len());
    let mut squares = Vector3::zeros();
    for ((a, b), set_point) in ours.iter().zip(&theirs).zip(&truth.model.experiment().set_points) {
        let stated = truth.model.experiment().centrifuge.speed_uncertainty;
        let speed = truth.model.linearise(set_point, &truth.values).setting_error
            * (truth.equipment.machine.speed_error / stated);
        let covariance = a.covariance + b.covariance + 2.0 * speed * speed.transpose();
        let factor = Cholesky::new(covariance).unwrap();
        let whitened = factor.l_dirty().solve_lower_triangular(&(a.mean - b.mean)).unwrap();
        squares += whitened.component_mul(&whitened);
        assert!(whitened.norm_squared() < 30.0, "{name}, {set_point:?}: {whitened:?} standard deviations");
    }
    // chi^2 with three degrees of freedom a plateau; beyond 4 standard deviations is 6e-5. A bias of half a standard
    // deviation in every mean, 2 ug, would add a quarter of the degrees of freedom: 18 % of chi^2, 5 standard deviations.
    let degrees = 3.0 * ours.len() as f64;
    println!("{name}: chi^2 {:.1} of {degrees}, by axis {squares:.0?}", squares.sum());
    assert!((squares.sum() - degrees).abs() < 4.0 * (2.0 * degrees).sqrt(), "{name}: chi^2 {}", squares.sum());
}

#[test]
#[ignore = "needs the shared data: set CENTRICAL_SHARED"]
fn means_agree_with_clean_csv() {
    compare("clean-csv", 1);
}

#[test]
#[ignore = "needs the shared data: set CENTRICAL_SHARED"]
fn means_agree_with_rough_parquet() {
    compare("rough-parquet", 2);
}

#[test]
#[ignore = "needs the shared data: set CENTRICAL_SHARED"]
fn means_agree_with_printed_relation() {
    compare("printed-relation", 3);
}

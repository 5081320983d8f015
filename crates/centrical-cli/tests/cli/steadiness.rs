//! Drift and tilt as `calibrate` tells them, of sessions that were made with and without.

use std::fs;

use centrical_session::CalibrationResult;
use serde_json::Value;

use crate::session::{Copy, example};

/// A session calibrated.
struct Calibrated {
    result: CalibrationResult,
    /// What the terminal shows.
    said: String,
    /// The sections on it of the reports in English and in Russian.
    sections: [String; 2],
}

/// Simulates the example with its first speed run again at the end, and calibrates it.
fn calibrated(truth: &str, seed: &str) -> Calibrated {
    let copy = Copy::new();
    let plan = fs::read_to_string(example().join("experiment.toml")).unwrap();
    let last = "  { speed = \"598.3 rpm\" },\n";
    let plan = plan.replace(last, &format!("{last}  {{ speed = \"133.8 rpm\" }},\n"));
    fs::write(copy.out().join("plan.toml"), plan).unwrap();
    fs::write(copy.out().join("truth.toml"), truth).unwrap();
    let made = copy.run(&["simulate", "plan.toml", "--truth", "truth.toml", "--seed", seed, "--out", "session"]);
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let output = copy.run(&["calibrate", "session"]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let sections =
        [("en", "<h2>Steadiness</h2>"), ("ru", "<h2>Стабильность показаний</h2>")].map(|(language, title)| {
            let made = copy.run(&["report", "result.json", "--html", "report.html", "--language", language]);
            // 1: written, but the result is not acceptable.
            assert!(matches!(made.status.code(), Some(0 | 1)), "{}", String::from_utf8_lossy(&made.stderr));
            let page = fs::read_to_string(copy.out().join("report.html")).unwrap();
            let (_, section) = page.split_once(title).expect("the page has the section");
            section.split_once("</details>").unwrap().0.to_owned()
        });
    Calibrated { result: CalibrationResult::read(&copy.out().join("result.json")).unwrap(), said, sections }
}

const STEADY: &str = r#"
typical = { size = 1.0 }
[parameters]
alpha_1 = "0.3 mrad"
alpha_2 = "-0.4 mrad"
[sensor]
white = "0.2 mg"
"#;

#[test]
fn a_steady_session_is_said_to_be_steady() {
    let Calibrated { result, said, sections: [english, russian] } = calibrated(STEADY, "11");
    let drift = result.drift.expect("records tell the drift");
    assert_eq!(drift.repeats.len(), 12);
    assert_eq!(drift.repeats[0].indices, [1, 8]);
    assert!(drift.repeats.iter().all(|repeat| repeat.probability > 1e-5));
    assert_eq!(said.matches("no drift seen").count(), 2, "{said}");
    assert!(said.contains("plateaus run again: 12") && said.contains("no difference seen"), "{said}");
    assert_eq!((english.matches("no drift seen").count(), russian.matches("уход не обнаружен").count()), (2, 2));
    assert!(english.contains("<td>12; farthest apart: ") && english.contains("no difference seen"), "{english}");
    assert!(english.contains("they agree") && russian.contains("результаты согласуются"), "{english}");
    // The numbers are those of the terminal, as each language writes them.
    let slopes = said.split_once("mean: ").unwrap().1.split_once(" ug/min").unwrap().0;
    for slope in slopes.split(", ") {
        let slope = slope.replace('-', "\u{2212}");
        assert!(english.contains(&slope) && russian.contains(&slope.replace('.', ",")), "{slope}: {english} {russian}");
    }
    assert!(english.contains(" µg/min; χ²") && russian.contains(" мкg/мин; χ²"), "{english} {russian}");
    let tilt = result.tilt.expect("the tilt is determined");
    assert!((tilt.spinning - 5e-4).abs() < 4.0 * tilt.spinning_uncertainty, "{tilt:?}");
    assert!((tilt.at_rest - 5e-4).abs() < 4.0 * tilt.at_rest_uncertainty, "{tilt:?}");
    assert!(said.contains("urad; chi^2") && said.contains("they agree"), "{said}");
    let spinning = &result.plateaus[3];
    let [phase, size] = [spinning.once_per_revolution_phase, spinning.once_per_revolution].map(Option::unwrap);
    assert!(phase.iter().all(|phase| phase.abs() <= std::f64::consts::PI));
    assert!(size[1] > 10.0 * spinning.once_per_revolution_uncertainty.unwrap()[1], "{size:?}");
    assert!(result.plateaus[0].once_per_revolution_phase.is_none());
}

/// A bias that moves by 0.2 mm/s^3 over every record is seen in the plateaus and in those that were run again.
#[test]
fn a_drifting_session_is_said_to_drift() {
    let truth = STEADY.replace("white", "drift = 2e-4\nwhite");
    let Calibrated { result, said, sections: [english, russian] } = calibrated(&truth, "12");
    assert!(said.contains("plateaus drift"), "{said}");
    assert!(said.contains("they differ"), "{said}");
    // chi^2 per degree of freedom is 1800: 75 standard uncertainties of a trend are not one beyond the scatter.
    assert!(said.contains("no more than the plateaus scatter"), "{said}");
    assert!(english.contains("no more than the plateaus scatter"), "{english}");
    assert!(english.contains("plateaus drift") && english.contains("they differ"), "{english}");
    assert!(russian.contains("показания на площадках уходят") && russian.contains("они различаются"), "{russian}");
    let drift = result.drift.expect("records tell the drift");
    assert!(drift.probability < 1e-9, "{drift:?}");
    let [first, second] = drift.repeats[0].indices.map(|index| &result.plateaus[index]);
    let middle = |plateau: &centrical_session::PlateauSummary| plateau.window.unwrap().iter().sum::<f64>() / 2.0;
    // The slope of one plateau foretells the change to the next of its kind.
    for axis in 0..3 {
        let foretold = first.drift.unwrap()[axis] * (middle(second) - middle(first));
        let uncertainty = first.drift_uncertainty.unwrap()[axis] * (middle(second) - middle(first));
        // The speeds of the two differ by 1e-5 each: 3 mm/s^2 at 10 g.
        let tolerance = 4.0 * uncertainty + 4.0 * 3e-3;
        assert!((drift.repeats[0].difference[axis] - foretold).abs() < tolerance, "{foretold} {:?}", drift.repeats[0]);
    }
}

/// Times in hundredths of a second taken for s, which the ramps do not show: the means are right, and nothing in the readings turns with the arm.
#[test]
fn times_in_another_unit_show_no_revolution() {
    let copy = Copy::new();
    copy.edit("experiment.toml", |text| {
        let lines = text.lines().filter(|line| !line.starts_with("telemetry"));
        lines.collect::<Vec<_>>().join("\n")
    });
    for mounting in 1..=12 {
        let scaled = |line: &str| match line.split_once(',').map(|(t, rest)| (t.parse::<f64>(), rest)) {
            Some((Ok(t), rest)) => format!("{},{rest}\n", 100.0 * t),
            _ => format!("{line}\n"),
        };
        copy.edit(&format!("records/m{mounting:02}.csv"), |text| text.lines().map(scaled).collect());
    }
    let said = String::from_utf8(copy.calibrate(&[]).stdout).unwrap();
    let said: Vec<&str> = said.split_whitespace().collect();
    assert!(
        said.join(" ").contains("no term turns with the arm: the times of the records are in another unit"),
        "{said:?}"
    );
}

/// A plateau that the record shows and the schedule lacks is left out, and named.
#[test]
fn a_plateau_that_the_schedule_lacks_is_named() {
    let copy = Copy::new();
    let all = |copy: &Copy| CalibrationResult::read(&copy.out().join("result.json")).unwrap().mountings;
    assert!(copy.calibrate(&[]).status.success());
    assert!(all(&copy).iter().all(|mounting| mounting.unscheduled.is_empty()));
    copy.edit("experiment.toml", |text| text.replacen("  { speed = \"463.5 rpm\" },\n", "", 1));
    let said = String::from_utf8(copy.calibrate(&[]).stdout).unwrap();
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("plateaus that the schedule does not have, not used: mounting 1, "), "{said}");
    let mountings = all(&copy);
    assert_eq!(mountings[0].unscheduled.len(), 1, "{:?}", mountings[0]);
    assert!(mountings[1..].iter().all(|mounting| mounting.unscheduled.is_empty()));
    let reduced = copy.run(&["reduce", "../session", "--out", "reduced", "--json"]);
    let reduced: Value = serde_json::from_slice(&reduced.stdout).unwrap();
    assert_eq!(reduced["unscheduled"][0]["mounting"], 1);
    assert_eq!(reduced["unscheduled"][0]["window"], serde_json::json!(mountings[0].unscheduled[0]));
}

/// Times with one digit behind the point leave a tenth of 100 samples a second, and the program says why.
#[test]
fn rounded_times_are_named() {
    let copy = Copy::new();
    for mounting in 1..=12 {
        let rounded = |line: &str| match line.split_once(',').map(|(t, rest)| (t.parse::<f64>(), rest)) {
            Some((Ok(t), rest)) => format!("{t:.1},{rest}\n"),
            _ => format!("{line}\n"),
        };
        copy.edit(&format!("records/m{mounting:02}.csv"), |text| text.lines().map(rounded).collect());
    }
    let said = String::from_utf8(copy.calibrate(&[]).stdout).unwrap();
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("more samples share a time than are used: the times are rounded"), "{said}");
}

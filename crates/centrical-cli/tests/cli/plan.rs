//! `centrical plan`: a plan, its schedule as a plan file, and what the other commands make of it.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::session::Copy;

/// The example with few speeds and no second scenario.
fn small(copy: &Copy, from: &str, to: &str) -> String {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/plans/best.toml");
    let text = fs::read_to_string(example).unwrap();
    let few = text.replace("count = 20", "count = 4").replace("noise = [\"40 ug/sqrt(Hz)\"]", "noise = []");
    assert!(few.contains(from), "{from}");
    let file = copy.out().join("plan.toml");
    fs::write(&file, few.replacen(from, to, 1)).unwrap();
    file.to_str().unwrap().to_owned()
}

fn json(copy: &Copy, arguments: &[&str]) -> Value {
    let run = copy.run(arguments);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    serde_json::from_slice(&run.stdout).unwrap()
}

/// Within the time, on all positions, above its bound; the schedule that is written is predicted by `observe` as by `plan`,
/// and the same input gives the same bytes.
#[test]
fn a_plan_for_a_time() {
    let copy = Copy::new();
    let plan = small(&copy, "time = \"8 h\"", "time = \"6 h 00 min\"");
    let arguments = ["plan", &plan, "--json", "--frontier", "--svg", "frontier.svg", "--out", "schedule.toml"];
    let report = json(&copy, &arguments);
    let number = |key: &str| report[key].as_f64().unwrap();
    assert!(number("time") <= 6.0 * 3600.0 && number("time") > 5.9 * 3600.0, "{}", number("time"));
    assert!(number("bound") <= number("value") && number("continuous_gap") < 0.01);
    let mountings = report["mountings"].as_array().unwrap();
    let spent: f64 = report["time_by_use"].as_array().unwrap().iter().map(|t| t.as_f64().unwrap()).sum();
    assert!((spent - number("time")).abs() < 1e-6);
    for row in report["frontier"].as_array().unwrap() {
        for usual in ["uniform", "normalised"] {
            assert!(row[usual].as_f64().is_none_or(|usual| usual > row["best"].as_f64().unwrap()), "{row}");
        }
    }
    let svg = fs::read_to_string(copy.out().join("frontier.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("best plan"));

    let observed = json(&copy, &["observe", "schedule.toml", "--json"]);
    let visits: usize = mountings.iter().map(|m| m["plateaus"].as_array().unwrap().len()).sum();
    assert_eq!(observed["plateaus"].as_u64().unwrap(), visits as u64);
    assert_eq!(observed["rank"], observed["columns"]);
    let of = |report: &Value| report["prediction"]["parameters"].as_array().unwrap().clone();
    for (a, b) in of(&report).iter().zip(of(&observed)) {
        let (u, v) = (a["combined"].as_f64().unwrap(), b["combined"].as_f64().unwrap());
        assert!(a["name"] == b["name"] && (u / v - 1.0).abs() < 1e-9, "{a} {b}");
    }

    let schedule = fs::read(copy.out().join("schedule.toml")).unwrap();
    assert_are_the_speeds(&report, std::str::from_utf8(&schedule).unwrap());
    assert_eq!(json(&copy, &arguments), report);
    assert!(schedule == fs::read(copy.out().join("schedule.toml")).unwrap());
    let text = String::from_utf8(copy.run(&["plan", &plan]).stdout).unwrap();
    for part in ["PLAN  6 h 00 min", "SCHEDULE", "without it", "PREDICTION", "compensated reading"] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
}

/// Time that hardly suffices leaves the visits next to nothing to choose from: a plan all the same, above its bound.
#[test]
fn a_plan_for_little_time() {
    let copy = Copy::new();
    let plan = small(&copy, "time = \"8 h\"", "time = \"2 h\"");
    let text = fs::read_to_string(&plan).unwrap().replace("count = 4", "count = 2");
    fs::write(&plan, text).unwrap();
    let report = json(&copy, &["plan", &plan, "--json"]);
    let number = |key: &str| report[key].as_f64().unwrap();
    assert!(number("time") <= 2.0 * 3600.0, "{report}");
    assert!(0.0 < number("bound") && number("bound") <= number("value"), "{} {}", number("bound"), number("value"));
}

/// A time on the command line stands for the one in the plan.
#[test]
fn a_time_beside_the_plan() {
    let copy = Copy::new();
    let stated = json(&copy, &["plan", &small(&copy, "time = \"8 h\"", "time = \"2 h\""), "--json"]);
    let plan = small(&copy, "time = \"8 h\"", "time = \"8 h\"");
    assert_eq!(json(&copy, &["plan", &plan, "--time", "120 min", "--json"]), stated);
    let wrong = copy.run(&["plan", &plan, "--time", "2 kg"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("2 kg"));
}

/// Goals that time reaches are met in the shortest time; goals that no time reaches are an error that says by how much; goals
/// that type B alone misses are named.
#[test]
fn plans_for_goals() {
    let copy = Copy::new();
    let goals = |goals: &str| {
        let plan = small(&copy, "criterion = \"I\"", "");
        let text = fs::read_to_string(&plan).unwrap().replace("time = \"8 h\"", goals);
        fs::write(&plan, text).unwrap();
        copy.run(&["plan", &plan, "--json"])
    };
    let met = goals("[target.uncertainty]\nreading = \"900 ug\"");
    assert_eq!(met.status.code(), Some(0), "{}", String::from_utf8_lossy(&met.stderr));
    let report: Value = serde_json::from_slice(&met.stdout).unwrap();
    assert!(report["value"].as_f64().unwrap() <= 1.0);
    for goal in report["goals"].as_array().unwrap() {
        assert!(goal["combined"].as_f64().unwrap() <= goal["wanted"].as_f64().unwrap(), "{goal}");
    }
    let missed = goals("[target.uncertainty]\nscale = \"0.001 ppm\"");
    assert_eq!(missed.status.code(), Some(2));
    let message = String::from_utf8_lossy(&missed.stderr).into_owned();
    assert!(message.contains("the stated type B uncertainties alone miss by a factor of"), "{message}");
}

/// A goal that noise would leave room for, but for its type B, is met by both together: gravity, which no speed can tell from the
/// scale of the newtonometers, leaves a good part of it.
#[test]
fn goals_are_met_by_both_types() {
    let copy = Copy::new();
    let plan = small(&copy, "criterion = \"I\"", "");
    let wanted = "[target.uncertainty]\nreading = \"900 ug\"";
    let text = fs::read_to_string(&plan).unwrap().replace("time = \"8 h\"", wanted);
    fs::write(&plan, text.replace("gravity = \"1e-6 m/s^2\"", "gravity = \"5e-5 m/s^2\"")).unwrap();
    let report = json(&copy, &["plan", &plan, "--json"]);
    let goal = &report["goals"][0];
    let [a, b, all, wanted] = ["type_a", "type_b", "combined", "wanted"].map(|key| goal[key].as_f64().unwrap());
    assert!(all <= wanted && all > 0.95 * wanted, "{goal}");
    assert!((a.hypot(b) / all - 1.0).abs() < 1e-9 && b > 0.3 * wanted && a < 0.95 * wanted, "{goal}");
    let text = String::from_utf8(copy.run(&["plan", &plan]).stdout).unwrap();
    assert!(text.contains("TYPE B") && text.contains("% of its goal"), "{text}");
}

/// The worst of several scenarios is shown with all of them, and an earlier result is what a plan is predicted for.
#[test]
fn plans_for_the_worst_case_and_for_a_known_unit() {
    let copy = Copy::new();
    let plan = small(&copy, "[robust]", "[robust]\nagainst = \"worst\"\nfloor = [\"20 ug\"]");
    let report = json(&copy, &["plan", &plan, "--json"]);
    let values: Vec<f64> = report["by_scenario"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
    let worst = values.iter().copied().fold(0.0, f64::max);
    assert!(values.len() == 2 && (worst / report["value"].as_f64().unwrap() - 1.0).abs() < 1e-9, "{values:?}");
    assert!(report["bound"].as_f64().unwrap() > 0.99 * worst && report["against"] == "worst");

    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/ta-200");
    assert_eq!(copy.run(&["calibrate", example, "--out", "earlier"]).status.code(), Some(0));
    let plan = small(&copy, "[candidates]", "nominal = \"earlier/result.json\"\n\n[candidates]");
    let of = |report: &Value, name: &str| {
        let parameters = report["prediction"]["parameters"].as_array().unwrap();
        parameters.iter().find(|p| p["name"] == name).unwrap()["type_a"].as_f64().unwrap()
    };
    let known = json(&copy, &["plan", &plan, "--json", "--out", "schedule.toml"]);
    assert!(of(&known, "G2_11") > 0.0 && of(&known, "G0_21") != of(&report, "G0_21"));
    let observed = json(&copy, &["observe", "schedule.toml", "--json"]);
    assert!((of(&observed, "G0_21") / of(&known, "G0_21") - 1.0).abs() < 1e-9);
}

/// The plan is simulated as long as it says, and calibrates.
#[test]
fn a_plan_is_simulated_as_it_says() {
    let copy = Copy::new();
    let plan = small(&copy, "time = \"8 h\"", "time = \"5 h\"");
    assert_eq!(copy.run(&["plan", &plan, "--out", "schedule.toml"]).status.code(), Some(0));
    fs::write(
        copy.out().join("truth.toml"),
        "typical = { size = 0.5, seed = 3 }\n[sensor]\nwhite = \"100 ug\"\n[recorder]\nrate = 20\n",
    )
    .unwrap();
    let run = copy.run(&["simulate", "schedule.toml", "--truth", "truth.toml", "--seed", "1", "--out", "session"]);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    let truth: Value = serde_json::from_slice(&fs::read(copy.out().join("session/truth.json")).unwrap()).unwrap();
    let report = json(&copy, &["plan", &plan, "--json"]);
    let planned =
        report["mountings"].as_array().unwrap().iter().flat_map(|m| m["plateaus"].as_array().unwrap().clone());
    let planned: Vec<f64> = planned.map(|p| p["duration"].as_f64().unwrap()).collect();
    let windows = truth["plateaus"].as_array().unwrap();
    assert_eq!(windows.len(), planned.len());
    for (made, planned) in windows.iter().zip(planned) {
        let end = |n: usize| made["window"][n].as_f64().unwrap();
        assert!((end(1) - end(0) - planned).abs() < 1.0, "{made} {planned}");
    }
    let calibrated = copy.run(&["calibrate", "session", "--json"]);
    assert_eq!(calibrated.status.code(), Some(0), "{}", String::from_utf8_lossy(&calibrated.stderr));
}

/// The schedule has the speeds of the plan in rpm, its angles in degrees and its durations in seconds.
fn assert_are_the_speeds(report: &Value, schedule: &str) {
    let quantity = |line: &str, key: &str, unit: &str| -> Option<f64> {
        let (_, text) = line.split_once(&format!("{key} = \""))?;
        text.split_once(&format!(" {unit}\""))?.0.parse().ok()
    };
    let lines: Vec<&str> = schedule.lines().filter(|line| line.starts_with("  { speed")).collect();
    let mountings = report["mountings"].as_array().unwrap();
    let planned: Vec<&Value> = mountings.iter().flat_map(|m| m["plateaus"].as_array().unwrap()).collect();
    assert_eq!(lines.len(), planned.len());
    for (line, planned) in lines.into_iter().zip(planned) {
        let number = |key: &str| planned[key].as_f64().unwrap();
        let speed = quantity(line, "speed", "rpm").unwrap() * (std::f64::consts::TAU / 60.0);
        // Two roundings of one part in 2^53 at most.
        assert!((speed - number("speed")).abs() <= f64::EPSILON * number("speed"), "{line}: {planned}");
        if number("speed") == 0.0 {
            assert_eq!(quantity(line, "angle", "deg").unwrap().to_radians(), number("angle"), "{line}");
        }
        assert_eq!(quantity(line, "duration", "s"), Some(number("duration")), "{line}");
    }
}

/// Rests beside the arm in a plan: chosen, written out, and predicted by `observe` as by `plan`.
#[test]
fn plans_with_rests_beside_the_arm() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/plans/with-rests.toml");
    let text = fs::read_to_string(example).unwrap().replace("count = 4", "count = 2");
    for known in [false, true] {
        let copy = Copy::new();
        let attitudes = if known { "attitude_uncertainty = \"0.05 deg\"\n" } else { "" };
        let text = text.replace("durations = [", &format!("{attitudes}durations = ["));
        fs::write(copy.out().join("plan.toml"), text).unwrap();
        let report = json(&copy, &["plan", "plan.toml", "--json", "--out", "schedule.toml"]);
        let rests = report["rests"]["rests"].as_array().unwrap();
        assert!(rests.len() > 3, "{report}");
        assert_eq!(report["rests"]["attitude_uncertainty"].is_number(), known);
        let observed = json(&copy, &["observe", "schedule.toml", "--json"]);
        let of = |report: &Value| report["prediction"]["parameters"].as_array().unwrap().clone();
        assert_eq!(of(&report).len(), of(&observed).len());
        for (a, b) in of(&report).iter().zip(of(&observed)) {
            let (u, v) = (a["combined"].as_f64().unwrap(), b["combined"].as_f64().unwrap());
            assert!(a["name"] == b["name"] && (u / v - 1.0).abs() < 1e-9, "{a} {b}");
        }
        let text = String::from_utf8(copy.run(&["plan", "plan.toml"]).stdout).unwrap();
        assert!(text.contains("RESTS beside the arm") && text.contains("rests beside the arm"), "{text}");
    }
}

/// Rests alone: a plan without an arm, whose written schedule is one of rests alone.
#[test]
fn plans_of_rests_alone() {
    let copy = Copy::new();
    let plan = "[candidates]\nattitudes = \"cube\"\ndurations = [\"60 s\"]\n\n[cost]\nattitude = \"20 s\"\n\n\
                [target]\ntime = \"30 min\"\n\n[site]\ngravity = \"9.81523 m/s^2\"\n\n[unit]\noutput_unit = \"m/s^2\"\n\n[model]\n\
                error_model = [\"df_1\", \"df_2\", \"df_3\", \"G0_11\", \"G0_21\", \"G0_22\", \"G0_31\", \"G0_32\", \"G0_33\"]\n";
    fs::write(copy.out().join("plan.toml"), plan).unwrap();
    let report = json(&copy, &["plan", "plan.toml", "--json", "--frontier", "--out", "schedule.toml"]);
    // Nine unknowns of the unit and one equation a rest: 22 rests of 80 s fill the time.
    assert_eq!(report["mountings"].as_array().unwrap().len(), 0);
    assert_eq!(report["rests"]["rests"].as_array().unwrap().len(), 22);
    assert!(report["frontier"].as_array().unwrap().iter().all(|row| row["normalised"].is_null()));
    let observed = json(&copy, &["observe", "schedule.toml", "--json"]);
    assert_eq!(observed["plateaus"], 22);
}

/// Some of the positions suffice for a plan; wanted uncertainties beside a criterion that does not know of them are refused.
#[test]
fn some_positions_and_goals_without_their_criterion() {
    let copy = Copy::new();
    let plan = small(
        &copy,
        "durations = [\"30 s\", \"60 s\", \"120 s\"]",
        "durations = [\"30 s\", \"60 s\"]\npositions = [\"1\", \"2\", \"3\"]",
    );
    let report = copy.run(&["plan", &plan, "--json", "--out", "schedule.toml"]);
    let report: Value = serde_json::from_slice(&report.stdout).unwrap();
    assert!(report["mountings"].as_array().unwrap().iter().all(|mounting| mounting["position"] != "4"));
    let observed = copy.run(&["observe", "schedule.toml", "--json"]);
    assert!(serde_json::from_slice::<Value>(&observed.stdout).is_ok(), "{}", String::from_utf8_lossy(&observed.stderr));

    let goals = small(&copy, "[robust]", "[target.uncertainty]\ndf_1 = \"5 ug\"\n\n[robust]");
    let run = copy.run(&["plan", &goals]);
    let said = String::from_utf8(run.stderr).unwrap();
    assert_eq!(run.status.code(), Some(2), "{said}");
    assert!(said.contains("[target], criterion: found criterion \"I\" beside [target.uncertainty]"), "{said}");
}

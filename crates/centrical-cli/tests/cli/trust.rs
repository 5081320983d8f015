//! The commands that say how far a calibration can be trusted, on the example.

use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::Value;

use crate::program;
use crate::session::{Copy, example};

fn run(arguments: &[&str]) -> Output {
    program::centrical().args(arguments).output().unwrap()
}

fn text(run: &Output) -> String {
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    String::from_utf8(run.stdout.clone()).unwrap()
}

#[test]
fn assess_tells_budget_validity_and_prediction() {
    let folder = example();
    let told = text(&run(&["assess", folder.to_str().unwrap(), "--without-outliers"]));
    for part in ["OUTLIERS", "UNCERTAINTY BUDGET", "noise", "speed of each plateau", "VALIDITY", "PREDICTION", "G2_33"]
    {
        assert!(told.contains(part), "{part} is not in\n{told}");
    }
}

/// A bound of an effect that grows is its size at a load or a speed, or that of one unit of it.
#[test]
fn bounds_are_stated_at_a_load_or_a_speed() {
    let parameters = |stated: &str| {
        let copy = Copy::new();
        copy.edit("experiment.toml", |text| format!("{text}\n[uncertainty]\n{stated}\n"));
        let told = text(&run(&["calibrate", copy.session().to_str().unwrap(), "--json"]));
        let result: Value = serde_json::from_str(&told).unwrap();
        result["budget"]["combined"].clone()
    };
    let per_g = parameters("arm_turn_load = \"0.003 urad/g\"");
    let [a, b] = [per_g, parameters("arm_turn_load = \"0.3 urad at 100 g\"")]
        .map(|combined| combined.as_array().unwrap().iter().filter_map(Value::as_f64).collect::<Vec<f64>>());
    assert!(a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| (a / b - 1.0).abs() < 1e-9));
    let at_speed = parameters("spin_square = \"5 ug at 10 rev/s\"");
    assert!(at_speed.as_array().unwrap().iter().any(Value::is_f64));
    let copy = Copy::new();
    copy.edit("experiment.toml", |text| format!("{text}\n[uncertainty]\nspin_square = \"100 ug\"\n"));
    let refused = String::from_utf8(run(&["calibrate", copy.session().to_str().unwrap()]).stderr).unwrap();
    assert!(refused.contains("or its size at a place: \"500 ug at 10 rev/s\""), "{refused}");
}

/// The same seed gives the same bytes on one thread and on three.
#[test]
fn montecarlo_repeats_itself() {
    let folder = example();
    let with = |threads: &str| {
        let arguments = ["montecarlo", folder.to_str().unwrap(), "--runs", "40", "--seed", "7"];
        program::centrical().args(arguments).env("RAYON_NUM_THREADS", threads).output().unwrap()
    };
    let one = text(&with("1"));
    assert!(one.contains("MONTE CARLO  40 calibrations, 0 did not converge"), "{one}");
    assert_eq!(one, text(&with("3")));
}

/// Uncertainties that do not hold are no success: linear fits alone of a unit of typical errors, and none of the exact ones.
#[test]
fn montecarlo_refuses_uncertainties_that_are_too_small() {
    let folder = example();
    let with =
        |more: &[&str]| run(&[&["montecarlo", folder.to_str().unwrap(), "--runs", "200", "--typical"], more].concat());
    let refused = with(&["--linear"]);
    assert_eq!(refused.status.code(), Some(1));
    let text = String::from_utf8(refused.stdout).unwrap();
    assert!(text.starts_with("NOT ACCEPTABLE  uncertainties are stated too small, at worst by a factor of "), "{text}");
    assert_eq!(with(&[]).status.code(), Some(0));
    let document: serde_json::Value = serde_json::from_slice(&with(&["--linear", "--json"]).stdout).unwrap();
    assert_eq!(document["acceptable"], false);
    assert!(document["understated"].as_array().unwrap().iter().any(|name| name == "G1_11"), "{document}");
}

/// A preset plan is drawn from as well.
#[test]
fn montecarlo_draws_from_a_preset_plan() {
    let plan = example().join("../plans/normalised.toml");
    let told = text(&run(&["montecarlo", plan.to_str().unwrap(), "--runs", "30"]));
    assert!(told.contains("MONTE CARLO  30 calibrations"), "{told}");
    assert!(told.starts_with("A unit with typical errors"), "its rank is short: {told}");
}

/// What calibrations state of the unit that is drawn for by default is what `observe` predicts.
#[test]
fn montecarlo_draws_for_the_unit_that_is_predicted() {
    let folder = tempfile::tempdir().unwrap();
    let plan = folder.path().join("plan.toml");
    let text_of_plan = fs::read_to_string(example().join("../plans/normalised.toml")).unwrap();
    fs::write(&plan, text_of_plan.replace("\"opposite\"", "\"common\"")).unwrap();
    let plan = plan.to_str().unwrap();
    let uncertainties = |told: &str, heading: &str, column: usize| -> HashMap<String, f64> {
        let table = &told[told.find(heading).unwrap()..];
        let row = |line: &str| {
            let words: Vec<&str> = line.split_whitespace().collect();
            Some((words.first()?.to_string(), words.get(column)?.parse().ok()?))
        };
        let is_head = |line: &&str| line.trim_start().starts_with("unit");
        table.lines().skip_while(|line| !is_head(line)).skip(1).map_while(row).collect()
    };
    let drawn = text(&run(&["montecarlo", plan, "--runs", "20"]));
    assert!(drawn.starts_with("A unit without errors"), "{drawn}");
    let drawn = uncertainties(&drawn, "MONTE CARLO", 2);
    let predicted = uncertainties(&text(&run(&["observe", plan])), "PREDICTION", 3);
    assert_eq!((drawn.len(), predicted.len()), (49, 49));
    let agree = |name: &str, drawn: &HashMap<String, f64>| {
        // A small number is printed with one digit, others with two or more.
        let rounding = if drawn[name] < 1e-3 { 0.5 } else { 0.05 };
        (drawn[name] / predicted[name] - 1.0).abs() < 0.02 + rounding
    };
    for name in predicted.keys() {
        assert!(agree(name, &drawn), "{name}: {} drawn, {} predicted", drawn[name], predicted[name]);
    }
    let typical = text(&run(&["montecarlo", plan, "--runs", "20", "--typical"]));
    assert!(typical.starts_with("A unit with typical errors"), "{typical}");
    let typical = uncertainties(&typical, "MONTE CARLO", 2);
    assert!(!predicted.keys().all(|name| agree(name, &typical)), "it makes no difference");
}

#[test]
fn models_recommends_what_the_example_was_made_with() {
    let told = text(&run(&["models", example().to_str().unwrap()]));
    assert!(told.contains("RECOMMENDED  \"as stated\""), "{told}");
}

/// What a laboratory states, all of it.
const STATED: &str = r#"
[uncertainty]
gravity = "1e-6 m/s^2"
latitude = "0.001 deg"
radius = "20 um"
radius_difference = "3 um"
speed_scale = 1e-6
plateau_speed = 1e-5
rest_angle = "10 arcsec"
proof_masses = "20 um"
attitude = "20 urad"
resolution = "1 ug"
doubt = 0.25
"#;

fn result(copy: &Copy) -> Value {
    serde_json::from_slice(&fs::read(copy.out().join("result.json")).unwrap()).unwrap()
}

/// A calibration says what its uncertainties hold, whether it can be believed, and the verdict.
#[test]
fn calibrate_tells_sources_validity_and_verdict() {
    let copy = Copy::new();
    let told = text(&copy.calibrate(&[]));
    for part in [
        "value ± standard uncertainty",
        "FROM    noise, speed of each plateau\n",
        "counts as exact: gravity, latitude, ",
        "gravity is 9.81523 m/s^2",
        "VALID   chi^2 as large or larger comes by chance with a probability of 0.1",
        "none of the 108 plateaus stands out",
        "patterns against speed, position, radius and time in the residuals",
        "each mounting predicted from all others",
        "ACCEPTABLE  no check raised an objection",
    ] {
        assert!(told.contains(part), "{part} is not in\n{told}");
    }
    let result = result(&copy);
    let (budget, validity) = (&result["budget"], &result["validity"]);
    assert_eq!(budget["sources"].as_array().unwrap().len(), 2);
    assert_eq!(validity["mountings"].as_array().unwrap().len(), 12);
    for (parameter, combined) in
        result["parameters"].as_array().unwrap().iter().zip(budget["combined"].as_array().unwrap())
    {
        let ratio = parameter["standard_uncertainty"].as_f64().unwrap() / combined.as_f64().unwrap();
        assert!((ratio - 1.0).abs() < 1e-6, "{parameter}");
    }
}

/// Where the session states uncertainties, those of the result, its covariance, the report and what is compared are the
/// combined ones; the estimates move by less than what is stated allows.
#[test]
fn stated_uncertainties_are_in_the_result() {
    let copy = Copy::new();
    text(&copy.calibrate(&["--out", "."]));
    let without = result(&copy);
    fs::rename(copy.out().join("result.json"), copy.out().join("without.json")).unwrap();
    copy.edit("experiment.toml", |text| text + STATED);
    let told = text(&copy.calibrate(&["--out", "."]));
    assert!(told.contains("value ± combined standard uncertainty") && !told.contains("states no"), "{told}");
    let with = result(&copy);
    let names: Vec<&str> =
        with["budget"]["sources"].as_array().unwrap().iter().map(|s| s["name"].as_str().unwrap()).collect();
    assert_eq!(names.len(), 11, "{names:?}");
    let page = fs::read_to_string(copy.out().join("report.html")).unwrap();
    for part in ["Scale of the speed", "Difference of radii", "Eff. degrees of freedom", "Plateaus that stand out"] {
        assert!(page.contains(part), "{part} is not in the report");
    }
    for j in 0..49 {
        let of = |result: &Value, key: &str| result["parameters"][j][key].as_f64().unwrap();
        let combined = of(&with, "standard_uncertainty");
        assert!((of(&with, "value") - of(&without, "value")).abs() < combined);
        assert!(combined > of(&without, "standard_uncertainty"));
        assert!((combined / with["budget"]["combined"][j].as_f64().unwrap() - 1.0).abs() < 1e-6);
        assert!((with["covariance"][j][j].as_f64().unwrap().sqrt() / combined - 1.0).abs() < 1e-12);
        let parts = with["budget"]["sources"].as_array().unwrap().iter();
        let sum: f64 = parts.map(|source| source["standard_uncertainty"][j].as_f64().unwrap().powi(2)).sum();
        assert!((sum.sqrt() / combined - 1.0).abs() < 1e-6, "{j}");
    }
    // delta_1[5] is nearly all attitude, doubtful by a quarter: 8 degrees of freedom, so U = 2.37 u and not 2 u.
    assert!(page.contains("750 ± 47") && !page.contains("750 ± 40"), "k of Student's distribution in the report");
    // The source that shifts a parameter most: a common radius is dR_1 and nothing else.
    let shift = with["parameters"].as_array().unwrap().iter().position(|p| p["name"] == "dR_1[A]").unwrap();
    assert!(with["parameters"][shift]["standard_uncertainty"].as_f64().unwrap() > 19e-6);
    let compared = text(&copy.run(&["compare", "without.json", "result.json"]));
    assert!(compared.contains("probability 1.00"), "{compared}");
}

/// A plateau that is grossly off stands out by name, and the calibration is not acceptable; held out it is.
#[test]
fn an_outlying_plateau_is_named() {
    let copy = Copy::new();
    copy.edit("records/m05.csv", |text| crate::watch::disturbed(&text));
    let run = copy.calibrate(&[]);
    let told = String::from_utf8(run.stdout).unwrap();
    assert_eq!(run.status.code(), Some(1), "{told}");
    assert!(told.contains("plateau 5:9 STANDS OUT") && told.contains("--hold-out 5:9"), "{told}");
    assert!(told.contains("NOT ACCEPTABLE  plateaus that stand out: 5:9"), "{told}");
    assert!(text(&copy.calibrate(&["--hold-out", "5:9"])).contains("ACCEPTABLE  no check raised"));
    let cleaned = text(&copy.run(&["assess", copy.session().to_str().unwrap(), "--without-outliers"]));
    assert!(cleaned.contains("OUTLIERS  1 plateau left out\n  mounting 5, plateau 9"), "{cleaned}");
    assert!(cleaned.contains("estimates that moved most"), "{cleaned}");
    // The verdict is that of the fit that is assessed.
    assert!(cleaned.ends_with("ACCEPTABLE  no check raised an objection\n"), "{cleaned}");
    let assessed = copy.run(&["assess", copy.session().to_str().unwrap(), "--json"]);
    assert_eq!(assessed.status.code(), Some(1));
    let document: Value = serde_json::from_slice(&assessed.stdout).unwrap();
    let objections = document["objections"].as_array().unwrap();
    assert!(document["acceptable"] == false && objections.contains(&"outlying".into()), "{objections:?}");
}

/// Two calibrations of one unit agree with themselves; of two units they do not, and the exit code says so.
#[test]
fn compare_tells_whether_two_calibrations_agree() {
    let copy = Copy::new();
    text(&copy.calibrate(&[]));
    let file = copy.out().join("result.json");
    let agree = |other: &Path| copy.run(&["compare", file.to_str().unwrap(), other.to_str().unwrap(), "--years", "2"]);
    assert!(text(&agree(&file)).contains("all 21 together: chi^2 = 0.0 with 21 degrees of freedom"));
    let mut moved = result(&copy);
    let parameters = moved["parameters"].as_array_mut().unwrap();
    let bias = parameters.iter_mut().find(|p| p["name"] == "df_1").unwrap();
    let far = bias["value"].as_f64().unwrap() + 20.0 * bias["standard_uncertainty"].as_f64().unwrap();
    bias["value"] = far.into();
    let other = copy.out().join("moved.json");
    fs::write(&other, moved.to_string()).unwrap();
    let run = agree(&other);
    let told = String::from_utf8(run.stdout).unwrap();
    assert_eq!(run.status.code(), Some(1), "{told}");
    let line = told.lines().find(|line| line.contains("df_1")).unwrap();
    assert!(line.ends_with("DISAGREE") && line.contains("7.07"), "{line}");
}

/// Two units do not agree, whatever their numbers; error models that differ are named, and only common terms are compared.
#[test]
fn compare_names_other_units_and_models() {
    let copy = Copy::new();
    text(&copy.calibrate(&[]));
    let compared = |change: &dyn Fn(&mut Value)| {
        let mut other = result(&copy);
        change(&mut other);
        fs::write(copy.out().join("other.json"), other.to_string()).unwrap();
        let run = copy.run(&["compare", "result.json", "other.json", "--other-units"]);
        (run.status.code(), String::from_utf8(run.stdout).unwrap())
    };
    let (code, said) = compared(&|other| other["session"]["unit_serial"] = "0002".into());
    assert_eq!(code, Some(1), "{said}");
    assert!(
        said.contains("DIFFERENT UNITS  the first result is of TA-200, serial 0001, the second of TA-200, serial 0002")
    );
    let refused = copy.run(&["compare", "result.json", "other.json"]);
    assert_eq!(refused.status.code(), Some(2));
    let message = String::from_utf8(refused.stderr).unwrap();
    let expected =
        "other.json: found a result of TA-200, serial 0002, expected a result of TA-200, serial 0001, or --other-units";
    assert!(message.contains(expected), "{message}");
    let rename = |other: &mut Value, from: &str, to: &str| {
        let parameters = other["parameters"].as_array_mut().unwrap();
        let parameter = parameters.iter_mut().find(|p| p["name"] == from).unwrap();
        (parameter["name"], parameter["unit"]) = (to.into(), "s^2/m".into());
    };
    let (code, said) = compared(&|other| {
        let term = &mut other["model"]["error_model"][0];
        (term["powers"], term["name"]) = (serde_json::json!([0, 1, 1]), "K_1[f2*f3]".into());
        rename(other, "df_1", "K_1[f2*f3]");
    });
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("only the first has df_1") && said.contains("only the second has K_1[f2*f3]"), "{said}");
    assert!(said.contains("all 20 together") && !said.contains("\n  df_1"), "{said}");
    let (code, said) = compared(&|other| {
        let terms = std::mem::replace(&mut other["model"]["error_model"], serde_json::json!([]));
        for term in terms.as_array().unwrap() {
            let name = term["name"].as_str().unwrap();
            rename(other, name, &format!("other_{name}"));
        }
    });
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("NOTHING TO COMPARE"), "{said}");
}

/// Three results: each against the one before, the last against the first; the years come from the dates.
#[test]
fn compare_takes_any_number_of_results() {
    let copy = Copy::new();
    text(&copy.calibrate(&[]));
    for (name, date) in [("2027.json", "2027-10-05"), ("2029.json", "2029-10-05")] {
        let mut later = result(&copy);
        later["session"]["date"] = date.into();
        fs::write(copy.out().join(name), later.to_string()).unwrap();
    }
    let arguments = ["compare", "result.json", "2027.json", "2029.json", "--svg", "plot.svg"];
    let said = text(&copy.run(&arguments));
    for heading in [
        "RESULT 2 LESS RESULT 1, 1.00 years",
        "RESULT 3 LESS RESULT 2, 2.00 years",
        "RESULT 3 LESS RESULT 1, 3.00 years",
    ] {
        assert!(said.contains(heading), "{said}");
    }
    assert!(said.contains("2 2027.json: TA-200, serial 0001, 2027-10-05"), "{said}");
    assert!(fs::read_to_string(copy.out().join("plot.svg")).unwrap().contains("<svg"));
    let json: Value =
        serde_json::from_slice(&copy.run(&["compare", "result.json", "2027.json", "--json"]).stdout).unwrap();
    assert_eq!(json["schema"], "centrical-comparison/1");
    assert_eq!(json["comparisons"].as_array().unwrap().len(), 1);
    assert_eq!(json["agree"], true);
}

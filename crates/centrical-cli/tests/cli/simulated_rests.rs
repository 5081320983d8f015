//! `simulate` of sessions with rests in attitudes of their own: calibrating them gives the truth back.

use std::fs;
use std::path::Path;
use std::process::Output;

use nalgebra::{DMatrix, DVector};
use serde_json::Value;
use tempfile::TempDir;

use crate::program;
use crate::session::example;

const TRUTH: &str = r#"
typical = { size = 1.0 }
[sensor]
white = "0.3 mg"
coloured = { deviation = "0.05 mg", time = "0.2 s" }
[hand]
rest = "5 s"
rest_spread = "3 s"
turn_spread = "1 s"
shake = "1 m/s^2"
tremor = { deviation = "1 mrad" }
"#;

/// A plan of rests alone.
const ALONE: &str = r#"
[session]
title = "rests"
date = ""
[site]
gravity = "9.81523 m/s^2"
[unit]
serial = ""
output_unit = "counts"
counts = { scale = [4e5, 4.1e5, -4.2e5], bias = [0, 100.5, -3] }
[model]
error_model = ["df_1", "df_2", "df_3", "G0_11", "G0_21", "G0_22", "G0_31", "G0_32", "G0_33"]
"#;

fn done(run: &Output) {
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
}

fn json(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

fn simulated(folder: &TempDir, plan: &str, seed: &str, out: &str) -> Value {
    let file = folder.path().join("plan.toml");
    fs::write(&file, plan).unwrap();
    fs::write(folder.path().join("truth.toml"), TRUTH).unwrap();
    let mut command = program::centrical();
    command.arg("simulate").arg(file).arg("--truth").arg(folder.path().join("truth.toml"));
    let run = command.args(["--seed", seed, "--json", "--out"]).arg(folder.path().join(out)).output().unwrap();
    done(&run);
    serde_json::from_slice(&run.stdout).unwrap()
}

/// Squared error of the parameters of the truth over their covariance, and their number.
fn squared_error(session: &Path) -> (f64, usize) {
    let run = program::centrical().args(["calibrate", "--json"]).arg(session).output().unwrap();
    done(&run);
    let (result, truth): (Value, _) = (serde_json::from_slice(&run.stdout).unwrap(), json(&session.join("truth.json")));
    let found = result["parameters"].as_array().unwrap();
    let place = |name: &Value| found.iter().position(|p| p["name"] == *name).unwrap();
    let truth: Vec<(usize, f64)> = truth["parameters"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| (place(&p["name"]), p["value"].as_f64().unwrap()))
        .collect();
    let uncertainty = |j: usize| found[j]["standard_uncertainty"].as_f64().unwrap();
    let error = |(j, truth): &(usize, f64)| (found[*j]["value"].as_f64().unwrap() - truth) / uncertainty(*j);
    let error = DVector::from_iterator(truth.len(), truth.iter().map(error));
    let correlation = DMatrix::from_fn(truth.len(), truth.len(), |a, b| {
        let (i, j) = (truth[a].0, truth[b].0);
        result["covariance"][i][j].as_f64().unwrap() / (uncertainty(i) * uncertainty(j))
    });
    (correlation.cholesky().unwrap().l().solve_lower_triangular(&error).unwrap().norm_squared(), truth.len())
}

/// Rests alone in drawn attitudes, and in known ones: of a cube, of a table beside the plan.
#[test]
fn rests_alone_give_the_truth_back() {
    let folder = TempDir::new().unwrap();
    let table = "up_1,up_2,up_3\n0,0,1\n0,0,-1\n0,2,0\n0,-1,0\n1,0,0\n-1,0,0\n0,1,1\n1,0,1\n1,1,0\n1,-1,0\n";
    fs::write(folder.path().join("where.csv"), table).unwrap();
    let cases = [
        ("record = \"not-there.csv\"\n", 24, 9, "record = \"records/tumble-1.csv\""),
        ("attitudes = \"cube\"\nduration = \"6 s\"\n", 26, 9, "record ="),
        (
            "attitudes = [[0, 0, 1], [0, 0, -1], [0, 1, 0], [0, -1, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 1], [1, 0, 1], [1, 1, 0], [1, -1, 0]]\n\
          durations = [\"6 s\", \"7 s\", \"6 s\", \"7 s\", \"6 s\", \"7 s\", \"6 s\", \"7 s\", \"6 s\", \"7 s\"]\n",
            10,
            9,
            "record =",
        ),
        ("attitudes = \"cube\"\nattitude_uncertainty = \"1 mrad\"\n", 26, 12, "attitudes = \"cube\""),
        ("attitudes = \"where.csv\"\nattitude_uncertainty = \"1 mrad\"\n", 10, 12, "attitudes = \"attitudes-1.csv\""),
    ];
    for (n, (tumble, rests, parameters, named)) in cases.into_iter().enumerate() {
        let out = format!("session{n}");
        let report = simulated(&folder, &format!("{ALONE}[[tumble]]\n{tumble}"), "4", &out);
        assert_eq!((&report["rests"], &report["mountings"]), (&rests.into(), &0.into()));
        let session = folder.path().join(&out);
        let text = fs::read_to_string(session.join("experiment.toml")).unwrap();
        assert!(text.contains(named) && !text.contains("duration"), "{text}");
        assert_eq!(json(&session.join("truth.json"))["rests"].as_array().unwrap().len(), rests);
        let (squared, count) = squared_error(&session);
        assert_eq!(count, parameters, "{tumble}");
        // The 99.99 % band of chi^2 with 9 and with 12 degrees of freedom.
        assert!((0.4..39.0).contains(&squared), "{tumble}: {squared}");
    }
}

/// A hand that turns the unit slowly and hardly rests: refused as rests, and calibrated to its truth with the turning radius. The folder is a session with
/// the same numbers.
#[test]
fn slow_rotation_counts_as_rests_where_it_is_asked_for() {
    let folder = TempDir::new().unwrap();
    let plan = ALONE.replace(
        "output_unit = \"counts\"\ncounts = { scale = [4e5, 4.1e5, -4.2e5], bias = [0, 100.5, -3] }",
        "output_unit = \"m/s^2\"",
    );
    fs::write(folder.path().join("plan.toml"), format!("{plan}[[tumble]]\nrecord = \"x.csv\"\n")).unwrap();
    let slowly = TRUTH.replace(
        "rest = \"5 s\"\nrest_spread = \"3 s\"\nturn_spread = \"1 s\"\nshake = \"1 m/s^2\"",
        "rest = \"0.3 s\"\nturn = \"60 s\"\nrests = 20",
    );
    fs::write(folder.path().join("truth.toml"), slowly).unwrap();
    let run = |arguments: &[&str]| program::centrical().current_dir(folder.path()).args(arguments).output().unwrap();
    done(&run(&["simulate", "plan.toml", "--truth", "truth.toml", "--seed", "3", "--out", "made"]));
    let record = ["tumble", "made/records/tumble-1.csv", "--gravity", "9.81523 m/s^2"];
    let refused = run(&record);
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && message.contains("--turning-radius"), "{message}");
    let found = run(&[&record[..], &["--turning-radius", "20 mm", "--out", "tumbled"]].concat());
    let text = String::from_utf8_lossy(&found.stdout).into_owned();
    assert_eq!(found.status.code(), Some(0), "{text}{}", String::from_utf8_lossy(&found.stderr));
    assert!(text.contains("arcs of slow rotation") && text.contains("20 mm from its axes"), "{text}");
    let (result, truth) =
        (json(&folder.path().join("tumbled/result.json")), json(&folder.path().join("made/truth.json")));
    assert!(
        result["turning"]["arcs"].as_u64() > Some(40) && result["turning"]["share"].as_f64() > Some(0.9),
        "{}",
        result["turning"]
    );
    for parameter in truth["parameters"].as_array().unwrap() {
        let found = result["parameters"].as_array().unwrap().iter().find(|p| p["name"] == parameter["name"]).unwrap();
        let [value, uncertainty] = ["value", "standard_uncertainty"].map(|key| found[key].as_f64().unwrap());
        let error = value - parameter["value"].as_f64().unwrap();
        // Nine of them: by chance once in 5,000 sets.
        assert!(error.abs() < 4.1 * uncertainty, "{}: {error} +- {uncertainty}", parameter["name"]);
    }
    done(&run(&["calibrate", "tumbled", "--out", "again"]));
    let again = json(&folder.path().join("again/result.json"));
    for key in ["parameters", "turning", "budget", "validity", "between_rests"] {
        assert_eq!(again[key], result[key], "{key}");
    }
    // A session that names the record finds the same arcs, and keeps them where it is reduced.
    let session = fs::read_to_string(folder.path().join("tumbled/experiment.toml")).unwrap();
    let lines = session.lines().filter(|line| !line.starts_with("noise_at_most") && !line.starts_with("turning"));
    let of_record = "record = \"../made/records/tumble-1.csv\"\nturning_radius = \"20 mm\"";
    let session = lines.collect::<Vec<_>>().join("\n").replace("rests = \"rests.csv\"", of_record);
    fs::create_dir(folder.path().join("session")).unwrap();
    fs::write(folder.path().join("session/experiment.toml"), session).unwrap();
    done(&run(&["reduce", "session", "--out", "reduced"]));
    for session in ["session", "reduced"] {
        done(&run(&["calibrate", session, "--out", "of-record"]));
        let of_record = json(&folder.path().join("of-record/result.json"));
        for key in ["parameters", "turning", "budget", "validity", "between_rests"] {
            assert_eq!(of_record[key], result[key], "{session}: {key}");
        }
    }
    // A centrifuge session that begins from the tumble knows of the arcs too.
    let begun = run(&["init", "made", "--tumble", "tumbled"]);
    let text = String::from_utf8_lossy(&begun.stdout).into_owned();
    let stated = fs::read_to_string(folder.path().join("tumbled/experiment.toml")).unwrap();
    let turning = stated.lines().find(|line| line.starts_with("turning")).unwrap();
    assert!(text.contains(turning), "{text}{}", String::from_utf8_lossy(&begun.stderr));
}

/// An arm with rests after a switch-off: the arm's records are those of the plan without rests, and the calibration knows of the change
/// of the bias that the truth tells.
#[test]
fn an_arm_with_rests_gives_the_truth_back() {
    let folder = TempDir::new().unwrap();
    let plan = fs::read_to_string(example().join("experiment.toml")).unwrap();
    let tumble = "[uncertainty]\nbias_change = \"2 mg\"\n[[tumble]]\nrecord = \"tumble.csv\"\n";
    simulated(&folder, &plan, "9", "arm");
    let report = simulated(&folder, &format!("{plan}\n{tumble}"), "9", "both");
    assert_eq!((&report["rests"], &report["mountings"], &report["plateaus"]), (&24.into(), &12.into(), &108.into()));
    let [arm, both] = ["arm", "both"].map(|out| folder.path().join(out));
    for record in ["records/m03.csv", "telemetry/m12.csv"] {
        assert!(fs::read(arm.join(record)).unwrap() == fs::read(both.join(record)).unwrap(), "{record}");
    }
    let truth = json(&both.join("truth.json"));
    let change = changes(&truth)[0];
    assert!(change.iter().all(|change| *change != 0.0 && change.abs() < 4.0 * 2e-3 * 9.80665), "{change:?}");
    let (squared, count) = squared_error(&both);
    assert_eq!(count, 49);
    // The 99.9 % band of chi^2 with 49 degrees of freedom.
    assert!((20.0..86.0).contains(&squared), "{squared}");
}

/// Changes of the bias of each tumble, as the truth has them [m/s^2].
fn changes(truth: &Value) -> Vec<[f64; 3]> {
    let change = |tumble: &Value| [0, 1, 2].map(|axis| tumble["bias_change"][axis].as_f64().unwrap());
    truth["tumbles"].as_array().unwrap().iter().map(change).collect()
}

/// Two tumbles have changes of bias of their own, unless they name the same switch-on: stated to be of one, what were two is refused.
#[test]
fn each_tumble_has_its_own_change_of_bias() {
    let folder = TempDir::new().unwrap();
    let plan = fs::read_to_string(example().join("experiment.toml")).unwrap();
    let tumble = |more: &str| format!("[[tumble]]\nrecord = \"x.csv\"\n{more}\n");
    let of_their_own = [tumble("bias_change = \"2 mg\""), tumble("bias_change = \"1 mg\"")].concat();
    simulated(&folder, &format!("{plan}\n{of_their_own}"), "11", "own");
    let own = folder.path().join("own");
    let [one, other] = changes(&json(&own.join("truth.json")))[..] else { panic!("two tumbles") };
    assert!((0..3).all(|axis| (one[axis] - other[axis]).abs() > 1e-4), "{one:?} {other:?}");
    let (squared, count) = squared_error(&own);
    // The 99.9 % band of chi^2 with 49 degrees of freedom.
    assert!(count == 49 && (20.0..86.0).contains(&squared), "{squared}");
    let file = own.join("experiment.toml");
    let text = fs::read_to_string(&file).unwrap();
    let refused = |text: &str| {
        fs::write(&file, text).unwrap();
        let run = program::centrical().args(["calibrate", "--json"]).arg(&own).output().unwrap();
        (run.status.code(), String::from_utf8(run.stderr).unwrap())
    };
    let named = text.replace("bias_change", "switch_on = \"monday\"\nbias_change");
    let (code, message) = refused(&named);
    assert!(
        code == Some(2) && message.contains("[[tumble]] 2, bias_change: found \"1 mg\", expected the same"),
        "{message}"
    );
    assert_eq!(refused(&named.replace("\"1 mg\"", "\"2 mg\"")).0, Some(1));
    let together = [tumble("switch_on = \"a\""), tumble("switch_on = \"a\"\nbias_change = \"2 mg\"")].concat();
    simulated(&folder, &format!("{plan}\n{together}"), "11", "together");
    let together = folder.path().join("together");
    let [one, other] = changes(&json(&together.join("truth.json")))[..] else { panic!("two tumbles") };
    assert_eq!(one, other);
    let (squared, _) = squared_error(&together);
    assert!((20.0..86.0).contains(&squared), "{squared}");
}

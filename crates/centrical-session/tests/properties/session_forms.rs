//! Experiment files that say the same in other words are read alike; what they say is what was read.

use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::Path;

use centrical::{ErrorModel, Experiment, Group, Monomial, PairRelation, ReferencePoint};
use centrical_session::{
    Column, ColumnName, Measured, PlateauRow, Scale, Session, SpeedSource, Speeds, write_plateaus,
};
use nalgebra::{Matrix3, Vector3};

const EXPERIMENT: &str = include_str!("../fuzz/seeds/experiment.toml");

fn read(experiment: &str) -> Session {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("experiment.toml"), experiment).unwrap();
    Session::read(folder.path()).unwrap()
}

/// The experiment of the file with `from` replaced by `to`.
fn with(from: &str, to: &str) -> Session {
    assert!(EXPERIMENT.contains(from), "{from}");
    read(&EXPERIMENT.replacen(from, to, 1))
}

fn experiment(from: &str, to: &str) -> Experiment {
    with(from, to).experiment
}

#[test]
fn what_is_written_is_read() {
    let session = read(EXPERIMENT);
    let experiment = &session.experiment;
    assert_eq!((session.title.as_str(), session.date.as_str()), ("Two positions", "2026-10-05"));
    assert_eq!(experiment.site.gravity, 9.81523);
    assert_eq!(experiment.site.latitude, Some(55.7 * (PI / 180.0)));
    assert_eq!(experiment.unit.reference, ReferencePoint::FirstProofMass);
    let rho_z = Matrix3::new(0.0, 0.021, 0.015, 0.0, 0.012, -0.01, 0.0, 10.5 * 1e-3, -0.014);
    assert_eq!(experiment.unit.rho_z, rho_z);
    assert_eq!(experiment.pair_relation, PairRelation::Common);
    assert_eq!(session.error_model, ErrorModel::kozlov_2017());
    assert_eq!(session.experiment.centrifuge.speed_uncertainty, 1e-5);
    assert_eq!(experiment.mountings[1].arm_y, Vector3::new(500.0 * 1e-3, 0.0, 0.0));
    let set: Vec<_> = experiment.set_points.iter().map(|p| (p.mounting, p.omega, p.angle)).collect();
    let spin = 133.8 * (TAU / 60.0);
    assert_eq!(set, [(0, 0.0, 0.0), (0, spin, 0.0), (1, spin, 0.0), (1, 0.0, 180.0 * (PI / 180.0))]);
    assert_eq!(session.columns.speed.scale, Scale::factor(TAU / 60.0));
}

#[test]
fn measured_speeds_are_read() {
    let stated = "rotation = \"+3\"\ntachometer_uncertainty = \"20 ppm\"\n\
         measured = { from = \"pulses\", uncertainty = \"1 ppm\", scale = 2e-6, pulses_per_revolution = 360 }";
    let session = with("rotation = \"+3\"", stated);
    let expected = Speeds {
        set_uncertainty: 1e-5,
        tachometer_uncertainty: Some(20.0 * 1e-6),
        measured: Some(Measured {
            source: SpeedSource::Pulses,
            uncertainty: 1e-6,
            scale: Some(2e-6),
            pulses_per_revolution: 360.0,
        }),
    };
    assert_eq!(session.speeds, expected);
    // What is predicted before any record is read.
    assert_eq!((session.experiment.centrifuge.speed_uncertainty, session.type_b.speed_scale), (1e-6, 2e-6));
    let plateau = "{ speed = \"-133.8 rpm\", speed_uncertainty = \"3 ppm\" }]";
    let experiment = experiment("{ speed = \"133.8 rpm\" }]", plateau);
    let set_point = experiment.set_points[1];
    assert_eq!(set_point.omega, -133.8 * (TAU / 60.0));
    assert_eq!(experiment.speed_uncertainty_of(&set_point), 3.0 * 1e-6);
    assert_eq!(experiment.speed_uncertainty_of(&experiment.set_points[2]), 1e-5);
}

/// The rate of the records is not that of the telemetry, which has a time of its own unless it is given another.
#[test]
fn the_time_of_the_telemetry_is_its_own() {
    let columns = |time: &str| with("speed_unit = \"rpm\"", &format!("speed_unit = \"rpm\"\n{time}")).columns;
    let own = columns("");
    assert_eq!(own.telemetry_time, own.time);
    assert_eq!(columns("time = { column = \"time\", unit = \"ms\" }").telemetry_time.scale, Scale::factor(1e-3));
    let counted = columns("time = { rate = \"1 kHz\" }");
    assert_eq!(counted.telemetry_time, Column::si("t", "s"));
    assert_eq!(counted.time.scale, Scale::factor(1e-3));
    assert_eq!(columns("time = { column = \"n\", rate = \"1 kHz\" }").telemetry_time, Column::si("n", "s"));
    let both = columns("time = { rate = \"1 kHz\" }\ntelemetry_time = { rate = \"20 Hz\" }");
    assert_eq!(both.telemetry_time.scale, Scale::factor(1.0 / 20.0));
}

#[test]
fn the_same_in_other_words() {
    let same = [
        ("\"9.81523 m/s^2\"", "9.81523"),
        ("\"9.81523 m/s^2\"", "\" 9.81523m/s^2 \""),
        ("\"+1 +2 +3\"", "\"1 2 3\""),
        ("axes = \"+1 +2 +3\"", "matrix = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]"),
        ("matrix = [[-1, 0, 0], [0, -1, 0], [0, 0, 1]]", "axes = \"-1 -2 +3\""),
        ("id = \"2\"", "id = 2"),
        ("\"kozlov-2017\"", "[\"kozlov-2017\"]"),
        ("speed = 0, angle = 0", "speed = \"-0 rpm\", angle = \"0 deg\""),
        ("record = \"records/m01.csv\"\n", ""),
        ("date = 2026-10-05", "date = \"autumn\""),
    ];
    for (from, to) in same {
        assert_eq!(experiment(from, to), read(EXPERIMENT).experiment, "{to}");
    }
}

#[test]
fn instrument_axes_are_the_rows() {
    // "+2 -3 -1": axes 1, 2, 3 point along +y2, -y3, -y1; the printed P_6.
    let p_6 = Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, -1.0, -1.0, 0.0, 0.0);
    assert_eq!(experiment("\"+1 +2 +3\"", "\"+2 -3 -1\"").positions[0].p_zy, p_6);
    let presets = centrical::Position::kozlov_2017(centrical::ThirdPosition::AxisOneUp);
    for (preset, axes) in presets.iter().zip(["1 2 3", "-1 -2 3", "3 1 2", "3 -1 -2", "-2 -3 1", "2 -3 -1"]) {
        assert_eq!(experiment("+1 +2 +3", axes).positions[0].p_zy, preset.p_zy, "{axes}");
    }
}

#[test]
fn rotation_is_the_sign_of_every_speed() {
    let forward = read(EXPERIMENT).experiment.set_points;
    let backward = experiment("\"+3\"", "\"-3\"").set_points;
    assert!(forward.iter().zip(&backward).all(|(f, b)| f.omega == -b.omega && f.angle == b.angle));
    assert!(backward.iter().all(|b| b.omega != 0.0 || b.omega.is_sign_positive()), "no -0");
}

#[test]
fn a_position_without_a_pair_is_one() {
    let alone = experiment("pair = \"A\"\n", "");
    assert_eq!((alone.positions[0].pair.as_str(), alone.positions[1].pair.as_str()), ("1", "A"));
}

#[test]
fn terms_beside_the_preset() {
    let list = r#"["kozlov-2017", { axis = 1, term = "f2*f1" }, { axis = 2, term = "f2*|f2|" }]"#;
    let terms = with("\"kozlov-2017\"", list).error_model.terms;
    assert_eq!(terms[..21], ErrorModel::kozlov_2017().terms);
    let own: Vec<_> = terms[21..].iter().map(|t| (t.name.as_str(), t.axis, t.monomial, t.group)).collect();
    let cross = ("K_1[f1*f2]", 0, Monomial::product(&[0, 1]), Group::CrossCoupling);
    assert_eq!(own, [cross, ("K_2[f2*|f2|]", 1, Monomial::odd_square(1), Group::Quadratic)]);
    // What the preset has is named as there.
    let known = with("\"kozlov-2017\"", r#"["G0_11", { axis = 3, term = "f1" }, { axis = 2, term = "1" }]"#);
    let names: Vec<_> = known.error_model.terms.iter().map(|t| t.name.as_str()).collect();
    assert_eq!(names, ["G0_11", "G0_31", "df_2"]);
}

#[test]
fn raw_output_is_taken_to_si() {
    let g = with("output_unit = \"m/s^2\"", "output_unit = \"g\"").columns;
    assert_eq!(g.f.map(|f| f.scale), [Scale::factor(9.80665); 3]);
    let counts = "output_unit = \"counts\"\ncounts = { scale = [415, 413, -415], bias = [33123, 33276, 32360] }";
    let counts = with("output_unit = \"m/s^2\"", counts).columns;
    assert_eq!(counts.f[1].scale, Scale { offset: 33276.0, factor: 1.0 / 413.0 });
    assert_eq!(counts.f[2].unit, "counts");
}

#[test]
fn columns_by_name_number_unit_and_rate() {
    let own = "[columns]\ntime = { column = 1, unit = \"ms\" }\nf = [\"ax\", 3, { column = \"az\", unit = \"mg\" }]\nspeed = 2\n";
    let columns = with("[columns]\n", own).columns;
    let name = |name: &str| ColumnName::Name(name.to_owned());
    assert_eq!(columns.time, Column { name: ColumnName::Number(1), unit: "ms".to_owned(), scale: Scale::factor(1e-3) });
    assert_eq!(columns.f[0], Column::si("ax", "m/s^2"));
    assert_eq!(columns.f[1].name, ColumnName::Number(3));
    assert_eq!((&columns.f[2].name, columns.f[2].scale), (&name("az"), Scale::factor(1e-3 * 9.80665)));
    let counter = with("[columns]\n", "[columns]\ntime = { column = \"n\", rate = \"1 kHz\" }\n").columns.time;
    assert_eq!((counter.name, counter.scale), (name("n"), Scale::factor(1e-3)));
    let rows = with("[columns]\n", "[columns]\ntime = { rate = 250 }\n").columns.time;
    assert_eq!((rows.name, rows.scale), (ColumnName::Row, Scale::factor(1.0 / 250.0)));
}

#[test]
fn plateaus_instead_of_records() {
    let folder = tempfile::tempdir().unwrap();
    let mean = Vector3::new(0.1, -98.0, 9.8);
    let plateau = |mounting, speed, angle| PlateauRow {
        mounting,
        speed,
        speed_uncertainty: None,
        bend_z: None,
        angle,
        mean,
        covariance: Matrix3::identity() * 1e-9,
        samples: 1000,
    };
    write_plateaus(
        &folder.path().join("means.csv"),
        &[plateau(1, 14.0, 0.0), plateau(0, 0.0, PI), plateau(1, 0.0, 0.5)],
    )
    .unwrap();
    let experiment = format!("plateaus = \"means.csv\"\n{EXPERIMENT}").replace("\"+3\"", "\"-3\"");
    fs::write(folder.path().join("experiment.toml"), experiment).unwrap();
    let session = Session::read(folder.path()).unwrap();
    let set: Vec<_> = session.experiment.set_points.iter().map(|p| (p.mounting, p.omega, p.angle)).collect();
    assert_eq!(set, [(0, 0.0, PI), (1, -14.0, 0.0), (1, 0.0, 0.5)]);
    let rows = &session.plateaus.as_ref().unwrap().rows;
    assert_eq!(rows.iter().map(|row| row.mounting).collect::<Vec<_>>(), [0, 1, 1]);
    let names: Vec<_> = session.files().into_iter().filter_map(Path::file_name).collect();
    assert_eq!(names, ["experiment.toml", "means.csv", "m01.csv", "m02.csv"]);
}

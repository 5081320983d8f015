//! Needs the shared data of the project, which is not part of the repository: set `CENTRICAL_SHARED` to its folder
//! and run with `--ignored`.

mod simulate;

use std::path::{Path, PathBuf};

use centrical_session::{
    Column, ColumnName, Columns, Scale, Session, Tumble, TumbleRequest, read_record, tumble, unwatched,
};

fn data(session: &str) -> PathBuf {
    let shared = std::env::var_os("CENTRICAL_SHARED").expect("CENTRICAL_SHARED is not set");
    PathBuf::from(shared).join("data").join(session)
}

#[test]
#[ignore = "needs the shared data: set CENTRICAL_SHARED"]
fn sessions_are_read_whole() {
    for (name, plateaus, rate) in
        [("clean-csv", 108, 100.0), ("rough-parquet", 108, 250.0), ("printed-relation", 72, 100.0)]
    {
        let session = Session::read(&data(name)).unwrap();
        assert_eq!(session.experiment.mountings.len(), 12);
        assert_eq!(session.experiment.set_points.len(), plateaus);
        for mounting in 0..12 {
            let record = session.record(mounting).unwrap();
            let telemetry = session.telemetry(mounting).unwrap().expect("telemetry");
            let (first, last) = (record.t[0], record.t[record.t.len() - 1]);
            let full = (last - first) * rate;
            assert!(record.t.len() as f64 > 0.98 * full, "{name} {mounting}: {} of {full}", record.t.len());
            assert!(record.f_z.iter().all(|f| f.len() == record.t.len()));
            let fastest = telemetry.omega.iter().copied().fold(0.0, f64::max);
            let of_mounting = session.experiment.set_points.iter().filter(|p| p.mounting == mounting);
            let set = of_mounting.map(|p| p.omega).fold(0.0, f64::max);
            assert!((fastest / set - 1.0).abs() < 0.01, "{name} {mounting}: {fastest} rad/s against {set}");
        }
    }
}

#[test]
#[ignore = "needs the shared data: set CENTRICAL_SHARED"]
fn a_real_record_of_counts_without_a_header() {
    let factory = [(415.0, 33123.0), (413.0, 33276.0), (415.0, 32360.0)];
    let column = |number, unit: &str, scale| Column { name: ColumnName::Number(number), unit: unit.to_owned(), scale };
    let f = [0, 1, 2].map(|j| {
        let (counts, bias) = factory[j];
        column(j + 2, "counts", Scale { offset: bias, factor: 1.0 / counts })
    });
    let columns = Columns { time: column(1, "s", Scale::factor(1.0)), f, ..Columns::default() };
    let record = read_record(&data("xsens-tumble").join("xsens_acc.txt"), &columns).unwrap();
    assert_eq!(record.t.len(), 51_175);
    let mut norms: Vec<f64> =
        (0..record.t.len()).map(|i| record.f_z.iter().map(|f| f[i] * f[i]).sum::<f64>().sqrt()).collect();
    norms.sort_by(f64::total_cmp);
    // Mostly at rest under 9.81744 m/s^2; the factory's misalignments of 0.01 change the norm by less than 2 %.
    let median = norms[norms.len() / 2];
    assert!((median / 9.81744 - 1.0).abs() < 0.02, "{median}");
}

/// The owners' numbers of units that were turned by hand: rests, scale [per m/s^2] and bias of each axis [readings].
struct Owned {
    file: &'static str,
    rests: usize,
    readings: [usize; 3],
    unit: &'static str,
    gravity: f64,
    scale: [f64; 3],
    /// Difference that the owners' own fit allows: of scale, relative, and of bias [readings].
    scatter: [f64; 2],
    bias: [f64; 3],
    /// Root mean square of what the size of the compensated force misses of gravity [m/s^2].
    misfit: [f64; 2],
}

const OWNED: [Owned; 3] = [
    Owned {
        file: "xsens-tumble/xsens_acc.txt",
        rests: 38,
        readings: [2, 3, 4],
        unit: "counts",
        gravity: 9.81744,
        scale: [415.0, 413.0, 415.0],
        // The factory's numbers are of another year: whole counts, and a bias that wanders.
        scatter: [3e-3, 8.0],
        bias: [33123.0, 33276.0, 32360.0],
        misfit: [0.5e-3, 1.5e-3],
    },
    Owned {
        file: "mpu9150/imu0.log",
        rests: 22,
        readings: [1, 2, 3],
        unit: "m/s^2",
        gravity: 9.81,
        scale: [1.00363, 1.00315, 1.00647],
        scatter: [2e-4, 1.4e-3],
        bias: [0.103, 0.097, 0.344],
        misfit: [0.98e-3, 2.75e-3],
    },
    Owned {
        file: "mpu9150/imu2.log",
        rests: 22,
        readings: [1, 2, 3],
        unit: "m/s^2",
        gravity: 9.81,
        scale: [1.00382, 1.00355, 1.00780],
        scatter: [2e-4, 1.4e-3],
        bias: [0.096, 0.008, -0.045],
        misfit: [0.98e-3, 2.75e-3],
    },
];

/// All rests are found, and scale and bias are the owners' within the combined uncertainty.
#[test]
#[ignore = "needs the shared data: set CENTRICAL_SHARED"]
fn units_turned_by_hand_are_as_their_owners_say() {
    for owned in OWNED {
        let with_time = owned.readings[0] == 2;
        let request = TumbleRequest {
            files: vec![data(owned.file)],
            time: ColumnName::Number(1),
            rate: (!with_time).then_some(100.0),
            readings: owned.readings.map(ColumnName::Number),
            unit: owned.unit.to_owned(),
            gravity: owned.gravity,
            gravity_uncertainty: 0.0,
            attitudes: None,
            terms: TumbleRequest::USUAL_TERMS.map(str::to_owned).to_vec(),
            serial: String::new(),
            date: String::new(),
        };
        let Tumble { session, result, .. } = tumble(&request, Path::new(""), &unwatched).unwrap();
        assert_eq!(session.rests().count(), owned.rests, "{}", owned.file);
        for axis in 0..3 {
            let Scale { offset, factor } = session.columns.f[axis].scale;
            let estimate = |name: String| {
                let found = result.parameter(&name).unwrap();
                (found.value.unwrap(), found.standard_uncertainty.unwrap())
            };
            let (gain, u_gain) = estimate(format!("G0_{0}{0}", axis + 1));
            let (bias, u_bias) = estimate(format!("df_{}", axis + 1));
            let off = |value: f64, own: f64, u: f64, of_owner: f64| (value - own).abs() / u.hypot(of_owner);
            let scale = off((1.0 + gain) / factor / owned.scale[axis], 1.0, u_gain, owned.scatter[0]);
            let bias = off(offset + bias / factor, owned.bias[axis], u_bias / factor, owned.scatter[1]);
            assert!(scale < 2.0 && bias < 2.0, "{} axis {}: {scale} {bias}", owned.file, axis + 1);
        }
        let misfits: Vec<f64> = result
            .rests()
            .map(|rest| {
                let f = rest.specific_force.unwrap();
                let size = f.iter().map(|f| f * f).sum::<f64>().sqrt();
                f.iter().zip(rest.residual).map(|(f, residual)| f / size * residual).sum()
            })
            .collect();
        let rms = (misfits.iter().map(|misfit| misfit * misfit).sum::<f64>() / misfits.len() as f64).sqrt();
        assert!((owned.misfit[0]..owned.misfit[1]).contains(&rms), "{}: {rms}", owned.file);
        assert!(result.objections().is_empty(), "{}: {:?}", owned.file, result.objections());
        // Squares of the reading do not show in these units.
        let suspects = result.validity.as_ref().unwrap();
        assert!(suspects.rivals.iter().all(|rival| rival.probability > 0.05), "{}", owned.file);
    }
}

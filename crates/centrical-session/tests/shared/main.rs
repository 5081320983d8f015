//! Needs the shared data of the project, which is not part of the repository: set `CENTRICAL_SHARED` to its folder
//! and run with `--ignored`.

mod simulate;

use std::path::PathBuf;

use centrical_session::{Column, ColumnName, Columns, Scale, Session, read_record};

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

//! Tables of plateaus already averaged, as they are written.

use std::fmt::Write as _;
use std::path::Path;

use centrical_table::{parquet_bytes, write_whole};

use super::plateaus::{BEND, COLUMNS, PlateauMean, SPEED_UNCERTAINTY};
use crate::error::Error;

/// Writes a table of plateaus, every number to its last digit; the file appears whole or not at all.
///
/// # Errors
/// If the file can not be written.
pub fn write_plateaus(file: &Path, plateaus: &[PlateauMean]) -> Result<(), Error> {
    let (is_measured, turns) = (is_measured(plateaus), turns(plateaus));
    let mut text = COLUMNS.map(|(name, _)| name).join(",");
    if is_measured {
        let _ = write!(text, ",{}", SPEED_UNCERTAINTY.0);
    }
    if turns {
        let _ = write!(text, ",{}", BEND.map(|(name, _)| name).join(","));
    }
    text.push('\n');
    for p in plateaus {
        let angle = if p.speed == 0.0 { p.angle.to_string() } else { String::new() };
        let c = &p.covariance;
        let [m1, m2, m3] = p.mean.into();
        let upper = [c.m11, c.m12, c.m13, c.m22, c.m23, c.m33].map(|v| format!("{v:e}")).join(",");
        // Writing to a String does not fail.
        let _ = write!(text, "{},{},{angle},{m1},{m2},{m3},{upper},{}", p.mounting + 1, p.speed, p.samples);
        if is_measured {
            let _ = write!(text, ",{}", p.speed_uncertainty.map_or_else(String::new, |u| format!("{u:e}")));
        }
        if turns {
            let [b1, b2, b3] = p.bend_z.unwrap_or_default().into();
            let _ = write!(text, ",{b1:e},{b2:e},{b3:e}");
        }
        text.push('\n');
    }
    Ok(write_whole(file, text.as_bytes())?)
}

/// Whether a speed was measured, so that the table has a column for its uncertainty.
fn is_measured(plateaus: &[PlateauMean]) -> bool {
    plateaus.iter().any(|p| p.speed_uncertainty.is_some())
}

/// Whether there are arcs of slow rotation, so that the table has columns for their bend.
fn turns(plateaus: &[PlateauMean]) -> bool {
    plateaus.iter().any(|p| p.bend_z.is_some())
}

/// As [`write_plateaus`], of plateaus on an arm in Parquet.
pub(crate) fn write_plateaus_parquet(file: &Path, plateaus: &[PlateauMean]) -> Result<(), Error> {
    let row = |p: &PlateauMean| {
        let angle = if p.speed == 0.0 { p.angle } else { f64::NAN };
        let (c, [m1, m2, m3]) = (&p.covariance, p.mean.into());
        let number = (p.mounting + 1) as f64;
        [number, p.speed, angle, m1, m2, m3, c.m11, c.m12, c.m13, c.m22, c.m23, c.m33, p.samples as f64]
    };
    let rows: Vec<[f64; COLUMNS.len()]> = plateaus.iter().map(row).collect();
    let mut columns: Vec<Vec<f64>> = (0..COLUMNS.len()).map(|k| rows.iter().map(|row| row[k]).collect()).collect();
    let mut names = COLUMNS.map(|(name, _)| name).to_vec();
    if is_measured(plateaus) {
        names.push(SPEED_UNCERTAINTY.0);
        columns.push(plateaus.iter().map(|p| p.speed_uncertainty.unwrap_or(f64::NAN)).collect());
    }
    let bytes = parquet_bytes(&names, &columns).map_err(|error| Error::writing(file, error))?;
    Ok(write_whole(file, &bytes)?)
}

#[cfg(test)]
mod tests {
    use centrical_table::Source;
    use nalgebra::{Matrix3, Vector3};

    use super::super::plateaus::{Further, PLATEAUS, plateaus_of, read_plateaus};
    use super::*;

    #[test]
    fn written_and_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("plateaus.csv");
        let covariance = Matrix3::new(2e-9, 1e-10, -3e-10, 1e-10, 3e-9, 0.1e-10, -3e-10, 0.1e-10, 1.0 / 3.0 * 1e-8);
        let mean = Vector3::new(0.1 + 0.2, -1.0 / 3.0, 9.806_65);
        let rest = PlateauMean {
            mounting: 1,
            speed: 0.0,
            speed_uncertainty: None,
            angle: std::f64::consts::PI,
            mean,
            covariance,
            samples: 1020,
            bend_z: None,
        };
        let spin = PlateauMean { mounting: 0, speed: 14.0 / 3.0, angle: 0.0, ..rest };
        write_plateaus(&file, &[rest, spin]).unwrap();
        assert_eq!(read_plateaus(&file, 2).unwrap(), [rest, spin]);
        let measured = PlateauMean { speed: -14.0 / 3.0, speed_uncertainty: Some(1e-6 / 3.0), ..spin };
        write_plateaus(&file, &[rest, measured]).unwrap();
        let table = Source::open(&file, PLATEAUS).unwrap();
        assert_eq!(plateaus_of(&table, 2, Further::Speeds).unwrap(), [rest, measured]);
        let arc = PlateauMean { bend_z: Some(Vector3::new(-1.0 / 3.0, 2e-3, 0.0)), ..rest };
        write_plateaus(&file, &[arc]).unwrap();
        let table = Source::open(&file, PLATEAUS).unwrap();
        assert_eq!(plateaus_of(&table, 2, Further::Bends).unwrap(), [arc]);
        let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
        assert_eq!(left.len(), 1, "nothing is left beside the table");
    }
}

//! Tables of plateaus already averaged, as they are written.

use std::path::Path;

use centrical_table::{parquet_bytes, write_whole};

use super::plateaus::{Further, PlateauRow, is_small};
use crate::error::Error;

/// Writes a table of plateaus, every number to its last digit; the file appears whole or not at all. Rows have uncertainties of speeds, on an arm,
/// or bends, at rest; where some have the first, no bend is written.
///
/// # Errors
/// If the file can not be written.
pub fn write_plateaus(file: &Path, plateaus: &[PlateauRow]) -> Result<(), Error> {
    let further = Further::of(plateaus);
    let mut text = further.names().join(",") + "\n";
    for plateau in plateaus {
        let cells = plateau.numbers(further).into_iter().enumerate().map(|(k, number)| match k {
            _ if number.is_nan() => String::new(),
            k if is_small(k) => format!("{number:e}"),
            _ => number.to_string(),
        });
        text += &cells.collect::<Vec<_>>().join(",");
        text.push('\n');
    }
    Ok(write_whole(file, text.as_bytes())?)
}

/// As [`write_plateaus`], in Parquet.
pub(crate) fn write_plateaus_parquet(file: &Path, plateaus: &[PlateauRow]) -> Result<(), Error> {
    let further = Further::of(plateaus);
    let (names, rows) = (further.names(), plateaus.iter().map(|plateau| plateau.numbers(further)).collect::<Vec<_>>());
    let columns: Vec<Vec<f64>> = (0..names.len()).map(|k| rows.iter().map(|row| row[k]).collect()).collect();
    let bytes = parquet_bytes(&names, &columns).map_err(|error| Error::writing(file, error))?;
    Ok(write_whole(file, &bytes)?)
}

#[cfg(test)]
mod tests {
    use centrical_table::Source;
    use nalgebra::{Matrix3, Vector3};

    use super::super::plateaus::{PLATEAUS, plateaus_of};
    use super::*;

    #[test]
    fn written_and_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("plateaus.csv");
        let covariance = Matrix3::new(2e-9, 1e-10, -3e-10, 1e-10, 3e-9, 0.1e-10, -3e-10, 0.1e-10, 1.0 / 3.0 * 1e-8);
        let mean = Vector3::new(0.1 + 0.2, -1.0 / 3.0, 9.806_65);
        let rest = PlateauRow {
            mounting: 1,
            speed: 0.0,
            speed_uncertainty: None,
            angle: std::f64::consts::PI,
            mean,
            covariance,
            samples: 1020,
            bend_z: None,
        };
        let spin = PlateauRow { mounting: 0, speed: 14.0 / 3.0, angle: 0.0, ..rest };
        write_plateaus(&file, &[rest, spin]).unwrap();
        let table = Source::open(&file, PLATEAUS).unwrap();
        assert_eq!(plateaus_of(&table, 2, Further::Nothing).unwrap(), [rest, spin]);
        let measured = PlateauRow { speed: -14.0 / 3.0, speed_uncertainty: Some(1e-6 / 3.0), ..spin };
        write_plateaus(&file, &[rest, measured]).unwrap();
        let table = Source::open(&file, PLATEAUS).unwrap();
        assert_eq!(plateaus_of(&table, 2, Further::Speeds).unwrap(), [rest, measured]);
        let arc = PlateauRow { bend_z: Some(Vector3::new(-1.0 / 3.0, 2e-3, 0.0)), ..rest };
        write_plateaus(&file, &[arc]).unwrap();
        let table = Source::open(&file, PLATEAUS).unwrap();
        assert_eq!(plateaus_of(&table, 2, Further::Bends).unwrap(), [arc]);
        let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
        assert_eq!(left.len(), 1, "nothing is left beside the table");
    }
}

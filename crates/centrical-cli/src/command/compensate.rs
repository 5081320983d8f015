//! `centrical compensate RESULT RECORD --out FILE`: from readings to specific force.

use std::path::{Path, PathBuf};

use centrical::STANDARD_GRAVITY;
use centrical_compensate::{Certificate, Compensation};
use centrical_session::{
    CalibrationResult, Columns, Compensated, Dimension, Error, NotThatQuantity, Quantity, Session, compensate_record,
};

use crate::Outcome;

/// Convert a record of readings to specific force with a calibration result.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The result of a calibration: result.json
    result: PathBuf,
    /// The record: CSV or Parquet with t, f1, f2, f3 in s and m/s^2, unless --session says otherwise
    record: PathBuf,
    /// Output file: Parquet if its name ends in .parquet, CSV otherwise
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// The session whose experiment.toml names the record's columns and units
    #[arg(long, value_name = "SESSION")]
    session: Option<PathBuf>,
    /// Largest specific force on each axis, such as "200 g"; readings beyond it become nan
    /// [default: twice the largest plateau reading of the calibration, within the range of the certified inverse]
    #[arg(long, value_name = "QUANTITY", value_parser = acceleration)]
    range: Option<f64>,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let result = CalibrationResult::read(&arguments.result)?;
    let file = || arguments.result.clone();
    let terms = result.error_terms().map_err(|source| Error::ErrorModel { file: file(), source })?;
    let compensation = (arguments.range.map_or_else(|| result.compensation_range(&terms), Ok))
        .and_then(|range| Compensation::new(&terms, range))
        .map_err(|source| Error::NotInvertible { file: file(), source })?;
    let columns = match &arguments.session {
        Some(session) => Session::read(session)?.columns,
        None => Columns::default(),
    };
    let compensated = compensate_record(&compensation, &arguments.record, &columns, &arguments.out)?;
    tell(&compensated, compensation.certificate(), &arguments.out);
    Ok(if compensated.outside == 0 { Outcome::Done } else { Outcome::NotAcceptable })
}

fn tell(compensated: &Compensated, certificate: &Certificate, out: &Path) {
    let g = |f: f64| format!("{:.6} g", f / STANDARD_GRAVITY);
    let Certificate { range, margin, .. } = *certificate;
    let farthest = if margin.is_finite() {
        format!("up to {:.0} g", margin * range / STANDARD_GRAVITY)
    } else {
        "anywhere".to_owned()
    };
    println!(
        "{} readings compensated, range {} on each axis; the inverse is unique there, and could be asked for {farthest}",
        compensated.readings,
        g(range)
    );
    if let Some(first) = &compensated.first_outside {
        let reading = first.reading.map(g).join(", ");
        println!(
            "NOT ACCEPTABLE  {} readings come from beyond the range and are nan, the first at t = {} s: {reading}",
            compensated.outside, first.t
        );
    }
    let out = out.display();
    match compensated.decimals {
        Some(count) => println!("Written to {out}, specific forces to {count} decimals of a m/s^2"),
        None => println!("Written to {out}"),
    }
}

/// "200 g", or a plain number in m/s^2.
fn acceleration(text: &str) -> Result<f64, NotThatQuantity> {
    Quantity::Text(text.to_owned()).si(Dimension::Acceleration)
}

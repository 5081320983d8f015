//! `centrical tumble RECORD...`: a unit that was turned by hand or on a table, calibrated by gravity alone.

use std::path::{Path, PathBuf};

use centrical_report::{read_issuer, terminal_table, unit_text, verdict_text, write_all_documents};
use centrical_session::{
    ColumnName, Dimension, Error, Folder, MOST_DISTANT, NotThatQuantity, STANDARD_GRAVITY, StatedAttitudes,
    TumbleRequest, claim_folder, refuse_inputs, tumble, unwatched,
};

use crate::command::calibrate::outputs;
use crate::command::report::{Documents, is_within_limits};
use crate::given::{column_name, frequency, quantity};
use crate::outcome::Outcome;
use crate::printing::Printing;

/// Calibrate a unit by gravity alone, from records in which it is turned and rests again and again.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical tumble examples/tumble/record.csv --gravity 9.81523 --out tumbled")]
pub struct Arguments {
    /// Records in any supported format, of one unit
    #[arg(required = true)]
    records: Vec<PathBuf>,
    /// Time column, in s: its name, or its number from 1
    #[arg(long, value_name = "COLUMN", default_value = "t", value_parser = column_name)]
    time: ColumnName,
    /// Sampling rate of records without a time column, such as "250 Hz"
    #[arg(long, value_name = "QUANTITY", value_parser = frequency, conflicts_with = "time")]
    rate: Option<f64>,
    /// Columns of newtonometers 1, 2, 3: names, or numbers from 1
    #[arg(long, value_name = "COLUMNS", default_value = "f1,f2,f3", value_parser = three_columns)]
    readings: Columns,
    /// Unit of the readings: of acceleration, or "counts" or "V", whose scale and bias are found
    #[arg(long, default_value = "m/s^2")]
    unit: String,
    /// Gravity at the place, such as "9.81523 m/s^2" [default: 9.80665 m/s^2, uncertain by 0.02 m/s^2]
    #[arg(long, value_name = "QUANTITY", value_parser = acceleration)]
    gravity: Option<f64>,
    /// Standard uncertainty of gravity [default: 0.02 m/s^2, or 0 for a gravity that is given]
    #[arg(long, value_name = "QUANTITY", value_parser = acceleration)]
    gravity_uncertainty: Option<f64>,
    /// Attitudes in which the unit was laid down: a table of up_1, up_2, up_3 in axes of the case, or "cube" for its faces,
    /// edges and corners
    #[arg(long, value_name = "FILE|cube", requires = "attitude_uncertainty")]
    attitudes: Option<PathBuf>,
    /// Standard uncertainty of these attitudes, such as "0.1 deg"
    #[arg(long, value_name = "QUANTITY", value_parser = angle, requires = "attitudes")]
    attitude_uncertainty: Option<f64>,
    /// Take slow rotation too, up to 3 deg/s: largest distance of the proof masses from its axis, such as "50 mm"
    #[arg(long, value_name = "QUANTITY", value_parser = distance)]
    turning_radius: Option<f64>,
    /// Terms of the error model, as in experiment.toml
    #[arg(long, value_name = "TERMS", value_delimiter = ',', default_values_t = TumbleRequest::USUAL_TERMS.map(str::to_owned))]
    terms: Vec<String>,
    /// Serial number of the unit
    #[arg(long, default_value = "")]
    serial: String,
    /// Date of the records, such as 2026-11-23
    #[arg(long, default_value = "")]
    date: String,
    /// Folder for result.json, the rests as a session, the report and its plots, created if absent
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    printing: Printing,
    #[command(flatten)]
    documents: Documents,
}

/// Three columns.
#[derive(Debug, Clone)]
struct Columns([ColumnName; 3]);

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let uncertain = if arguments.gravity.is_some() { 0.0 } else { TumbleRequest::GRAVITY_ANYWHERE };
    let request = TumbleRequest {
        files: arguments.records.clone(),
        folder: Folder::default(),
        time: arguments.time.clone(),
        rate: arguments.rate,
        readings: arguments.readings.0.clone(),
        unit: arguments.unit.clone(),
        gravity: arguments.gravity.unwrap_or(STANDARD_GRAVITY),
        gravity_uncertainty: arguments.gravity_uncertainty.unwrap_or(uncertain),
        attitudes: (arguments.attitudes.iter().zip(arguments.attitude_uncertainty))
            .map(|(name, uncertainty)| StatedAttitudes::named(name, uncertainty))
            .next()
            .transpose()?,
        turning_radius: arguments.turning_radius,
        terms: arguments.terms.clone(),
        serial: arguments.serial.clone(),
        date: arguments.date.clone(),
    };
    let out = arguments.out.as_deref();
    let claim = out.map(claim_folder).transpose()?;
    let laboratory = arguments.documents.laboratory.as_deref();
    let read: Vec<&Path> = request.inputs().chain(laboratory).collect();
    refuse_inputs(&outputs(out, None), &read)?;
    let mut tumble = tumble(&request, out.unwrap_or(Path::new("")), &unwatched)?;
    tumble.result = arguments.documents.in_axes(tumble.result, &request.files[0])?;
    let issuer = laboratory.map(|file| read_issuer(file, &tumble.result)).transpose()?;
    if let Some(folder) = out {
        tumble.write(&request, folder)?;
        write_all_documents(&tumble.result, issuer.as_ref(), arguments.documents.language.into(), folder)?;
    }
    drop(claim);
    let objections = tumble.result.objections();
    let unit = issuer.and_then(|issuer| issuer.unit);
    let text = || {
        let mut screen = verdict_text(&objections);
        if let Some(unit) = &unit {
            screen.add(unit_text(unit));
        }
        screen.gap();
        screen.add(terminal_table(&tumble.result));
        if let Some(folder) = out {
            screen.gap();
            screen.say(0, &format!("Written to {}", folder.display()));
        }
        screen
    };
    arguments.printing.show(text, || tumble.result.to_json())?;
    Ok(Outcome::acceptable(objections.is_empty() && is_within_limits(unit.as_ref())))
}

fn three_columns(text: &str) -> Result<Columns, String> {
    let columns = text.split(',').map(column_name).collect::<Result<Vec<_>, _>>()?;
    let columns = <[ColumnName; 3]>::try_from(columns);
    columns.map(Columns).map_err(|found| format!("found {} columns, expected three", found.len()))
}

fn angle(text: &str) -> Result<f64, NotThatQuantity> {
    quantity(text, Dimension::Angle)
}

fn distance(text: &str) -> Result<f64, String> {
    let distance = quantity(text, Dimension::Length).map_err(|not| not.to_string())?;
    let is_distance = (0.0..=MOST_DISTANT).contains(&distance);
    if is_distance { Ok(distance) } else { Err(format!("found {text}, expected a distance of 0 to {MOST_DISTANT} m")) }
}

fn acceleration(text: &str) -> Result<f64, NotThatQuantity> {
    quantity(text, Dimension::Acceleration)
}

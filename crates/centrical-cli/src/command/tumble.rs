//! `centrical tumble RECORD...|SESSION`: a unit that was turned by hand or on a table, calibrated by gravity alone.

use std::path::{Path, PathBuf};

use centrical_report::{read_issuer, terminal_table, unit_text, verdict_text, write_all_documents};
use centrical_session::{
    CalibrationResult, ColumnName, Dimension, Error, Folder, MOST_DISTANT, Method, NotThatQuantity, Place,
    STANDARD_GRAVITY, Session, StatedAttitudes, TumbleRequest, calibrate, claim_folder, refuse_inputs, tumble,
    unwatched,
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
    /// Records in any supported format, of one unit; or a session with [[tumble]], a folder or its experiment.toml, whose rests alone are taken
    #[arg(required = true, value_name = "RECORDS|SESSION")]
    records: Vec<PathBuf>,
    /// Time column, in s: its name, or its number from 1 [default: t]
    #[arg(long, value_name = "COLUMN", value_parser = column_name)]
    time: Option<ColumnName>,
    /// Sampling rate of records without a time column, such as "250 Hz"
    #[arg(long, value_name = "QUANTITY", value_parser = frequency, conflicts_with = "time")]
    rate: Option<f64>,
    /// Columns of newtonometers 1, 2, 3: names, or numbers from 1 [default: f1,f2,f3]
    #[arg(long, value_name = "COLUMNS", value_parser = three_columns)]
    readings: Option<Columns>,
    /// Unit of the readings: of acceleration, or "counts" or "V", whose scale and bias are found [default: m/s^2]
    #[arg(long)]
    unit: Option<String>,
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
    #[arg(long)]
    serial: Option<String>,
    /// Date of the records, such as 2026-11-23
    #[arg(long)]
    date: Option<String>,
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
    match &arguments.records[..] {
        [session] if is_session(session) => of_session(arguments, session),
        _ => of_records(arguments),
    }
}

/// Whether the path is that of a session: no record is a folder, or a text in TOML.
fn is_session(path: &Path) -> bool {
    path.is_dir() || path.extension().is_some_and(|extension| extension == "toml")
}

/// By records whose rests are still to be found.
fn of_records(arguments: &Arguments) -> Result<Outcome, Error> {
    let uncertain = if arguments.gravity.is_some() { 0.0 } else { TumbleRequest::GRAVITY_ANYWHERE };
    let Columns(readings) = arguments.readings.clone().unwrap_or_else(|| Columns(["f1", "f2", "f3"].map(named)));
    let request = TumbleRequest {
        files: arguments.records.clone(),
        folder: Folder::default(),
        time: arguments.time.clone().unwrap_or_else(|| named("t")),
        rate: arguments.rate,
        readings,
        unit: arguments.unit.clone().unwrap_or_else(|| "m/s^2".to_owned()),
        gravity: arguments.gravity.unwrap_or(STANDARD_GRAVITY),
        gravity_uncertainty: arguments.gravity_uncertainty.unwrap_or(uncertain),
        attitudes: (arguments.attitudes.iter().zip(arguments.attitude_uncertainty))
            .map(|(name, uncertainty)| StatedAttitudes::named(name, uncertainty))
            .next()
            .transpose()?,
        turning_radius: arguments.turning_radius,
        terms: arguments.terms.clone(),
        serial: arguments.serial.clone().unwrap_or_default(),
        date: arguments.date.clone().unwrap_or_default(),
    };
    let out = arguments.out.as_deref();
    let claim = out.map(claim_folder).transpose()?;
    arguments.refuse_inputs(request.inputs())?;
    let mut tumble = tumble(&request, out.unwrap_or(Path::new("")), &unwatched)?;
    tumble.result = arguments.documents.in_axes(tumble.result, &request.files[0])?;
    let outcome = arguments.hand_over(&tumble.result, |folder| tumble.write(&request, folder));
    drop(claim);
    outcome
}

/// By the rests of a session alone.
fn of_session(arguments: &Arguments, path: &Path) -> Result<Outcome, Error> {
    arguments.refuse_what_a_session_states(path)?;
    let session = Session::read(path)?.off_arm(&arguments.terms)?;
    let out = arguments.out.as_deref();
    let claim = out.map(claim_folder).transpose()?;
    arguments.refuse_inputs(session.files().into_iter())?;
    let result = calibrate(&session, Method::Exact, &unwatched)?;
    let result = arguments.documents.in_axes(result, path)?;
    let outcome = arguments.hand_over(&result, |folder| result.write(&folder.join(RESULT)));
    drop(claim);
    outcome
}

impl Arguments {
    /// Columns, unit, place and attitudes of a session stand in its experiment file.
    fn refuse_what_a_session_states(&self, session: &Path) -> Result<(), Error> {
        let given = [
            ("--time", self.time.is_some()),
            ("--rate", self.rate.is_some()),
            ("--readings", self.readings.is_some()),
            ("--unit", self.unit.is_some()),
            ("--gravity", self.gravity.is_some()),
            ("--gravity-uncertainty", self.gravity_uncertainty.is_some()),
            ("--attitudes", self.attitudes.is_some()),
            ("--turning-radius", self.turning_radius.is_some()),
            ("--serial", self.serial.is_some()),
            ("--date", self.date.is_some()),
        ];
        match given.into_iter().find(|(_, is_given)| *is_given) {
            Some((option, _)) => Err(Error::content(
                session,
                Place::Whole,
                format!("{option} beside a session"),
                "the same in its experiment file",
            )),
            None => Ok(()),
        }
    }

    /// Refuses outputs over what is read.
    fn refuse_inputs<'a>(&'a self, inputs: impl Iterator<Item = &'a Path>) -> Result<(), Error> {
        let read: Vec<&Path> = inputs.chain(self.documents.laboratory.as_deref()).collect();
        let result = self.out.as_ref().map(|folder| folder.join(RESULT));
        Ok(refuse_inputs(&outputs(self.out.as_deref(), result.as_deref()), &read)?)
    }

    /// Writes the result by `write` and the documents, shows the result and says whether it is acceptable.
    fn hand_over(
        &self,
        result: &CalibrationResult,
        write: impl FnOnce(&Path) -> Result<(), Error>,
    ) -> Result<Outcome, Error> {
        let out = self.out.as_deref();
        let laboratory = self.documents.laboratory.as_deref();
        let issuer = laboratory.map(|file| read_issuer(file, result)).transpose()?;
        if let Some(folder) = out {
            write(folder)?;
            write_all_documents(result, issuer.as_ref(), self.documents.language.into(), folder)?;
        }
        let objections = result.objections();
        let unit = issuer.and_then(|issuer| issuer.unit);
        let text = || {
            let mut screen = verdict_text(&objections);
            if let Some(unit) = &unit {
                screen.add(unit_text(unit));
            }
            screen.gap();
            screen.add(terminal_table(result));
            if let Some(folder) = out {
                screen.gap();
                screen.say(0, &format!("Written to {}", folder.display()));
            }
            screen
        };
        self.printing.show(text, || result.to_json())?;
        Ok(Outcome::acceptable(objections.is_empty() && is_within_limits(unit.as_ref())))
    }
}

/// The result in the folder.
const RESULT: &str = "result.json";

fn named(name: &str) -> ColumnName {
    ColumnName::Name(name.to_owned())
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

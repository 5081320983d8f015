//! `centrical tumble RECORD...|SESSION`: a unit that was turned by hand or on a table, calibrated by gravity alone.

use std::path::{Path, PathBuf};

use centrical_report::refuse_outputs;
use centrical_session::{
    ColumnName, Error, Folder, Method, Place, Session, StatedAttitudes, TumbleRequest, calibrate, claim_folder, tumble,
    unwatched,
};

use crate::documents::Documents;
use crate::given::{ThreeColumns, acceleration, angle, column_name, gravity, sampling_rate, turning_radius};
use crate::output::{Outcome, Printing, remark_unused_time};

/// Calibrate a unit by gravity alone, from records in which it is turned and rests again and again.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical tumble examples/tumble/record.csv --gravity 9.81523 --out tumbled")]
pub struct Arguments {
    /// Records of one unit in any supported format; or a session with [[tumble]], a folder or its experiment.toml, whose rests alone are calibrated
    #[arg(required = true, value_name = "RECORDS|SESSION")]
    records: Vec<PathBuf>,
    /// Time column, in s: its name, or its number from 1 [default: t]
    #[arg(long, value_name = "COLUMN", value_parser = column_name)]
    time: Option<ColumnName>,
    /// Sampling rate of records without a time column, such as "250 Hz"
    #[arg(long, value_name = "QUANTITY", value_parser = sampling_rate, conflicts_with = "time")]
    rate: Option<f64>,
    /// Columns of newtonometers 1, 2, 3: names, or numbers from 1 [default: f1,f2,f3]
    #[arg(long, value_name = "COLUMNS", value_parser = ThreeColumns::parse)]
    readings: Option<ThreeColumns>,
    /// Unit of the readings: of acceleration, or "counts" or "V", whose scale and bias are found [default: m/s^2]
    #[arg(long, value_parser = TumbleRequest::unit)]
    unit: Option<String>,
    /// Gravity at the place, such as "9.81523 m/s^2" [default: 9.80665 m/s^2, uncertain by 0.02 m/s^2]
    #[arg(long, value_name = "QUANTITY", value_parser = gravity)]
    gravity: Option<f64>,
    /// Standard uncertainty of gravity [default: 0.02 m/s^2, or 0 for a gravity that is given]
    #[arg(long, value_name = "QUANTITY", value_parser = acceleration, requires = "gravity")]
    gravity_uncertainty: Option<f64>,
    /// Attitudes in which the unit was laid down: a table of up_1, up_2, up_3 in axes of the case, or "cube" for its faces,
    /// edges and corners
    #[arg(long, value_name = "FILE|cube", requires = "attitude_uncertainty")]
    attitudes: Option<PathBuf>,
    /// Standard uncertainty of these attitudes, such as "0.1 deg"
    #[arg(long, value_name = "QUANTITY", value_parser = angle, requires = "attitudes")]
    attitude_uncertainty: Option<f64>,
    /// Largest distance of the proof masses from the axis of slow rotation, such as "50 mm": rotation up to 3 deg/s then counts as rests
    #[arg(long, value_name = "QUANTITY", value_parser = turning_radius)]
    turning_radius: Option<f64>,
    /// Terms of the error model, as in experiment.toml
    #[arg(long, value_name = "TERMS", value_delimiter = ',', default_values_t = TumbleRequest::USUAL_TERMS.map(str::to_owned))]
    terms: Vec<String>,
    /// Model of the unit
    #[arg(long)]
    model: Option<String>,
    /// Serial number of the unit
    #[arg(long)]
    serial: Option<String>,
    /// Date of the records, such as 2026-11-23
    #[arg(long, value_parser = TumbleRequest::date)]
    date: Option<String>,
    /// Folder for result.json, the rests as a session, the report and its plots, created if absent
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    printing: Printing,
    #[command(flatten)]
    documents: Documents,
}

/// The result in the folder.
const RESULT: &str = "result.json";

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    match &arguments.records[..] {
        [session] if Session::is_named_by(session) => of_session(arguments, session),
        _ => of_records(arguments),
    }
}

/// By records whose rests are still to be found.
fn of_records(arguments: &Arguments) -> Result<Outcome, Error> {
    let request = arguments.request()?;
    if request.rate.is_some() && !arguments.printing.quiet {
        remark_unused_time(request.files.iter().map(PathBuf::as_path));
    }
    let out = arguments.out.as_deref();
    let _claim = out.map(claim_folder).transpose()?;
    arguments.refuse_outputs(request.inputs(), [&request.model, &request.serial])?;
    let mut tumble = tumble(&request, out.unwrap_or(Path::new("")), &unwatched)?;
    tumble.result = arguments.documents.in_axes(tumble.result, &request.files[0])?;
    out.map_or(Ok(()), |folder| tumble.write(&request, folder))?;
    arguments.documents.hand_over(&tumble.result, arguments.printing, out, out)
}

/// By the rests of a session alone.
fn of_session(arguments: &Arguments, path: &Path) -> Result<Outcome, Error> {
    arguments.refuse_what_a_session_states(path)?;
    let session = Session::read(path)?.off_arm(&arguments.terms)?;
    let out = arguments.out.as_deref();
    let _claim = out.map(claim_folder).transpose()?;
    arguments.refuse_outputs(session.files().into_iter(), [&session.unit_model, &session.unit_serial])?;
    let result = calibrate(&session, &[], Method::Exact, &unwatched)?;
    let result = arguments.documents.in_axes(result, path)?;
    arguments.documents.hand_over(&result, arguments.printing, out, out)
}

impl Arguments {
    /// What is to be made of records.
    fn request(&self) -> Result<TumbleRequest, Error> {
        let [gravity, gravity_uncertainty] = TumbleRequest::gravity(self.gravity, self.gravity_uncertainty);
        let readings =
            self.readings.clone().map_or_else(|| ["f1", "f2", "f3"].map(named), |ThreeColumns(columns)| columns);
        Ok(TumbleRequest {
            files: self.records.clone(),
            folder: Folder::default(),
            time: self.time.clone().unwrap_or_else(|| named("t")),
            rate: self.rate,
            readings,
            unit: self.unit.clone().unwrap_or_else(|| "m/s^2".to_owned()),
            gravity,
            gravity_uncertainty,
            attitudes: (self.attitudes.iter().zip(self.attitude_uncertainty))
                .map(|(name, uncertainty)| StatedAttitudes::named(name, uncertainty))
                .next()
                .transpose()?,
            turning_radius: self.turning_radius,
            terms: self.terms.clone(),
            model: self.model.clone().unwrap_or_default(),
            serial: self.serial.clone().unwrap_or_default(),
            date: self.date.clone().unwrap_or_default(),
        })
    }

    /// Refuses outputs over what is read, and over the result of another unit.
    fn refuse_outputs<'a>(&'a self, inputs: impl Iterator<Item = &'a Path>, unit: [&str; 2]) -> Result<(), Error> {
        let inputs: Vec<&Path> = inputs.chain(self.documents.laboratory.as_deref()).collect();
        let result = self.out.as_ref().map(|folder| folder.join(RESULT));
        refuse_outputs(result.as_deref(), self.out.as_deref(), &inputs, unit)
    }

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
            ("--model", self.model.is_some()),
            ("--serial", self.serial.is_some()),
            ("--date", self.date.is_some()),
        ];
        let Some((option, _)) = given.into_iter().find(|(_, is_given)| *is_given) else { return Ok(()) };
        let found = format!("{option} beside a session");
        Err(Error::content(session, Place::Whole, found, "the same in its experiment file"))
    }
}

fn named(name: &str) -> ColumnName {
    ColumnName::Name(name.to_owned())
}

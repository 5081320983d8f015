//! Calibration by gravity alone: a unit that was turned by hand or on a table and rested again and again.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use centrical::reduction::{CoarseScale, Record, Rests};
use centrical::{OnProgress, STANDARD_GRAVITY, advance};
use centrical_table::{ColumnName, TableLines, unit_of_word, write_whole};
use nalgebra::Vector3;

use super::calibrate::calibrate_reduced;
use super::noise::Series;
use super::reduce::{find_rests, is_of_gravity, mean_size, refuse_repeated_rests};
use crate::document::{CalibrationResult, Method};
use crate::error::{Error, Place};
use crate::experiment::{
    ASKEW, EXPERIMENT_FILE, FileMarks, Folder, MOST_DISTANT, RAW_OUTPUT, RestSource, Session, StatedAttitudes, Turning,
    misalignments_left_out, refuse_another_session, refuse_other_inputs, write_attitudes, write_plateaus,
};
use crate::quantity::{Date, NotThatQuantity, Quantity};
use crate::record::{EqualColumns, Input, RECORD, Scale, named_columns};
use crate::reduced::{Reduced, ReducedPlateau, rest_rows};
use crate::settings::toml_text;
use crate::units::Dimension;

/// Records of a unit that rested in attitudes that only gravity shows, and what is to be made of them.
#[derive(Debug, Clone, PartialEq)]
pub struct TumbleRequest {
    /// The records, in any format.
    pub files: Vec<PathBuf>,
    /// Where they are.
    pub folder: Folder,
    /// Column of time [s].
    pub time: ColumnName,
    /// Sampling rate of records without a column of time [Hz].
    pub rate: Option<f64>,
    /// Columns of newtonometers 1, 2, 3.
    pub readings: [ColumnName; 3],
    /// Unit of the readings: one of acceleration, `V` or `counts`.
    pub unit: String,
    /// Gravity at the place [m/s^2].
    pub gravity: f64,
    /// Its standard uncertainty [m/s^2].
    pub gravity_uncertainty: f64,
    /// Attitudes in which the unit was laid down, where they are known.
    pub attitudes: Option<StatedAttitudes>,
    /// Largest distance of the proof masses from the axis of rotation [m]: slow rotation counts as rests. `None`: it does not count.
    pub turning_radius: Option<f64>,
    /// Terms of the error model, as in `[model]`.
    pub terms: Vec<String>,
    /// Model of the unit; empty if it is not stated.
    pub model: String,
    /// Serial number of the unit.
    pub serial: String,
    /// Date of the records, as written.
    pub date: String,
}

impl TumbleRequest {
    /// Bias, scale and misalignment: what a unit shows at 1 g.
    pub const USUAL_TERMS: [&'static str; 9] =
        ["df_1", "df_2", "df_3", "G0_11", "G0_21", "G0_22", "G0_31", "G0_32", "G0_33"];

    /// The unit of readings: one of acceleration, `V` or `counts`, in the spelling of settings.
    ///
    /// # Errors
    /// What was found and expected.
    pub fn unit(text: &str) -> Result<String, String> {
        let unit = unit_of_word(text).unwrap_or(text);
        let is_raw = RAW_OUTPUT.iter().any(|(_, raw, _)| *raw == unit);
        if is_raw || Dimension::Acceleration.factor(unit).is_some() {
            return Ok(unit.to_owned());
        }
        Err(format!(
            "found {text:?}, expected a unit of acceleration such as \"m/s^2\" or \"g\", or \"counts\" or \"V\""
        ))
    }

    /// The largest distance of the proof masses from an axis of rotation [m].
    ///
    /// # Errors
    /// [`NotThatQuantity`] if it is negative or beyond 10 m.
    pub fn turning_radius(distance: &Quantity) -> Result<f64, NotThatQuantity> {
        distance.within(Dimension::Length, 0.0..=MOST_DISTANT, &format!("a distance of 0 to {MOST_DISTANT} m"))
    }

    /// All files that are read: the records, and that of the attitudes.
    pub fn inputs(&self) -> impl Iterator<Item = &Path> {
        let attitudes = self.attitudes.iter().flat_map(|attitudes| &attitudes.file);
        self.files.iter().chain(attitudes).map(PathBuf::as_path)
    }

    /// Gravity at the place and its standard uncertainty [m/s^2], by what is stated of both: exact unless an uncertainty is stated; that of any
    /// place on Earth without a statement.
    pub fn gravity(stated: Option<f64>, uncertainty: Option<f64>) -> [f64; 2] {
        /// Rectangular from 9.764 to 9.834 m/s^2.
        const ANYWHERE: f64 = 0.02;
        let usual = if stated.is_some() { 0.0 } else { ANYWHERE };
        [stated.unwrap_or(STANDARD_GRAVITY), uncertainty.unwrap_or(usual)]
    }

    /// A date of records as it is written: a day of ISO 8601, with or without a time; empty if it is not stated.
    ///
    /// # Errors
    /// What was found and expected.
    pub fn date(text: &str) -> Result<String, String> {
        match text.parse::<Date>() {
            Err(expected) if !text.is_empty() => Err(format!("found {text:?}, {expected}")),
            _ => Ok(text.to_owned()),
        }
    }
}

/// A calibration by rests.
#[derive(Debug, Clone, PartialEq)]
pub struct Tumble {
    /// The rests as a session.
    pub session: Session,
    /// The text of its experiment file.
    pub text: String,
    /// The means of the rests.
    pub reduced: Reduced,
    /// What follows from them.
    pub result: CalibrationResult,
}

/// Finds the rests of the records, averages each, and calibrates the unit by them: gravity has the same size in all. The text of
/// the session is that of a file in `folder`. `progress` is called with the number of bytes read.
///
/// # Errors
/// [`Error`] naming the file, the place, what was found and what was expected; [`Error::Stopped`].
pub fn tumble(request: &TumbleRequest, folder: &Path, progress: OnProgress) -> Result<Tumble, Error> {
    let before = FileMarks::of(request.inputs());
    let mut records = Vec::with_capacity(request.files.len());
    for file in &request.files {
        let record = record(request, file, progress)?;
        answers(request, &record, file)?;
        records.push(record);
    }
    let mut rests = found(request, &records, progress)?;
    advance(progress, 0)?;
    let coarse = if Dimension::Acceleration.factor(&request.unit).is_some() {
        None
    } else {
        let coarse = coarse(request, &rests)?;
        for record in &mut records {
            in_si(record, &coarse);
        }
        rests = found(request, &records, progress)?;
        Some(coarse)
    };
    let means = means(&rests);
    if request.attitudes.is_none() {
        turns(request, &means)?;
    }
    if coarse.is_none() {
        has_unit(request, &rests)?;
    }
    let known = (request.attitudes.as_ref()).map(|stated| stated.of_rests(&means, &first(request))).transpose()?;
    let text = session_text(request, coarse.as_ref(), &rests);
    let plateaus: Vec<ReducedPlateau> = rests.means.into_iter().flatten().map(ReducedPlateau::from).collect();
    let mut reduced = Reduced { plateaus, ..Reduced::default() };
    let input = |file: &Path| {
        let source = request.folder.open(file, Input::EXPECTED)?;
        Input::of(file.parent().unwrap_or(Path::new("")), &source, progress)
    };
    let inputs = request.inputs().map(input);
    reduced.inputs = inputs.collect::<Result<_, _>>()?;
    before.refuse_changed()?;
    refuse_twice(request, &reduced.inputs)?;
    let session = Session::parse_with(&text, &folder.join(EXPERIMENT_FILE), Folder::at(folder), |table, _| {
        table.means = rest_rows(&reduced.plateaus);
        if let (Some(table), Some(known)) = (&mut table.attitudes, &known) {
            table.up_b.clone_from(known);
        }
        Ok(())
    })?;
    refuse_repeated_rests(&session, &reduced, request.files.last().unwrap_or(&session.file))?;
    let result = calibrate_reduced(&blaming_record(&session, request), &reduced, Method::Exact, progress)?;
    Ok(Tumble { session, text, reduced, result })
}

impl Tumble {
    /// Writes the rests as a session into `folder`, which is there. The result is written with its documents.
    ///
    /// # Errors
    /// If the folder holds a session with records or of another unit, or does not take the files, or one of them was read.
    pub fn write(&self, request: &TumbleRequest, folder: &Path) -> Result<(), Error> {
        refuse_another_session(folder, &self.session)?;
        let names = [TABLE, ATTITUDES, EXPERIMENT_FILE];
        let outputs @ [table, attitudes, experiment] = &names.map(|name| folder.join(name));
        refuse_other_inputs(folder, outputs, &request.inputs().collect::<Vec<_>>())?;
        write_plateaus(table, &rest_rows(&self.reduced.plateaus))?;
        for known in self.session.rest_tables.iter().filter_map(|table| table.attitudes.as_ref()) {
            write_attitudes(attitudes, &known.up_b)?;
        }
        Ok(write_whole(experiment, self.text.as_bytes())?)
    }
}

/// The session with the record as its file in messages: its own files are still to be written.
fn blaming_record(session: &Session, request: &TumbleRequest) -> Session {
    let mut blaming = session.clone();
    blaming.file = first(request);
    for table in &mut blaming.rest_tables {
        table.source = RestSource::Table(first(request));
    }
    blaming
}

/// Refuses a record that is given twice: its noise would count for half.
fn refuse_twice(request: &TumbleRequest, inputs: &[Input]) -> Result<(), Error> {
    let records = || request.files.iter().zip(inputs);
    for (n, (file, input)) in records().enumerate() {
        if let Some((before, _)) = records().take(n).find(|(_, before)| before.sha256 == input.sha256) {
            let found = format!("the same bytes as in {}", before.display());
            return Err(Error::content(file, Place::Whole, found, "every record once"));
        }
    }
    Ok(())
}

/// A record as it is, in m/s^2 where its unit is one of acceleration.
fn record(request: &TumbleRequest, file: &Path, progress: OnProgress) -> Result<Record, Error> {
    let (time, readings) = named_columns(&request.time, request.rate, &request.readings, &request.unit);
    let everything = [f64::NEG_INFINITY, f64::INFINITY];
    let series = Series::read(
        request.folder.open(file, RECORD)?,
        TableLines::default(),
        &time,
        &readings,
        everything,
        progress,
    )?;
    let mut columns = series.columns.into_iter().map(|(_, _, values)| values);
    let record = Record { t: series.t, f_z: std::array::from_fn(|_| columns.next().unwrap_or_default()) };
    let mut equal = EqualColumns::of(request.readings.each_ref().map(ToString::to_string));
    equal.see(record.as_slice().f_z);
    equal.refuse(file)?;
    Ok(record)
}

/// The rests of the records, and the arcs if they count.
fn found(request: &TumbleRequest, records: &[Record], progress: OnProgress) -> Result<Rests, Error> {
    let records: Vec<_> = records.iter().map(|record| (record.as_slice(), request.turning_radius)).collect();
    find_rests(&records, &first(request), progress)
}

/// The mean readings of the rests of all records.
fn means(rests: &Rests) -> Vec<Vector3<f64>> {
    rests.means.iter().flatten().map(|rest| rest.mean).collect()
}

/// The coarse scale and bias of readings in counts or volts.
fn coarse(request: &TumbleRequest, rests: &Rests) -> Result<CoarseScale, Error> {
    let means = means(rests);
    CoarseScale::of(&means, request.gravity).ok_or_else(|| {
        let found = format!("{} rests that do not show scale and bias of {}", means.len(), request.unit);
        let expected = "rests with each axis about up and about down, six at least";
        Error::content(&first(request), Place::Whole, found, expected)
    })
}

fn in_si(record: &mut Record, CoarseScale { scale, bias }: &CoarseScale) {
    for (axis, values) in record.f_z.iter_mut().enumerate() {
        Scale { offset: bias[axis], factor: 1.0 / scale[axis] }.apply(values);
    }
}

/// Least part of the size of the rests through which each newtonometer is turned: half of its range, as by a turn of 6 deg. With less
/// its scale is its bias, and the fit goes astray.
const LEAST_TURN: f64 = 0.1;

/// Units that readings are mistaken for.
const UNITS: [&str; 3] = ["m/s^2", "g", "mg"];

/// # Errors
/// If a newtonometer gives one reading throughout.
fn answers(request: &TumbleRequest, record: &Record, file: &Path) -> Result<(), Error> {
    for (column, readings) in request.readings.iter().zip(&record.f_z) {
        let mut values = readings.iter().filter(|reading| reading.is_finite());
        let Some(first) = values.next() else { continue };
        if values.all(|reading| reading == first) {
            let found = format!("the same reading in all rows of column {column}");
            let expected = "a newtonometer that answers to turns";
            return Err(Error::content(file, Place::Whole, found, expected));
        }
    }
    Ok(())
}

/// # Errors
/// If the rests of a record [m/s^2] are longer or shorter than gravity is: each record is judged by its own.
fn has_unit(request: &TumbleRequest, rests: &Rests) -> Result<(), Error> {
    let sizes = rests.means.iter().map(|means| {
        let means: Vec<Vector3<f64>> = means.iter().map(|rest| rest.mean).collect();
        (!means.is_empty()).then(|| mean_size(&means))
    });
    let sizes: Vec<(&PathBuf, f64)> =
        request.files.iter().zip(sizes).filter_map(|(file, size)| Some((file, size?))).collect();
    let is_gravity = |size: f64| is_of_gravity(size, request.gravity);
    let Some((file, size)) = sizes.iter().find(|(_, size)| !is_gravity(*size)) else { return Ok(()) };
    let factor = |unit: &str| Dimension::Acceleration.factor(unit);
    let as_written = size / factor(&request.unit).unwrap_or(1.0);
    let likely = UNITS.into_iter().find(|unit| factor(unit).is_some_and(|factor| is_gravity(as_written * factor)));
    let found = format!("rests of {as_written:.4} {} on average", request.unit);
    let unit = likely.unwrap_or("counts");
    let others =
        if sizes.iter().any(|(_, size)| is_gravity(*size)) { "this record alone: all need one unit" } else { "" };
    let expected = format!("rests of gravity, {:.5} m/s^2; --unit {unit} would fit {others}", request.gravity);
    Err(Error::content(file, Place::Whole, found, expected.trim_end()))
}

/// # Errors
/// If a newtonometer whose scale is asked for hardly turns in the rests of unknown attitudes.
fn turns(request: &TumbleRequest, means: &[Vector3<f64>]) -> Result<(), Error> {
    let (low, high) = means.iter().fold((means[0], means[0]), |(low, high), mean| (low.inf(mean), high.sup(mean)));
    let is_asked = |axis: usize| request.terms.iter().any(|term| *term == format!("G0_{0}{0}", axis + 1));
    let turned = |axis: usize| 0.5 * (high - low)[axis] / mean_size(means);
    if let Some(axis) = (0..3).find(|axis| is_asked(*axis) && turned(*axis) < LEAST_TURN) {
        let found = format!(
            "newtonometer {} between {:.3} and {:.3} m/s^2 in all {} rests",
            axis + 1,
            low[axis],
            high[axis],
            means.len()
        );
        let expected = "readings that differ by a fifth of gravity at least, best of rests in which it points up and others in which it points down, or a \
                        newtonometer that answers";
        return Err(Error::content(&first(request), Place::Whole, found, expected));
    }
    Ok(())
}

/// The record that messages name.
fn first(request: &TumbleRequest) -> PathBuf {
    request.files.first().cloned().unwrap_or_default()
}

/// Name of the table of rests.
const TABLE: &str = "rests.csv";

/// Name of the table of their attitudes.
const ATTITUDES: &str = "attitudes.csv";

/// The experiment file of rests in a table beside it, of readings with this coarse scale where they are in no unit of acceleration.
fn session_text(request: &TumbleRequest, coarse: Option<&CoarseScale>, rests: &Rests) -> String {
    let mut text = String::new();
    let mut line = |line: String| {
        // Writing to a String does not fail.
        let _ = writeln!(text, "{line}");
    };
    let names: Vec<String> = request.files.iter().map(|file| file.display().to_string()).collect();
    line("# Rests in attitudes of their own, found by `centrical tumble`.".to_owned());
    let title = toml_text(&format!("Rests of {}", names.join(", ")));
    line(format!("[session]\ntitle = {title}\ndate = {}\n", toml_text(&request.date)));
    line(format!("[site]\ngravity = \"{:?} m/s^2\"\n", request.gravity));
    line(format!("[uncertainty]\ngravity = \"{:?} m/s^2\"\n", request.gravity_uncertainty));
    line("[unit]".to_owned());
    // An empty name names nothing: without one the file is as it was.
    if !request.model.is_empty() {
        line(format!("model = {}", toml_text(&request.model)));
    }
    line(format!("serial = {}", toml_text(&request.serial)));
    let raw = RAW_OUTPUT.into_iter().find(|(_, unit, _)| *unit == request.unit);
    match coarse.zip(raw) {
        Some((CoarseScale { scale, bias }, (_, unit, key))) => {
            line(format!("output_unit = \"{unit}\""));
            line(format!("{key} = {{ scale = {:?}, bias = {:?}, found = true }}\n", scale.as_slice(), bias.as_slice()));
        }
        None => line(format!("output_unit = {}\n", toml_text(&request.unit))),
    }
    let askew = misalignments_left_out(&request.terms);
    let terms: Vec<String> = request.terms.iter().chain(&askew).map(|term| toml_text(term)).collect();
    line(format!("[model]\nerror_model = [{}]\n", terms.join(", ")));
    if !askew.is_empty() {
        let priors: Vec<String> = askew.iter().map(|name| format!("{name} = {ASKEW:?}\n")).collect();
        line(format!("# Of what the terms leave out.\n[prior]\n{}", priors.concat()));
    }
    line(format!("[[tumble]]\nrests = {TABLE:?}"));
    if rests.noise_at_most > 1.0 {
        line(format!("noise_at_most = {:?}", rests.noise_at_most));
    }
    let turning = request.turning_radius.and_then(|radius| Turning::of(rests.means.iter().flatten(), radius));
    if let Some(turning) = turning {
        line(format!("turning = {}", turning.inline_table()));
    }
    if let Some(attitudes) = &request.attitudes {
        let uncertainty = attitudes.uncertainty;
        line(format!("attitudes = {ATTITUDES:?}\nattitude_uncertainty = \"{uncertainty:?} rad\""));
    }
    text
}

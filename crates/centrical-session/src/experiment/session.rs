//! A session: what `experiment.toml` says and the files that it names.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use centrical::TypeB;
use centrical::{Centrifuge, ErrorModel, Experiment, Extension, MeasurementModel, Rotation, SetPoint, Site};

use super::extensions::{extensions, pair_relation};
use super::folder::Folder;
use super::form::{Form, MountingTable, SiteTable};
use super::plateaus::PlateauTable;
use super::prior::{self, PriorEntry};
use super::rests::{self, RestTable};
use super::speeds::{SpeedSource, Speeds};
use super::toml_path::TomlPath;
use super::unit::OutputUnit;
use super::{attitude, columns, schedule, speeds, terms, uncertainty, unit};
use crate::error::{Error, Place, quoted};
use crate::record::Columns;
use crate::settings::{editable, from_toml, read_settings, settings_of};
use crate::units::Dimension;

/// Name of the experiment file in a session folder.
pub(crate) const EXPERIMENT_FILE: &str = "experiment.toml";

/// A session: everything that is known before the records are read, and where they are.
#[derive(Debug, Clone, PartialEq)]
pub struct Session {
    /// The experiment file.
    pub file: PathBuf,
    /// Title, for the report.
    pub title: String,
    /// Date, as written.
    pub date: String,
    /// Free text, for the report.
    pub text: String,
    /// Model of the unit.
    pub unit_model: String,
    /// Serial number of the unit.
    pub unit_serial: String,
    /// Name of the station, empty if none is stated.
    pub station: String,
    /// What the unit puts out.
    pub output_unit: OutputUnit,
    /// Whether the nominal scale and bias of a raw output were found in the records of this session.
    pub nominal_found: bool,
    /// The experiment. Its set points are those of the plateau table where the session brings one.
    pub experiment: Experiment,
    /// The error model of the unit.
    pub error_model: ErrorModel,
    /// Unknowns beyond those of the source.
    pub extensions: Vec<Extension>,
    /// Standard uncertainties of what the model takes as exact, as stated in `[uncertainty]`.
    pub type_b: TypeB,
    /// How the speeds of plateaus are known.
    pub speeds: Speeds,
    /// Columns of the records and the telemetry.
    pub columns: Columns,
    /// Files of every mounting, in the order of [`Experiment::mountings`].
    pub mountings: Vec<MountingFiles>,
    /// Plateaus already averaged, if the session brings them instead of records.
    pub plateaus: Option<PlateauTable>,
    /// What the records showed beside these means, as JSON.
    pub record_findings: Option<String>,
    /// Tables of rests in free attitudes, each rest a mounting behind the others.
    pub(crate) rest_tables: Vec<RestTable>,
    /// Duration that the schedule states for each set point, if it does [s].
    pub durations: Vec<Option<f64>>,
    pub(super) priors: Vec<PriorEntry>,
    /// Where its files are.
    pub(crate) folder: Folder,
}

/// The files of one mounting.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct MountingFiles {
    /// One record, or three, one for each newtonometer; none for a mounting that came averaged.
    pub records: Vec<PathBuf>,
    /// The telemetry.
    pub telemetry: Option<PathBuf>,
    /// Times of the pulses of an index mark or an encoder.
    pub pulses: Option<PathBuf>,
}

impl MountingFiles {
    /// Those that a table names.
    fn of(folder: &Folder, table: &MountingTable) -> Self {
        let path = |name: &Option<String>| name.as_ref().map(|name| folder.join(name));
        let records = table.record.iter().flat_map(|record| &record.0).map(|name| folder.join(name)).collect();
        Self { records, telemetry: path(&table.telemetry), pulses: path(&table.pulses) }
    }
}

impl Session {
    /// Whether the path is that of a session, and not of a record: no record is a folder, or a text in TOML.
    pub fn is_named_by(path: &Path) -> bool {
        path.is_dir() || path.extension().is_some_and(|extension| extension == "toml")
    }

    /// Reads the session in a folder, or of an experiment file. The records themselves are not touched.
    ///
    /// # Errors
    /// If the experiment file can not be read or does not follow the form, or makes no sense: every key is
    /// known, every quantity finite and of its dimension, every position a rotation and mounted.
    pub fn read(path: &Path) -> Result<Self, Error> {
        Self::read_with(path, RestTable::read)
    }

    /// [`Session::read`] of a session whose tables of rests need not be there yet: they are not read.
    ///
    /// # Errors
    /// As [`Session::read`].
    pub fn read_before_rests(path: &Path) -> Result<Self, Error> {
        Self::read_with(path, |_, _| Ok(()))
    }

    fn read_with(path: &Path, read: impl FnMut(&mut RestTable, &Folder) -> Result<(), Error>) -> Result<Self, Error> {
        let file = experiment_file(path);
        let folder = Folder::of(&file);
        let text = settings_of(&folder.open_kept(&file, EXPERIMENT)?, EXPERIMENT)?;
        refuse_other_text(&file, &text)?;
        let session = Self::parse_with(&text, &file, folder, read)?;
        session.folder.marks().refuse_changed()?;
        Ok(session)
    }

    /// The session of an experiment file with this `text`, as if it were `experiment.toml` in `folder`.
    ///
    /// # Errors
    /// As [`Session::read`].
    pub fn parse(text: &str, folder: Folder) -> Result<Self, Error> {
        Self::parse_file(text, &folder.join(EXPERIMENT_FILE), folder)
    }

    /// The same as if the text were `file`.
    ///
    /// # Errors
    /// As [`Session::read`].
    pub fn parse_file(text: &str, file: &Path, folder: Folder) -> Result<Self, Error> {
        let folder = folder.with_file(file, text.to_owned().into());
        Self::parse_with(text, file, folder, RestTable::read)
    }

    /// [`Session::parse_file`] with tables of rests that `read` fills.
    pub(crate) fn parse_with(
        text: &str,
        file: &Path,
        folder: Folder,
        mut read: impl FnMut(&mut RestTable, &Folder) -> Result<(), Error>,
    ) -> Result<Self, Error> {
        let form = from_toml::<Form>(file, text)?.with_schedules();
        let mut session = Self::without_plateaus(file, folder, &form)?;
        let rotation = session.experiment.centrifuge.rotation;
        if let Some(table) = &form.plateaus {
            let has_speeds = has_measured_speeds(file, &session.speeds)?;
            let table = PlateauTable::read(&session.folder, table, form.mounting.len(), has_speeds)?;
            session.experiment.set_points = table.set_points(rotation);
            table.check_means(file, &session.experiment)?;
            session.plateaus = Some(table);
        } else {
            session.experiment.set_points = schedule::set_points(file, &form.mounting, rotation)?;
            session.durations = schedule::durations(file, &form.mounting)?;
        }
        session.rest_tables.iter_mut().try_for_each(|table| read(table, &session.folder))?;
        session.refuse_rests_alone()?;
        session.add_rests();
        session.state_uncertainties(&form)?;
        // Whatever is wrong with the priors is said before any record is read, unless they may be of rests that are to be found.
        if !session.rest_tables.iter().any(RestTable::is_awaited) {
            session.model()?;
        }
        Ok(session)
    }

    /// The session with a table of plateaus from memory, columns in the order of [`PlateauTable::columns`].
    ///
    /// # Errors
    /// If a row is invalid, as in a file.
    pub fn with_plateaus(mut self, columns: &[Vec<f64>]) -> Result<Self, Error> {
        let table = PlateauTable::in_memory(&self.file, columns, self.mountings.len())?;
        self.forget_rests();
        self.experiment.set_points = table.set_points(self.experiment.centrifuge.rotation);
        table.check_means(&self.file, &self.experiment)?;
        (self.plateaus, self.durations) = (Some(table), Vec::new());
        self.refuse_rests_alone()?;
        self.add_rests();
        Ok(self)
    }

    /// On an arm plateaus at rest alone show nothing of a centrifuge.
    fn refuse_rests_alone(&self) -> Result<(), Error> {
        let has_rests = |table: &RestTable| table.count() > 0 || table.is_awaited();
        let is_of_rests = !self.experiment.has_arm() && self.rest_tables.iter().any(has_rests);
        if !is_of_rests && self.experiment.set_points.iter().all(SetPoint::is_rest) {
            let at = TomlPath::entry(&self.file, "mounting", 0);
            return Err(at.unexpected("plateaus", "all plateaus at rest", "at least one plateau with a speed"));
        }
        Ok(())
    }

    /// The measurement model of the session: its experiment, error model, extensions and priors.
    ///
    /// # Errors
    /// If a prior names no parameter, or is invalid: only for a session changed since it was read.
    pub fn model(&self) -> Result<MeasurementModel, Error> {
        self.model_at(self.experiment.set_points.clone(), None)
    }

    /// The measurement model with other set points, such as the measured ones, and the noise of a single reading [m/s^2] where records show
    /// it.
    ///
    /// # Errors
    /// As [`Session::model`].
    pub(crate) fn model_at(
        &self,
        set_points: Vec<SetPoint>,
        reading_noise: Option<f64>,
    ) -> Result<MeasurementModel, Error> {
        self.refuse_absent(&TomlPath::table(&self.file, "model"), &self.extensions)?;
        let experiment = Experiment { set_points, ..self.experiment.clone() };
        let reading_noise = reading_noise.unwrap_or(self.type_b.reading_noise);
        let stated = TypeB { reading_noise, ..self.type_b };
        let model = MeasurementModel::new(experiment, self.error_model.clone(), &self.extensions).with_stated(stated);
        if self.rest_tables.iter().any(RestTable::is_awaited) {
            // A name that stands for nothing may be that of a rest to come.
            let there: Vec<_> = self.priors.iter().filter(|prior| prior.is_of(&model)).cloned().collect();
            return prior::with_priors(&self.file, model, &there);
        }
        prior::with_priors(&self.file, model, &self.priors)
    }

    /// Refuses an extension of a mounting, a set speed or a plateau that the session does not have. Rests to come bring plateaus.
    pub(super) fn refuse_absent(&self, at: &TomlPath, extensions: &[Extension]) -> Result<(), Error> {
        let is_awaited = self.rest_tables.iter().any(RestTable::is_awaited);
        let may_come = |extension: &Extension| is_awaited && matches!(extension, Extension::Disturbance(_));
        for extension in extensions.iter().filter(|extension| !may_come(extension)) {
            let Some(numbers) = extension.numbers(&self.experiment) else { continue };
            if extension.parameters(&self.experiment, &self.error_model).is_empty() {
                let (first, last) = numbers.into_inner();
                let expected = format!("a number from {first} to {last}, as the session has them");
                return Err(at.unexpected("extensions", quoted(extension.name().as_bytes()), expected));
            }
        }
        Ok(())
    }

    /// Takes what `[uncertainty]` states of the experiment, which has its set points and rests.
    pub(super) fn state_uncertainties(&mut self, form: &Form) -> Result<(), Error> {
        let mut experiment = self.experiment.clone();
        if form.candidates.is_some() && experiment.has_arm() {
            // The schedule of a plan may do without what is stated of its candidates.
            experiment.set_points.extend([0.0, PI].map(|angle| SetPoint::at_rest(0, angle)));
        }
        rests::add_awaited(&mut experiment, &self.rest_tables);
        self.type_b = uncertainty::type_b(&self.file, &form.uncertainty, &experiment, &self.error_model, &self.speeds)?;
        Ok(())
    }

    /// Everything but the set points and what `[uncertainty]` states.
    pub(crate) fn without_plateaus(file: &Path, folder: Folder, form: &Form) -> Result<Self, Error> {
        let has_arm = form.has_arm();
        if has_arm {
            refuse_missing_keys(file, form)?;
        }
        let pair_relation = pair_relation(file, &form.model)?;
        let positions = attitude::positions(file, &form.position, pair_relation, has_arm)?;
        let mountings = schedule::mountings(file, &form.mounting, &positions)?;
        let centrifuge = form.centrifuge.as_ref();
        let speeds = centrifuge.map(|table| speeds::speeds(file, table)).transpose()?.unwrap_or_default();
        let experiment = Experiment {
            site: site(file, &form.site)?,
            unit: unit::geometry(file, &form.unit)?,
            centrifuge: Centrifuge {
                rotation: centrifuge.map_or(Ok(Rotation::Positive), |table| rotation(file, &table.rotation))?,
                speed_uncertainty: speeds.expected_uncertainty(),
            },
            positions,
            pair_relation,
            mountings,
            set_points: Vec::new(),
        };
        let error_model = terms::error_model(file, &form.model.error_model)?;
        // Rests of a plan may be among its candidates.
        let has_rests = !form.tumble.is_empty() || form.candidates.is_some();
        if let Some(change) = form.uncertainty.get("bias_change").filter(|_| !has_rests) {
            let expected = "[[tumble]] rests, whose biases may differ by it from those on the arm";
            return Err(TomlPath::table(file, "uncertainty").unexpected("bias_change", change.to_string(), expected));
        }
        Ok(Self {
            file: file.to_owned(),
            title: form.session.title.clone(),
            date: form.session.date.clone(),
            text: form.session.text.clone(),
            unit_model: form.unit.model.clone(),
            unit_serial: form.unit.serial.clone(),
            station: centrifuge.map_or_else(String::new, |table| table.station.clone()),
            output_unit: OutputUnit::named(&form.unit.output_unit),
            nominal_found: [&form.unit.counts, &form.unit.volts].into_iter().flatten().any(|raw| raw.found),
            type_b: TypeB::default(),
            speeds,
            experiment,
            error_model,
            extensions: extensions(file, &form.model)?,
            columns: columns::columns(file, &form.columns, &form.unit)?,
            mountings: form.mounting.iter().map(|table| MountingFiles::of(&folder, table)).collect(),
            plateaus: None,
            record_findings: form.record_findings.clone(),
            rest_tables: RestTable::named(file, &folder, &form.tumble)?,
            durations: Vec::new(),
            priors: prior::entries(&form.prior),
            folder,
        })
    }
}

/// What an experiment file is expected to be.
pub(super) const EXPERIMENT: &str = "an experiment file, or the folder with its experiment.toml";

/// Refuses a text, such as a record, that neither is TOML nor has the name of it.
fn refuse_other_text(file: &Path, text: &str) -> Result<(), Error> {
    if Session::is_named_by(file) || editable(file, text).is_ok() {
        return Ok(());
    }
    let expected = format!("{EXPERIMENT}; `centrical init` drafts one from records");
    Err(Error::content(file, Place::Whole, "another text", expected))
}

/// Refuses a session with an arm that says nothing of what only an arm has.
fn refuse_missing_keys(file: &Path, form: &Form) -> Result<(), Error> {
    let keys = [
        ("centrifuge", "speed_uncertainty", form.centrifuge.is_some()),
        ("unit", "proof_masses", form.unit.proof_masses.is_some()),
        ("model", "pair_relation", form.model.pair_relation.is_some()),
    ];
    match keys.into_iter().find(|(.., is_there)| !is_there) {
        Some((table, key, _)) => {
            let expected = "one, for the unit on the arm";
            Err(TomlPath::table(file, table).unexpected(key, "no such key", expected))
        }
        None => Ok(()),
    }
}

/// The experiment file of a session's folder, or the file itself.
pub(super) fn experiment_file(path: &Path) -> PathBuf {
    if path.is_dir() { path.join(EXPERIMENT_FILE) } else { path.to_owned() }
}

/// The text of the experiment file.
pub(crate) fn read_text(file: &Path) -> Result<String, Error> {
    read_settings(file, EXPERIMENT)
}

fn site(file: &Path, table: &SiteTable) -> Result<Site, Error> {
    use std::f64::consts::FRAC_PI_2;
    let at = TomlPath::table(file, "site");
    let gravity = table.gravity.gravity().map_err(|not| at.unexpected("gravity", not.found, not.expected))?;
    let latitude =
        |l| at.bounded("latitude", l, Dimension::Angle, (-FRAC_PI_2, FRAC_PI_2), "a latitude from -90 deg to 90 deg");
    Ok(Site { gravity, latitude: table.latitude.as_ref().map(latitude).transpose()? })
}

/// Whether the table of plateaus states measured speeds: telemetry and pulses are not read beside a table.
fn has_measured_speeds(file: &Path, speeds: &Speeds) -> Result<bool, Error> {
    match speeds.measured.map(|measured| measured.source) {
        None => Ok(false),
        Some(SpeedSource::Plateaus) => Ok(true),
        Some(other) => {
            let expected = "\"plateaus\" in a session that brings a table of plateaus";
            Err(TomlPath::table(file, "centrifuge").unexpected(
                "measured.from",
                format!("{:?}", other.name()),
                expected,
            ))
        }
    }
}

/// Sense of rotation about the third arm axis.
fn rotation(file: &Path, text: &str) -> Result<Rotation, Error> {
    match text {
        "+3" => Ok(Rotation::Positive),
        "-3" => Ok(Rotation::Negative),
        _ => {
            Err(TomlPath::table(file, "centrifuge").unexpected("rotation", quoted(text.as_bytes()), "\"+3\" or \"-3\""))
        }
    }
}

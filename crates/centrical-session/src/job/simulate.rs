//! A session as a laboratory would deliver it, of a unit whose truth is known: experiment.toml, records and telemetry; and truth.json.

use std::io;
use std::path::Path;

use centrical::simulate::{Records, SimulatedMounting, Simulation};
use centrical::{OnProgress, advance};
use centrical_table::{ColumnName, TableFormat, claim_folder, create_folder, write_table, write_whole};
use rayon::prelude::*;
use toml_edit::{Item, TableLike, value};

use crate::document::{Written, WrittenSession, WrittenTumble, truth_json};
use crate::error::{Error, Place};
use crate::experiment::{
    EXPERIMENT_FILE, OutputUnit, RestTable, Session, refuse_inputs, refuse_session, write_attitudes,
};
use crate::record::Column;
use crate::settings::{editable, read_settings, tables_of};
use crate::truth::Truth;

/// Simulates the session of the plan of `truth` and writes it to `folder`. `progress` is called with the number of records that
/// were written, from any thread; the files do not depend on the number of threads.
///
/// # Errors
/// [`Error`] when the folder holds a session already, the plan brings plateaus already averaged or columns without
/// names, or a file cannot be written; [`Error::Stopped`].
pub fn simulate_session(
    truth: &Truth,
    seed: u64,
    format: TableFormat,
    folder: &Path,
    progress: OnProgress<usize>,
) -> Result<(), Error> {
    let plan = &truth.plan;
    let _claim = claim_folder(folder)?;
    let experiment_file = folder.join(EXPERIMENT_FILE);
    refuse_session(folder)?;
    refuse_history(truth)?;
    let columns = Headers::of(plan)?;
    let text = with_files(plan, format)?;
    let simulation = Simulation::new(&truth.model, &truth.values, &truth.equipment, seed)
        .and_then(|simulation| simulation.with_durations(&plan.durations))
        .map_err(|source| Error::Simulation { file: truth.file.clone(), source })?;
    let (mountings, tumbles) = (0..plan.mountings.len(), 0..plan.rest_tables.len());
    let mut outputs = vec![experiment_file.clone(), folder.join("truth.json")];
    outputs.extend(mountings.clone().map(|m| folder.join(record_path(m, format))));
    outputs.extend(mountings.clone().map(|m| folder.join(telemetry_path(m, format))));
    outputs.extend(tumbles.clone().flat_map(|n| [tumble_path(n, format), attitudes_path(n)]).map(|f| folder.join(f)));
    refuse_inputs(&outputs, &[vec![truth.file.as_path()], plan.files()].concat())?;
    create_folder(&folder.join("records"))?;
    if !mountings.is_empty() {
        create_folder(&folder.join("telemetry"))?;
    }
    if plan.speeds.counts_pulses() {
        create_folder(&folder.join("pulses"))?;
    }
    let output = Output { plan, headers: &columns, format, folder, progress };
    let mountings = mountings.into_par_iter().map(|m| output.mounting(&simulation.mounting(m), m));
    let mountings = mountings.collect::<Result<Vec<Written>, Error>>()?;
    let tumbles = tumbles.into_par_iter().map(|n| output.tumble(&simulation, n));
    let tumbles = tumbles.collect::<Result<Vec<WrittenTumble>, Error>>()?;
    let written = WrittenSession { mountings, tumbles };
    write_whole(&folder.join("truth.json"), truth_json(truth, seed, &written).as_bytes())?;
    // Last, so that a folder with an experiment file is a whole session.
    Ok(write_whole(&experiment_file, text.as_bytes())?)
}

/// An instant of a record does not know what came before it.
fn refuse_history(truth: &Truth) -> Result<(), Error> {
    let Some(parameter) = truth.model.of_history(&truth.values) else { return Ok(()) };
    let found = format!("{}, which acts through what came before a plateau", parameter.name);
    let expected = "effects that act at an instant: it cannot be simulated";
    Err(Error::content(&truth.file, Place::Whole, found, expected))
}

/// Where the tables of a session go.
struct Output<'a> {
    plan: &'a Session,
    headers: &'a Headers<'a>,
    format: TableFormat,
    folder: &'a Path,
    progress: OnProgress<'a, usize>,
}

impl Output<'_> {
    /// The record and the telemetry of one mounting.
    fn mounting(&self, mounting: &SimulatedMounting, m: usize) -> Result<Written, Error> {
        let Self { plan, headers, format, folder, progress } = *self;
        self.record(mounting.records(), &record_path(m, format))?;
        let telemetry = mounting.telemetry();
        let sense = plan.experiment.centrifuge.rotation.sign();
        let speed = telemetry.omega.iter().map(|omega| sense * omega + 0.0).collect();
        let rows = raw([telemetry.t, speed], [&plan.columns.telemetry_time, &plan.columns.speed]);
        let file = folder.join(telemetry_path(m, format));
        write_table(&file, format, &headers.telemetry, std::iter::once(Ok(rows)))?;
        if plan.speeds.counts_pulses() {
            let rows = raw([mounting.pulses()], [&plan.columns.pulse]);
            let file = folder.join(pulses_path(m, format));
            write_table(&file, format, &headers.pulses, std::iter::once(Ok(rows)))?;
        }
        advance(progress, 1)?;
        let [clock_offset, clock_drift] = mounting.clock();
        Ok(Written { plateaus: mounting.plateaus(), clock_offset, clock_drift })
    }

    /// The record of the rests of one `[[tumble]]`, and the attitudes that are known of them where a table states them.
    fn tumble(&self, simulation: &Simulation, n: usize) -> Result<WrittenTumble, Error> {
        let tables = &self.plan.rest_tables;
        let first = self.plan.mountings.len() + tables[..n].iter().map(RestTable::count).sum::<usize>();
        let tumble = simulation.tumble(first..first + tables[n].count());
        self.record(tumble.records(), &tumble_path(n, self.format))?;
        if let Some(known) = tables[n].attitudes.as_ref().filter(|known| known.file.is_some()) {
            let up_b: Vec<_> = known.up_b.iter().copied().flatten().map(Some).collect();
            write_attitudes(&self.folder.join(attitudes_path(n)), &up_b)?;
        }
        advance(self.progress, 1)?;
        Ok(WrittenTumble { rests: tumble.rests(), bias_change: simulation.bias_change(first) })
    }

    /// A record, as the unit puts it out.
    fn record(&self, records: Records, path: &str) -> Result<(), Error> {
        let Self { plan, headers, format, folder, progress } = *self;
        let [f1, f2, f3] = &plan.columns.f;
        let columns = [&plan.columns.time, f1, f2, f3];
        let rows = records.map(|stretch| {
            advance(progress, 0).map_err(io::Error::other)?;
            let [f1, f2, f3] = stretch.f_z;
            let mut rows = raw([stretch.t, f1, f2, f3], columns);
            if plan.output_unit == OutputUnit::Counts {
                rows[1..].iter_mut().flatten().for_each(|value| *value = value.round());
            }
            Ok(rows)
        });
        let written = write_table(&folder.join(path), format, &headers.record, rows);
        // A caller who stops the work is the reason why the file could not be written.
        advance(progress, 0)?;
        Ok(written?)
    }
}

/// From SI to the numbers of the file.
fn raw<const N: usize>(mut values: [Vec<f64>; N], columns: [&Column; N]) -> [Vec<f64>; N] {
    for (values, column) in values.iter_mut().zip(columns) {
        for value in values {
            *value = column.scale.raw(*value);
        }
    }
    values
}

/// Names of the columns of records and telemetry.
#[derive(Debug)]
struct Headers<'a> {
    record: [&'a str; 4],
    telemetry: [&'a str; 2],
    pulses: [&'a str; 1],
}

impl<'a> Headers<'a> {
    fn of(plan: &'a Session) -> Result<Self, Error> {
        let name = |column: &'a Column| match &column.name {
            ColumnName::Name(name) => Ok(name.as_str()),
            other => {
                let place = Place::Key { table: "[columns]".to_owned(), key: other.to_string() };
                let expected = "a column by name: simulated tables have a header";
                Err(Error::content(&plan.file, place, "a column without a name", expected))
            }
        };
        let time = name(&plan.columns.time)?;
        let [f1, f2, f3] = &plan.columns.f;
        Ok(Self {
            record: [time, name(f1)?, name(f2)?, name(f3)?],
            telemetry: [name(&plan.columns.telemetry_time)?, name(&plan.columns.speed)?],
            pulses: [name(&plan.columns.pulse)?],
        })
    }
}

/// The text of the plan with `record` and `telemetry` of every mounting, and `record` of every tumble.
fn with_files(plan: &Session, format: TableFormat) -> Result<String, Error> {
    let file = &plan.file;
    if plan.plateaus.is_some() {
        let expected = "a schedule of plateaus in every [[mounting]]";
        return Err(Error::content(file, Place::Whole, "plateaus already averaged", expected));
    }
    let mut document = editable(file, &read_settings(file, "a plan")?)?;
    let has_pulses = plan.speeds.counts_pulses();
    for (m, table) in tables_of(&mut document, "mounting").into_iter().enumerate() {
        name(table, m, format, has_pulses);
    }
    for (n, (table, rests)) in tables_of(&mut document, "tumble").into_iter().zip(&plan.rest_tables).enumerate() {
        name_tumble(table, n, format, rests);
    }
    if let Some(columns) = document.get_mut("columns").and_then(Item::as_table_like_mut) {
        // The files that are written begin with their header.
        for key in ["header_line", "first_row", "telemetry_header_line", "telemetry_first_row"] {
            columns.remove(key);
        }
    }
    Ok(document.to_string())
}

fn name(table: &mut dyn TableLike, mounting: usize, format: TableFormat, has_pulses: bool) {
    table.insert("record", value(record_path(mounting, format)));
    table.insert("telemetry", value(telemetry_path(mounting, format)));
    if has_pulses {
        table.insert("pulses", value(pulses_path(mounting, format)));
    }
}

/// The rests that were planned are now in a record, in the attitudes that are known of them.
fn name_tumble(table: &mut dyn TableLike, tumble: usize, format: TableFormat, rests: &RestTable) {
    for key in ["rests", "duration", "durations"] {
        table.remove(key);
    }
    table.insert("record", value(tumble_path(tumble, format)));
    match &rests.attitudes {
        None => drop(table.remove("attitudes")),
        Some(known) if known.file.is_some() => drop(table.insert("attitudes", value(attitudes_path(tumble)))),
        Some(_) => {}
    }
}

/// Path of the record of a mounting within the session's folder.
fn record_path(mounting: usize, format: TableFormat) -> String {
    format!("records/m{:02}.{}", mounting + 1, format.extension())
}

/// Path of the pulses of a mounting within the session's folder.
fn pulses_path(mounting: usize, format: TableFormat) -> String {
    format!("pulses/m{:02}.{}", mounting + 1, format.extension())
}

/// Path of the telemetry of a mounting within the session's folder.
fn telemetry_path(mounting: usize, format: TableFormat) -> String {
    format!("telemetry/m{:02}.{}", mounting + 1, format.extension())
}

/// Path of the record of the rests of `[[tumble]]` number `tumble`, from 0, within the session's folder.
fn tumble_path(tumble: usize, format: TableFormat) -> String {
    format!("records/tumble-{}.{}", tumble + 1, format.extension())
}

/// Name of the table of their attitudes.
fn attitudes_path(tumble: usize) -> String {
    format!("attitudes-{}.csv", tumble + 1)
}

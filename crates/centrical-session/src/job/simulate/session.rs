//! A whole session as a laboratory would deliver it: experiment.toml, records, telemetry; and truth.json, which no
//! laboratory has.

use std::io;
use std::path::Path;

use centrical::simulate::{SimulatedMounting, Simulation};
use centrical::{OnProgress, advance};
use centrical_table::{ColumnName, TableFormat, claim_folder, create_folder, refuse_inputs, write_table, write_whole};
use rayon::prelude::*;

use super::files::{pulses_path, record_path, telemetry_path};
use super::session_text::{counts_pulses, with_files};
use crate::document::{Written, truth_json};
use crate::error::{Error, Place};
use crate::experiment::{EXPERIMENT_FILE, OutputUnit, Session};
use crate::record::Column;
use crate::truth::Truth;

/// Simulates the session that `plan` describes and writes it to `folder`. `progress` is called with the number of mountings that
/// were written, from any thread; the files do not depend on the number of threads.
///
/// # Errors
/// [`Error`] when the folder holds a session already, the plan brings plateaus already averaged or columns without
/// names, or a file cannot be written; [`Error::Stopped`].
pub fn simulate_session(
    plan: &Session,
    truth: &Truth,
    seed: u64,
    format: TableFormat,
    folder: &Path,
    progress: OnProgress<usize>,
) -> Result<(), Error> {
    let _claim = claim_folder(folder)?;
    let experiment_file = folder.join(EXPERIMENT_FILE);
    if experiment_file.exists() {
        return Err(Error::content(&experiment_file, Place::Whole, "a session", "a folder without one"));
    }
    if let Some(parameter) = truth.model.of_history(&truth.values) {
        let found = format!("{}, which acts through what came before a plateau", parameter.name);
        return Err(Error::content(
            &truth.file,
            Place::Whole,
            found,
            "effects that act at an instant: it cannot be simulated",
        ));
    }
    let columns = Headers::of(plan)?;
    let text = with_files(plan, format)?;
    // Plateaus last as long as the plan says, or as the machine makes them.
    let stated = plan.durations.iter().map(|duration| duration.unwrap_or(truth.equipment.machine.plateau));
    let durations: Vec<f64> = stated.collect();
    let simulation = Simulation::new(&truth.model, &truth.values, &truth.equipment, seed)
        .and_then(|simulation| simulation.with_durations(&durations))
        .map_err(|source| Error::Simulation { file: truth.file.clone(), source })?;
    let mountings = 0..plan.experiment.mountings.len();
    let mut outputs = vec![experiment_file.clone(), folder.join("truth.json")];
    outputs.extend(
        mountings.clone().flat_map(|m| [record_path(m, format), telemetry_path(m, format)]).map(|f| folder.join(f)),
    );
    refuse_inputs(&outputs, &[vec![truth.file.as_path()], plan.files()].concat())?;
    create_folder(&folder.join("records"))?;
    create_folder(&folder.join("telemetry"))?;
    if counts_pulses(plan) {
        create_folder(&folder.join("pulses"))?;
    }
    let mountings = mountings.into_par_iter().map(|m| {
        let written = write_mounting(plan, &columns, &simulation.mounting(m), format, folder, m, progress)?;
        advance(progress, 1)?;
        Ok(written)
    });
    let mountings = mountings.collect::<Result<Vec<Written>, Error>>()?;
    write_whole(&folder.join("truth.json"), truth_json(plan, truth, seed, &mountings).as_bytes())?;
    // Last, so that a folder with an experiment file is a whole session.
    Ok(write_whole(&experiment_file, text.as_bytes())?)
}

/// The record and the telemetry of one mounting.
fn write_mounting(
    plan: &Session,
    headers: &Headers,
    mounting: &SimulatedMounting,
    format: TableFormat,
    folder: &Path,
    m: usize,
    progress: OnProgress<usize>,
) -> Result<Written, Error> {
    let [f1, f2, f3] = &plan.columns.f;
    let columns = [&plan.columns.time, f1, f2, f3];
    let record = mounting.records().map(|stretch| {
        advance(progress, 0).map_err(io::Error::other)?;
        let [f1, f2, f3] = stretch.f_z;
        let mut rows = raw([stretch.t, f1, f2, f3], columns);
        if plan.output_unit == OutputUnit::Counts {
            rows[1..].iter_mut().flatten().for_each(|value| *value = value.round());
        }
        Ok(rows)
    });
    let written = write_table(&folder.join(record_path(m, format)), format, &headers.record, record);
    // A caller who stops the work is the reason why the file could not be written.
    advance(progress, 0)?;
    written?;

    let telemetry = mounting.telemetry();
    let sense = plan.experiment.centrifuge.rotation.sign();
    let speed = telemetry.omega.iter().map(|omega| sense * omega + 0.0).collect();
    let rows = raw([telemetry.t, speed], [&plan.columns.telemetry_time, &plan.columns.speed]);
    write_table(&folder.join(telemetry_path(m, format)), format, &headers.telemetry, std::iter::once(Ok(rows)))?;
    if counts_pulses(plan) {
        let rows = raw([mounting.pulses()], [&plan.columns.pulse]);
        write_table(&folder.join(pulses_path(m, format)), format, &headers.pulses, std::iter::once(Ok(rows)))?;
    }
    Ok(Written {
        plateaus: mounting.plateaus(),
        clock_offset: telemetry.clock_offset,
        clock_drift: telemetry.clock_drift,
    })
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

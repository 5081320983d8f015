//! `centrical noise FILE`: deviations of the Allan family, spectrum and noise terms of a record.

use std::path::PathBuf;

use centrical_report::{Emphasis, Screen, noise_table, noise_warnings, write_noise};
use centrical_session::{ColumnName, Error, Estimator, Folder, NoiseRequest, PlateauName, noise_of, unwatched};

use crate::given::{column_name, sampling_rate, time};
use crate::output::{Outcome, Printing, remark_unused_time};

/// Analyse the noise of a record: deviations of the Allan family with intervals, spectrum, noise terms.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: centrical noise examples/ta-200 --plateau 2:1 --out noise")]
pub struct Arguments {
    /// A record in any supported format, or a session and one plateau of it
    file: PathBuf,
    /// Plateau of the session [default: the longest at rest]
    #[arg(long, value_name = "MOUNTING:PLATEAU")]
    plateau: Option<PlateauName>,
    /// The session whose experiment.toml names the record's columns and units
    #[arg(long, value_name = "SESSION", conflicts_with_all = ["time", "rate", "readings", "unit"])]
    session: Option<PathBuf>,
    /// Time column, in s: its name, or its number from 1
    #[arg(long, value_name = "COLUMN", default_value = "t", value_parser = column_name)]
    time: ColumnName,
    /// Sampling rate of a record without a time column, such as "250 Hz"
    #[arg(long, value_name = "QUANTITY", value_parser = sampling_rate, conflicts_with = "time")]
    rate: Option<f64>,
    /// Columns of readings: names, or numbers from 1
    #[arg(long, value_name = "COLUMNS", value_delimiter = ',', default_value = "f1,f2,f3", value_parser = column_name)]
    readings: Vec<ColumnName>,
    /// Unit of the readings; a unit that is not one of acceleration, such as "counts", is shown as it is
    #[arg(long, default_value = "m/s^2")]
    unit: String,
    /// Start of the interval to analyse, on the record's clock, s
    #[arg(long, value_name = "TIME", value_parser = time, allow_hyphen_values = true)]
    from: Option<f64>,
    /// End of the interval to analyse
    #[arg(long, value_name = "TIME", value_parser = time, allow_hyphen_values = true)]
    to: Option<f64>,
    /// Estimators, or "all"
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = "overlapping-allan,overlapping-hadamard", value_parser = estimators)]
    estimators: Vec<Estimators>,
    /// Folder for noise.json and the plots, created if absent
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    printing: Printing,
}

/// One estimator or all.
#[derive(Debug, Clone)]
struct Estimators(Vec<Estimator>);

/// Runs the command. Not acceptable: noise terms do not describe a column of readings.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    if arguments.rate.is_some() && !arguments.printing.quiet {
        remark_unused_time([arguments.file.as_path()]);
    }
    let (analysis, plateau) = noise_of(
        &NoiseRequest {
            file: arguments.file.clone(),
            folder: Folder::default(),
            plateau: arguments.plateau,
            session: arguments.session.clone(),
            time: arguments.time.clone(),
            rate: arguments.rate,
            readings: arguments.readings.clone(),
            unit: arguments.unit.clone(),
            window: [arguments.from.unwrap_or(f64::NEG_INFINITY), arguments.to.unwrap_or(f64::INFINITY)],
            estimators: arguments.estimators.iter().flat_map(|some| some.0.clone()).collect(),
        },
        &unwatched,
    )?;
    if let Some(folder) = &arguments.out {
        write_noise(&analysis, folder)?;
    }
    let warnings = noise_warnings(&analysis);
    let text = || {
        let mut screen = Screen::default();
        for warning in &warnings {
            screen.marked(Emphasis::NotAcceptable, "NOT ACCEPTABLE", warning);
        }
        let plateau = plateau.map(|name| format!("Plateau {}:{} of ", name.mounting, name.plateau));
        screen.add(noise_table(&analysis, &plateau.unwrap_or_default()));
        if let Some(folder) = &arguments.out {
            screen.gap();
            screen.say(0, &format!("Written to {}", folder.display()));
        }
        screen
    };
    arguments.printing.show(text, || Ok(analysis.to_json()))?;
    Ok(Outcome::acceptable(warnings.is_empty()))
}

fn estimators(text: &str) -> Result<Estimators, String> {
    if text == "all" {
        return Ok(Estimators(Estimator::ALL.to_vec()));
    }
    let found = Estimator::ALL.into_iter().find(|estimator| estimator.name() == text);
    let names = || Estimator::ALL.map(Estimator::name).join(", ");
    found.map(|one| Estimators(vec![one])).ok_or_else(|| format!("expected \"all\" or some of {}", names()))
}

//! `centrical report RESULT`: the documents that a laboratory hands over, from a result.

use std::path::{Path, PathBuf};

use centrical_report::codegen::{NamedTerm, compensation_source, heading};
use centrical_report::{
    Language, digital_certificate, figures, history_figure, html_report, html_report_with, objections, pdf_certificate,
    verdict_text,
};
use centrical_session::{CalibrationResult, Error, Laboratory, Place, create_folder, read_history, write_whole};
use clap::ValueEnum;

use crate::Outcome;

/// Write the documents of a calibration from its result.json.
#[derive(Debug, clap::Args)]
#[command(arg_required_else_help = true)]
pub struct Arguments {
    /// The result.json of a calibration
    result: PathBuf,
    /// Write the report to this file: one self-contained HTML page
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Add a plot of the uncertainties during the session to the report, from the watch-history.jsonl of `watch`
    #[arg(long, value_name = "FILE", requires = "html")]
    history: Option<PathBuf>,
    /// Write the calibration certificate (ISO/IEC 17025) to this file
    #[arg(long, value_name = "FILE", requires = "laboratory")]
    pdf: Option<PathBuf>,
    /// Add the results before an adjustment to the certificate, from the result.json of that calibration
    #[arg(long, value_name = "RESULT", requires = "pdf")]
    before: Option<PathBuf>,
    /// Write the digital calibration certificate (DCC XML 3.3.0) to this file
    #[arg(long, value_name = "FILE", requires = "laboratory")]
    dcc: Option<PathBuf>,
    /// Write the compensation as source code with test vectors to this folder: C99, MATLAB and Octave, Python
    #[arg(long, alias = "c", value_name = "DIR")]
    code: Option<PathBuf>,
    #[command(flatten)]
    documents: Documents,
}

/// Language of the documents, and the laboratory's data in them.
#[derive(Debug, clap::Args)]
pub struct Documents {
    /// Laboratory file: laboratory, customer, dates, standards and persons named in the certificates
    #[arg(long, value_name = "FILE")]
    laboratory: Option<PathBuf>,
    /// Language of the documents
    #[arg(long, value_enum, default_value = "en")]
    language: LanguageName,
}

/// A language by its code.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum LanguageName {
    /// English
    En,
    /// Russian
    Ru,
}

impl From<LanguageName> for Language {
    fn from(name: LanguageName) -> Self {
        match name {
            LanguageName::En => Self::English,
            LanguageName::Ru => Self::Russian,
        }
    }
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Error> {
    let result = CalibrationResult::read(&arguments.result)?;
    let laboratory = arguments.documents.laboratory(&result)?;
    let language = arguments.documents.language.into();
    if let Some(file) = &arguments.html {
        let history = arguments.history.as_deref().map(read_history).transpose()?.unwrap_or_default();
        let group_of = |name: &str| result.parameter(name).map(|parameter| parameter.group.as_str());
        let further = history_figure(&history, &group_of, language);
        write_whole(file, html_report_with(&result, further.as_slice(), language).as_bytes())?;
    }
    if let Some(laboratory) = laboratory {
        if let Some(file) = &arguments.pdf {
            let before = arguments.before.as_deref().map(|file| before(file, &result, &laboratory)).transpose()?;
            write_whole(file, &pdf_certificate(&result, before.as_ref(), &laboratory, language))?;
        }
        if let Some(file) = &arguments.dcc {
            write_whole(file, digital_certificate(&result, &laboratory, language).as_bytes())?;
        }
    }
    if let Some(folder) = &arguments.code {
        write_source(&result, &arguments.result, folder)?;
    }
    let objections = objections(&result);
    if objections.is_empty() {
        return Ok(Outcome::Done);
    }
    print!("{}", verdict_text(&objections));
    Ok(Outcome::NotAcceptable)
}

/// The result before an adjustment, which has to be of the same unit, and the laboratory has to say what it adjusted.
fn before(file: &Path, after: &CalibrationResult, laboratory: &Laboratory) -> Result<CalibrationResult, Error> {
    let before = CalibrationResult::read(file)?;
    let unit = |result: &CalibrationResult| format!("{} {}", result.session.unit_model, result.session.unit_serial);
    let refuse = |found: String, expected: String| Err(Error::content(file, Place::Whole, found, expected));
    if unit(&before) != unit(after) {
        return refuse(format!("a result of {}", unit(&before)), format!("one of {}", unit(after)));
    }
    if laboratory.item.adjustment.is_none() {
        let expected = "[item] adjustment in the laboratory's file, what was adjusted between the two calibrations";
        return refuse("a result before an adjustment".to_owned(), expected.to_owned());
    }
    Ok(before)
}

/// Writes the compensation as source code.
fn write_source(result: &CalibrationResult, file: &Path, folder: &Path) -> Result<(), Error> {
    let file = || file.to_owned();
    let no_model = |source| Error::ErrorModel { file: file(), source };
    let terms = NamedTerm::of(result).map_err(no_model)?;
    let plain = result.error_terms().map_err(no_model)?;
    let sources = (result.compensation_range(&plain))
        .and_then(|range| compensation_source(&heading(result), &terms, range))
        .map_err(|source| Error::NotInvertible { file: file(), source })?;
    create_folder(folder)?;
    for source in sources {
        write_whole(&folder.join(source.name), source.text.as_bytes())?;
    }
    Ok(())
}

impl Documents {
    /// What the laboratory says, its limits those of parameters of the result.
    fn laboratory(&self, result: &CalibrationResult) -> Result<Option<Laboratory>, Error> {
        let Some(file) = &self.laboratory else { return Ok(None) };
        let laboratory = Laboratory::read(file)?;
        laboratory.check_limits(file, result)?;
        Ok(Some(laboratory))
    }

    /// Writes the report and its plots to a folder, and the certificates if the laboratory's data are given.
    pub fn write_all(&self, result: &CalibrationResult, folder: &Path) -> Result<(), Error> {
        let language = self.language.into();
        let laboratory = self.laboratory(result)?;
        write_whole(&folder.join("report.html"), html_report(result, language).as_bytes())?;
        if let Some(laboratory) = laboratory {
            write_whole(&folder.join("certificate.pdf"), &pdf_certificate(result, None, &laboratory, language))?;
            let dcc = digital_certificate(result, &laboratory, language);
            write_whole(&folder.join("certificate.xml"), dcc.as_bytes())?;
        }
        let plots = folder.join("plots");
        create_folder(&plots)?;
        for figure in figures(result, language) {
            let is_one = figure.drawings.len() == 1;
            for (n, drawing) in (1..).zip(&figure.drawings) {
                let name = if is_one { format!("{}.svg", figure.name) } else { format!("{}-{n:02}.svg", figure.name) };
                write_whole(&plots.join(name), drawing.as_bytes())?;
            }
        }
        Ok(())
    }
}

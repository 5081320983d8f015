//! The documents of one result, and plots as files.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use centrical::MeasurementModel;
use centrical_session::{
    Axes, CalibrationResult, Date, DocumentKind, Error, HistoryEntry, HistoryEstimate, Laboratory, Limitable,
    NoiseAnalysis, Place, UnknownUnit, claim_folder, create_folder, history_up_to, read_history, refuse_inputs,
    result_beside, write_together, write_whole,
};

use crate::codegen::source_of_result;
use crate::dcc::digital_certificate;
use crate::document::{Attachment, Document, Issuer, certificate, report};
use crate::evaluation::UnitStatement;
use crate::figure::{figures, history_figure, noise_plots};
use crate::language::Language;
use crate::picture::read_picture;
use crate::plot::Plot;
use crate::render::{html, letters_without_glyph, pdf};

/// The documents that are made of a result.
#[derive(Debug, Clone, PartialEq)]
pub struct DocumentRequest {
    /// The result of a calibration.
    pub result: PathBuf,
    /// File for the report.
    pub html: Option<PathBuf>,
    /// History of a watch, shown in the report.
    pub history: Option<PathBuf>,
    /// Earlier calibrations of the unit, results, folders of them or stores: what they say of it stands in report and certificates.
    pub past: Vec<PathBuf>,
    /// File for the certificate; needs a laboratory.
    pub pdf: Option<PathBuf>,
    /// Result before the unit was adjusted, shown in the certificate.
    pub before: Option<PathBuf>,
    /// File for the digital certificate; needs a laboratory.
    pub dcc: Option<PathBuf>,
    /// Folder for the compensation as source code.
    pub code: Option<PathBuf>,
    /// Largest specific force on each axis that the source code takes [m/s^2]; the result's own range if none.
    pub range: Option<f64>,
    /// What the certificates say of the laboratory.
    pub laboratory: Option<PathBuf>,
    /// Axes to state the error model in; those of the result if none.
    pub axes: Option<Axes>,
    /// Language of the documents.
    pub language: Language,
}

impl DocumentRequest {
    /// The documents that are asked for, and their files.
    pub fn written(&self) -> Vec<(DocumentKind, &Path)> {
        let documents = [
            (DocumentKind::Report, &self.html),
            (DocumentKind::Certificate, &self.pdf),
            (DocumentKind::DigitalCertificate, &self.dcc),
            (DocumentKind::Code, &self.code),
        ];
        documents.into_iter().filter_map(|(kind, path)| Some((kind, path.as_deref()?))).collect()
    }
}

/// The result that documents were made of, and what they say of the unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Documents {
    /// The result.
    pub result: CalibrationResult,
    /// What the laboratory's decision says of the unit, where one was asked for.
    pub unit: Option<UnitStatement>,
    /// That the laboratory's file has the calibration on other days, in words.
    pub other_days: Option<String>,
}

/// Writes the documents and returns what they are made of.
///
/// # Errors
/// [`Error`] when a file cannot be read or written, or does not go with the result.
pub fn write_documents(request: &DocumentRequest) -> Result<Documents, Error> {
    let result = CalibrationResult::read(&request.result)?;
    let result = match &request.axes {
        Some(axes) => axes.of(result, &request.result)?,
        None => result,
    };
    let has_past = !request.past.is_empty();
    let past = has_past.then(|| history_up_to(&request.result, &result, &request.past)).transpose()?;
    let issuer = request.laboratory.as_deref().map(|file| read_issuer(file, &result)).transpose()?;
    let issuer = issuer.map(|issuer| Issuer { past: past.clone(), ..issuer });
    let logo = issuer.as_ref().zip(request.laboratory.as_ref()).and_then(|(of, file)| of.laboratory.logo(file));
    let inputs = [&request.history, &request.before, &request.laboratory, &logo].into_iter().flatten();
    let inputs: Vec<PathBuf> = [&request.result].into_iter().chain(inputs).chain(&request.past).cloned().collect();
    let outputs: Vec<PathBuf> = [&request.html, &request.pdf, &request.dcc].into_iter().flatten().cloned().collect();
    refuse_inputs(&outputs, &inputs)?;
    if let Some(code) = request.code.as_ref().filter(|code| outputs.contains(code)) {
        return Err(Error::content(code, Place::Whole, "a document of the name of the folder for code", "two names"));
    }
    if request.pdf.is_some() || request.dcc.is_some() {
        refuse_unnamed_item(&result, &request.result)?;
    }
    let language = request.language;
    let unit = issuer.as_ref().and_then(|issuer| issuer.unit.as_ref());
    // What can be refused comes before the first document is written.
    let before = (request.before.as_deref().zip(issuer.as_ref()))
        .map(|(file, issuer)| before(file, &result, &request.result, &issuer.laboratory))
        .transpose()?;
    let dcc = (issuer.as_ref().filter(|_| request.dcc.is_some()))
        .map(|issuer| dcc(&result, issuer, language, &request.result))
        .transpose()?;
    let certificate = (issuer.as_ref().zip(request.pdf.as_ref()))
        .map(|(issuer, _)| {
            let document = certificate(&result, before.as_ref(), issuer, language);
            printed(&with_attachment(document, dcc.as_deref()), issuer, &request.result)
        })
        .transpose()?;
    let mut sources = Vec::new();
    if let Some(folder) = &request.code {
        let of_result = source_of_result(&result, &request.result, request.range)?.into_iter();
        sources.extend(of_result.map(|source| (folder.join(source.name), source.text.into_bytes())));
    }
    let history =
        request.history.as_deref().map(|file| lines_of_history(file, &result)).transpose()?.unwrap_or_default();
    let mut files = Vec::new();
    if let Some(file) = &request.html {
        let group_of = |name: &str| result.parameter(name).map(|parameter| parameter.group);
        let mut drawn = figures(&result, language);
        drawn.extend(history_figure(&history, &group_of, language));
        let report = html(&report(&result, unit, past.as_ref(), drawn, language));
        files.push((file.clone(), report.into_bytes()));
    }
    files.extend(request.pdf.clone().zip(certificate));
    files.extend(request.dcc.clone().zip(dcc.map(String::into_bytes)));
    let _claim = request.code.as_deref().map(claim_folder).transpose()?;
    refuse_inputs(&sources.iter().map(|(file, _)| file.clone()).collect::<Vec<_>>(), &inputs)?;
    files.extend(sources);
    write_together(&files)?;
    let other_days = issuer.as_ref().and_then(|issuer| issuer.other_days(&result));
    Ok(Documents { unit: issuer.and_then(|issuer| issuer.unit), other_days, result })
}

/// Refuses the file of a `result`, or what [`write_all_documents`] writes to a `folder` beside plots, over what is read, and over the result of
/// another unit than that of this model and serial number.
///
/// # Errors
/// [`Error`] when one of the `inputs`, or such a result, would be overwritten.
pub fn refuse_outputs(
    result: Option<&Path>,
    folder: Option<&Path>,
    inputs: &[&Path],
    [model, serial]: [&str; 2],
) -> Result<(), Error> {
    let documents = [REPORT, CERTIFICATE, DIGITAL_CERTIFICATE].map(|name| Some(folder?.join(name)));
    let outputs: Vec<PathBuf> = result.map(Path::to_owned).into_iter().chain(documents.into_iter().flatten()).collect();
    refuse_inputs(&outputs, inputs)?;
    result.map_or(Ok(()), |file| CalibrationResult::refuse_another_unit(file, model, serial))
}

const RESULT: &str = "result.json";
const REPORT: &str = "report.html";
const CERTIFICATE: &str = "certificate.pdf";
const DIGITAL_CERTIFICATE: &str = "certificate.xml";

/// The certificates in a folder, whatever result they are of.
pub fn certificates_in(folder: &Path) -> impl Iterator<Item = PathBuf> {
    [CERTIFICATE, DIGITAL_CERTIFICATE].map(|name| folder.join(name)).into_iter().filter(|file| file.is_file())
}

/// Writes the result to a folder with the report and its plots, and the certificates if the data of the laboratory are given. What cannot be
/// written does not take the others with it.
///
/// # Errors
/// [`Error`] when the laboratory's file is wrong or the folder does not take the documents.
pub fn write_all_documents(
    result: &CalibrationResult,
    issuer: Option<&Issuer>,
    language: Language,
    folder: &Path,
) -> Result<(), Error> {
    let unit = issuer.and_then(|issuer| issuer.unit.as_ref());
    let drawn = figures(result, language);
    let report = html(&report(result, unit, None, drawn.clone(), language));
    let mut files =
        vec![(folder.join(RESULT), result.to_json()?.into_bytes()), (folder.join(REPORT), report.into_bytes())];
    let plots = folder.join("plots");
    let made = create_folder(&plots);
    for figure in drawn {
        let is_one = figure.drawings.len() == 1;
        for (n, drawing) in (1..).zip(figure.drawings) {
            let name = if is_one { format!("{}.svg", figure.name) } else { format!("{}-{n:02}.svg", figure.name) };
            files.push((plots.join(name), drawing.into_bytes()));
        }
    }
    let certificates = issuer.map(|issuer| certificates(result, issuer, language, folder)).transpose();
    let (certificates, refused) = certificates.map_or_else(|error| (None, Err(error)), |files| (files, Ok(())));
    files.extend(certificates.into_iter().flatten());
    let written = write_together(&files);
    made?;
    written?;
    refused
}

/// The certificates of a result for a folder, which may be refused where other documents are not.
fn certificates(
    result: &CalibrationResult,
    issuer: &Issuer,
    language: Language,
    folder: &Path,
) -> Result<[(PathBuf, Vec<u8>); 2], Error> {
    let file = folder.join(RESULT);
    refuse_unnamed_item(result, &file)?;
    let dcc = dcc(result, issuer, language, &file)?;
    let certificate = with_attachment(certificate(result, None, issuer, language), Some(&dcc));
    let certificate = printed(&certificate, issuer, &file)?;
    Ok([(folder.join(DIGITAL_CERTIFICATE), dcc.into_bytes()), (folder.join(CERTIFICATE), certificate)])
}

/// Writes the analysis of noise and its plots to a folder.
///
/// # Errors
/// [`Error::Io`] when the folder does not take them.
pub fn write_noise(analysis: &NoiseAnalysis, folder: &Path) -> Result<(), Error> {
    let _claim = claim_folder(folder)?;
    let plots = noise_plots(analysis).into_iter();
    let plots = plots.map(|(name, plot)| (folder.join(name), plot.to_svg().into_bytes()));
    let analysis = (folder.join("noise.json"), analysis.to_json().into_bytes());
    Ok(write_together(&[analysis].into_iter().chain(plots).collect::<Vec<_>>())?)
}

/// A history that somebody names: with a line at least, which one that is just begun need not have.
fn lines_of_history(file: &Path, result: &CalibrationResult) -> Result<Vec<HistoryEntry>, Error> {
    /// Estimates of a part of a session and of the whole do not lie farther apart, in their standard uncertainties together.
    const FARTHEST: f64 = 10.0;
    let lines = read_history(file)?;
    let Some(last) = lines.last() else {
        return Err(Error::content(file, Place::Whole, "no whole line", "the history of a watch"));
    };
    // The model may have gained or lost unknowns since.
    let agrees = |estimate: &HistoryEstimate| {
        let own = result.parameter(&estimate.name).and_then(|own| own.value.zip(own.standard_uncertainty));
        let pair = own.zip(estimate.value.zip(estimate.standard_uncertainty));
        pair.is_none_or(|((own, u), (value, of_part))| (own - value).abs() <= FARTHEST * u.hypot(of_part))
    };
    let is_of_result = last.plateau <= result.plateaus.len() && last.estimates.iter().all(agrees);
    if is_of_result {
        return Ok(lines);
    }
    let expected = format!("that of the session of {}", result.session.unit());
    Err(Error::content(file, Place::Whole, "the history of another session", expected))
}

/// Draws the history in a folder beside it, if it holds one.
///
/// # Errors
/// [`Error`] when the history cannot be read or the folder does not take the plot.
pub fn write_history_plot(model: &MeasurementModel, folder: &Path) -> Result<(), Error> {
    let history = folder.join("watch-history.jsonl");
    if !history.exists() {
        return Ok(());
    }
    let parameters = model.parameters();
    let group_of = |name: &str| parameters.find(name).map(|j| parameters[j].group);
    if let Some(figure) = history_figure(&read_history(&history)?, &group_of, Language::English) {
        write_whole(&folder.join("watch-history.svg"), figure.drawings.concat().as_bytes())?;
    }
    Ok(())
}

/// Writes plots by their names, `NAME.svg`, into a folder, which is made if it is not there, and over none of the `inputs`.
///
/// # Errors
/// [`Error`] when the folder does not take them, or one of them was read.
pub fn write_plots(folder: &Path, plots: &[(impl Display, Plot)], inputs: &[PathBuf]) -> Result<(), Error> {
    let files: Vec<PathBuf> = plots.iter().map(|(name, _)| folder.join(format!("{name}.svg"))).collect();
    refuse_inputs(&files, inputs)?;
    let _claim = claim_folder(folder)?;
    let files = files.into_iter().zip(plots).map(|(file, (_, plot))| (file, plot.to_svg().into_bytes()));
    Ok(write_together(&files.collect::<Vec<_>>())?)
}

/// Refuses a certificate of an item that nothing identifies (ISO/IEC 17025, 7.8.2.1 g).
fn refuse_unnamed_item(result: &CalibrationResult, file: &Path) -> Result<(), Error> {
    if !result.session.unit_serial.is_empty() {
        return Ok(());
    }
    let expected = "the serial number under [unit] of the session, or --serial of a tumble: a certificate identifies its item \
                    (ISO/IEC 17025, 7.8.2.1 g)";
    Err(Error::content(file, Place::Whole, "a unit without a serial number", expected))
}

/// Who issues the documents of `result`, from the laboratory's file, with what its decision says of the unit.
///
/// # Errors
/// [`Error`] when the file is wrong, its limits are not those of a quantity of the result, or its picture cannot be shown.
pub fn read_issuer(file: &Path, result: &CalibrationResult) -> Result<Issuer, Error> {
    let laboratory = Laboratory::read(file)?;
    let parameters = result.parameters.iter();
    let parameters: Vec<Limitable> =
        parameters.map(|p| Limitable { name: &p.name, unit: &p.unit, group: p.group }).collect();
    let limits = laboratory.limits(file, &parameters)?;
    let unit = laboratory.decision.as_ref().map(|decision| UnitStatement::new(result, decision, limits));
    let logo = laboratory.logo(file).map(|file| read_picture(&file)).transpose()?;
    Ok(Issuer { file: file.to_owned(), laboratory, unit, past: None, logo })
}

/// The PDF file of a certificate of the result in `file`.
///
/// # Errors
/// [`Error`] naming the text with letters that the font lacks: they would be shown as question marks.
fn printed(certificate: &Document, issuer: &Issuer, file: &Path) -> Result<Vec<u8>, Error> {
    let refuse = |file: &Path, place, letters: String| {
        let expected = "letters of Latin, Greek and Cyrillic alphabets that the font of the PDF has; HTML and the digital \
                        certificate take all";
        Error::content(file, place, format!("the letters {letters}"), expected)
    };
    for (table, key, text) in issuer.laboratory.texts() {
        let letters = letters_without_glyph(text);
        if !letters.is_empty() {
            return Err(refuse(&issuer.file, Place::Key { table, key: key.to_owned() }, letters));
        }
    }
    pdf(certificate).map_err(|letters| refuse(file, Place::Whole, letters))
}

/// A certificate that carries its digital form.
fn with_attachment(certificate: Document, dcc: Option<&str>) -> Document {
    let attachment = dcc.map(|text| Attachment {
        name: DIGITAL_CERTIFICATE,
        media_type: "application/xml",
        bytes: text.as_bytes().to_vec(),
    });
    Document { attachment, ..certificate }
}

/// The result in `file` before an adjustment, beside that `after` it in `of`: of the same unit, and the laboratory has to say what it adjusted.
fn before(
    file: &Path,
    after: &CalibrationResult,
    of: &Path,
    laboratory: &Laboratory,
) -> Result<CalibrationResult, Error> {
    let before = CalibrationResult::read(file)?;
    let unit = |result: &CalibrationResult| result.session.unit();
    let refuse = |found: String, expected: String| Err(Error::content(file, Place::Whole, found, expected));
    if unit(&before) != unit(after) {
        return refuse(format!("a result of {}", unit(&before)), format!("one of {}", unit(after)));
    }
    if before.session == after.session && before.inputs == after.inputs {
        return refuse("the result itself".to_owned(), "a result from before the adjustment".to_owned());
    }
    let day = |result: &CalibrationResult| result.session.date.parse::<Date>().ok();
    if let (Some(earlier), Some(later)) = (day(&before), day(after))
        && earlier > later
    {
        return refuse(format!("a session of {earlier}"), format!("one of {later} or earlier"));
    }
    if laboratory.item.adjustment.is_none() {
        let expected = "[item] adjustment in the laboratory's file, what was adjusted between the two calibrations";
        return refuse("a result before an adjustment".to_owned(), expected.to_owned());
    }
    result_beside(before, file, after, of)
}

/// The digital certificate of the result in `file`.
fn dcc(result: &CalibrationResult, issuer: &Issuer, language: Language, file: &Path) -> Result<String, Error> {
    digital_certificate(result, issuer, language).map_err(|UnknownUnit { found }| {
        let expected = "a fraction of powers of m, s and rad such as s^2/m, or 1";
        Error::content(file, Place::Whole, format!("a parameter in {found:?}"), expected)
    })
}

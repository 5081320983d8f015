//! Writes the documents of a calibration: `cargo run --example 05_certificate`.

use std::error::Error;
use std::path::Path;

use centrical_report::{DocumentRequest, Language, write_documents};
use centrical_session::{Method, Session, calibrate, create_folder, unwatched};

/// Report, certificate, digital certificate and the compensation as source code; and the objections if there are any.
///
/// # Errors
/// If a file is wrong or cannot be written.
pub fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::temp_dir().join("centrical-05");
    create_folder(&folder)?;
    let session = Session::read(Path::new("examples/ta-200"))?;
    calibrate(&session, &[], Method::Exact, &unwatched)?.write(&folder.join("result.json"))?;

    let documents = write_documents(&DocumentRequest {
        result: folder.join("result.json"),
        html: Some(folder.join("report.html")),
        history: None,
        past: Vec::new(),
        pdf: Some(folder.join("certificate.pdf")),
        before: None,
        dcc: Some(folder.join("certificate.xml")),
        code: Some(folder.join("code")),
        range: None,
        laboratory: Some("examples/ta-200/laboratory.toml".into()),
        axes: None,
        language: Language::English,
    })?;
    println!("{}: {} objections", folder.display(), documents.result.objections().len());
    Ok(())
}

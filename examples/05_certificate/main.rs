//! Writes the report and the certificates of a calibration: `cargo run --example 05_certificate`.

use std::error::Error;
use std::path::Path;

use centrical_report::{Language, digital_certificate, html_report, objections, pdf_certificate};
use centrical_session::{Laboratory, Method, Session, calibrate, create_folder, write_whole};

/// HTML, PDF and DCC, and the objections if there are any.
///
/// # Errors
/// If a file is wrong or cannot be written.
pub fn main() -> Result<(), Box<dyn Error>> {
    let session = Session::read(Path::new("examples/ta-200"))?;
    let result = calibrate(&session, Method::Exact, &|_| ())?;
    let laboratory = Laboratory::read(Path::new("examples/ta-200/laboratory.toml"))?;

    let folder = std::env::temp_dir().join("centrical-05");
    create_folder(&folder)?;
    let english = Language::English;
    write_whole(&folder.join("report.html"), html_report(&result, english).as_bytes())?;
    write_whole(&folder.join("certificate.pdf"), &pdf_certificate(&result, None, &laboratory, english))?;
    write_whole(&folder.join("certificate.xml"), digital_certificate(&result, &laboratory, english).as_bytes())?;

    println!("{}: {} objections", folder.display(), objections(&result).len());
    Ok(())
}

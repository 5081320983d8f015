//! Calibrates a session folder and prints the biases: `cargo run --example 01_calibrate`.

use std::error::Error;
use std::path::Path;

use centrical::Group;
use centrical_session::{Method, Session, calibrate, unwatched};

/// From records to estimates.
///
/// # Errors
/// If a file is wrong; the message names the file, the place, what was found and what was expected.
pub fn main() -> Result<(), Box<dyn Error>> {
    let session = Session::read(Path::new("examples/ta-200"))?;
    let result = calibrate(&session, &[], Method::Exact, &unwatched)?;

    println!("{}: chi^2 {:.1}, {} degrees", session.title, result.fit.chi_squared, result.fit.degrees_of_freedom);
    for parameter in result.parameters.iter().filter(|parameter| parameter.group == Group::Bias) {
        // What the data do not determine has no value.
        match (parameter.value, parameter.standard_uncertainty) {
            (Some(value), Some(u)) => println!("{} = {value:.6} ± {u:.6} {}", parameter.name, parameter.unit),
            _ => println!("{} is not determined", parameter.name),
        }
    }
    Ok(())
}

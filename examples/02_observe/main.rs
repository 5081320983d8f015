//! Asks which parameters a planned experiment determines: `cargo run --example 02_observe`.

use std::error::Error;
use std::path::Path;

use centrical_session::{ObservabilityReport, subject, unwatched};

/// Rank, undetermined combinations, causes, and the cheapest remedy.
///
/// # Errors
/// If the plan file is wrong.
pub fn main() -> Result<(), Box<dyn Error>> {
    let subject = subject(Path::new("examples/plans/normalised.toml"), &unwatched)?;
    let report = ObservabilityReport::of(&subject, &[])?;

    println!("rank {} of {}", report.rank, report.columns);
    for combination in &report.lost {
        println!("{}: {}", combination.text, combination.reason);
    }
    if let Some(remedy) = report.remedies.first() {
        for step in &remedy.steps {
            println!("cheapest remedy: {}", step.text);
        }
    }
    Ok(())
}

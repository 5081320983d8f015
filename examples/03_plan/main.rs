//! Finds the best schedule for six hours: `cargo run --example 03_plan`.

use std::error::Error;
use std::path::Path;

use centrical_session::{PlanRequest, plan, unwatched};

/// The schedule with the smallest uncertainty, and how far from the optimum it can be.
///
/// # Errors
/// If the plan file is wrong, or no plan fits its time.
pub fn main() -> Result<(), Box<dyn Error>> {
    let request = PlanRequest {
        certify: false,
        frontier: Vec::new(),
        levels: Vec::new(),
        time: None,
        coverage: 0.95,
        outputs: Vec::new(),
    };
    let report = plan(Path::new("examples/03_plan/plan.toml"), &request, &unwatched)?;

    for mounting in &report.mountings {
        println!("position {} at {} m: {} plateaus", mounting.position, mounting.radius, mounting.plateaus.len());
    }
    println!(
        "{:.1} h; uncertainty {:.3e} m/s^2, no plan below {:.3e}",
        report.time / 3600.0,
        report.value,
        report.bound
    );
    Ok(())
}

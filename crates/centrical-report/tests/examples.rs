//! The numbered examples run, from the root of the repository.

use std::error::Error;

#[path = "../../../examples/01_calibrate/main.rs"]
mod calibrate;
#[path = "../../../examples/05_certificate/main.rs"]
mod certificate;
#[path = "../../../examples/02_observe/main.rs"]
mod observe;
#[path = "../../../examples/03_plan/main.rs"]
mod plan;
#[path = "../../../examples/04_watch/main.rs"]
mod watch;

#[test]
fn every_example_runs() -> Result<(), Box<dyn Error>> {
    std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))?;
    calibrate::main()?;
    observe::main()?;
    plan::main()?;
    watch::main()?;
    certificate::main()
}

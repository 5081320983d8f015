//! Processes a session plateau by plateau, as records arrive: `cargo run --example 04_watch`.

use std::error::Error;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use centrical::fit::Follower;
use centrical_session::{Session, Watch};

/// Rank and uncertainty of one coefficient after each plateau, and a test of the plateau before it is used.
///
/// # Errors
/// If a file is wrong, or a record has no plateau that its schedule has.
pub fn main() -> Result<(), Box<dyn Error>> {
    let session = Session::read(Path::new("examples/ta-200"))?;
    let model = session.model()?;
    let column = model.parameters().find("G1_11").ok_or("the error model has no G1_11")?;
    let mut follower = Follower::new(&model);
    // A record that has not changed for this time is complete.
    let mut watch = Watch::new(&session, Duration::ZERO, false);
    // Whoever raises it ends a look after the record that is read.
    let stop = AtomicBool::new(false);

    while !watch.is_complete() {
        for observation in watch.look(&stop)? {
            let arrival = follower.test(&observation)?;
            let test = arrival.innovation;
            follower.take(arrival)?;
            let now = follower.progress()?;
            let u = now.estimates[column].map_or("not determined".to_owned(), |(_, u)| format!("{u:.2e} s^2/m"));
            println!("rank {}, G1_11: {u}, probability of the plateau {:.2}", now.rank, test.probability);
        }
    }
    Ok(())
}

//! Calibrate newtonometer (accelerometer) triads on a precision centrifuge.
//!
//! From arguments to one job to an exit code: 0 done, 1 done but the result is not acceptable, 2 bad input or usage.

mod command;
mod format;
mod outcome;
mod progress;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use outcome::Outcome;

/// Calibrate newtonometer (accelerometer) triads on a precision centrifuge.
#[derive(Debug, Parser)]
#[command(version, arg_required_else_help = true, after_help = EXIT_CODES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 1 done, but the result is not acceptable (the reason is printed); \
                          2 bad input or usage.";

#[derive(Debug, Subcommand)]
enum Command {
    Calibrate(command::calibrate::Arguments),
    Reduce(command::reduce::Arguments),
    Compensate(command::compensate::Arguments),
    Simulate(command::simulate::Arguments),
    Report(command::report::Arguments),
    Assess(command::assess::Arguments),
    Montecarlo(command::montecarlo::Arguments),
    Models(command::models::Arguments),
    Compare(command::compare::Arguments),
    Noise(command::noise::Arguments),
    Observe(command::observe::Arguments),
    Plan(command::plan::Arguments),
    Watch(command::watch::Arguments),
}

fn main() -> ExitCode {
    let outcome = match Arguments::parse().command {
        Command::Calibrate(arguments) => command::calibrate::run(&arguments),
        Command::Reduce(arguments) => command::reduce::run(&arguments),
        Command::Compensate(arguments) => command::compensate::run(&arguments),
        Command::Simulate(arguments) => command::simulate::run(&arguments),
        Command::Report(arguments) => command::report::run(&arguments),
        Command::Assess(arguments) => command::assess::run(&arguments),
        Command::Montecarlo(arguments) => command::montecarlo::run(&arguments),
        Command::Models(arguments) => command::models::run(&arguments),
        Command::Compare(arguments) => command::compare::run(&arguments),
        Command::Noise(arguments) => command::noise::run(&arguments),
        Command::Observe(arguments) => command::observe::run(&arguments),
        Command::Plan(arguments) => command::plan::run(&arguments),
        Command::Watch(arguments) => command::watch::run(&arguments),
    };
    match outcome {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::NotAcceptable) => ExitCode::from(1),
        Err(error) => {
            eprintln!("centrical: {error}");
            ExitCode::from(2)
        }
    }
}

//! Calibrate newtonometer (accelerometer) triads on a precision centrifuge.
//!
//! From arguments to one job to an exit code: 0 done, 1 done but the result is not acceptable, 2 bad input or usage.

mod command;
mod format;
mod help;
mod interruption;
mod outcome;
mod output;
mod printing;
mod progress;

use std::io::{self, Write};
use std::process::ExitCode;

use centrical_session::Error;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use outcome::Outcome;
use output::{say, written};

/// Calibrate newtonometer (accelerometer) triads on a precision centrifuge.
#[derive(Debug, Parser)]
#[command(name = "centrical", version, arg_required_else_help = true, after_help = EXIT_CODES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 1 done, but the result is not acceptable (the reason is printed); \
                          2 bad input or usage.";

#[derive(Debug, Subcommand)]
enum Command {
    Init(command::init::Arguments),
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
    Schema(command::schema::Arguments),
    Completions(command::completions::Arguments),
    Man(command::man::Arguments),
}

fn main() -> ExitCode {
    interruption::prepare();
    let matches = help::grouped(Arguments::command()).try_get_matches();
    let outcome = match matches.and_then(|matches| Arguments::from_arg_matches(&matches)) {
        Ok(arguments) => run(arguments.command),
        Err(text) if text.use_stderr() => {
            // If standard error does not take it there is nobody to tell.
            let _ = text.print();
            return ExitCode::from(2);
        }
        Err(help) => written(help.print().and_then(|()| io::stdout().flush())).map(|()| Outcome::Done),
    };
    match outcome {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::NotAcceptable) => ExitCode::from(1),
        Err(error) => {
            say(&format!("centrical: {error}\n"));
            ExitCode::from(2)
        }
    }
}

fn run(command: Command) -> Result<Outcome, Error> {
    match command {
        Command::Init(arguments) => command::init::run(&arguments),
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
        Command::Schema(arguments) => command::schema::run(&arguments),
        Command::Completions(arguments) => command::completions::run(&arguments, &mut Arguments::command()),
        Command::Man(arguments) => command::man::run(&arguments, Arguments::command()),
    }
}

//! Calibrate newtonometer (accelerometer) triads on a precision centrifuge.
//!
//! From arguments to one job to an exit code: 0 done, 1 done but the result is not acceptable, 2 bad input or usage.

mod alarm;
mod command;
mod documents;
mod given;
mod help;
mod interruption;
mod output;
mod progress;
#[cfg(feature = "serve")]
mod serving;

use std::env;
use std::io::{self, Write};
use std::num::NonZero;
use std::process::ExitCode;
use std::sync::Mutex;
use std::thread;

use centrical_session::Error;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use rayon::ThreadPoolBuilder;

use output::{Outcome, say, written};

/// Calibrate newtonometer (accelerometer) triads on a precision centrifuge.
#[derive(Debug, Parser)]
#[command(name = "centrical", version, arg_required_else_help = true, after_help = EXIT_CODES, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

const EXIT_CODES: &str = "\
Exit codes: 0 done; 1 done, but the result is not acceptable (the reason is
printed, unless --quiet is given); 2 bad input or usage.";

#[derive(Debug, Subcommand)]
enum Command {
    Init(command::init::Arguments),
    Calibrate(command::calibrate::Arguments),
    Reduce(command::reduce::Arguments),
    Compensate(command::compensate::Arguments),
    Simulate(command::simulate::Arguments),
    Tumble(command::tumble::Arguments),
    Report(command::report::Arguments),
    Assess(command::assess::Arguments),
    Montecarlo(command::montecarlo::Arguments),
    Models(command::models::Arguments),
    Compare(command::compare::Arguments),
    Series(command::series::Arguments),
    History(command::history::Arguments),
    Noise(command::noise::Arguments),
    Observe(command::observe::Arguments),
    Plan(command::plan::Arguments),
    Watch(command::watch::Arguments),
    #[cfg(feature = "serve")]
    View(command::view::Arguments),
    Schema(command::schema::Arguments),
    Completions(command::completions::Arguments),
    Man(command::man::Arguments),
}

fn main() -> ExitCode {
    interruption::prepare();
    let matches = help::grouped(Arguments::command()).try_get_matches();
    let outcome = match matches.and_then(|matches| Arguments::from_arg_matches(&matches)) {
        Ok(arguments) => {
            make_do_with_few_threads();
            run(arguments.command)
        }
        Err(text) if text.use_stderr() => {
            say(&in_short(&text.render().to_string()));
            return ExitCode::from(2);
        }
        Err(help) => written(help.print().and_then(|()| io::stdout().flush())).map(|()| Outcome::Done),
    };
    match outcome {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::NotAcceptable) => ExitCode::from(1),
        Ok(Outcome::SomeFailed) => ExitCode::from(2),
        Err(error) => {
            say(&format!("centrical: {error}\n"));
            ExitCode::from(2)
        }
    }
}

/// Makes do with as many threads as the system gives, where it gives fewer than there are processors: a container may limit them.
fn make_do_with_few_threads() {
    /// Threads beside those that compute: of files that are written, and of a server.
    const OTHERS: usize = 3;
    if env::var_os("RAYON_NUM_THREADS").is_some() {
        return;
    }
    let processors = thread::available_parallelism().map_or(1, NonZero::get);
    let gate = Mutex::new(());
    let given = thread::scope(|scope| {
        // Each waits for the others.
        let _closed = gate.lock();
        let is_given = |_: &usize| thread::Builder::new().spawn_scoped(scope, || drop(gate.lock())).is_ok();
        (0..processors + OTHERS).take_while(is_given).count()
    });
    if given < processors + OTHERS {
        let count = given.saturating_sub(OTHERS);
        let builder = ThreadPoolBuilder::new().num_threads(count.max(1));
        let builder = if count == 0 { builder.use_current_thread() } else { builder };
        // An error is that of whoever needs the threads.
        let _ = builder.build_global();
    }
}

/// What is wrong with the arguments, of each long line its ends: what was given stands before what was expected.
fn in_short(text: &str) -> String {
    const LONGEST_END: usize = 400;
    let line = |line: &str| {
        let letters: Vec<char> = line.chars().collect();
        match letters.len().checked_sub(LONGEST_END) {
            Some(last) if last > LONGEST_END => {
                let [start, end]: [String; 2] =
                    [&letters[..LONGEST_END], &letters[last..]].map(|ends| ends.iter().collect());
                format!("{start} ... {end}\n")
            }
            _ => format!("{line}\n"),
        }
    };
    text.lines().map(line).collect()
}

fn run(command: Command) -> Result<Outcome, Error> {
    match command {
        Command::Init(arguments) => command::init::run(&arguments),
        Command::Calibrate(arguments) => command::calibrate::run(&arguments),
        Command::Reduce(arguments) => command::reduce::run(&arguments),
        Command::Compensate(arguments) => command::compensate::run(&arguments),
        Command::Simulate(arguments) => command::simulate::run(&arguments),
        Command::Tumble(arguments) => command::tumble::run(&arguments),
        Command::Report(arguments) => command::report::run(&arguments),
        Command::Assess(arguments) => command::assess::run(&arguments),
        Command::Montecarlo(arguments) => command::montecarlo::run(&arguments),
        Command::Models(arguments) => command::models::run(&arguments),
        Command::Compare(arguments) => command::compare::run(&arguments),
        Command::Series(arguments) => command::series::run(&arguments),
        Command::History(arguments) => command::history::run(&arguments),
        Command::Noise(arguments) => command::noise::run(&arguments),
        Command::Observe(arguments) => command::observe::run(&arguments),
        Command::Plan(arguments) => command::plan::run(&arguments),
        Command::Watch(arguments) => command::watch::run(&arguments),
        #[cfg(feature = "serve")]
        Command::View(arguments) => command::view::run(&arguments),
        Command::Schema(arguments) => command::schema::run(&arguments),
        Command::Completions(arguments) => command::completions::run(&arguments, &mut Arguments::command()),
        Command::Man(arguments) => command::man::run(&arguments, Arguments::command()),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// Commands without JSON: what they make is read by a shell and by `man`; the subcommands of `history` have their own.
    const WITHOUT_JSON: [&str; 4] = ["completions", "history", "man", "view"];
    /// Commands without `-q`: `watch` has another `--quiet`, `completions` prints no more than was asked for.
    const WITHOUT_QUIET: [&str; 4] = ["completions", "history", "view", "watch"];

    fn commands() -> Vec<clap::Command> {
        Arguments::command().get_subcommands().cloned().collect()
    }

    /// The words of the example in a command's help, as a shell splits them.
    fn example(command: &clap::Command) -> Vec<String> {
        let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
        let line = help.strip_prefix("Example: ").unwrap_or_else(|| panic!("{}: no example", command.get_name()));
        let line = line.split(" > ").next().unwrap_or_default();
        let outside = |(n, part): (usize, &str)| match n % 2 {
            0 => part.split_whitespace().map(str::to_owned).collect(),
            _ => vec![part.to_owned()],
        };
        line.split('\'').enumerate().flat_map(outside).collect()
    }

    #[test]
    fn the_description_of_the_program_is_sound() {
        help::grouped(Arguments::command()).debug_assert();
    }

    #[test]
    fn every_command_stands_in_exactly_one_group() {
        let mut grouped: Vec<&str> = help::GROUPS.iter().flat_map(|(_, names)| names.iter().copied()).collect();
        let mut known: Vec<String> = commands().iter().map(|command| command.get_name().to_owned()).collect();
        grouped.sort_unstable();
        known.sort_unstable();
        assert_eq!(grouped, known);
        let help = help::grouped(Arguments::command()).render_help().to_string();
        for name in known {
            assert_eq!(help.matches(&format!("\n  {name} ")).count(), 1, "{name}: {help}");
        }
        let widest = help.lines().map(|line| line.chars().count()).max();
        assert!(widest <= Some(80), "{widest:?} columns: {help}");
    }

    /// The frequent options have one short form each, everywhere, and no other option takes it.
    #[test]
    fn every_command_has_json_quiet_and_their_short_forms() {
        for command in commands() {
            let name = command.get_name();
            let takes = |long: &str, short: char| {
                let mut with = command.get_arguments().filter(|a| a.get_long() == Some(long));
                with.any(|a| a.get_short() == Some(short))
            };
            assert_eq!(takes("json", 'j'), !WITHOUT_JSON.contains(&name), "{name} --json");
            assert_eq!(takes("quiet", 'q'), !WITHOUT_QUIET.contains(&name), "{name} --quiet");
            for argument in command.get_arguments() {
                let expected = match argument.get_long() {
                    Some("out") => Some('o'),
                    Some("json") => Some('j'),
                    Some("quiet") if name != "watch" => Some('q'),
                    _ => None,
                };
                assert_eq!(argument.get_short(), expected, "{name} {:?}", argument.get_long());
            }
        }
    }

    /// Every example is one that the program takes, of its own command, on files of the repository where it names them.
    #[test]
    fn every_command_has_an_example_that_is_taken() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        for command in commands() {
            let words = example(&command);
            assert_eq!(words[..2], ["centrical", command.get_name()]);
            if let Err(error) = Arguments::try_parse_from(&words) {
                panic!("{words:?}: {error}");
            }
            for file in words.iter().filter(|word| word.starts_with("examples/")) {
                assert!(root.join(file).exists(), "{file}");
            }
        }
    }
}

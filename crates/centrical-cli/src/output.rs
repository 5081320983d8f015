//! The one way to the terminal: what cannot be written is an error, and what comes from files cannot command the terminal. Beside it how
//! a command prints, and how it ends.

use std::env;
use std::io::{self, ErrorKind, Write};
use std::path::Path;

use centrical_report::{Emphasis, Line, Screen};
use centrical_session::{Error, harmless, time_column};
use console::{Style, Term};

/// Lines and characters of a terminal that does not say how many it has, and of a pipe: what is written there does not depend on
/// the machine.
const USUAL: (u16, u16) = (24, 80);

/// Widest lines where nobody states a width: longer ones are hard to read.
const WIDEST: u16 = 120;

/// How a command ended that could do its work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Done.
    Done,
    /// Done, but the result is not acceptable; it was said why.
    NotAcceptable,
    /// Done, but some of many failed; it was said which.
    SomeFailed,
}

impl Outcome {
    /// The worst of many.
    pub fn of_series(failed: usize, not_acceptable: usize) -> Self {
        match (failed, not_acceptable) {
            (0, 0) => Self::Done,
            (0, _) => Self::NotAcceptable,
            _ => Self::SomeFailed,
        }
    }

    /// Done, and acceptable or not.
    pub fn acceptable(is_acceptable: bool) -> Self {
        if is_acceptable { Self::Done } else { Self::NotAcceptable }
    }
}

/// How a command prints.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct Printing {
    /// Print a JSON document instead of text; docs/json.md describes it
    #[arg(short, long)]
    pub json: bool,
    /// Print only what was asked for, without progress; messages of errors and the exit code stay
    #[arg(short, long)]
    pub quiet: bool,
}

impl Printing {
    /// Prints the JSON document if it was asked for, and the text unless the command is to be quiet.
    ///
    /// # Errors
    /// [`Error`] when the document cannot be made or standard output does not take it.
    pub fn show(
        self,
        text: impl FnOnce() -> Screen,
        json: impl FnOnce() -> Result<String, Error>,
    ) -> Result<(), Error> {
        match (self.json, self.quiet) {
            (true, _) => print(&json()?),
            (false, false) => show(&text()),
            (false, true) => Ok(()),
        }
    }
}

/// Shows a text in the width of the terminal, verdicts in colour where it has any.
///
/// # Errors
/// As [`print`].
pub fn show(screen: &Screen) -> Result<(), Error> {
    let terminal = Term::stdout();
    let text = drawn(screen, &terminal, console::colors_enabled());
    print_as_it_is(&text)
}

/// Shows a text on standard error. If that is closed or full there is nobody to tell.
pub fn remark(screen: &Screen) {
    let text = drawn(screen, &Term::stderr(), console::colors_enabled_stderr());
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// Remarks that the columns of time of these files are not used, beside a sampling rate that is.
pub fn remark_unused_time<'a>(files: impl IntoIterator<Item = &'a Path>) {
    for file in files {
        if let Some(column) = time_column(file) {
            let mut screen = Screen::default();
            screen.say(0, &format!("{}: the time in column {column} is not used, --rate is", file.display()));
            remark(&screen);
        }
    }
}

/// The lines of a text. Colour comes after what files say was made harmless.
fn drawn(screen: &Screen, terminal: &Term, is_coloured: bool) -> String {
    let (height, width) = terminal.size_checked().filter(|_| terminal.is_term()).unwrap_or(USUAL);
    let stated = env::var("COLUMNS").ok().and_then(|columns| columns.parse().ok());
    let line = |Line { mark, rest }: Line| {
        let mark = mark.map_or(String::new(), |(emphasis, mark)| {
            let mark = harmless(&mark);
            if is_coloured { style(emphasis).apply_to(mark).to_string() } else { mark.into_owned() }
        });
        format!("{mark}{}\n", harmless(&rest))
    };
    screen.lines(stated.unwrap_or(width.min(WIDEST).into()), height.into()).into_iter().map(line).collect()
}

/// How an emphasis looks where there is colour.
fn style(emphasis: Emphasis) -> Style {
    let style = Style::new().force_styling(true).bold();
    match emphasis {
        Emphasis::Acceptable => style.green(),
        Emphasis::NotAcceptable => style.red(),
        Emphasis::Warning => style.yellow(),
        Emphasis::Heading => style,
    }
}

/// Prints a text on standard output. A reader that has seen enough (`| head`) is not a failure; a full disk is.
///
/// # Errors
/// [`Error`] when standard output does not take the text.
pub fn print(text: &str) -> Result<(), Error> {
    print_as_it_is(&harmless(text))
}

/// Prints a text that may command the terminal.
///
/// # Errors
/// As [`print`].
pub fn print_as_it_is(text: &str) -> Result<(), Error> {
    let mut output = io::stdout().lock();
    written(output.write_all(text.as_bytes()).and_then(|()| output.flush()))
}

/// What became of writing to standard output.
///
/// # Errors
/// [`Error`] unless it was written or the reader has gone.
pub fn written(outcome: io::Result<()>) -> Result<(), Error> {
    match outcome {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Error::writing(Path::new("standard output"), error)),
        _ => Ok(()),
    }
}

/// Says what a command waits for.
pub fn say_waiting(note: &str) {
    say(&format!("{note}\n"));
}

/// Says something on standard error. If that is closed or full there is nobody to tell; the exit code still does.
pub fn say(text: &str) {
    let _ = io::stderr().lock().write_all(harmless(text).as_bytes());
}

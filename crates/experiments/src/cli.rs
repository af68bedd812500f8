//! The command line of `experiments`: one file per subcommand.

pub mod args;
pub mod audit;
mod cell;
pub mod check;
pub mod compare;
pub mod evaluate;
pub mod export;
mod fixed;
mod left_out;
pub mod list;
mod protocol;
pub mod report;
pub mod run;
mod speed;
pub mod watch;
mod work;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;

use crate::Error;
use args::{Cli, Command};

/// The whole binary: parses the command line, runs the subcommand, reports errors on stderr.
///
/// A reward plugin's own binary is two lines: `use my_rewards as _;` and a call of this function.
///
/// Returns 0 on success, 2 on bad input (nothing was written), 3 where `audit` finds a reward that pays best for not
/// arriving, 1 on any other failure.
pub fn main() -> ExitCode {
    let result = execute(&Cli::parse().command, &mut io::stdout().lock());
    match result {
        Ok(code) => code,
        Err(error) if is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            // Where even stderr is closed, the exit code must do.
            let _ = writeln!(io::stderr(), "error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}

fn execute(command: &Command, out: &mut dyn Write) -> Result<ExitCode, Error> {
    let done = match command {
        Command::Audit(args) => return audit::execute(args, out),
        Command::Check(args) => check::execute(args, out),
        Command::List(args) => list::execute(args, out),
        Command::Report(args) => report::execute(args, out),
        Command::Compare(args) => compare::execute(args, out),
        Command::Export(args) => export::execute(args, out),
        Command::Watch(args) => watch::execute(args, out),
        Command::Run(args) => run::execute(args, out),
        Command::Evaluate(args) => evaluate::execute(args, out),
    };
    done.map(|()| ExitCode::SUCCESS)
}

/// Whether the reader of our output has seen enough, as `head` has.
fn is_closed_pipe(error: &Error) -> bool {
    matches!(error, Error::Io { source, .. } if source.kind() == io::ErrorKind::BrokenPipe)
}

/// Writes `text` to the output.
fn print(out: &mut dyn Write, text: &str) -> Result<(), Error> {
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    written.map_err(|error| Error::io("write", "the output".as_ref(), error))
}

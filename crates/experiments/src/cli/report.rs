//! `experiments report`.

use std::io::{self, Write};

use super::args::{ReportArgs, ReportFormat};
use super::print;
use crate::error::Error;
use crate::report;

/// Prints the report on a results folder to `out`, or a list of its runs; with a format for machines, what a reader must know of it goes to
/// stderr.
///
/// # Errors
/// [`Error::Input`] if the folder holds no results or a file in it is damaged, [`Error::Io`] if it cannot be read or `out`
/// cannot be written to.
pub fn execute(args: &ReportArgs, out: &mut dyn Write) -> Result<(), Error> {
    let report = report::load(&args.dir)?;
    if args.runs {
        return print(out, &report.runs_table());
    }
    match args.format {
        ReportFormat::Table => return print(out, &report.table()), // ends with the notes
        ReportFormat::Json => print(out, &report.json())?,
        ReportFormat::Csv => print(out, &report.csv())?,
    }
    for note in report.notes() {
        // Where even stderr is closed, nobody misses it.
        let _ = writeln!(io::stderr(), "{note}");
    }
    Ok(())
}

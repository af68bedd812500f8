//! `experiments compare`.

use std::io::{self, Write};

use super::args::{CompareArgs, CompareFormat};
use super::print;
use crate::Error;
use crate::report;

/// Prints the levels of an axis against one of them to `out`; in what settings they differ, and what else a reader must
/// know of the runs, goes to stderr.
///
/// # Errors
/// [`Error::Input`] if the folder holds no results, a file in it is damaged, or the grid has no such axis or level; [`Error::Io`]
/// if the folder cannot be read, or `out` cannot be written to.
pub fn execute(args: &CompareArgs, out: &mut dyn Write) -> Result<(), Error> {
    let report = report::load(&args.dir)?;
    let contrasts = report.contrasts(&args.over, args.base.as_deref())?;
    let text = match args.format {
        CompareFormat::Table => contrasts.table(&args.metric),
        CompareFormat::Json => contrasts.json(),
        CompareFormat::Csv => contrasts.csv(),
    };
    print(out, &text)?;
    for note in contrasts.settings(&args.dir)?.into_iter().chain(report.notes()) {
        // Where even stderr is closed, nobody misses it.
        let _ = writeln!(io::stderr(), "{note}");
    }
    Ok(())
}

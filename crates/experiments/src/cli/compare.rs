//! `experiments compare`.

use std::io::{self, Write};

use super::args::{CompareArgs, CompareFormat};
use super::print;
use crate::Error;
use crate::report;

/// Prints the levels of an axis against one of them to `out`; what else a reader must know of the runs goes to stderr, and with CSV in
/// what settings the levels differ.
///
/// # Errors
/// [`Error::Input`] if the folder holds no results, a file in it is damaged, or the grid has no such axis or level; [`Error::Io`]
/// if the folder cannot be read, or `out` cannot be written to.
pub fn execute(args: &CompareArgs, out: &mut dyn Write) -> Result<(), Error> {
    let report = report::load(&args.dir)?;
    let contrasts = report.contrasts(&args.over, args.base.as_deref())?.with_settings(&args.dir)?;
    let text = match args.format {
        CompareFormat::Table => contrasts.table(&args.metric),
        CompareFormat::Json => contrasts.json(),
        CompareFormat::Csv => contrasts.csv(),
    };
    print(out, &text)?;
    let settings = if args.format == CompareFormat::Csv { contrasts.settings_in_words() } else { Vec::new() };
    for note in settings.into_iter().chain(report.notes()) {
        // Where even stderr is closed, nobody misses it.
        let _ = writeln!(io::stderr(), "{note}");
    }
    Ok(())
}

//! `experiments export`.

use std::io::{self, Write};

use super::args::ExportArgs;
use super::print;
use crate::Error;
use crate::export::{Export, ExportedFile};

/// Writes a results folder as Parquet files and prints their paths to `out`; what a reader must know of them goes to stderr.
///
/// # Errors
/// [`Error::Input`] if the folder holds no results, a file in it is damaged, an episode is asked for that is not there, or the place for
/// the tables is no folder; [`Error::Io`] if the folder cannot be read, or `out` or a file cannot be written to.
pub fn execute(args: &ExportArgs, out: &mut dyn Write) -> Result<(), Error> {
    let folder = args.out.clone().unwrap_or_else(|| args.dir.join("tables"));
    if folder.exists() && !folder.is_dir() {
        return Err(Error::Input(format!("--out {}: is a file; give a folder", folder.display())));
    }
    let export = Export::write(&args.dir, &folder, &args.choice())?;
    let line = |file: &ExportedFile| {
        format!("{} ({} rows, {:.2} MB)\n", file.path.display(), file.n_rows, file.n_bytes as f64 / 1e6)
    };
    print(out, &export.files.iter().map(line).collect::<String>())?;
    for note in export.notes {
        // Where even stderr is closed, nobody misses it.
        let _ = writeln!(io::stderr(), "{note}");
    }
    Ok(())
}

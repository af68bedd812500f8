//! `experiments report`.

use std::io::{self, Write};
use std::path::Path;

use super::args::{ReportArgs, ReportFormat};
use super::print;
use crate::error::Error;
use crate::report::{self, FigureFormat, Study, Trajectories};

/// Prints the report on a results folder to `out`, or a list of its runs, or writes it to files; with a format for machines,
/// what a reader must know of it goes to stderr.
///
/// # Errors
/// [`Error::Input`] if the folder holds no results, a file in it is damaged or an option does not go with the format;
/// [`Error::Io`] if the folder cannot be read, or `out` or a file cannot be written to.
pub fn execute(args: &ReportArgs, out: &mut dyn Write) -> Result<(), Error> {
    if args.scale.is_some() && args.format != ReportFormat::Png {
        return Err(Error::Input("--scale goes with --format png".into()));
    }
    if args.runs && matches!(args.format, ReportFormat::Html | ReportFormat::Svg | ReportFormat::Png) {
        return Err(Error::Input("--runs goes with --format table, json or csv".into()));
    }
    let notes = match args.format {
        ReportFormat::Html => write_page(args, out)?,
        ReportFormat::Svg => write_figures(args, FigureFormat::Svg, out)?,
        ReportFormat::Png => {
            let scale = args.scale.unwrap_or(2.0);
            write_figures(args, FigureFormat::Png { scale }, out)?
        }
        ReportFormat::Table | ReportFormat::Json | ReportFormat::Csv => print_report(args, out)?,
    };
    for note in notes {
        // Where even stderr is closed, nobody misses it.
        let _ = writeln!(io::stderr(), "{note}");
    }
    Ok(())
}

/// Prints text; the notes that are not in it.
fn print_report(args: &ReportArgs, out: &mut dyn Write) -> Result<Vec<String>, Error> {
    if args.out.is_some() || args.drives.is_some() || !args.drive.is_empty() {
        return Err(Error::Input("--out, --drives and --drive go with --format html, svg or png".into()));
    }
    let report = report::load(&args.dir)?;
    let text = match (args.format, args.runs) {
        (ReportFormat::Json, false) => report.json(),
        (ReportFormat::Json, true) => report.runs_json(),
        (ReportFormat::Csv, false) => report.csv(),
        (ReportFormat::Csv, true) => report.runs_csv(),
        (_, false) => report.table(),
        (_, true) => report.runs_table(),
    };
    print(out, &text)?;
    // Tables end with the notes.
    Ok(if args.format == ReportFormat::Table { Vec::new() } else { report.notes() })
}

fn write_page(args: &ReportArgs, out: &mut dyn Write) -> Result<Vec<String>, Error> {
    let path = args.out.clone().unwrap_or_else(|| args.dir.join("report.html"));
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(Error::Input(format!("--out {}: there is no folder `{}`", path.display(), folder.display())));
    }
    let study = Study::load(&args.dir, &args.choice(), Trajectories::Dropped)?;
    let page = study.html(folder);
    std::fs::write(&path, &page).map_err(|error| Error::io("write", &path, error))?;
    print(out, &format!("{} ({:.1} MB)\n", path.display(), page.len() as f64 / 1e6))?;
    Ok(study.report.notes())
}

fn write_figures(args: &ReportArgs, format: FigureFormat, out: &mut dyn Write) -> Result<Vec<String>, Error> {
    let folder = args.out.clone().unwrap_or_else(|| args.dir.join("figures"));
    let study = Study::load(&args.dir, &args.choice(), Trajectories::Kept)?;
    let written = study.write_figures(&folder, format)?;
    let lines: String = written.paths.iter().map(|path| format!("{}\n", path.display())).collect();
    print(out, &lines)?;
    Ok([study.report.notes(), written.notes].concat())
}

//! `experiments watch`: a grid as it is made.

use std::fmt::Write as _;
use std::io::Write;
use std::thread;
use std::time::Duration;

use console::{Style, Term, truncate_str};

use super::args::WatchArgs;
use super::print;
use crate::Error;
use crate::watch::{Stage, Tone, View, Watcher};

/// The time between two looks.
const PERIOD: Duration = Duration::from_secs(1);
/// The size of what is no terminal.
const PAGE: (usize, usize) = (160, usize::MAX);

/// Shows the runs of a results folder; on a terminal again and again, in the same place, until all are done or damaged.
///
/// # Errors
/// [`Error::Input`] if the folder holds no results, [`Error::Io`] if it cannot be read or `out`
/// cannot be written to.
pub fn execute(args: &WatchArgs, out: &mut dyn Write) -> Result<(), Error> {
    let (mut watcher, term) = (Watcher::new(&args.dir), Term::stdout());
    if args.once || !term.is_term() {
        let (index, runs) = watcher.look()?;
        return print(out, &page(&View::new(&index, &runs, PAGE.0, PAGE.1)));
    }
    let mut n_shown = 0;
    loop {
        let (index, runs) = watcher.look()?;
        let (n_lines, n_columns) = term.size();
        let view = View::new(&index, &runs, n_columns.into(), n_lines.into());
        let (text, n) = screen(&view, n_columns.into());
        let up = if n_shown > 0 { format!("\x1b[{n_shown}A\r") } else { String::new() };
        print(out, &format!("{up}{text}\x1b[J"))?;
        n_shown = n;
        if runs.iter().all(|run| matches!(run.stage, Stage::Done | Stage::Damaged)) {
            return Ok(());
        }
        thread::sleep(PERIOD);
    }
}

/// The view without colours.
fn page(view: &View) -> String {
    view.lines.iter().fold(format!("{}\n\n", view.title), |text, (line, _)| text + line + "\n")
}

/// The view for a terminal, each line cut to its width and cleared to its end; and how many lines it has.
fn screen(view: &View, n_columns: usize) -> (String, usize) {
    let mut text = String::new();
    let title = [(view.title.as_str(), Style::new().bold()), ("", Style::new())];
    let table = view.lines.iter().map(|(line, tone)| (line.as_str(), style(*tone)));
    let mut n_lines = 0;
    for (line, style) in title.into_iter().chain(table) {
        // Writing to a string cannot fail.
        let _ = write!(text, "{}\x1b[K\r\n", style.apply_to(truncate_str(line, n_columns, "…")));
        n_lines += 1;
    }
    (text, n_lines)
}

fn style(tone: Tone) -> Style {
    match tone {
        Tone::Plain => Style::new(),
        Tone::Active => Style::new().cyan(),
        Tone::Faint => Style::new().dim(),
        Tone::Alarm => Style::new().red(),
    }
}

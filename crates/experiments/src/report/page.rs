//! A study as one HTML page that needs nothing beside it: no network, no library, no font.

mod budget;
mod cells;
mod comparison;
mod links;
mod results;
mod runs;
mod text;

use std::path::Path;

use serde::Serialize;

use super::Row;
use super::figures::{Figure, Figures};
use super::study::{ASKED, Choice, Counts, Drive, Study};
use super::table::{self, number};
use crate::episode::{Metric, Quantity};
use crate::plot::colour::VIRIDIS;
use budget::Shown;
use links::relative;
use text::{escaped, fill, in_script};

const TEMPLATE: &str = include_str!("html/page.html");
const STYLE: &str = include_str!("html/page.css");
const SCRIPTS: [&str; 6] = [
    include_str!("html/trace.js"),
    include_str!("html/surface.js"),
    include_str!("html/scene.js"),
    include_str!("html/player.js"),
    include_str!("html/sort.js"),
    include_str!("html/page.js"),
];

/// What the page's scripts are given.
#[derive(Serialize)]
struct Data<'a> {
    /// As `--format json` has them.
    rows: &'a [Row],
    /// What each row is called.
    labels: Vec<String>,
    drives: &'a [&'a Drive],
    /// The colours of speeds, from none to the greatest.
    viridis: [[u8; 3]; 9],
}

impl Study {
    /// The page, to be put into `folder`: its links to the runs' folders lead from there.
    pub fn html(&self, folder: &Path) -> String {
        let shown = Shown::of(self);
        let root = relative(folder, &self.folder);
        let figures = self.figures();
        let labels: Vec<String> = (0..self.report.rows.len()).map(|row| self.row_label(row)).collect();
        let data = Data { rows: &self.report.rows, labels, drives: &shown.drives, viridis: VIRIDIS };
        let meaning = [Some(self.report.meaning()), self.report.caution(&Metric::ALL).map(str::to_owned)];
        let meaning: Vec<String> = meaning.into_iter().flatten().collect();
        let parts = [
            ("title", escaped(&self.name)),
            ("style", STYLE.to_owned()),
            ("lead", self.lead()),
            ("notes", self.notes(&shown)),
            ("meaning", escaped(&meaning.join(" "))),
            ("definitions", escaped(table::DEFINITIONS)),
            ("results", self.results()),
            ("cells", self.cells_section()),
            ("rule", escaped(Choice::RULE)),
            ("drives", self.options(&shown)),
            ("figures", self.sections(&figures)),
            ("runs", self.run_tables(&root, &shown)),
            ("data", in_script(&data)),
            ("script", SCRIPTS.concat()),
        ];
        fill(TEMPLATE, &parts)
    }

    /// What a row is called: its cell and its world.
    fn row_label(&self, row: usize) -> String {
        format!("{} · {}", self.label(self.places[row].cell), self.report.rows[row].world)
    }

    /// Where the numbers come from.
    fn lead(&self) -> String {
        let mut seeds: Vec<u64> = self.report.runs.iter().map(|run| run.seed).collect();
        seeds.sort_unstable();
        seeds.dedup();
        let seeds = match &seeds[..] {
            [] => "none".to_owned(),
            [seed] => seed.to_string(),
            [first, .., last] if last - first + 1 == seeds.len() as u64 => format!("{first} to {last}"),
            all => all.iter().map(u64::to_string).collect::<Vec<_>>().join(", "),
        };
        let n_episodes: usize = self.report.rows.iter().map(|row| row.n_episodes).sum();
        let counted = |counts: &Counts| match counts.len() {
            1 => counts.keys().next().cloned().unwrap_or_default(),
            _ => counts.iter().map(|(value, n)| format!("{value} ({n} runs)")).collect::<Vec<_>>().join(", "),
        };
        let (n_collapsed, n_trained) = self.report.n_collapsed();
        let collapsed =
            (n_trained > 0).then(|| ("Collapsed", format!("{n_collapsed} of {n_trained} runs, in a world or all")));
        let facts = [
            ("Spec", self.name.clone()),
            ("Cells", self.cells.len().to_string()),
            ("Training seeds", seeds),
            ("Runs complete", format!("{} of {}", self.report.n_complete, self.report.n_runs)),
        ];
        let rest = [
            ("Worlds", self.worlds().join(", ")),
            ("Episodes", n_episodes.to_string()),
            ("Results version", counted(&self.versions)),
            ("Code revision", counted(&self.revisions)),
        ];
        let fact = |(name, value): &(&str, String)| format!("<div><dt>{name}</dt><dd>{}</dd></div>", escaped(value));
        facts.iter().chain(&collapsed).chain(&rest).map(fact).collect()
    }

    /// What a reader must know before trusting the numbers.
    fn notes(&self, shown: &Shown<'_>) -> String {
        let mut notes = self.report.notes();
        notes.extend(shown.note());
        let lines: String = notes.iter().map(|note| format!("<li>{}</li>", escaped(note))).collect();
        if lines.is_empty() { lines } else { format!("<ul class=\"notes\" aria-label=\"Notes\">{lines}</ul>") }
    }

    /// The choice of drives.
    fn options(&self, shown: &Shown<'_>) -> String {
        let option = |(number, drive): (usize, &&Drive)| {
            let text = format!("{}: {}", self.row_label(drive.row), self.said(drive));
            format!("<option value=\"{number}\">{}</option>", escaped(&text))
        };
        shown.drives.iter().enumerate().map(option).collect()
    }

    /// What a drive is called in lists: with the share of the cell's episodes that end as it does, so that nobody takes the
    /// rare for the usual.
    fn said(&self, drive: &Drive) -> String {
        let Drive { seed, scenario, why, duration, outcome, .. } = drive;
        let share = self.report.rows[drive.row].estimate(Metric::share_of(*outcome)).mean;
        let share = share.map(|share| format!("{} % of episodes end so", number(share, Quantity::Rate)));
        // The others' names say how they end.
        let name = (*why == ASKED).then(|| outcome.name().to_owned());
        let known: Vec<String> = name.into_iter().chain(share).collect();
        format!("{why} ({}), seed {seed}, scenario {scenario}, {duration:.1} s", known.join("; "))
    }

    fn sections(&self, figures: &Figures) -> String {
        let Figures { speed, intervals, comparison, curves, clearance } = figures;
        [
            section("speed", "Success against speed", speed, ""),
            section("intervals", "Intervals", intervals, ""),
            section("contrasts", "One axis at a time", &[], &self.contrast_tables()),
            section("comparison", "Cells beside each other", comparison, &self.ranking_tables()),
            section("curves", "Learning curves", curves, ""),
            section("clearance", "Speed against clearance", clearance, ""),
        ]
        .concat()
    }
}

fn section(id: &str, title: &str, figures: &[Figure], rest: &str) -> String {
    if figures.is_empty() && rest.is_empty() {
        return String::new();
    }
    let mut html = String::new();
    for (k, this) in figures.iter().enumerate() {
        // A caption that says what the last one said is left out.
        let is_told = k > 0 && figures[k - 1].caption == this.caption;
        html += &figure(this, if is_told { "" } else { &this.caption });
    }
    format!("<section id=\"{id}\"><h2>{title}</h2><div class=\"figures\">{html}</div>{rest}</section>\n")
}

fn figure(Figure { name, title, caption: _, svg, narrow, is_wide }: &Figure, caption: &str) -> String {
    let (name, title, caption) = (escaped(name), escaped(title), escaped(caption));
    let class = if *is_wide { "wide" } else { "narrow" };
    format!(
        "<figure class=\"{class}\" data-name=\"{name}\"><div class=\"head\"><h3>{title}</h3></div>\
         <div class=\"chart\" role=\"img\" aria-label=\"{title}\"><div class=\"at-wide\">{svg}</div>\
         <div class=\"at-narrow\">{narrow}</div></div>\
         <figcaption>{caption}</figcaption></figure>\n"
    )
}

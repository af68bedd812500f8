//! The runs for programs: JSON and CSV.

use serde::ser::{Serialize, SerializeMap, Serializer};

use super::{Policy, RunRow};
use crate::collapse::Collapse;
use crate::episode::{Metric, SeedSummary};
use crate::report::Report;
use crate::report::csv::written;
use crate::report::json::Levels;

/// The columns of a run in CSV, beside those of the axes and of the metrics.
const COLUMNS: [&str; 7] = ["seed", "id", "policy", "path", "world", "episodes", "collapse"];

impl Report {
    /// The runs as a JSON list of objects: `axes` (level by axis), `seed`, `id`, `policy` (`trained`, `none_trained`, `damaged` or
    /// `unfinished`), its `path` (or `null`), `collapse` (a list of its verdicts: see [`Collapse`]), and
    /// `worlds`: by name its `episodes` and each [`Metric`], `null` where undefined; a world is `null` that it was not evaluated in.
    /// Rates are shares in [0, 1].
    pub fn runs_json(&self) -> String {
        let text = serde_json::to_string_pretty(&self.runs);
        text.expect("maps with string keys and numbers always have a JSON form") + "\n"
    }

    /// The runs as CSV with a header, a row for each in each of its worlds: the axes, `seed`, `id`, `policy` and `path` as in
    /// [`runs_json`](Self::runs_json), `world`, `episodes`, `collapse` (the kinds of the verdicts by its training or in that world, with a
    /// blank between them), and each [`Metric`]; empty where undefined.
    pub fn runs_csv(&self) -> String {
        let metrics = Metric::ALL.iter().map(|metric| metric.name());
        let header = self.axes.iter().map(String::as_str).chain(COLUMNS).chain(metrics).map(str::to_owned).collect();
        let of_run = |run: &RunRow| -> Vec<Vec<String>> {
            run.summaries.iter().map(|(world, summary)| record(run, world, summary.as_ref())).collect()
        };
        written(std::iter::once(header).chain(self.runs.iter().flat_map(of_run)))
    }
}

fn record(run: &RunRow, world: &str, summary: Option<&SeedSummary>) -> Vec<String> {
    let text = |number: Option<f64>| number.map_or_else(String::new, |number| number.to_string());
    let kinds: Vec<&str> = run.collapse_in(world).map(Collapse::kind).collect();
    let n_episodes = summary.map_or(0, |summary| summary.n_episodes);
    let mut fields: Vec<String> = run.axes.iter().map(|level| level.level.clone()).collect();
    fields.extend([run.seed.to_string(), run.train_id.to_string(), run.policy.name().to_owned()]);
    fields.extend([run.policy.path(), world.to_owned(), n_episodes.to_string(), kinds.join(" ")]);
    fields.extend(Metric::ALL.map(|metric| text(summary.and_then(|summary| metric.of(summary)))));
    fields
}

impl Policy {
    /// What there is of it in one word, for programs.
    fn name(&self) -> &'static str {
        match self {
            Self::At(_) => "trained",
            Self::NotTrained => "none_trained",
            Self::Damaged => "damaged",
            Self::Unfinished => "unfinished",
        }
    }

    /// The path of its file; empty if there is none.
    fn path(&self) -> String {
        if let Self::At(path) = self { path.display().to_string() } else { String::new() }
    }
}

impl Serialize for RunRow {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let path = Some(self.policy.path()).filter(|path| !path.is_empty());
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("axes", &Levels(&self.axes))?;
        map.serialize_entry("seed", &self.seed)?;
        map.serialize_entry("id", self.train_id.as_str())?;
        map.serialize_entry("policy", self.policy.name())?;
        map.serialize_entry("path", &path)?;
        map.serialize_entry("collapse", &self.collapse)?;
        map.serialize_entry("worlds", &Worlds(&self.summaries))?;
        map.end()
    }
}

/// What a run is worth in each world.
struct Worlds<'a>(&'a [(String, Option<SeedSummary>)]);

impl Serialize for Worlds<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(world, summary)| (world, summary.as_ref().map(Numbers))))
    }
}

/// The metrics of a run in a world.
struct Numbers<'a>(&'a SeedSummary);

impl Serialize for Numbers<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("episodes", &self.0.n_episodes)?;
        for metric in Metric::ALL {
            map.serialize_entry(metric.name(), &metric.of(self.0))?;
        }
        map.end()
    }
}

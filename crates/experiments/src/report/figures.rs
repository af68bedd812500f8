//! The figures of a study, as a page shows them and as files for papers.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::Row;
use super::chart::{Bar, Breadth, Column, Facet, IntervalChart, LineChart, ScatterChart, Series, Shape, Spot, XRange};
use super::study::{Aggregate, Comparison, Curves, N_CLEARANCE_EPISODES, Point, Study};
use super::table::{header_words, number};
use crate::Error;
use crate::episode::{Metric, Quantity};
use crate::plot::{self, PngError, PngRenderer};

/// Most cells whose lines share a frame.
const MAX_LINES: usize = 6;

/// A frame of lines.
type Lines = Facet<Vec<Point>>;

/// One figure of a study.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// Its name, and that of its file without the ending.
    pub name: String,
    /// What it is of.
    pub title: String,
    /// What its marks are.
    pub caption: String,
    /// The SVG, which stands alone.
    pub svg: String,
    /// The same for windows as narrow as a phone's: what stands side by side there stands one below the other here.
    pub narrow: String,
    /// Whether it takes the whole width of a page.
    pub is_wide: bool,
}

/// What figures are written as.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FigureFormat {
    /// SVG.
    Svg,
    /// PNG.
    Png {
        /// Pixels for each of the SVG's, positive.
        scale: f64,
    },
}

/// What [`Study::write_figures`] left behind.
#[derive(Debug)]
pub struct WrittenFigures {
    /// The files.
    pub paths: Vec<PathBuf>,
    /// What a reader must know before trusting the pictures, one line each.
    pub notes: Vec<String>,
}

/// The figures of a study by what they tell.
#[derive(Debug)]
pub(super) struct Figures {
    pub(super) speed: Vec<Figure>,
    pub(super) intervals: Vec<Figure>,
    pub(super) comparison: Vec<Figure>,
    pub(super) curves: Vec<Figure>,
    pub(super) clearance: Vec<Figure>,
}

impl Study {
    /// Writes every figure to a folder, which is made if need be: success against speed, intervals, comparisons, learning curves and speeds
    /// over clearance, and, if the study was loaded with them, every drive.
    ///
    /// # Errors
    /// [`Error::Input`], before anything is written, if a PNG would be too large; [`Error::Io`] if a file cannot be written.
    pub fn write_figures(&self, folder: &Path, format: FigureFormat) -> Result<WrittenFigures, Error> {
        let Figures { speed, intervals, comparison, curves, clearance } = self.figures();
        let charts = [speed, intervals, comparison, curves, clearance].concat();
        let charts = charts.into_iter().map(|figure| (figure.name, figure.svg));
        let drives = self.drives().filter_map(|drive| {
            let Row { axes, world, .. } = &self.report.rows[drive.row];
            let cell: Vec<&str> = axes.iter().map(|level| level.level.as_str()).collect();
            let name = format!("drive-{}-{world}-{}-{}", cell.join("-"), drive.seed, drive.scenario);
            Some((file_name(&name), plot::figure(drive.trajectory.as_ref()?)))
        });
        let figures: Vec<(String, String)> = charts.chain(drives).collect();
        match format {
            FigureFormat::Svg => {
                let paths = write_all(folder, "svg", figures, |svg| Ok(svg.into_bytes()))?;
                Ok(WrittenFigures { paths, notes: Vec::new() })
            }
            FigureFormat::Png { scale } => {
                let renderer = PngRenderer::default();
                let notes = check_png(&renderer, &figures, scale)?;
                let png = |svg: String| renderer.picture(&svg)?.png(scale);
                let paths = write_all(folder, "png", figures, |svg| png(svg).map_err(Error::failure))?;
                Ok(WrittenFigures { paths, notes })
            }
        }
    }

    /// All figures but those of drives.
    pub(super) fn figures(&self) -> Figures {
        Figures {
            speed: self.worlds().into_iter().map(|world| self.speed(world)).collect(),
            intervals: self.worlds().into_iter().map(|world| self.intervals(world)).collect(),
            comparison: self.comparison(),
            curves: self.curves.iter().map(|curves| self.learning_curve(curves)).collect(),
            clearance: self.clearance(),
        }
    }

    fn speed(&self, world: &str) -> Figure {
        let rows = self.rows_of(world);
        let row_of = |cell| rows.iter().copied().find(|row| self.places[*row].cell == cell);
        let [x, y] = [Metric::MeanSpeed, Metric::Success].map(header_words);
        let chart = ScatterChart {
            x_label: format!("{} ({})", x.0, x.1),
            y_label: format!("{} ({})", y.0, y.1),
            y_top: 100.0,
            facets: self.facets(|cell| self.spot(row_of(cell)?)),
        };
        Figure {
            name: file_name(&format!("speed-{world}")),
            title: format!("World {world}"),
            caption: "Right is faster; up is where more goals are reached. Marks (hollow, so that none hides another): mean over the training seeds; thin bars: 95 % percentile \
                      bootstrap intervals of both over the seeds, from three seeds on."
                .into(),
            svg: chart.svg(Breadth::Wide),
            narrow: chart.svg(Breadth::Narrow),
            is_wide: chart.facets.len() > 1,
        }
    }

    /// The mark of a row: its success over its mean speed.
    fn spot(&self, row: usize) -> Option<Spot> {
        let [speed, success] = [Metric::MeanSpeed, Metric::Success].map(|metric| self.bar(row, metric));
        let (speed, success) = (speed?, success?);
        Some(Spot {
            at: [speed.mean, success.mean],
            bands: [speed.interval, success.interval],
            tip: format!("{}\n{}", success.tip, speed.tip),
        })
    }

    fn intervals(&self, world: &str) -> Figure {
        let rows = self.rows_of(world);
        let shown = [
            Metric::Success,
            Metric::Collision,
            Metric::Timeout,
            Metric::MeanSpeed,
            Metric::NeedlessDecelerationsPerM,
            Metric::MeanJerk,
        ];
        let column = |metric: Metric| {
            let (title, unit) = header_words(metric);
            let bars = rows.iter().map(|row| self.bar(*row, metric)).collect();
            let most = match metric.quantity() {
                Quantity::Rate => 100.0,
                Quantity::Score => 1.0,
                Quantity::Speed | Quantity::PerMetre | Quantity::Jerk => f64::INFINITY,
            };
            let unit = if unit.is_empty() { "share".into() } else { unit };
            Column { title, unit, bars, bounds: [0.0, most] }
        };
        let chart = IntervalChart {
            rows: rows.iter().map(|row| self.label(self.places[*row].cell)).collect(),
            columns: shown.into_iter().map(column).collect(),
        };
        Figure {
            name: file_name(&format!("intervals-{world}")),
            title: format!("World {world}"),
            caption:
                "Ticks: mean over the training seeds; bars: its 95 % percentile bootstrap interval over the seeds, from three seeds on \
                      (where it is no wider than the tick, only that shows); dots below: the seeds. Each axis is fitted to what it \
                      shows, from the value at its left end to that at its right, and need not start at 0."
                    .into(),
            svg: chart.svg(Breadth::Wide),
            narrow: chart.svg(Breadth::Narrow),
            is_wide: true,
        }
    }

    fn bar(&self, row: usize, metric: Metric) -> Option<Bar> {
        let (place, numbers) = (&self.places[row], &self.report.rows[row]);
        let factor = if metric.quantity() == Quantity::Rate { 100.0 } else { 1.0 };
        // Of values beyond all bounds there is no place on an axis.
        let mean = numbers.estimate(metric).mean.filter(|mean| mean.is_finite())?;
        let runs = &self.report.runs[self.cells[place.cell].runs.clone()];
        let units: Vec<f64> = runs
            .iter()
            .filter_map(|run| metric.of(run.summaries[place.world].1.as_ref()?))
            .filter(|unit| unit.is_finite())
            .collect();
        let interval = numbers.interval(metric).filter(|(low, high)| low.is_finite() && high.is_finite());
        let text = |value: f64| number(value, metric.quantity());
        let ends = interval.map_or_else(String::new, |(low, high)| format!(" ({} to {})", text(low), text(high)));
        let (name, unit) = header_words(metric);
        Some(Bar {
            mean: factor * mean,
            interval: interval.map(|(low, high)| (factor * low, factor * high)),
            tip: format!("{}: {name} {}{ends} {unit}, n = {}", self.label(place.cell), text(mean), units.len()),
            units: units.into_iter().map(|unit| factor * unit).collect(),
        })
    }

    fn comparison(&self) -> Vec<Figure> {
        if self.cells.len() < 2 {
            return Vec::new();
        }
        let profile = |comparison: &Comparison| {
            let name = header_words(comparison.metric).0;
            Figure {
                name: format!("profile-{}", comparison.metric.name()),
                title: format!("Performance profile: {name}"),
                caption: format!(
                    "The share of runs (a seed in a world) whose {name} is above the value below: it falls at the scores that \
                     occur. Higher is better everywhere; bands are pointwise 95 % bootstrap intervals, from three seeds on. Each \
                     frame's axis is fitted to its scores."
                ),
                ..of_lines(&LineChart {
                    x_label: format!("{name}, \u{3c4}"),
                    x_range: XRange::OfFrame([0.0, 1.0]),
                    y_label: "share of runs above \u{3c4}".into(),
                    y_range: Some([0.0, 1.0]),
                    shape: Shape::Steps { before: 1.0 },
                    facets: self.facets(|cell| comparison.profiles[cell].clone()),
                })
            }
        };
        std::iter::once(self.aggregates()).chain(self.comparisons.iter().map(profile)).collect()
    }

    /// The interquartile means.
    fn aggregates(&self) -> Figure {
        let column = |comparison: &Comparison| {
            let bar = |(cell, iqm): (usize, &Option<_>)| {
                let Aggregate { value, band, n_runs } = (*iqm)?;
                let ends = band.map_or_else(String::new, |(low, high)| format!(" ({low:.3} to {high:.3})"));
                let tip = format!("{}: IQM {value:.3}{ends}, n = {n_runs} seeds", self.label(cell));
                Some(Bar { mean: value, interval: band, units: Vec::new(), tip })
            };
            let title = format!("IQM of {}", header_words(comparison.metric).0);
            Column {
                title,
                unit: "share".into(),
                bars: comparison.iqm.iter().enumerate().map(bar).collect(),
                bounds: [0.0, 1.0],
            }
        };
        let chart = IntervalChart {
            rows: (0..self.cells.len()).map(|cell| self.label(cell)).collect(),
            columns: self.comparisons.iter().map(column).collect(),
        };
        Figure {
            name: "iqm".into(),
            title: "Interquartile means over seeds and worlds".into(),
            caption: "Ticks: the mean of the middle half of all runs (a seed in a world); bars: its 95 % stratified bootstrap \
                      interval, from three seeds on. Each axis is fitted to what it shows."
                .into(),
            svg: chart.svg(Breadth::Wide),
            narrow: chart.svg(Breadth::Narrow),
            is_wide: true,
        }
    }

    fn learning_curve(&self, curves: &Curves) -> Figure {
        Figure {
            name: format!("curve-{}", curves.quantity.name()),
            title: curves.quantity.label().into(),
            caption:
                "In training, exploration included. Mean over the training seeds; bands: its 95 % percentile bootstrap \
                      interval over the seeds, from three seeds on."
                    .into(),
            ..of_lines(&LineChart {
                x_label: "env steps".into(),
                x_range: XRange::FromZero,
                y_label: curves.quantity.label().into(),
                y_range: curves.quantity.range(),
                shape: Shape::Straight,
                facets: self.facets(|cell| curves.by_cell[cell].clone()),
            })
        }
    }

    fn clearance(&self) -> Vec<Figure> {
        let figure = |name: String, title: String, facets: Vec<Lines>| Figure {
            name,
            title,
            caption: format!(
                "Distance over time at each clearance (from the footprint to what is nearest), in bins of 0.1 m, over the \
                 first {N_CLEARANCE_EPISODES} scenarios of every seed, driven again; where at least half of the seeds spent a \
                 second or more. Mean over the seeds; bands: 95 % percentile bootstrap over the seeds, from three on."
            ),
            ..of_lines(&LineChart {
                x_label: "clearance (m)".into(),
                x_range: XRange::FromZero,
                y_label: "mean speed (m/s)".into(),
                y_range: None,
                shape: Shape::Straight,
                facets,
            })
        };
        let of = |world: &str| -> Vec<Lines> {
            let rows = self.rows_of(world);
            self.facets(|cell| {
                let row = rows.iter().find(|row| self.places[**row].cell == cell);
                row.map_or_else(Vec::new, |row| self.driven[*row].clearance.clone())
            })
        };
        let worlds = self.worlds().into_iter().map(|world| (world, of(world)));
        let worlds: Vec<_> =
            worlds.filter(|(_, facets)| facets.iter().any(|facet| facet.points().next().is_some())).collect();
        if worlds.iter().all(|(_, facets)| facets.len() == 1) {
            let facets: Vec<Lines> = worlds
                .into_iter()
                .flat_map(|(world, facets)| facets.into_iter().map(|facet| Facet { title: world.into(), ..facet }))
                .collect();
            return if facets.is_empty() {
                Vec::new()
            } else {
                vec![figure("clearance".into(), "Speed against clearance".into(), facets)]
            };
        }
        let one = |(world, facets)| figure(file_name(&format!("clearance-{world}")), format!("World {world}"), facets);
        worlds.into_iter().map(one).collect()
    }

    /// What is drawn of each cell, in frames: one for all if they are few, or else one for each level of the first axis.
    fn facets<T>(&self, data: impl Fn(usize) -> T) -> Vec<Facet<T>> {
        let series = |(cell, key)| Series { key, data: data(cell) };
        let facet = |(title, cells): (String, Vec<_>)| Facet { title, series: cells.into_iter().map(series).collect() };
        self.frames(MAX_LINES).into_iter().map(facet).collect()
    }

    /// The cells with what they are called: all together if they are no more than `n_together`, or else those of each level
    /// of the first axis, under its name.
    pub(super) fn frames(&self, n_together: usize) -> Vec<(String, Vec<(usize, String)>)> {
        let cells = || self.cells.iter().enumerate();
        if self.cells.len() <= n_together || cells().any(|(_, cell)| cell.distinct.len() < 2) {
            return vec![(String::new(), cells().map(|(number, _)| (number, self.label(number))).collect())];
        }
        let mut frames: Vec<(String, Vec<(usize, String)>)> = Vec::new();
        for (number, cell) in cells() {
            let (title, cell) = (&cell.distinct[0], (number, cell.distinct[1..].join(" · ")));
            match frames.iter_mut().find(|(known, _)| known == title) {
                Some((_, cells)) => cells.push(cell),
                None => frames.push((title.clone(), vec![cell])),
            }
        }
        frames
    }
}

/// Refuses a scale at which one of the figures would be too large; a note on the signs that none of them can show.
fn check_png(renderer: &PngRenderer, figures: &[(String, String)], scale: f64) -> Result<Vec<String>, Error> {
    let (mut unpainted, mut too_large) = (BTreeSet::new(), Vec::new());
    for (name, svg) in figures {
        let refused = |error| Error::Input(format!("`{name}` cannot be drawn: {error}"));
        let picture = renderer.picture(svg).map_err(refused)?;
        unpainted.extend(picture.unpainted());
        if let Err(error) = picture.size(scale) {
            too_large.push((name, error));
        }
    }
    let greatest = |error: &PngError| match error {
        PngError::TooLarge { greatest_scale, .. } => *greatest_scale,
        PngError::NotSvg(_) => 0.0,
    };
    // What the largest of them fits, all do.
    if let Some((name, error)) = too_large.into_iter().min_by(|(_, a), (_, b)| greatest(a).total_cmp(&greatest(b))) {
        return Err(Error::Input(format!("--scale {scale}: `{name}.png`: {error}; --format svg has no limit")));
    }
    let signs: Vec<String> = unpainted.iter().map(|sign| format!("`{sign}` (U+{:04X})", u32::from(*sign))).collect();
    let note = || format!("warning: boxes stand in the figures for signs that their font lacks: {}", signs.join(", "));
    Ok((!signs.is_empty()).then(note).into_iter().collect())
}

/// Writes each figure to a file of its own; their paths.
fn write_all(
    folder: &Path,
    ending: &str,
    figures: Vec<(String, String)>,
    bytes: impl Fn(String) -> Result<Vec<u8>, Error>,
) -> Result<Vec<PathBuf>, Error> {
    std::fs::create_dir_all(folder).map_err(|error| Error::io("create the folder", folder, error))?;
    let mut paths = Vec::new();
    for (name, svg) in figures {
        let path = free_path(folder, &name, ending, &paths);
        std::fs::write(&path, bytes(svg)?).map_err(|error| Error::io("write", &path, error))?;
        paths.push(path);
    }
    Ok(paths)
}

/// The path of a figure: names that differ in what files cannot have must not share one.
fn free_path(folder: &Path, name: &str, ending: &str, taken: &[PathBuf]) -> PathBuf {
    let numbered = (2..).map(|k| folder.join(format!("{name}-{k}.{ending}")));
    let mut paths = std::iter::once(folder.join(format!("{name}.{ending}"))).chain(numbered);
    paths.find(|path| !taken.contains(path)).expect("numbers do not end")
}

/// The picture of a figure of lines, without words.
fn of_lines(chart: &LineChart) -> Figure {
    let none = String::new;
    Figure {
        name: none(),
        title: none(),
        caption: none(),
        svg: chart.svg(Breadth::Wide),
        narrow: chart.svg(Breadth::Narrow),
        is_wide: chart.facets.len() > 1,
    }
}

/// A name of a file: letters, digits, dots and dashes.
fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || c == '.' || c == '_' { c } else { '-' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_stay_in_their_folder() {
        assert_eq!(file_name("drive-../a b-R=1"), "drive-..-a-b-R-1");
        let first = free_path(Path::new("f"), "a", "svg", &[]);
        assert_eq!(free_path(Path::new("f"), "a", "svg", &[first]), Path::new("f/a-2.svg"));
    }
}

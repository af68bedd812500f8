//! Cells beside each other, over all seeds and worlds.

use headway_stats::{
    Bootstrap, Estimator, Interval, MIN_UNITS, Profile, Redrawn, Scores, improvement_bootstrap, performance_profile,
    stratified_bootstrap,
};

use super::bands::{Point, resampling};
use crate::Error;
use crate::episode::Metric;
use crate::report::RunRow;

/// Fewest seeds of either cell from which a probability counts as told from luck: as many as the test for seeds that pair up
/// ([`sign_flip`](headway_stats::sign_flip)) takes to have a p of 0.05 or less, so that the two say the same of few seeds.
pub(crate) const MIN_SEEDS_TOLD: usize = 6;

/// The scores that cells are compared in: from 0 to 1, of which more is better.
const SCORES: [Metric; 2] = [Metric::Success, Metric::Spl];
/// The metrics of which cells are said to have more than others.
const RANKED: [Metric; 3] = [Metric::Success, Metric::Spl, Metric::MeanSpeed];

/// One score, cell by cell; `None` for cells without a run of which it is known in every world.
#[derive(Debug, Clone)]
pub(crate) struct Comparison {
    pub(crate) metric: Metric,
    /// The interquartile mean over seeds and worlds, with its interval where there are three seeds.
    pub(crate) iqm: Vec<Option<Aggregate>>,
    /// The share of runs above each score that occurs, in ascending order: it holds from there to the next, and is 1 before the first.
    pub(crate) profiles: Vec<Vec<Point>>,
}

/// How likely a run of one cell is to have more of a metric than a run of another.
#[derive(Debug, Clone)]
pub(crate) struct Ranking {
    pub(crate) metric: Metric,
    /// Of the row's cell over the column's; `None` where their worlds or their number do not allow it.
    pub(crate) more: Vec<Vec<Option<Interval>>>,
    /// The number of runs of each cell.
    pub(crate) n_runs: Vec<usize>,
}

/// An aggregate over runs and worlds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Aggregate {
    pub(crate) value: f64,
    pub(crate) band: Option<(f64, f64)>,
    pub(crate) n_runs: usize,
}

/// The scores of a cell with the names of its worlds.
struct Arm<'a> {
    worlds: Vec<&'a str>,
    scores: Option<Scores>,
}

/// One policy drives in all worlds, so that its scores are redrawn together.
fn whole(how: Bootstrap) -> Bootstrap {
    how.redrawing(Redrawn::WholeRuns)
}

impl Comparison {
    /// The comparisons of cells in all scores, each cell given by its runs.
    pub(super) fn all(cells: &[&[RunRow]]) -> Result<Vec<Self>, Error> {
        SCORES.into_iter().map(|metric| Self::new(metric, &arms(metric, cells))).collect()
    }

    fn new(metric: Metric, arms: &[Arm<'_>]) -> Result<Self, Error> {
        let profiles = arms.iter().map(Arm::profile).collect::<Result<_, _>>()?;
        Ok(Self { metric, iqm: arms.iter().map(Arm::iqm).collect(), profiles })
    }
}

impl Ranking {
    /// The rankings of cells in all metrics that tell anything of two of them, each cell given by its runs.
    pub(super) fn all(cells: &[&[RunRow]]) -> Result<Vec<Self>, Error> {
        let rankings = RANKED.into_iter().map(|metric| Self::new(metric, &arms(metric, cells)));
        let mut rankings = rankings.collect::<Result<Vec<_>, _>>()?;
        rankings.retain(|ranking| ranking.more.iter().flatten().any(Option::is_some));
        Ok(rankings)
    }

    fn new(metric: Metric, arms: &[Arm<'_>]) -> Result<Self, Error> {
        let mut more = vec![vec![None; arms.len()]; arms.len()];
        for (i, x) in arms.iter().enumerate() {
            for (j, y) in arms.iter().enumerate().skip(i + 1) {
                let over = x.more(y)?;
                more[i][j] = over;
                // Pairs are counted once, ties by half: the other direction is what remains.
                more[j][i] =
                    over.map(|over| Interval { point: 1.0 - over.point, low: 1.0 - over.high, high: 1.0 - over.low });
            }
        }
        Ok(Self { metric, more, n_runs: arms.iter().map(Arm::n_runs).collect() })
    }

    /// Whether two cells have seeds enough for their probability to be told from luck.
    pub(crate) fn has_enough(&self, x: usize, y: usize) -> bool {
        self.n_runs[x].min(self.n_runs[y]) >= MIN_SEEDS_TOLD
    }

    /// Whether that of one cell over another is told from one half: by its interval, and with seeds enough.
    pub(crate) fn is_told(&self, x: usize, y: usize) -> bool {
        self.has_enough(x, y) && self.more[x][y].is_some_and(|over| over.low > 0.5 || over.high < 0.5)
    }
}

fn arms<'a>(metric: Metric, cells: &[&'a [RunRow]]) -> Vec<Arm<'a>> {
    cells.iter().map(|runs| Arm::new(metric, runs)).collect()
}

impl<'a> Arm<'a> {
    fn new(metric: Metric, runs: &'a [RunRow]) -> Self {
        let worlds =
            runs.first().map_or_else(Vec::new, |run| run.summaries.iter().map(|(name, _)| &name[..]).collect());
        let row = |run: &RunRow| run.summaries.iter().map(|(_, summary)| metric.of(summary.as_ref()?)).collect();
        let rows: Vec<Vec<f64>> = runs.iter().filter_map(row).collect();
        Self { worlds, scores: Scores::from_rows(&rows).ok() }
    }

    fn n_runs(&self) -> usize {
        self.scores.as_ref().map_or(0, Scores::n_runs)
    }

    fn has_spread(&self) -> bool {
        self.n_runs() >= MIN_UNITS
    }

    fn iqm(&self) -> Option<Aggregate> {
        let interval = stratified_bootstrap(self.scores.as_ref()?, Estimator::Iqm, &whole(Bootstrap::default()));
        let band = self.has_spread().then(|| interval.ends());
        Some(Aggregate { value: interval.point, band, n_runs: self.n_runs() })
    }

    fn profile(&self) -> Result<Vec<Point>, Error> {
        let Some(scores) = &self.scores else { return Ok(Vec::new()) };
        let mut taus = scores.values().to_vec();
        taus.sort_unstable_by(f64::total_cmp);
        taus.dedup();
        let shares = performance_profile(scores, &taus, Profile::Runs, &whole(resampling())).map_err(Error::failure)?;
        let band = |share: &Interval| self.has_spread().then(|| share.ends());
        let point =
            |(tau, share): (f64, &Interval)| Point { x: tau, y: share.point, band: band(share), n: self.n_runs() };
        Ok(taus.into_iter().zip(&shares).map(point).collect())
    }

    fn more(&self, other: &Self) -> Result<Option<Interval>, Error> {
        let (Some(x), Some(y)) = (&self.scores, &other.scores) else { return Ok(None) };
        if self.worlds != other.worlds || !self.has_spread() || !other.has_spread() {
            return Ok(None);
        }
        improvement_bootstrap(x, y, &whole(resampling())).map(Some).map_err(Error::failure)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arm(rows: &[[f64; 2]]) -> Arm<'static> {
        Arm { worlds: vec!["a", "b"], scores: Scores::from_rows(rows).ok() }
    }

    fn shares(rows: &[[f64; 2]]) -> Vec<(f64, f64)> {
        arm(rows).profile().unwrap().iter().map(|point| (point.x, point.y)).collect()
    }

    #[test]
    fn profiles_fall_at_the_scores_that_occur() {
        assert_eq!(shares(&[[0.995, 0.999], [0.999, 1.0]]), [(0.995, 0.75), (0.999, 0.25), (1.0, 0.0)]);
        assert_eq!(shares(&[[1.0, 1.0]]), [(1.0, 0.0)]);
        assert!(shares(&[]).is_empty());
        let three = arm(&[[0.2, 0.2], [0.4, 0.4], [0.6, 0.6]]).profile().unwrap();
        // All of three redrawn runs are the first with a probability of 1/27, more than the 2.5 % of a tail: none then lies above.
        assert_eq!(three[0].band, Some((0.0, 1.0)));
        assert_eq!((three[2].y, three[2].band), (0.0, Some((0.0, 0.0))), "nothing lies above the greatest");
    }

    #[test]
    fn few_seeds_tell_nothing_however_far_apart() {
        let told = |n: usize, others: usize| {
            let side = |n: usize, score: f64| arm(&vec![[score; 2]; n]);
            let ranking = Ranking::new(Metric::Success, &[side(n, 1.0), side(others, 0.5)]).unwrap();
            assert_eq!(ranking.more[0][1].map(|over| (over.low, over.high)), Some((1.0, 1.0)));
            assert_eq!(ranking.is_told(0, 1), ranking.is_told(1, 0));
            ranking.is_told(0, 1)
        };
        assert_eq!([(3, 3), (5, 20), (6, 6), (20, 20)].map(|(n, others)| told(n, others)), [false, false, true, true]);
        let alike = Ranking::new(Metric::Success, &[arm(&[[0.5; 2]; 9]), arm(&[[0.5; 2]; 9])]).unwrap();
        assert!(alike.has_enough(0, 1) && !alike.is_told(0, 1));
        let least_p = |n: usize| headway_stats::sign_flip(&vec![1.0; n]);
        assert!(least_p(MIN_SEEDS_TOLD) <= 0.05 && least_p(MIN_SEEDS_TOLD - 1) > 0.05);
    }
}

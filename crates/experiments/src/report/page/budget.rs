//! How many drives a page can hold.

use crate::report::study::{ASKED, Drive, Study};

/// Bytes of all drives together: with them, the page of a large study stays below 30 MB.
const BUDGET: usize = 16_000_000;

/// The drives that a page shows.
pub(super) struct Shown<'a> {
    /// In the order of the report's rows.
    pub(super) drives: Vec<&'a Drive>,
    n_left_out: usize,
}

impl<'a> Shown<'a> {
    /// Those of a study: in rounds, those asked for first, then the first of every row, the second of every row, and so on,
    /// until the budget is spent.
    pub(super) fn of(study: &'a Study) -> Self {
        Self::within(BUDGET, study.driven.iter().map(|driven| &driven.drives[..]))
    }

    fn within(budget: usize, rows: impl Iterator<Item = &'a [Drive]>) -> Self {
        let mut queue = Vec::new();
        for drives in rows {
            let (asked, others): (Vec<_>, Vec<_>) = drives.iter().partition(|drive| drive.why == ASKED);
            queue.extend(asked.into_iter().map(|drive| (0, drive)));
            queue.extend((1..).zip(others));
        }
        queue.sort_by_key(|(round, _)| *round); // stable: row by row within a round
        let mut spent = 0;
        let affordable = queue.iter().take_while(|(_, drive)| {
            spent += drive.trace.packed.len();
            spent <= budget
        });
        let mut drives: Vec<&Drive> = affordable.map(|(_, drive)| *drive).collect();
        let n_left_out = queue.len() - drives.len();
        drives.sort_by_key(|drive| drive.row);
        Self { drives, n_left_out }
    }

    /// What the reader is told of those that are left out.
    pub(super) fn note(&self) -> Option<String> {
        let (n, all) = (self.n_left_out, self.n_left_out + self.drives.len());
        let note =
            || format!("{n} of {all} drives are left out to keep the page small; `--drive` shows one in particular");
        (n > 0).then(note)
    }

    /// The number of a drive, with the drive, of those of a row and a seed.
    pub(super) fn of_run(&self, row: usize, seed: u64) -> impl Iterator<Item = (usize, &'a Drive)> {
        let drives = self.drives.iter().copied().enumerate();
        drives.filter(move |(_, drive)| drive.row == row && drive.seed == seed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::episode::Outcome;
    use crate::report::study::{Form, Scene, Trace};

    fn drive(row: usize, scenario: u64, why: &'static str) -> Drive {
        let footprint = Form::Disc([0.0, 0.0, 0.2]);
        let scene = Scene { view: [0.0; 4], obstacles: vec![], movers: vec![], goal: [0.0; 2], reach: 0.5, footprint };
        let (rays, packed) = (vec![], "x".repeat(10));
        let trace = Trace { n: 1, origin: [0.0; 2], step: 1.0, rays, max_range: 5.0, n_movers: 0, packed };
        Drive {
            row,
            seed: 0,
            scenario,
            why,
            outcome: Outcome::Success,
            duration: 1.0,
            distance: 1.0,
            is_as_recorded: true,
            scene,
            trace,
            set_points: None,
            trajectory: None,
        }
    }

    #[test]
    fn every_row_has_its_first_drive_before_any_has_two() {
        let rows = [
            vec![drive(0, 1, "typical success"), drive(0, 2, "typical collision")],
            vec![drive(1, 3, "typical success"), drive(1, 4, "typical collision"), drive(1, 5, ASKED)],
        ];
        let scenarios = |budget| {
            let shown = Shown::within(budget, rows.iter().map(|row| &row[..]));
            (shown.drives.iter().map(|drive| drive.scenario).collect::<Vec<_>>(), shown.note().is_some())
        };
        assert_eq!(scenarios(10), (vec![5], true));
        assert_eq!(scenarios(30), (vec![1, 5, 3], true));
        assert_eq!(scenarios(50), (vec![1, 2, 5, 3, 4], false));
    }
}

//! Every observation once, however many transitions it is part of.

use serde::{Deserialize, Serialize};

use crate::checkpoint::f32_bytes;

/// The place of an observation among [`Observations`].
pub(crate) type Row = u32;

/// Rows of numbers that live as long as somebody holds them; `4 obs_dim + 4` bytes each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Observations {
    obs_dim: usize,
    /// `[n_rows, obs_dim]`.
    #[serde(with = "f32_bytes")]
    values: Vec<f32>,
    /// The rows that nobody holds; the last is used next.
    free: Vec<Row>,
    /// `[n_rows]`: how often each row is held. Not saved, but counted anew from those who hold.
    #[serde(skip)]
    n_holds: Vec<u32>,
}

impl Observations {
    pub(crate) fn new(obs_dim: usize) -> Self {
        Self { obs_dim, values: Vec::new(), free: Vec::new(), n_holds: Vec::new() }
    }

    /// Stores an observation, held once.
    ///
    /// # Panics
    /// If 2^32 observations are held: as many as the largest replay has transitions, in more than 64 GB.
    pub(crate) fn insert(&mut self, obs: &[f32]) -> Row {
        let Some(row) = self.free.pop() else {
            let row = Row::try_from(self.n_holds.len()).expect("fewer than 2^32 observations");
            self.values.extend_from_slice(obs);
            self.n_holds.push(1);
            return row;
        };
        let begin = row as usize * self.obs_dim;
        self.values[begin..begin + self.obs_dim].copy_from_slice(obs);
        self.n_holds[row as usize] = 1;
        row
    }

    pub(crate) fn get(&self, row: Row) -> &[f32] {
        &self.values[row as usize * self.obs_dim..][..self.obs_dim]
    }

    pub(crate) fn hold(&mut self, row: Row) {
        self.n_holds[row as usize] += 1;
    }

    pub(crate) fn release(&mut self, row: Row) {
        let n_holds = &mut self.n_holds[row as usize];
        *n_holds -= 1;
        if *n_holds == 0 {
            self.free.push(row);
        }
    }

    /// Counts anew who holds what, after reading from a stream; whether all adds up.
    pub(crate) fn recount(&mut self, obs_dim: usize, holds: impl Iterator<Item = Row>) -> bool {
        if self.obs_dim != obs_dim || !self.values.len().is_multiple_of(obs_dim) {
            return false;
        }
        self.n_holds = vec![0; self.values.len() / obs_dim];
        for row in holds {
            match self.n_holds.get_mut(row as usize) {
                Some(n_holds) => *n_holds += 1,
                None => return false,
            }
        }
        self.free_are_those_nobody_holds()
    }

    fn free_are_those_nobody_holds(&self) -> bool {
        let mut is_free: Vec<bool> = self.n_holds.iter().map(|&n_holds| n_holds == 0).collect();
        // A row that is listed twice is not free the second time.
        let mut take = |row: Row| is_free.get_mut(row as usize).is_some_and(std::mem::take);
        self.free.iter().all(|&row| take(row)) && !is_free.contains(&true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_used_again_once_nobody_holds_them() {
        let mut observations = Observations::new(2);
        let [a, b] = [[1.0, 2.0], [3.0, 4.0]].map(|obs| observations.insert(&obs));
        observations.hold(a);
        observations.release(a);
        assert_eq!(observations.insert(&[5.0, 6.0]), 2);
        observations.release(a);
        assert_eq!(observations.insert(&[7.0, 8.0]), a);
        assert_eq!((observations.get(a), observations.get(b)), (&[7.0, 8.0][..], &[3.0, 4.0][..]));
        assert_eq!(observations.values.len(), 6);
    }

    #[test]
    fn a_stream_that_does_not_add_up_is_refused() {
        let mut sound = Observations::new(2);
        (0..4).for_each(|i| _ = sound.insert(&[i as f32; 2]));
        [3, 1].into_iter().for_each(|row| sound.release(row));
        assert!(sound.recount(2, [0, 2, 2].into_iter()));
        assert_eq!(sound.n_holds, [1, 0, 2, 0]);
        let refused = |observations: &Observations, obs_dim, holds: &[Row]| {
            assert!(!observations.clone().recount(obs_dim, holds.iter().copied()), "{observations:?} {holds:?}");
        };
        refused(&sound, 4, &[0, 2]);
        refused(&sound, 2, &[0, 2, 4]); // no such row
        refused(&sound, 2, &[0, 2, 3]); // held and free
        refused(&sound, 2, &[0]); // neither
        for free in [vec![3, 3], vec![1, 4], vec![3], vec![3, 1, 1]] {
            refused(&Observations { free, ..sound.clone() }, 2, &[0, 2]);
        }
        refused(&Observations { values: vec![0.0; 7], ..sound.clone() }, 2, &[0, 2]);
    }
}

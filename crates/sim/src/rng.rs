//! Named random streams.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The random stream `name` number `index` of a run's seed.
///
/// `ChaCha8` is keyed with seed, index and name side by side, so streams of different names, indices
/// or seeds are independent, and adding a stream never shifts another one. The numbers are the same
/// on every platform.
///
/// # Panics
/// If `name` is longer than 16 bytes.
///
/// ```
/// use rand::Rng;
/// let mut layout = headway_sim::stream(7, "layout", 0);
/// let mut noise = headway_sim::stream(7, "noise", 0);
/// assert_ne!(layout.next_u64(), noise.next_u64());
/// ```
#[must_use]
pub fn stream(seed: u64, name: &str, index: u64) -> ChaCha8Rng {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..16].copy_from_slice(&index.to_le_bytes());
    key[16..16 + name.len()].copy_from_slice(name.as_bytes());
    ChaCha8Rng::from_seed(key)
}

/// The seed of a part of a run: the first number of the stream `name` number `index`.
#[must_use]
pub fn stream_seed(seed: u64, name: &str, index: u64) -> u64 {
    stream(seed, name, index).next_u64()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_keys_give_equal_streams_and_others_do_not() {
        let first = |seed, name, index| stream_seed(seed, name, index);
        assert_eq!(first(1, "layout", 2), first(1, "layout", 2));
        let all = [first(1, "layout", 2), first(2, "layout", 1), first(1, "layou", 2), first(1, "noise", 2)];
        for (i, a) in all.iter().enumerate() {
            assert!(all[i + 1..].iter().all(|b| a != b));
        }
    }
}

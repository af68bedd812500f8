//! Named random streams derived from one seed.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The stream `name` of the run with this seed: ChaCha8 keyed by seed (8 bytes LE), zero (8 bytes), name (16 bytes, zero-padded).
///
/// # Panics
/// If the name is longer than 16 bytes.
pub(crate) fn stream(seed: u64, name: &str) -> ChaCha8Rng {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[16..16 + name.len()].copy_from_slice(name.as_bytes());
    ChaCha8Rng::from_seed(key)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    #[test]
    fn streams_differ_by_seed_and_by_name_only() {
        let first = |seed, name| stream(seed, name).next_u64();
        assert_eq!(first(1, "weights"), first(1, "weights"));
        assert_ne!(first(1, "weights"), first(2, "weights"));
        assert_ne!(first(1, "weights"), first(1, "replay"));
    }
}

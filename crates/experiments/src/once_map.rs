//! Values that several threads need and one of them makes.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Values by key, each made by whoever asks first; who asks meanwhile waits.
#[derive(Debug)]
pub(crate) struct OnceMap<K, V> {
    slots: Mutex<HashMap<K, Slot<V>>>,
}

/// A lock of its own for each key, so that values of different keys are made side by side.
type Slot<V> = Arc<Mutex<Option<Arc<V>>>>;

impl<K, V> Default for OnceMap<K, V> {
    fn default() -> Self {
        Self { slots: Mutex::default() }
    }
}

impl<K: Eq + Hash, V> OnceMap<K, V> {
    /// The value of a key, which `make` makes if it is not there.
    ///
    /// # Errors
    /// If it cannot be made; who asks next tries again.
    pub(crate) fn get<E>(&self, key: K, make: impl FnOnce() -> Result<V, E>) -> Result<Arc<V>, E> {
        let slot = Arc::clone(lock(&self.slots).entry(key).or_default());
        let mut slot = lock(&slot);
        if let Some(value) = &*slot {
            return Ok(Arc::clone(value));
        }
        let value = Arc::new(make()?);
        *slot = Some(Arc::clone(&value));
        Ok(value)
    }
}

/// A slot stays empty if its maker panics: nothing half-made is ever seen.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::thread;
    use std::time::Duration;

    #[test]
    fn each_value_is_made_once_however_many_ask_at_once() {
        let (map, n_made) = (OnceMap::default(), AtomicUsize::new(0));
        thread::scope(|scope| {
            for i in 0..8 {
                let (map, n_made) = (&map, &n_made);
                scope.spawn(move || {
                    let value = map.get(i % 2, || {
                        thread::sleep(Duration::from_millis(20));
                        n_made.fetch_add(1, Ordering::Relaxed);
                        Ok::<_, ()>(i % 2 * 10)
                    });
                    assert_eq!(value.map(|value| *value), Ok(i % 2 * 10));
                });
            }
        });
        assert_eq!(n_made.into_inner(), 2);
    }

    #[test]
    fn what_failed_is_tried_again() {
        let map = OnceMap::default();
        assert_eq!(map.get("a", || Err::<u8, _>("no")), Err("no"));
        assert_eq!(map.get("a", || Ok::<_, &str>(1)), Ok(Arc::new(1)));
    }
}

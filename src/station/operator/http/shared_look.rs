//! One look for all who ask at the same time. No caller gets a result from before its question, and while
//! a look hangs on a disk no other begins.

use std::sync::Arc;
use std::time::{Duration, Instant};

use tokio::sync::Mutex;
use tokio::task::spawn_blocking;
use tokio::time::timeout;

/// How long to wait for a look. A look that takes longer hangs on a disk, and continues.
const PATIENCE: Duration = Duration::from_millis(1500);

/// A look that callers share.
#[derive(Debug, Clone)]
pub struct SharedLook<T> {
    patience: Duration,
    /// When the last look began, and its result. Locked while a look is running.
    last: Arc<Mutex<Option<(Instant, T)>>>,
}

impl<T> Default for SharedLook<T> {
    fn default() -> SharedLook<T> {
        SharedLook { patience: PATIENCE, last: Arc::default() }
    }
}

impl<T: Clone + Send + 'static> SharedLook<T> {
    /// The result of a look that begins now or later, on a thread that may block; `None` if it does not
    /// end in time or panics.
    pub async fn of(&self, look: impl FnOnce() -> T + Send + 'static) -> Option<T> {
        let asked = Instant::now();
        let seen = async {
            let mut last = Arc::clone(&self.last).lock_owned().await;
            if let Some((begun, seen)) = &*last
                && *begun >= asked
            {
                return Some(seen.clone());
            }
            let look = move || {
                let begun = Instant::now();
                let seen = look();
                *last = Some((begun, seen.clone()));
                seen
            };
            spawn_blocking(look).await.ok()
        };
        timeout(self.patience, seen).await.ok().flatten()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::sync::{self, mpsc};

    use tokio::task::yield_now;

    use super::*;

    fn with_patience<T>(patience: Duration) -> SharedLook<T> {
        SharedLook { patience, last: Arc::default() }
    }

    #[tokio::test]
    async fn however_many_ask_at_once_two_looks_serve_them_and_none_is_older_than_its_question() {
        let shared = with_patience(Duration::from_secs(60));
        let (asked, looks) = (Arc::new(AtomicU64::new(0)), Arc::new(AtomicU64::new(0)));
        let (go, gate) = mpsc::channel::<()>();
        let gate = Arc::new(sync::Mutex::new(gate));
        let ask = || {
            let (shared, asked, gate) = (shared.clone(), Arc::clone(&asked), Arc::clone(&gate));
            let looks = Arc::clone(&looks);
            tokio::spawn(async move {
                asked.fetch_add(1, Ordering::SeqCst);
                let look = move || {
                    let number = looks.fetch_add(1, Ordering::SeqCst) + 1;
                    gate.lock().unwrap().recv().unwrap();
                    number
                };
                shared.of(look).await
            })
        };
        let first = ask();
        while looks.load(Ordering::SeqCst) == 0 {
            yield_now().await;
        }
        let others: Vec<_> = (0..100).map(|_| ask()).collect();
        while asked.load(Ordering::SeqCst) < 101 {
            yield_now().await;
        }
        go.send(()).unwrap();
        assert_eq!(first.await.unwrap(), Some(1));
        go.send(()).unwrap();
        for other in others {
            assert_eq!(other.await.unwrap(), Some(2));
        }
        assert_eq!(looks.load(Ordering::SeqCst), 2);
    }

    #[tokio::test]
    async fn a_look_that_hangs_is_not_waited_for_and_no_other_begins_meanwhile() {
        let shared = with_patience(Duration::from_millis(10));
        let (go, gate) = mpsc::channel::<()>();
        assert_eq!(shared.of(move || gate.recv().is_ok()).await, None);
        assert_eq!(shared.of(|| unreachable!("one hangs already")).await, None);
        drop(go);
        while shared.of(|| true).await.is_none() {}
    }
}

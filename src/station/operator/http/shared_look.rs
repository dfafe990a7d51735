//! One look for all who ask at the same time. However many ask, at most one look is running and one is
//! pending, and no caller gets a result from before its question.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::watch;
use tokio::task::spawn_blocking;
use tokio::time::timeout;

/// How long to wait for a look. A look that takes longer hangs on a disk, and goes on.
const PATIENCE: Duration = Duration::from_millis(1500);

/// A look that callers share.
#[derive(Debug)]
pub struct SharedLook<T> {
    patience: Duration,
    turns: Mutex<Turns>,
    /// The number of the last look that ended, and its result.
    seen: watch::Sender<(u64, Option<T>)>,
}

#[derive(Debug, Default)]
struct Turns {
    begun: u64,
    is_running: bool,
    /// A caller asked after the running look had begun.
    is_wanted: bool,
}

impl<T> Default for SharedLook<T> {
    fn default() -> SharedLook<T> {
        SharedLook::with_patience(PATIENCE)
    }
}

impl<T> SharedLook<T> {
    fn with_patience(patience: Duration) -> SharedLook<T> {
        SharedLook { patience, turns: Mutex::default(), seen: watch::Sender::new((0, None)) }
    }
}

impl<T: Clone + Send + Sync + 'static> SharedLook<T> {
    /// The result of a look that begins now or later, on a thread that may block; `None` if it does not
    /// end in time or panics.
    pub async fn of(self: &Arc<Self>, look: impl Fn() -> T + Send + Sync + 'static) -> Option<T> {
        let (number, is_ours) = {
            let mut turns = self.turns();
            let is_ours = !turns.is_running;
            turns.is_wanted |= turns.is_running;
            turns.is_running = true;
            (turns.begun + 1, is_ours)
        };
        let mut seen = self.seen.subscribe();
        if is_ours {
            tokio::spawn(Arc::clone(self).run(Arc::new(look)));
        }
        let seen = timeout(self.patience, seen.wait_for(|(last, _)| *last >= number)).await;
        seen.ok()?.ok()?.1.clone()
    }

    /// Looks as long as a caller wants it.
    async fn run(self: Arc<Self>, look: Arc<impl Fn() -> T + Send + Sync + 'static>) {
        loop {
            let number = {
                let mut turns = self.turns();
                turns.begun += 1;
                turns.is_wanted = false;
                turns.begun
            };
            let look = Arc::clone(&look);
            let seen = spawn_blocking(move || look()).await.ok();
            self.seen.send_replace((number, seen));
            let mut turns = self.turns();
            if !turns.is_wanted {
                turns.is_running = false;
                return;
            }
        }
    }

    fn turns(&self) -> MutexGuard<'_, Turns> {
        self.turns.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::sync::mpsc;

    use super::*;

    #[tokio::test]
    async fn however_many_ask_at_once_two_looks_serve_them_and_none_is_older_than_its_question() {
        let (shared, looks) = (Arc::new(SharedLook::default()), Arc::new(AtomicU64::new(0)));
        let (go, gate) = mpsc::channel::<()>();
        let gate = Mutex::new(gate);
        let counted = Arc::clone(&looks);
        let first = tokio::spawn({
            let shared = Arc::clone(&shared);
            async move {
                let look = move || {
                    let number = counted.fetch_add(1, Ordering::SeqCst) + 1;
                    gate.lock().unwrap().recv().unwrap();
                    number
                };
                shared.of(look).await
            }
        });
        while looks.load(Ordering::SeqCst) == 0 {
            tokio::task::yield_now().await;
        }
        let unused = || -> u64 { unreachable!("a look is under way") };
        let others: Vec<_> = (0..100)
            .map(|_| {
                let shared = Arc::clone(&shared);
                tokio::spawn(async move { shared.of(unused).await })
            })
            .collect();
        // Each caller has its number when it listens.
        while shared.seen.receiver_count() < 101 {
            tokio::task::yield_now().await;
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
    async fn a_look_that_hangs_is_not_waited_for_and_not_begun_twice() {
        let shared = Arc::new(SharedLook::<u64>::with_patience(Duration::from_millis(10)));
        let looks = Arc::new(AtomicU64::new(0));
        let (go, gate) = mpsc::channel::<()>();
        let (gate, counted) = (Mutex::new(gate), Arc::clone(&looks));
        let look = move || {
            let _ = gate.lock().unwrap().recv();
            counted.fetch_add(1, Ordering::SeqCst)
        };
        assert_eq!(shared.of(look).await, None);
        assert_eq!(shared.of(|| unreachable!("one hangs already")).await, None);
        drop(go);
        while looks.load(Ordering::SeqCst) < 2 {
            tokio::task::yield_now().await;
        }
    }
}

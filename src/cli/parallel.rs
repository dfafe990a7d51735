//! Processes many scans on several threads and returns the results in order.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

use crate::station::runtime::caught::caught;

/// The most results per thread that may wait for their turn. A slow scan among quick ones does not block
/// the others, and memory stays bounded.
const WAITING_PER_JOB: usize = 2;

/// As many threads as the machine has processors.
pub fn usual_jobs() -> NonZeroUsize {
    thread::available_parallelism().unwrap_or(NonZeroUsize::MIN)
}

/// Processes all items on this many threads and passes the results to `take` one by one, in the order of
/// the items. If the work panics, the result is the panic's message.
pub fn in_order<T: Sync, R: Send>(
    items: &[T],
    jobs: NonZeroUsize,
    work: impl Fn(&T) -> R + Sync,
    mut take: impl FnMut(&T, Result<R, String>),
) {
    let queue = Queue { state: Mutex::default(), changed: Condvar::new() };
    let ahead = jobs.get().saturating_mul(WAITING_PER_JOB);
    thread::scope(|scope| {
        for _ in 0..jobs.get().min(items.len()) {
            scope.spawn(|| {
                while let Some(at) = queue.begin(items.len(), ahead) {
                    queue.done(at, caught(|| work(&items[at])));
                }
            });
        }
        let _end = End { queue: &queue };
        for (at, item) in items.iter().enumerate() {
            take(item, queue.take(at));
        }
    });
}

/// What the threads share.
struct Queue<R> {
    state: Mutex<State<R>>,
    changed: Condvar,
}

struct State<R> {
    /// The next item to work on.
    next: usize,
    /// How many results were taken.
    taken: usize,
    /// Results that wait for their turn.
    done: BTreeMap<usize, Result<R, String>>,
}

impl<R> Default for State<R> {
    fn default() -> State<R> {
        State { next: 0, taken: 0, done: BTreeMap::new() }
    }
}

impl<R> Queue<R> {
    /// The next item, once it is at most `ahead` past the item whose result is due. `None` at the end.
    fn begin(&self, items: usize, ahead: usize) -> Option<usize> {
        let mut state = self
            .wait(|state| state.next >= items || state.next <= state.taken.saturating_add(ahead));
        let at = state.next;
        state.next = state.next.saturating_add(1);
        (at < items).then_some(at)
    }

    fn done(&self, at: usize, result: Result<R, String>) {
        self.lock().done.insert(at, result);
        self.changed.notify_all();
    }

    /// Waits for the result of an item.
    fn take(&self, at: usize) -> Result<R, String> {
        loop {
            let mut state = self.wait(|state| state.done.contains_key(&at));
            if let Some(result) = state.done.remove(&at) {
                state.taken += 1;
                drop(state);
                self.changed.notify_all();
                return result;
            }
        }
    }

    fn wait(&self, until: impl Fn(&State<R>) -> bool) -> MutexGuard<'_, State<R>> {
        let waited = self.changed.wait_while(self.lock(), |state| !until(state));
        waited.unwrap_or_else(PoisonError::into_inner)
    }

    fn lock(&self) -> MutexGuard<'_, State<R>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Lets the threads begin no more items when it is dropped. If the consumer panics, no result is taken
/// any more, and the threads must end instead of waiting forever.
struct End<'a, R> {
    queue: &'a Queue<R>,
}

impl<R> Drop for End<'_, R> {
    fn drop(&mut self) {
        self.queue.lock().next = usize::MAX;
        self.queue.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    fn jobs(count: usize) -> NonZeroUsize {
        NonZeroUsize::new(count).unwrap()
    }

    #[test]
    fn results_come_in_the_items_order_whichever_is_done_first() {
        for count in [1, 2, 7, 50] {
            let items: Vec<usize> = (0..40).collect();
            let mut seen = Vec::new();
            // The first of every seven items takes longest.
            let work = |item: &usize| {
                (0..10_000 * (7 - item % 7)).for_each(|n| {
                    std::hint::black_box(n);
                });
                item * item
            };
            in_order(&items, jobs(count), work, |item, result| seen.push((*item, result.unwrap())));
            let expected: Vec<_> = items.iter().map(|item| (*item, item * item)).collect();
            assert_eq!(seen, expected);
        }
        in_order(&[], jobs(3), |item: &u8| *item, |_, _| panic!("there is nothing"));
    }

    #[test]
    fn no_more_is_begun_than_its_turn_allows() {
        let (items, begun) = ((0..100).collect::<Vec<usize>>(), AtomicUsize::new(0));
        let mut taken = 0;
        let work = |_: &usize| begun.fetch_add(1, Ordering::SeqCst);
        in_order(&items, jobs(2), work, |_, _| {
            // Two results wait for each of the two threads, and one is due.
            assert!(begun.load(Ordering::SeqCst) <= taken + 2 * WAITING_PER_JOB + 2);
            taken += 1;
        });
        assert_eq!(taken, 100);
    }

    #[test]
    #[should_panic(expected = "nobody takes it")]
    fn a_panic_over_a_result_does_not_wait_for_the_others() {
        let items: Vec<usize> = (0..100).collect();
        in_order(&items, jobs(2), |item| *item, |_, _| panic!("nobody takes it"));
    }

    #[test]
    fn a_panic_is_the_fault_of_its_item_only() {
        std::panic::set_hook(Box::new(|_| {}));
        let mut said = Vec::new();
        let work = |item: &u8| if *item == 2 { panic!("row {item}") } else { *item };
        in_order(&[1, 2, 3], jobs(2), work, |_, result| said.push(result));
        assert_eq!(said, [Ok(1), Err("row 2".to_owned()), Ok(3)]);
    }
}

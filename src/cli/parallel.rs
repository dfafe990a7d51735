//! Processes many scans on several threads and returns the results in order.

use std::collections::VecDeque;
use std::num::NonZeroUsize;
use std::sync::{Mutex, PoisonError, mpsc};
use std::thread;

use crate::station::runtime::caught;

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
    let ahead = jobs.get().saturating_mul(WAITING_PER_JOB);
    let (give, tasks) = mpsc::channel::<(&T, mpsc::Sender<Result<R, String>>)>();
    let tasks = Mutex::new(tasks);
    // In a function of its own, so that the lock is let go before the work begins.
    let next = || tasks.lock().unwrap_or_else(PoisonError::into_inner).recv();
    thread::scope(|scope| {
        for _ in 0..jobs.get().min(items.len()) {
            scope.spawn(|| {
                while let Ok((item, answer)) = next() {
                    // Fails if the consumer has panicked: then nobody waits for it.
                    let _ = answer.send(caught(|| work(item)));
                }
            });
        }
        // Dropped at the end of this block, also by a panic of the consumer: then the threads end.
        let give = give;
        let mut finish = |(item, result): (&T, mpsc::Receiver<Result<R, String>>)| {
            take(item, result.recv().unwrap_or_else(|gone| Err(gone.to_string())));
        };
        let mut due = VecDeque::new();
        for item in items {
            if due.len() >= ahead {
                due.pop_front().into_iter().for_each(&mut finish);
            }
            let (answer, result) = mpsc::channel();
            // The threads take what is given until `give` is dropped.
            let _ = give.send((item, answer));
            due.push_back((item, result));
        }
        drop(give);
        due.into_iter().for_each(finish);
    });
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

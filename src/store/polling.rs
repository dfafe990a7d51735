//! Waiting for what another process is about to do: release a lock, open its socket. Neither locks of files
//! nor shares nor missing sockets notify.

use std::thread::sleep;
use std::time::{Duration, Instant};

/// Interval between attempts.
const PACE: Duration = Duration::from_millis(20);

/// Tries until there is a result, for at most about `limit`; `None` if there is none by then. Blocks.
pub fn poll<T>(limit: Duration, mut attempt: impl FnMut() -> Option<T>) -> Option<T> {
    let began = Instant::now();
    loop {
        let found = attempt();
        if found.is_some() || began.elapsed() >= limit {
            return found;
        }
        sleep(PACE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_succeeds_later_is_waited_for_and_a_limit_of_nothing_means_one_attempt() {
        let mut left = 3;
        let mut attempt = || {
            left -= 1;
            (left == 0).then_some("done")
        };
        assert_eq!(poll(Duration::from_secs(60), &mut attempt), Some("done"));
        let mut attempts = 0;
        let never = poll(Duration::ZERO, || {
            attempts += 1;
            None::<()>
        });
        assert_eq!((never, attempts), (None, 1));
    }
}

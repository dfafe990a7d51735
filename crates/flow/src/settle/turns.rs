//! Whose turn it is: fresh scans before a backlog, but no file is last for ever.
//!
//! The operator waits for the latest scan; files from before the start can wait. So files are ordered by
//! when they last changed, the newest first and by name within one look. But every fourth turn goes to
//! the oldest, so that a scanner that never rests starves none.

use std::cmp::Reverse;
use std::time::Duration;

use super::Settled;

/// One turn in this many goes to the file that has waited longest.
const OLDEST_EVERY: usize = 4;

/// Files with the time of their last change, in the order of their turns. `turns` is how many turns
/// there were before.
pub(super) fn in_turn(files: Vec<(Duration, Settled)>, turns: usize) -> Vec<Settled> {
    let mut oldest: Vec<usize> = (0..files.len()).collect();
    oldest.sort_by_key(|&at| (files[at].0, &files[at].1.path));
    let mut newest = oldest.clone();
    newest.sort_by_key(|&at| Reverse(files[at].0));
    let (mut oldest, mut newest) = (oldest.into_iter(), newest.into_iter());
    let mut files: Vec<Option<Settled>> =
        files.into_iter().map(|(_, settled)| Some(settled)).collect();
    let mut in_turn = Vec::with_capacity(files.len());
    while in_turn.len() < files.len() {
        let turn = turns.wrapping_add(in_turn.len());
        let side = if turn % OLDEST_EVERY == OLDEST_EVERY - 1 { &mut oldest } else { &mut newest };
        let next = side.find_map(|at| files[at].take());
        let Some(next) = next else { break };
        in_turn.push(next);
    }
    in_turn
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{Appeared, Group, Writing};
    use super::*;
    use crate::export::stamp::Stamp;

    fn file(changed_s: u64, name: &str) -> (Duration, Settled) {
        let stamp = Stamp { dev: 1, ino: 1, size: 1, mtime_ns: 0, ctime_ns: 0 };
        let settled = Settled {
            path: name.into(),
            group: Group::from(stamp),
            awaited: false,
            writing: Writing::new(Appeared { absent: None, seen: Duration::ZERO }),
            has_late_companion: false,
        };
        (Duration::from_secs(changed_s), settled)
    }

    fn names(files: &[Settled]) -> Vec<&str> {
        files.iter().map(|file| file.path.to_str().unwrap()).collect()
    }

    #[test]
    fn a_backlog_goes_in_name_order_and_fresh_files_go_before_it() {
        let backlog = ["c", "a", "b", "d", "e"].map(|name| file(0, name));
        assert_eq!(names(&in_turn(backlog.to_vec(), 0)), ["a", "b", "c", "d", "e"]);
        let mut files = backlog.to_vec();
        files.extend([file(7, "y"), file(9, "z"), file(7, "x")]);
        assert_eq!(names(&in_turn(files, 0)), ["z", "x", "y", "a", "b", "c", "d", "e"]);
    }

    #[test]
    fn every_fourth_turn_is_that_of_the_oldest_across_looks() {
        let files: Vec<_> = (0..8).map(|age| file(age, &age.to_string())).collect();
        assert_eq!(names(&in_turn(files.clone(), 0)), ["7", "6", "5", "0", "4", "3", "2", "1"]);
        assert_eq!(names(&in_turn(files, 3))[0], "0");
    }

    proptest! {
        #[test]
        fn everybody_has_one_turn(changed in prop::collection::vec(0..5_u64, 0..40), turns: usize) {
            let numbered = (0..).zip(&changed);
            let files = numbered.map(|(n, changed)| file(*changed, &format!("{n:02}"))).collect();
            let mut in_turn = in_turn(files, turns);
            in_turn.sort_by(|a, b| a.path.cmp(&b.path));
            let all: Vec<String> = (0..changed.len()).map(|n| format!("{n:02}")).collect();
            prop_assert_eq!(names(&in_turn), all);
        }
    }
}

//! When the content of a file was written, as far as looks and short reads show it.
//!
//! A look sees sizes and times, never content. So a few bytes of each file that is not taken yet are read
//! whenever it has changed, and kept as a [`Fingerprint`]. A later content that begins with the marked part
//! has grown since; one that does not was written again. A capture's export is judged by when its content
//! began, not by when its name appeared.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::stamp::Stamp;
use gaiter_record::sha256;

/// How much of each end of a part is compared, bytes. Two bodies differ within their first points.
pub const END_BYTES: usize = 4096;

/// A shorter part is no evidence, bytes: two exports may begin with the same header.
const MARK_LEAST: u64 = END_BYTES as u64;

/// This much behind their headers distinguishes two contents, bytes.
const TRUNK_BYTES: usize = END_BYTES / 2;

/// The header of a binary STL: a title, and a count that some exporters write last, bytes.
const STL_HEADER_BYTES: usize = 84;

/// What some programs put before a text.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// This many zeros at the end are reserved space that is not written yet, bytes.
const RESERVED_LEAST: usize = 16;

/// How many marks of one file are kept: the first, and the last ones.
const MARKS_MOST: usize = 8;

/// How many lengths at which a file was read whole are kept: the last ones.
const READ_MOST: usize = 8;

/// A file whose content is older than its name by more than this came from elsewhere. The coarsest file
/// systems keep times to 2 s.
const STAMPS_APART: Duration = Duration::from_secs(2);

/// Part of a file is read within this time after the look that finds it.
const MARKED: Duration = Duration::from_secs(1);

/// Digits of a mark's sum: two contents are taken for the same with a probability of 2⁻⁶⁴.
const DIGITS: usize = 16;

/// When a content began, as far as is known; times are since the machine's start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Appeared {
    /// It was not there at this time; `None` if there was no look before.
    pub absent: Option<Duration>,
    /// It was there at this time.
    pub seen: Duration,
}

impl Appeared {
    /// The same for a content that was written at this time at the latest, if that is known of it.
    pub(crate) fn written_by(self, written: Option<Duration>) -> Appeared {
        let absent = self.absent.map(|absent| written.map_or(absent, |at| absent.min(at)));
        Appeared { absent, ..self }
    }
}

/// When a content was written at the latest that a look found at `seen`, if it was written elsewhere: its
/// file came to its place, or got its times, `moved` after that.
pub(crate) fn written_elsewhere(seen: Duration, moved: Duration) -> Option<Duration> {
    (moved > STAMPS_APART).then(|| seen.saturating_sub(moved))
}

/// The part of a file that existed at some time.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fingerprint {
    /// The time before it was read.
    pub began: Duration,
    /// The time after it was read.
    pub ended: Duration,
    /// Its length, bytes.
    pub size: u64,
    /// The sum of its two ends.
    pub sum: String,
    /// The sum of what comes first behind its header; `None` if that is not written yet.
    trunk: Option<String>,
    /// When it was written at the latest, if the times of its file show that it was written elsewhere.
    pub written: Option<Duration>,
}

impl Fingerprint {
    /// The mark of a part of `size` bytes with these ends, each of [`END_BYTES`] or all of it.
    pub fn new(
        began: Duration,
        ended: Duration,
        size: u64,
        head: &[u8],
        tail: &[u8],
    ) -> Fingerprint {
        Fingerprint { began, ended, size, sum: sum(head, tail), trunk: trunk(head), written: None }
    }

    /// The mark of a whole content that was read at once.
    pub fn whole(began: Duration, ended: Duration, bytes: &[u8]) -> Fingerprint {
        let (head, tail) = ends(bytes);
        Fingerprint::new(began, ended, bytes.len() as u64, head, tail)
    }

    /// Whether a content begins with this part.
    fn begins(&self, bytes: &[u8]) -> bool {
        let part = usize::try_from(self.size).ok().and_then(|size| bytes.get(..size));
        part.is_some_and(|part| {
            let (head, tail) = ends(part);
            self.size >= MARK_LEAST && sum(head, tail) == self.sum
        })
    }
}

/// Whether a mark belongs to a given content.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Match {
    /// It is a part of it.
    Same,
    /// It is a part of another.
    Other,
    /// It may be of either.
    Unknown,
}

fn ends(bytes: &[u8]) -> (&[u8], &[u8]) {
    let length = bytes.len().min(END_BYTES);
    (&bytes[..length], &bytes[bytes.len() - length..])
}

/// What distinguishes a body from another, whatever is appended to it or changed in its header.
fn trunk(head: &[u8]) -> Option<String> {
    let begins = header(head);
    let part = head.get(begins..begins + TRUNK_BYTES)?;
    let is_written = part.iter().rev().take(RESERVED_LEAST).any(|byte| *byte != 0);
    is_written.then(|| sum(part, &[]))
}

/// The length of what may state when a body was exported, or how much of it follows: comments, the header of
/// a PLY, the title and count of a binary STL. Bytes.
fn header(head: &[u8]) -> usize {
    if head.starts_with(b"ply") {
        let last = b"end_header";
        let at = head.windows(last.len()).position(|word| word == last);
        return at.map_or(head.len(), |at| at + last.len());
    }
    if head.iter().take(STL_HEADER_BYTES).any(|byte| *byte == 0) {
        return STL_HEADER_BYTES;
    }
    let is_comment = |line: &&[u8]| {
        let line = line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(line).trim_ascii();
        line.is_empty() || line.starts_with(b"#")
    };
    head.split_inclusive(|byte| *byte == b'\n').take_while(is_comment).map(<[u8]>::len).sum()
}

fn sum(head: &[u8], tail: &[u8]) -> String {
    let mut digest = sha256(&[head, tail].concat());
    digest.truncate(DIGITS);
    digest
}

/// What is known about how a file was written. It stays with the file when it is renamed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Writing {
    first: Appeared,
    /// When its content was last seen to have changed since; `None` if it has not.
    changed: Option<Duration>,
    marks: Vec<Fingerprint>,
    /// The latest time at which its content since the last partial read was written, if its times show that
    /// it was written elsewhere.
    written: Option<Duration>,
    /// Its lengths each time it was read whole, bytes.
    read: Vec<u64>,
    /// The content that was dealt with last.
    kept: Option<Kept>,
}

/// A content that was taken, or whose bytes the station has.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Kept {
    stamp: Stamp,
    trunk: Option<String>,
}

impl Writing {
    /// A file that was seen for the first time, or started again.
    pub fn new(first: Appeared) -> Writing {
        let (changed, written, kept) = (None, None, None);
        Writing { first, changed, marks: Vec::new(), written, read: Vec::new(), kept }
    }

    /// The same for a file whose times may show that its content was written elsewhere.
    pub(crate) fn found(first: Appeared, written: Option<Duration>) -> Writing {
        Writing { written, ..Writing::new(first.written_by(written)) }
    }

    /// When the file appeared, regardless of what was written into it since.
    pub fn appeared(&self) -> Appeared {
        self.first
    }

    /// Whether part of it was read.
    pub(crate) fn is_marked(&self) -> bool {
        !self.marks.is_empty()
    }

    /// Its content was seen to have changed.
    pub fn change(&mut self, seen: Duration) {
        self.changed = Some(seen);
    }

    /// In its new state, its times may show that its content was written elsewhere.
    pub(crate) fn date(&mut self, written: Option<Duration>) {
        self.written = self.written.into_iter().chain(written).min();
    }

    /// Part of it was read.
    pub fn mark(&mut self, mark: Fingerprint) {
        if mark.size < MARK_LEAST {
            return;
        }
        if self.marks.len() == MARKS_MOST {
            self.marks.remove(1);
        }
        self.marks.push(Fingerprint { written: self.written.take(), ..mark });
    }

    /// All of it was read, in a state that is known from now on: what came before only matters if it
    /// grows.
    pub fn known(&mut self, mark: Fingerprint) {
        self.marks.retain(|known| known.ended <= mark.began);
        if self.read.last() != Some(&mark.size) {
            self.read.drain(..(self.read.len() + 1).saturating_sub(READ_MOST));
            self.read.push(mark.size);
        }
        self.mark(mark);
    }

    /// What the file holds in this state was dealt with.
    pub(crate) fn keep(&mut self, stamp: Stamp) {
        let trunk = self.trunk().map(str::to_owned);
        self.kept = Some(Kept { stamp, trunk });
    }

    /// Whether what the file holds in this state was dealt with.
    pub(crate) fn is_kept(&self, stamp: &Stamp) -> bool {
        self.kept.as_ref().is_some_and(|kept| {
            let is_alike = kept.trunk.is_some() && kept.trunk.as_deref() == self.trunk();
            stamp.has_content_of(&kept.stamp) || is_alike && stamp.size == kept.stamp.size
        })
    }

    /// What distinguishes the content that was marked last; `None` if not known.
    pub(crate) fn trunk(&self) -> Option<&str> {
        self.marks.last().and_then(|last| last.trunk.as_deref())
    }

    /// Whether its place was reserved and not written yet when it was marked last.
    pub(crate) fn is_reserved(&self) -> bool {
        self.marks.last().is_some_and(|last| last.trunk.is_none())
    }

    /// Whether this part belongs to another content than the one that was marked last and was not dealt with.
    pub(crate) fn loses_to(&self, mark: &Fingerprint) -> bool {
        let Some(last) = self.marks.last() else { return false };
        let is_other = last.trunk.is_some() && mark.trunk.is_some() && last.trunk != mark.trunk;
        let is_kept = self
            .kept
            .as_ref()
            .is_some_and(|kept| kept.trunk == last.trunk && kept.stamp.size == last.size);
        is_other && !is_kept
    }

    /// When the file was last seen to have changed.
    pub(crate) fn last_changed(&self) -> Duration {
        self.changed.unwrap_or(self.first.seen)
    }

    /// When the content that was marked last began; `None` if no part was read.
    pub(crate) fn marked_began(&self) -> Option<Appeared> {
        let last = self.marks.last()?;
        let first = self.marks.iter().find(|mark| mark.trunk == last.trunk).unwrap_or(last);
        Some(Appeared { seen: first.ended.max(self.first.seen), ..self.first })
    }

    /// When what the file holds now began, for all that is known without reading it.
    pub(crate) fn last_began(&self) -> Appeared {
        let Some(changed) = self.changed else { return self.first };
        let is_read = self.marks.last().is_some_and(|last| last.ended >= changed);
        let marked = self.marked_began().filter(|_| is_read);
        marked.unwrap_or(Appeared { seen: changed, ..self.first })
    }

    /// When a look first found what the file holds now: the end of that look.
    pub(crate) fn content_seen(&self) -> Duration {
        let began = self.last_began().seen;
        let is_first = began <= self.first.seen + MARKED;
        if is_first { self.first.seen } else { began.saturating_sub(MARKED) }
    }

    /// The lengths at which it was read whole, bytes, the latest one last: a longer content that begins
    /// with one of them continues it.
    pub fn read(&self) -> &[u64] {
        &self.read
    }

    /// When this content of the file began.
    pub fn began(&self, bytes: &[u8]) -> Appeared {
        let Some(changed) = self.changed else { return self.first };
        let began = self.seen_in(bytes).unwrap_or_else(|| {
            let marks = self.compared(bytes);
            let others = marks.filter(|(_, found)| *found == Match::Other);
            let absent = others.map(|(mark, _)| mark.began).max().max(self.first.absent);
            Appeared { absent, seen: changed }
        });
        began.written_by(self.written_last(bytes))
    }

    /// When this content of the file was written at the latest, if times show that it was written elsewhere.
    pub(crate) fn written_last(&self, bytes: &[u8]) -> Option<Duration> {
        self.written(bytes).into_iter().chain(self.written).min()
    }

    /// The same of a part of this content that was seen in this file, whatever the file holds now.
    pub(crate) fn written(&self, bytes: &[u8]) -> Option<Duration> {
        let marks = self.compared(bytes);
        let own = marks.filter(|(_, found)| *found != Match::Other);
        own.filter_map(|(mark, _)| mark.written).min()
    }

    /// Each mark, in their order, and whether it belongs to this content.
    fn compared(&self, bytes: &[u8]) -> impl Iterator<Item = (&Fingerprint, Match)> {
        let trunk = trunk(ends(bytes).0);
        // What was dealt with is no part of what comes after it, unless that begins with it.
        let kept = self.kept.as_ref().map(|kept| kept.trunk.as_deref());
        self.marks.iter().map(move |mark| {
            let is_alike = mark.trunk.is_some() && mark.trunk == trunk;
            let was_kept = kept.is_some_and(|kept| kept == mark.trunk.as_deref());
            let found = match (&mark.trunk, is_alike) {
                _ if mark.begins(bytes) => Match::Same,
                (Some(_), true) if was_kept => Match::Unknown,
                (Some(_), true) => Match::Same,
                (Some(_), false) => Match::Other,
                // A place that was reserved may be this content's; in a file whose content was dealt with, it
                // came after that.
                (None, _) if kept.is_some() => Match::Other,
                (None, _) => Match::Unknown,
            };
            (mark, found)
        })
    }

    /// When a part of this content was seen in this file, whatever the file holds now; `None` if no part
    /// is known to have been seen.
    pub(crate) fn seen_in(&self, bytes: &[u8]) -> Option<Appeared> {
        let mut absent = self.first.absent;
        for (mark, found) in self.compared(bytes) {
            match found {
                Match::Same => {
                    return Some(Appeared { absent, seen: mark.ended.max(self.first.seen) });
                }
                Match::Other => absent = absent.max(Some(mark.began)),
                Match::Unknown => {}
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn s(seconds: u64) -> Duration {
        Duration::from_secs(seconds)
    }

    fn content(of: u8, length: usize) -> Vec<u8> {
        (0..length).map(|at| of.wrapping_add((at % 251) as u8)).collect()
    }

    fn first(absent: u64, seen: u64) -> Writing {
        Writing::new(Appeared { absent: Some(s(absent)), seen: s(seen) })
    }

    #[test]
    fn a_file_that_grows_at_its_end_began_when_it_was_first_seen() {
        let whole = content(1, 30_000);
        let mut writing = first(9, 10);
        for (at, size) in [(10, 5_000), (20, 12_000), (30, 30_000)] {
            if at > 10 {
                writing.change(s(at));
            }
            writing.mark(Fingerprint::whole(s(at), s(at), &whole[..size]));
        }
        let began = Appeared { absent: Some(s(9)), seen: s(10) };
        assert_eq!(writing.began(&whole), began);
    }

    #[test]
    fn a_content_that_does_not_begin_with_what_was_there_began_after_it() {
        let (first_body, second_body) = (content(1, 9_000), content(2, 30_000));
        let mut writing = first(9, 10);
        writing.mark(Fingerprint::whole(s(10), s(11), &first_body));
        writing.change(s(60));
        writing.mark(Fingerprint::whole(s(60), s(61), &second_body[..20_000]));
        writing.change(s(70));
        let began = Appeared { absent: Some(s(10)), seen: s(61) };
        assert_eq!(writing.began(&second_body), began);
    }

    #[test]
    fn a_header_that_two_exports_share_is_no_evidence() {
        let mut writing = first(9, 10);
        writing.mark(Fingerprint::whole(s(10), s(10), b"# exported\n"));
        writing.change(s(60));
        let began = Appeared { absent: Some(s(9)), seen: s(60) };
        assert_eq!(writing.began(&[b"# exported\n", content(2, 9_000).as_slice()].concat()), began);
    }

    #[test]
    fn a_content_whose_header_is_written_last_or_whose_place_was_reserved_began_when_it_was_first_seen()
     {
        let counted =
            |count: u8| [&[b' '; 80][..], &[count, 0, 0, 0], content(1, 9_000).as_slice()].concat();
        let whole = counted(9);
        let mut filled = whole.clone();
        filled[6_000..].fill(0);
        let mut reserved = whole.clone();
        reserved[84..].fill(0);
        let began = Appeared { absent: Some(s(9)), seen: s(10) };
        for (before, seen) in [(&counted(0)[..7_000], 10), (&filled, 10), (&reserved, 30)] {
            let mut writing = first(9, 10);
            writing.mark(Fingerprint::whole(s(10), s(10), before));
            // A press comes in between, and a look at what is there then.
            writing.change(s(20));
            writing.mark(Fingerprint::whole(s(20), s(20), before));
            writing.change(s(30));
            assert_eq!(writing.began(&whole), Appeared { seen: s(seen), ..began });
        }
    }

    #[test]
    fn a_content_after_one_that_was_dealt_with_is_not_taken_for_it_because_they_begin_alike() {
        let alike = content(7, 3_000);
        let [old, new] = [1, 2].map(|of| [alike.as_slice(), &content(of, 9_000)].concat());
        let stamp = Stamp { dev: 1, ino: 7, size: 12_000, mtime_ns: 5, ctime_ns: 5 };
        let mut writing = first(9, 10);
        writing.mark(Fingerprint::whole(s(10), s(10), &old));
        writing.keep(stamp);
        writing.change(s(30));
        writing.mark(Fingerprint::whole(s(30), s(30), &new));
        // Since when it is there is not known.
        assert_eq!(writing.began(&new), Appeared { absent: Some(s(9)), seen: s(30) });
        assert_eq!(writing.began(&old).seen, s(10), "the same again");
        let mut reserved = first(9, 10);
        reserved.mark(Fingerprint::whole(s(10), s(10), &content(1, 9_000)));
        reserved.keep(stamp);
        reserved.change(s(20));
        reserved.mark(Fingerprint::whole(s(20), s(20), &[0; 9_000]));
        reserved.change(s(30));
        assert_eq!(reserved.began(&content(2, 9_000)).absent, Some(s(20)));
    }

    #[test]
    fn a_touched_file_began_when_it_did() {
        let body = content(1, 9_000);
        let mut writing = first(9, 10);
        writing.mark(Fingerprint::whole(s(10), s(10), &body));
        writing.change(s(60));
        assert_eq!(writing.began(&body), Appeared { absent: Some(s(9)), seen: s(10) });
    }

    #[test]
    fn a_content_is_told_from_another_whatever_its_header_and_its_end_say() {
        let mark = |at, bytes: &[u8]| Fingerprint::whole(s(at), s(at), bytes);
        let (body, other) = (content(1, 9_000), content(2, 9_000));
        let behind = |header: &[u8]| [header, body.as_slice()].concat();
        let counted = |count: u8| [&[b' '; 80][..], &[count, 0, 0, 0], body.as_slice()].concat();
        let mut reserved = body.clone();
        reserved[1_000..].fill(0);
        for (before, after, loses) in [
            (&body[..5_000], &body[..], false),
            (&body[..], &other[..], true),
            (&behind(b"# 9:15\n")[..], &behind(b"# again\n# 10:15\n")[..], false),
            (&behind(b"\xef\xbb\xbf\n# 9:15\n")[..], &behind(b"\n# 10:15\n")[..], false),
            (&behind(b"ply\n0 \nend_header")[..], &behind(b"ply\n17\nend_header")[..], false),
            (&counted(0)[..], &counted(9)[..], false),
            // Of a place that is reserved, and of a part that is too short, nothing is known.
            (&reserved[..], &other[..], false),
            (&body[..4_000], &other[..], false),
        ] {
            let mut writing = first(9, 10);
            writing.mark(mark(10, before));
            assert_eq!(writing.loses_to(&mark(20, after)), loses);
        }
        let mut writing = first(9, 10);
        writing.mark(mark(10, &reserved));
        assert!(writing.is_reserved());
    }

    #[test]
    fn a_content_that_was_dealt_with_is_not_lost() {
        let (body, other) = (content(1, 9_000), content(2, 9_000));
        let stamp = Stamp { dev: 1, ino: 7, size: 9_000, mtime_ns: 5, ctime_ns: 5 };
        let mut writing = first(9, 10);
        writing.mark(Fingerprint::whole(s(10), s(10), &body));
        let later = Fingerprint::whole(s(20), s(20), &other);
        assert!(writing.loses_to(&later) && !writing.is_kept(&stamp));
        writing.keep(stamp);
        assert!(!writing.loses_to(&later) && writing.is_kept(&stamp));
        assert!(writing.is_kept(&Stamp { mtime_ns: 6, ctime_ns: 6, ..stamp }), "touched");
        assert!(!writing.is_kept(&Stamp { size: 9_001, mtime_ns: 6, ..stamp }), "it has grown");
    }

    #[test]
    fn the_last_content_began_when_its_first_part_was_read() {
        let mut writing = first(9, 10);
        assert_eq!(writing.last_began().seen, s(10));
        writing.mark(Fingerprint::whole(s(11), s(11), &content(1, 5_000)));
        assert_eq!(writing.last_began().seen, s(10));
        writing.change(s(20));
        assert_eq!(writing.last_began().seen, s(20));
        for (at, length) in [(21, 5_000), (31, 9_000)] {
            writing.mark(Fingerprint::whole(s(at), s(at), &content(2, length)));
        }
        writing.change(s(31));
        assert_eq!(writing.last_began(), Appeared { absent: Some(s(9)), seen: s(21) });
    }

    #[test]
    fn of_many_marks_the_first_and_the_last_are_kept() {
        let whole = content(1, 100_000);
        let mut writing = first(9, 10);
        for at in 0..20 {
            writing.change(s(10 + at));
            writing.mark(Fingerprint::whole(
                s(10 + at),
                s(10 + at),
                &whole[..5_000 * (at as usize + 1)],
            ));
        }
        assert_eq!(writing.marks.len(), MARKS_MOST);
        assert_eq!(writing.began(&whole).seen, s(10));
        assert_eq!(writing.marks.last().map(|mark| mark.size), Some(100_000));
    }

    #[test]
    fn what_came_from_elsewhere_may_be_as_old_as_its_content() {
        let appeared = Appeared { absent: Some(s(99)), seen: s(100) };
        let moved_in = |of: Appeared, moved| of.written_by(written_elsewhere(of.seen, s(moved)));
        assert_eq!(moved_in(appeared, 2), appeared);
        assert_eq!(moved_in(appeared, 60).absent, Some(s(40)));
        assert_eq!(moved_in(appeared, 600).absent, Some(s(0)));
        let unlooked = Appeared { absent: None, seen: s(100) };
        assert_eq!(moved_in(unlooked, 60).absent, None);
    }

    #[test]
    fn an_old_time_is_that_of_the_content_that_had_it() {
        let (old, new) = (content(1, 9_000), content(2, 9_000));
        let mut writing = first(9, 10);
        writing.mark(Fingerprint::whole(s(10), s(10), &old));
        writing.change(s(20));
        writing.date(Some(s(3)));
        assert_eq!(writing.began(&old).absent, Some(s(3)), "before it is read again");
        writing.mark(Fingerprint::whole(s(20), s(20), &old));
        // Somebody sets its time to now.
        writing.change(s(30));
        writing.date(None);
        writing.mark(Fingerprint::whole(s(30), s(30), &old));
        assert_eq!(writing.began(&old), Appeared { absent: Some(s(3)), seen: s(10) });
        writing.change(s(40));
        assert_eq!(writing.began(&new).absent, Some(s(30)), "an export over it is new");
    }

    #[test]
    fn the_lengths_at_which_a_file_was_read_whole_are_kept_the_last_ones_each_once() {
        let whole = content(1, 100_000);
        let mut writing = first(9, 10);
        writing.mark(Fingerprint::whole(s(10), s(10), &whole[..4_500]));
        for size in [5_000, 5_000, 6_000] {
            writing.known(Fingerprint::whole(s(11), s(11), &whole[..size]));
        }
        assert_eq!(writing.read(), [5_000, 6_000]);
        for size in 7..=20 {
            writing.known(Fingerprint::whole(s(12), s(12), &whole[..size * 1000]));
        }
        assert_eq!((writing.read().len(), writing.read()[7]), (READ_MOST, 20_000));
    }
}

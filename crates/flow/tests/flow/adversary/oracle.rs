//! The oracle: the six rules by their definition, looked up in the list of all that the station could
//! observe. It uses none of the laws of `flow::round`. Those name a round for each scan that it gives to a patient;
//! the oracle says which rule that round breaks, if any.

use std::collections::{BTreeMap, BTreeSet};

use gaiter_flow::round::CaptureMatch;
use gaiter_record::SourceKind;

use super::booth::{LATE, NAME_LASTS, WINDOW};
use super::content::Scan;

const WINDOW_MS: u64 = WINDOW.as_millis() as u64;
const LATE_MS: u64 = LATE.as_millis() as u64;
const NAME_LASTS_MS: u64 = NAME_LASTS.as_millis() as u64;

/// How long the export of a press may come, milliseconds.
const AWAITED_MS: u64 = WINDOW_MS + LATE_MS;

/// When a content began: it was absent at the end of one look, none if at no look, and seen at another.
#[derive(Debug, Clone, Copy)]
pub struct Began {
    pub absent_ms: Option<u64>,
    pub seen_ms: u64,
}

/// To whom a content went, as the station said.
#[derive(Debug, Clone)]
pub enum Went {
    /// It is the export of this round, of this patient or of nobody.
    Round { number: i64, patient: Option<String> },
    /// It is held; this round has got an export with it, and no other round may have it.
    Held { answered: Option<i64>, is_alone: bool },
    /// No patient was scanned for it.
    Nobody,
}

impl Went {
    /// None of what is known already.
    pub fn from_match(judged: &CaptureMatch) -> Option<Went> {
        match judged {
            CaptureMatch::Known => None,
            CaptureMatch::Unpressed => Some(Went::Nobody),
            CaptureMatch::Of(capture) => {
                let patient = capture.patient.as_ref().map(|named| named.id.clone());
                Some(Went::Round { number: capture.number, patient })
            }
            CaptureMatch::Held { answered, doubtful, .. } => {
                Some(Went::Held { answered: *answered, is_alone: doubtful.is_empty() })
            }
        }
    }
}

/// What the station observed.
#[derive(Debug, Clone)]
pub enum Seen {
    Press {
        number: i64,
    },
    /// Somebody was named. The order's file was not there at `absent_ms`; without a button it opened or
    /// prolonged a round, and ended others.
    Named {
        id: String,
        by: SourceKind,
        is_sure: bool,
        absent_ms: u64,
        round: i64,
        ended: Vec<i64>,
    },
    /// A name was given and not understood or not kept.
    Unread,
    /// A source of names is away.
    NamesAway,
    /// Presses could not be heard, or one could not be kept.
    PressesAway,
    /// Presses are heard again.
    PressesBack,
    Start,
    CalledOff,
    /// The machine starts anew; no name waits any more.
    Reboot,
    /// The journal was lost and with it everything that waited, which everybody sees.
    JournalLost,
    Gone(Began),
    Taken {
        scan: Scan,
        began: Began,
        others: Vec<Began>,
        went: Went,
        is_rest: bool,
    },
    Measured(Scan),
    Refused(Scan),
    /// A person said whose a scan is; it is that round's export.
    Decided {
        scan: Scan,
        id: Option<String>,
        round: Option<i64>,
    },
}

/// Whom a round is for.
#[derive(Debug, Clone, Default)]
struct Whose {
    ids: Vec<String>,
    is_sure: bool,
    /// Its order came after its press.
    is_ordered_after: bool,
}

/// What was given to the patient of a round.
struct Given {
    number: i64,
    opened_ms: u64,
    scan: Scan,
    began: Began,
}

/// Everything that was observed, and when, milliseconds.
#[derive(Debug, Default)]
pub struct Oracle {
    by_press: bool,
    orders_come_after: bool,
    seen: Vec<(u64, Seen)>,
}

impl Oracle {
    pub fn new(by_press: bool, orders_come_after: bool) -> Oracle {
        Oracle { by_press, orders_come_after, seen: Vec::new() }
    }

    pub fn observe(&mut self, at_ms: u64, what: Seen) {
        self.seen.push((at_ms, what));
    }

    /// Which rule was broken when the content that was taken last was given to a patient.
    pub fn flaw(&self) -> Option<String> {
        let (taken_ms, Seen::Taken { scan, began, others, went, is_rest }) = self.seen.last()?
        else {
            return None;
        };
        let Went::Round { number, patient: Some(patient) } = went else { return None };
        if *is_rest && self.has_part_of(*number, *scan) {
            // It begins with what was given in its round already.
            return None;
        }
        let all = self.whose();
        let (Some(opened_ms), Some(whose)) = (self.opened_ms(*number), all.get(number)) else {
            return Some("there is no such round".to_owned());
        };
        if !whose.is_sure || whose.ids != [patient.clone()] {
            return Some(format!("R2, R3: it is for {whose:?}"));
        }
        let given = Given { number: *number, opened_ms, scan: *scan, began: *began };
        self.rest(&given, &all, *taken_ms)
            .or_else(|| self.new_content(&given, others, patient))
            .or_else(|| self.ears(&given))
            .or_else(|| self.time(&given, *taken_ms))
    }

    /// Whether another content was given to a round that this one goes on with.
    fn has_part_of(&self, round: i64, scan: Scan) -> bool {
        self.seen.iter().any(|(_, what)| match what {
            Seen::Taken { scan: of, went: Went::Round { number, .. }, .. } => {
                *of != scan && *number == round
            }
            _ => false,
        })
    }

    /// R1, and R3: no other round was open at the press, and none was opened before the content began.
    fn rest(&self, given: &Given, all: &BTreeMap<i64, Whose>, taken_ms: u64) -> Option<String> {
        let whose = all.get(&given.number)?;
        let words = self.seen.iter().filter_map(|(at_ms, what)| match what {
            Seen::Named { by: SourceKind::Operator, round, .. } => {
                (*round == given.number).then_some(*at_ms)
            }
            _ => None,
        });
        // Without a button a word of a person ends whatever others wait for, again.
        let rest_ms = words.max().unwrap_or(given.opened_ms);
        self.rounds().into_iter().find_map(|(other, other_ms)| {
            let is_theirs = all.get(&other).is_some_and(|of| of.is_sure && of.ids == whose.ids);
            if other == given.number || is_theirs || other_ms >= given.began.seen_ms {
                return None;
            }
            let (rule, before_ms) = match other_ms > given.opened_ms {
                true => ("R3", taken_ms),
                false => ("R1", rest_ms),
            };
            let is_over = self.is_over(all, other, before_ms, whose);
            (!is_over).then(|| format!("{rule}: round {other} has not ended"))
        })
    }

    /// R4: the content is new, and the only new one.
    fn new_content(&self, given: &Given, others: &[Began], patient: &str) -> Option<String> {
        let Given { number, opened_ms, began, .. } = *given;
        if began.absent_ms.is_none_or(|absent_ms| absent_ms < opened_ms) {
            return Some("R4: it may be older".to_owned());
        }
        if others.iter().any(|other| other.seen_ms > opened_ms) {
            return Some("R4: another content lies there".to_owned());
        }
        let since = self.seen.iter().filter(|(at_ms, _)| *at_ms > opened_ms);
        let is_other = |(at_ms, what): &&(u64, Seen)| match what {
            Seen::Gone(gone) => gone.seen_ms > opened_ms,
            Seen::Taken { scan, .. } if *scan == given.scan => false,
            Seen::Taken { scan, began, went, .. } => match went {
                Went::Round { number: of, .. } if *of == number => !self.was_refused(*scan, *at_ms),
                Went::Round { patient: of, .. } => of.as_deref() != Some(patient),
                // One of before is of an earlier round, which has ended or is theirs.
                Went::Held { .. } => began.seen_ms > opened_ms,
                Went::Nobody => true,
            },
            _ => false,
        };
        let other = since.into_iter().find(is_other);
        other.map(|(at_ms, _)| format!("R4: another content came at {at_ms}"))
    }

    /// R5: everything was heard since the press, and every press since long before it.
    fn ears(&self, given: &Given) -> Option<String> {
        let is_unheard = |(at_ms, what): &&(u64, Seen)| match what {
            Seen::Start | Seen::PressesAway | Seen::PressesBack if self.by_press => {
                at_ms + AWAITED_MS > given.opened_ms
            }
            Seen::Start | Seen::NamesAway | Seen::Unread if !self.by_press => {
                *at_ms > given.opened_ms
            }
            _ => false,
        };
        let unheard = self.seen.iter().find(is_unheard);
        unheard.map(|(at_ms, what)| format!("R5: {what:?} at {at_ms}"))
    }

    /// R6: it began within the window, and was taken before the time for late ones was over.
    fn time(&self, given: &Given, taken_ms: u64) -> Option<String> {
        let until_ms = self.until_ms(given.number, Some(given.scan), taken_ms);
        let is_late = given.began.seen_ms > until_ms || taken_ms > until_ms + LATE_MS;
        is_late.then(|| format!("R6: it was to come before {until_ms}"))
    }

    /// Every round, and when it began.
    fn rounds(&self) -> Vec<(i64, u64)> {
        let number = |what: &Seen| match what {
            Seen::Press { number } => Some(*number),
            Seen::Named { round, .. } if !self.by_press => Some(*round),
            _ => None,
        };
        let mut rounds: Vec<(i64, u64)> = Vec::new();
        for (at_ms, what) in &self.seen {
            let known = number(what).filter(|of| rounds.iter().all(|(known, _)| known != of));
            rounds.extend(known.map(|of| (of, *at_ms)));
        }
        rounds
    }

    fn opened_ms(&self, number: i64) -> Option<u64> {
        let found = self.rounds().into_iter().find(|(of, _)| *of == number);
        found.map(|(_, at_ms)| at_ms)
    }

    fn was_refused(&self, scan: Scan, after_ms: u64) -> bool {
        let is_it = |what: &Seen| matches!(what, Seen::Refused(of) if *of == scan);
        self.seen.iter().any(|(at_ms, what)| *at_ms >= after_ms && is_it(what))
    }

    /// The round whose export a scan is, as was last said before then; none where another was said to be.
    fn round_of(&self, scan: Scan, before_ms: u64) -> Option<i64> {
        let seen = self.seen.iter().filter(|(at_ms, _)| *at_ms <= before_ms);
        let said = seen.filter_map(|(_, what)| match what {
            Seen::Taken { scan, went: Went::Round { number, .. }, .. } => {
                Some((*scan, Some(*number)))
            }
            Seen::Taken { scan, went: Went::Held { answered, .. }, .. } => Some((*scan, *answered)),
            Seen::Decided { scan, round, .. } => Some((*scan, *round)),
            _ => None,
        });
        let said: Vec<(Scan, Option<i64>)> = said.collect();
        let (_, round) = said.iter().rfind(|(of, _)| *of == scan)?;
        let (last, _) = said.iter().rfind(|(_, of)| of == round)?;
        round.filter(|_| *last == scan)
    }

    /// The end of the time in which a round's export may begin, as it is when this scan comes.
    fn until_ms(&self, number: i64, scan: Option<Scan>, before_ms: u64) -> u64 {
        let lasts_ms = if self.by_press { WINDOW_MS } else { NAME_LASTS_MS };
        let mut until_ms = 0;
        for (at_ms, what) in self.seen.iter().filter(|(at_ms, _)| *at_ms <= before_ms) {
            match what {
                Seen::Press { number: of } if *of == number => until_ms = at_ms + lasts_ms,
                Seen::Named { round, .. } if !self.by_press && *round == number => {
                    until_ms = at_ms + lasts_ms;
                }
                // What is over stays so.
                _ if until_ms + LATE_MS < *at_ms => {}
                Seen::Refused(of) if self.round_of(*of, *at_ms) == Some(number) => {
                    until_ms = at_ms + lasts_ms;
                }
                Seen::Taken { scan: of, went: Went::Round { number: to, .. }, .. }
                    if *to == number && scan != Some(*of) =>
                {
                    until_ms = at_ms + WINDOW_MS;
                }
                // A second export of the same scan comes soon.
                Seen::Taken { went: Went::Held { answered: Some(to), is_alone: true }, .. }
                    if *to == number =>
                {
                    until_ms = until_ms.min(at_ms + WINDOW_MS);
                }
                Seen::Decided { round: Some(to), .. } if *to == number => {
                    until_ms = at_ms + WINDOW_MS;
                }
                _ => {}
            }
        }
        until_ms
    }

    /// R1: whether a round ended before then. One that came to nothing needs a word at the booth besides, but
    /// for a press whose order is still to come.
    fn is_over(
        &self,
        all: &BTreeMap<i64, Whose>,
        number: i64,
        before_ms: u64,
        next: &Whose,
    ) -> bool {
        let (Some(opened_ms), Some(whose)) = (self.opened_ms(number), all.get(&number)) else {
            return true;
        };
        let over_ms = self.until_ms(number, None, before_ms) + LATE_MS;
        let is_timed_out = over_ms < before_ms;
        self.seen.iter().any(|(at_ms, what)| {
            let is_in_between = *at_ms >= opened_ms && *at_ms <= before_ms;
            is_in_between
                && match what {
                    Seen::CalledOff | Seen::JournalLost => true,
                    Seen::Decided { round, .. } => *round == Some(number),
                    Seen::Measured(scan) => {
                        let of = self.round_of(*scan, *at_ms);
                        // Measured at last, the same patient's refused scans are closed.
                        let is_theirs = of.and_then(|of| all.get(&of));
                        of == Some(number) || is_theirs.is_some_and(|of| of.ids == whose.ids)
                    }
                    Seen::Named { by, ended, .. } => {
                        let is_word = *by != SourceKind::Order && *at_ms > over_ms;
                        ended.contains(&number) || (is_timed_out && is_word)
                    }
                    _ => false,
                }
        }) || (is_timed_out && (whose.ids.is_empty() || next.is_ordered_after))
    }

    /// R2 and R3: whom each round is for, by the names before it.
    fn whose(&self) -> BTreeMap<i64, Whose> {
        match self.by_press {
            true => self.whose_presses(),
            false => self.whose_names(),
        }
    }

    /// Without a button the name opens its round; an order needs a word since anything went unheard.
    fn whose_names(&self) -> BTreeMap<i64, Whose> {
        let mut whose: BTreeMap<i64, Whose> = BTreeMap::new();
        let mut is_unsure = false;
        for (_, what) in &self.seen {
            match what {
                Seen::Named { id, by, is_sure, round, .. } => {
                    is_unsure &= *by == SourceKind::Order;
                    let is_sure = *is_sure && !is_unsure;
                    let opened = || Whose { ids: vec![id.clone()], is_sure, ..Whose::default() };
                    whose.entry(*round).or_insert_with(opened).is_sure &= is_sure;
                }
                Seen::Unread | Seen::NamesAway | Seen::Start => is_unsure = true,
                Seen::CalledOff => is_unsure = false,
                _ => {}
            }
        }
        whose
    }

    /// Where orders come after the press, whether one waited at a press.
    fn may_be_ordered(&self, press_ms: u64) -> bool {
        self.orders_come_after
            && self.seen.iter().any(|(at_ms, what)| {
                let is_recent = *at_ms <= press_ms && at_ms + NAME_LASTS_MS >= press_ms;
                is_recent && matches!(what, Seen::Named { by: SourceKind::Order, .. })
            })
    }

    fn whose_presses(&self) -> BTreeMap<i64, Whose> {
        let mut names = Waiting::default();
        let mut whose: BTreeMap<i64, (u64, Whose)> = BTreeMap::new();
        // Presses that were given up, or decided upon: no word is for them.
        let (mut called_off_ms, mut decided) = (0, BTreeSet::<i64>::new());
        for (now_ms, what) in &self.seen {
            names.expire(*now_ms);
            if matches!(what, Seen::JournalLost | Seen::Reboot) {
                // Nobody takes a name for one of a press before that.
                whose.values_mut().for_each(|(at_ms, _)| *at_ms = 0);
                names = Waiting::default();
                continue;
            }
            let mut recent = whose.iter().filter(|(_, (at_ms, _))| *now_ms <= at_ms + AWAITED_MS);
            match what {
                Seen::Named { id, by: SourceKind::Order, is_sure, absent_ms, .. } => {
                    let is_overtaken = recent.clone().any(|(_, (at, _))| at > absent_ms);
                    // Several who were named before a press need no other order.
                    let is_crossed = recent.any(|(_, (_, of))| !of.is_sure && of.ids.len() < 2);
                    let is_sure = *is_sure && !is_overtaken;
                    if self.orders_come_after {
                        pair(&mut whose, names.said.is_empty(), (id, is_sure), *now_ms);
                    } else {
                        names.order(id, *now_ms, is_sure && !is_crossed);
                    }
                }
                Seen::Named { id, by, is_sure, .. } => {
                    // Not where an order that came too late for its press may have been for that one.
                    let is_crossed = recent.any(|(number, (at, of))| {
                        let is_settled = *at <= called_off_ms || decided.contains(number);
                        of.ids.is_empty() && !is_settled && !self.may_be_ordered(*at)
                    });
                    names.word(id, *by, *now_ms, *is_sure && !is_crossed);
                }
                Seen::Press { number } => {
                    whose.insert(*number, (*now_ms, names.used()));
                }
                Seen::CalledOff => (names, called_off_ms) = (Waiting::default(), *now_ms),
                Seen::PressesBack => names.is_unsure |= !names.said.is_empty(),
                Seen::Unread | Seen::NamesAway | Seen::PressesAway | Seen::Start => names.doubt(),
                Seen::Taken { went: Went::Nobody, .. } if !names.said.is_empty() => names.doubt(),
                Seen::Decided { id: Some(id), round, .. } => {
                    decided.extend(round);
                    let (own, others): (Vec<_>, Vec<_>) =
                        whose.iter().partition(|(number, _)| Some(**number) == *round);
                    let ids = |of: Vec<(&i64, &(u64, Whose))>| {
                        of.into_iter().flat_map(|(_, (_, of))| of.ids.clone()).collect()
                    };
                    names.decided(id, &ids(own), &ids(others));
                }
                _ => {}
            }
        }
        whose.into_iter().map(|(number, (_, whose))| (number, whose)).collect()
    }
}

/// The names that wait for a press.
#[derive(Debug, Default)]
struct Waiting {
    /// Who, by what, and when.
    said: Vec<(String, SourceKind, u64)>,
    /// The presses of some of them.
    presses: usize,
    /// A word replaced the order of somebody else.
    has_left: bool,
    /// Who was said to be on a scan since the last word at the booth.
    decided: Vec<String>,
    /// It is not sure that the next press is theirs.
    is_unsure: bool,
    /// Something went unheard, or an order was left over, since the last word at the booth.
    was_unheard: bool,
}

impl Waiting {
    fn waits(&self, id: &str) -> bool {
        self.said.iter().any(|(said, _, _)| said == id)
    }

    /// R5: no order is certain before the next word at the booth.
    fn doubt(&mut self) {
        (self.is_unsure, self.was_unheard) = (true, true);
    }

    /// Patients who were named so long ago may still be there.
    fn expire(&mut self, now_ms: u64) {
        let before = self.said.len();
        self.said.retain(|(_, _, at_ms)| now_ms <= at_ms + NAME_LASTS_MS);
        if self.said.len() < before {
            self.presses = self.presses.min(self.said.len().saturating_sub(1));
            self.doubt();
        }
    }

    /// A card or a word says who is there; a card that names somebody else than another did is asked about.
    fn word(&mut self, id: &str, by: SourceKind, now_ms: u64, is_sure: bool) {
        let at_booth = self.said.iter().filter(|(_, by, _)| *by != SourceKind::Order);
        let said: Vec<&String> = at_booth.map(|(said, _, _)| said).collect();
        let is_new = !said.is_empty() && said.iter().all(|said| *said != id);
        let contradicts = by == SourceKind::Reader && is_new;
        if !contradicts {
            let is_left =
                |(said, by, _): &(String, SourceKind, u64)| *by == SourceKind::Order && said != id;
            self.has_left |= self.said.iter().any(is_left);
            (self.said, self.presses) = (Vec::new(), 0);
        }
        self.said.push((id.to_owned(), by, now_ms));
        (self.is_unsure, self.was_unheard) = (contradicts || !is_sure, false);
        self.decided.clear();
    }

    /// A scan that could have been of these is that patient's. The others who were ordered for it may come next
    /// (R2), unless another press may have been theirs.
    fn decided(&mut self, id: &str, own: &BTreeSet<String>, others: &BTreeSet<String>) {
        self.is_unsure |= self.waits(id);
        self.decided.push(id.to_owned());
        let has_scan = |of: &String| others.contains(of) || self.decided.contains(of);
        if own.iter().any(|of| !has_scan(of) && !self.waits(of)) {
            self.doubt();
        }
    }

    fn order(&mut self, id: &str, now_ms: u64, is_sure: bool) {
        self.decided.retain(|decided| decided != id);
        match self.said.iter_mut().find(|(said, _, _)| said == id) {
            Some((_, _, at_ms)) => *at_ms = now_ms,
            None => self.said.push((id.to_owned(), SourceKind::Order, now_ms)),
        }
        self.is_unsure |= !is_sure || self.was_unheard || self.said.len() > 1;
    }

    /// The names of a press. Where there are more than one, they wait for as many presses.
    fn used(&mut self) -> Whose {
        let ids: Vec<String> = self.said.iter().map(|(id, _, _)| id.clone()).collect();
        let is_sure = ids.len() == 1 && !self.is_unsure;
        self.presses += 1;
        if self.presses >= ids.len() {
            (self.said, self.is_unsure, self.presses) = (Vec::new(), false, 0);
        }
        // R2: the patient of an order that a word replaced may come next.
        if self.said.is_empty() {
            self.was_unheard |= std::mem::take(&mut self.has_left);
        }
        Whose { ids, is_sure, ..Whose::default() }
    }
}

/// Where orders come after the press: exactly one after exactly one press without a name.
fn pair(
    whose: &mut BTreeMap<i64, (u64, Whose)>,
    is_next_unnamed: bool,
    (id, is_sure): (&String, bool),
    now_ms: u64,
) {
    let recent = |at_ms: u64| now_ms <= at_ms + AWAITED_MS;
    let mut open: Vec<&mut Whose> =
        whose.values_mut().filter(|(at_ms, _)| recent(*at_ms)).map(|(_, of)| of).collect();
    // One that was named by card still gets its order.
    open.retain(|of| !of.is_ordered_after);
    if let Some(own) = open.iter_mut().find(|of| of.is_sure && of.ids == [id.clone()]) {
        own.is_ordered_after = true;
        return;
    }
    if let [only] = open.as_mut_slice()
        && only.ids.is_empty()
        && is_next_unnamed
    {
        **only = Whose { ids: vec![id.clone()], is_sure, is_ordered_after: true };
        return;
    }
    // The patient who was named before a press is there. An order after it may be another's, but never names
    // a later press.
    for of in open.into_iter().filter(|of| !of.is_sure) {
        of.ids.push(id.clone());
    }
}

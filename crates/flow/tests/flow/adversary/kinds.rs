//! What may happen, by name. Every kind follows every other, many times over a run.

use std::collections::{BTreeMap, BTreeSet};

use super::laws::Off;

/// A kind of event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Somebody is scanned; with a button it is pressed for that.
    Press,
    /// The next patient is scanned before the last export came.
    PressEarly,
    /// The next patient steps in.
    NextPatient,
    /// The person in the booth is named by card or barcode.
    Card,
    /// By a word on the page, or the verb.
    Word,
    /// By an order, before the press.
    Order,
    /// An order 0.5 to 5 s after its press.
    OrderAfterPress,
    /// An order long after its press.
    OrderLate,
    /// The order of the next patient, before the present one's is used or after.
    OrderEarly,
    /// An order that is kept is written again with the same words.
    OrderRepeated,
    /// An order that is kept changes its mode.
    OrderTouched,
    /// A card or an order cannot be read.
    Unread,
    /// A card is read while the reader's port is away, or settles, and nobody notices.
    CardAway,
    /// An order is written while its folder is out of reach.
    OrderAway,
    /// An order is written just before its press, and read after it.
    OrderOvertaken,
    /// The next operator says that nobody is named.
    Nobody,
    /// Somebody who was ordered never comes.
    NoShow,
    /// An export begins under a name of its own.
    Export,
    /// Under a name that was used, in the same file.
    ExportRewrites,
    /// Under a name that was used, as a new file.
    ExportReplaces,
    /// Under a temporary name.
    ExportRenamed,
    /// It was written elsewhere and is moved in.
    ExportMovedIn,
    /// Somebody brings in a scan of somebody else that was made long ago, by some tool.
    OlderBroughtIn,
    /// The export of the later of two presses comes first.
    ExportOutOfOrder,
    /// It comes when its window is over.
    ExportLate,
    /// More of it is written.
    Grows,
    /// All of it is written.
    Ends,
    /// It breaks off.
    BreaksOff,
    /// One that broke off goes on to its end.
    GoesOn,
    /// One comes again with the same bytes.
    AgainSame,
    /// With another comment.
    AgainComment,
    /// Whole after half.
    AgainWhole,
    /// Somebody whose scan was refused is named and scanned again.
    RescanNamed,
    /// Scanned again without a name.
    RescanUnnamed,
    /// Given up without a word.
    GivenUp,
    /// A virus scanner changes the mode of a file,
    Chmod,
    /// a backup links it,
    Link,
    /// somebody renames it or deletes it,
    Rename,
    /// or sets its times.
    Touch,
    /// Somebody pauses the station, or lets it go on.
    Pause,
    /// The folder goes out of reach, or comes back.
    FolderAway,
    /// The button's port goes away, or comes back.
    Unplug,
    /// The process is killed, or starts again.
    Crash,
    /// The process stands still, or goes on.
    Sleep,
    /// The machine starts anew.
    Reboot,
    /// The journal is lost and built anew.
    Rebuild,
    /// The journal cannot be written for a while.
    JournalLocked,
    /// The clock of the file system is set, by a second or by hours.
    ClockSet,
    /// Something fails between spool, journal and memory with the next scan.
    TakeFails,
    /// The store goes out of reach, or comes back.
    StoreAway,
    /// A person says whose a held scan is.
    Decide,
    /// A person takes a scan back.
    TakeBack,
    /// Nothing happens for long.
    Wait,
}

/// In how many sequences a kind occurs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Share {
    Always,
    Half,
    /// There is seldom occasion for these: half, where a law is looked for, else all.
    Seldom,
    /// Half, where no law is looked for that has nothing to do with these.
    Apart,
    /// Of these each sequence has few, and many have none.
    Fault,
}

/// What must meet before a law is put to the test: a sequence is drawn with one of these in mind.
pub fn theme(of: Off) -> &'static [Kind] {
    match of {
        Off::Nothing | Off::CodesMeanOne => &[],
        Off::ContentNotName => &[Kind::ExportRewrites, Kind::BreaksOff],
        Off::Inodes => &[Kind::ExportRenamed, Kind::Rename, Kind::Link],
        Off::BroughtInIsOlder => &[Kind::OlderBroughtIn, Kind::Card],
        Off::KnownAnswerNothing => &[Kind::AgainSame, Kind::PressEarly, Kind::Card],
        Off::RestBefore => &[Kind::BreaksOff, Kind::AgainWhole, Kind::Card, Kind::NextPatient],
        Off::OrdersAddUp => &[Kind::Order, Kind::OrderEarly],
        Off::PressAfterName => &[Kind::OrderAfterPress, Kind::OrderLate],
        Off::FailedNamingDisarms => &[Kind::Unread, Kind::Order],
        Off::EarsOpen => &[Kind::CardAway, Kind::OrderAway, Kind::OrderEarly, Kind::NextPatient],
        Off::InTime => &[Kind::ExportLate, Kind::Card],
        Off::JournalFirst => &[Kind::JournalLocked, Kind::Word, Kind::NextPatient],
        Off::DecisionsOutlive => &[Kind::Decide, Kind::TakeBack, Kind::Rebuild, Kind::StoreAway],
        Off::FreshCompanions => &[Kind::ExportRewrites, Kind::ExportReplaces],
        Off::OrdersNameOnce => &[Kind::Order, Kind::OrderTouched],
    }
}

impl Kind {
    pub const ALL: [Kind; 53] = [
        Kind::Press,
        Kind::PressEarly,
        Kind::NextPatient,
        Kind::Card,
        Kind::Word,
        Kind::Order,
        Kind::OrderAfterPress,
        Kind::OrderLate,
        Kind::OrderEarly,
        Kind::OrderRepeated,
        Kind::OrderTouched,
        Kind::Unread,
        Kind::CardAway,
        Kind::OrderAway,
        Kind::OrderOvertaken,
        Kind::Nobody,
        Kind::NoShow,
        Kind::Export,
        Kind::ExportRewrites,
        Kind::ExportReplaces,
        Kind::ExportRenamed,
        Kind::ExportMovedIn,
        Kind::OlderBroughtIn,
        Kind::ExportOutOfOrder,
        Kind::ExportLate,
        Kind::Grows,
        Kind::Ends,
        Kind::BreaksOff,
        Kind::GoesOn,
        Kind::AgainSame,
        Kind::AgainComment,
        Kind::AgainWhole,
        Kind::RescanNamed,
        Kind::RescanUnnamed,
        Kind::GivenUp,
        Kind::Chmod,
        Kind::Link,
        Kind::Rename,
        Kind::Touch,
        Kind::Pause,
        Kind::FolderAway,
        Kind::Unplug,
        Kind::Crash,
        Kind::Sleep,
        Kind::Reboot,
        Kind::Rebuild,
        Kind::JournalLocked,
        Kind::ClockSet,
        Kind::TakeFails,
        Kind::StoreAway,
        Kind::Decide,
        Kind::TakeBack,
        Kind::Wait,
    ];

    pub fn share(self) -> Share {
        match self {
            Kind::Press | Kind::NextPatient | Kind::Card | Kind::Word => Share::Always,
            Kind::Export | Kind::Ends | Kind::Wait => Share::Always,
            Kind::RescanNamed | Kind::RescanUnnamed | Kind::GivenUp => Share::Seldom,
            Kind::NoShow | Kind::ExportOutOfOrder | Kind::OrderEarly => Share::Seldom,
            Kind::OrderRepeated | Kind::OrderOvertaken => Share::Seldom,
            Kind::OlderBroughtIn => Share::Apart,
            Kind::Pause | Kind::FolderAway | Kind::Unplug | Kind::Crash => Share::Fault,
            Kind::Reboot | Kind::Rebuild | Kind::JournalLocked | Kind::TakeFails => Share::Fault,
            Kind::StoreAway | Kind::ClockSet | Kind::Sleep => Share::Fault,
            _ => Share::Half,
        }
    }

    /// How often it is drawn: what seldom is possible often, what ends much seldom.
    pub fn weight(self) -> usize {
        match self {
            Kind::Press => 12,
            Kind::NextPatient | Kind::Card | Kind::Order => 5,
            Kind::PressEarly | Kind::BreaksOff => 2,
            Kind::Export | Kind::ExportRewrites | Kind::ExportRenamed => 8,
            Kind::ExportReplaces | Kind::ExportMovedIn => 8,
            Kind::ExportLate | Kind::OrderLate | Kind::OrderAfterPress => 6,
            Kind::OrderOvertaken => 8,
            Kind::OrderAway => 5,
            Kind::GoesOn | Kind::AgainWhole => 10,
            Kind::RescanNamed => 115,
            Kind::GivenUp => 105,

            Kind::RescanUnnamed => 165,
            Kind::ExportOutOfOrder => 40,
            Kind::Decide | Kind::TakeBack | Kind::NoShow => 6,
            Kind::Rebuild | Kind::StoreAway | Kind::Crash | Kind::JournalLocked => 1,
            Kind::OlderBroughtIn => 1,
            Kind::Reboot => 5,
            Kind::Unplug => 4,
            Kind::Chmod | Kind::Link | Kind::Rename | Kind::Touch | Kind::Unread => 1,
            Kind::ClockSet => 2,
            Kind::Grows | Kind::Ends | Kind::AgainSame | Kind::AgainComment => 4,
            _ => 3,
        }
    }
}

/// Two events that far apart have to do with each other.
const APART: usize = 10;

/// How often each kind came after each other, with at most [`APART`] events from one to the other.
#[derive(Debug, Default)]
pub struct Pairs(BTreeMap<(Kind, Kind), u64>);

impl Pairs {
    /// One more event happens in a sequence: `before` are those before it, the last one last.
    pub fn note(&mut self, before: &[Kind], after: Kind) {
        let near: BTreeSet<Kind> = before.iter().rev().take(APART).copied().collect();
        for before in near {
            *self.0.entry((before, after)).or_default() += 1;
        }
    }

    pub fn add(&mut self, other: &Pairs) {
        for (pair, count) in &other.0 {
            *self.0.entry(*pair).or_default() += count;
        }
    }

    /// The pair that came least often, and how often.
    pub fn rarest(&self) -> ((Kind, Kind), u64) {
        let all = Kind::ALL.into_iter().flat_map(|a| Kind::ALL.map(|b| (a, b)));
        let counted = all.map(|pair| (pair, self.0.get(&pair).copied().unwrap_or(0)));
        counted.min_by_key(|(_, count)| *count).unwrap_or(((Kind::Wait, Kind::Wait), 0))
    }

    /// The rarest pairs, in words.
    pub fn rare(&self) -> String {
        let all = Kind::ALL.into_iter().flat_map(|a| Kind::ALL.map(|b| (a, b)));
        let mut counted: Vec<(u64, (Kind, Kind))> =
            all.map(|pair| (self.0.get(&pair).copied().unwrap_or(0), pair)).collect();
        counted.sort();
        counted.iter().take(60).map(|(count, pair)| format!("{count} {pair:?}\n")).collect()
    }

    /// How often each kind came after another.
    pub fn counts(&self) -> BTreeMap<Kind, u64> {
        let mut counts = BTreeMap::new();
        for ((_, after), count) in &self.0 {
            *counts.entry(*after).or_default() += count;
        }
        counts
    }
}

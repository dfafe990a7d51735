//! The laws that can be switched off, in the model and never in the program: with any one of them off
//! a wrong name must come up, or the model proves nothing of it.

/// A law that does not hold in a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Off {
    /// All laws hold.
    Nothing,
    /// R4: An export is judged by the first sight of its name, not by that of its content.
    ContentNotName,
    /// R4: A content is followed by its name only, not by device and inode.
    Inodes,
    /// R4: What is brought in is older by its times, its folder or the folder that it takes the place of.
    BroughtInIsOlder,
    /// Known scans answer captures.
    KnownAnswerNothing,
    /// R1: A round begins although earlier captures have not ended.
    RestBefore,
    /// R2: An order replaces the name that waits.
    OrdersAddUp,
    /// R3: A name after a press without one is certain for the next press.
    PressAfterName,
    /// R5: A naming that failed does nothing.
    FailedNamingDisarms,
    /// R5: Nobody tells that a source of names was away, or that an order lay there unread at a press.
    EarsOpen,
    /// R6: The window of a capture is ten times as long as it should be.
    InTime,
    /// A command that the journal did not take has taken effect.
    JournalFirst,
    /// A rebuild forgets what a person decided.
    DecisionsOutlive,
    /// A companion counts that was there before the scan.
    FreshCompanions,
    /// An order that was touched names its patient again.
    OrdersNameOnce,
    /// A code of the worklist that may mean several patients names the first. It has no theme: the worklist draws for
    /// itself.
    CodesMeanOne,
}

impl Off {
    pub const ALL: [Off; 15] = [
        Off::Nothing,
        Off::ContentNotName,
        Off::Inodes,
        Off::BroughtInIsOlder,
        Off::KnownAnswerNothing,
        Off::RestBefore,
        Off::OrdersAddUp,
        Off::PressAfterName,
        Off::FailedNamingDisarms,
        Off::EarsOpen,
        Off::InTime,
        Off::JournalFirst,
        Off::DecisionsOutlive,
        Off::FreshCompanions,
        Off::OrdersNameOnce,
    ];
}

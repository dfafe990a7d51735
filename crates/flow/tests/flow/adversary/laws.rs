//! The laws that can be switched off, in the model and never in the program: with any one of them off
//! a wrong name must come up, or the model proves nothing of it.

/// A law that does not hold in a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Off {
    /// All laws hold.
    Nothing,
    /// An export is judged by the first sight of its name, not by that of its content.
    ContentNotName,
    /// A content is followed by its name only, not by device and inode.
    Inodes,
    /// Known scans answer captures.
    KnownAnswerNothing,
    /// A refusal does not open its capture again.
    RefusalOpensAgain,
    /// A refused capture is no candidate for the exports that come.
    RefusedIsCandidate,
    /// An order replaces the name that waits.
    OrdersAddUp,
    /// An order after a press without a name is certain.
    OrderAfterUnnamedPress,
    /// A naming that failed does nothing.
    FailedNamingDisarms,
    /// A command that the journal did not take has taken effect.
    JournalFirst,
    /// A scan that the spool keeps and the journal does not know answers nothing.
    KeptScansAnswer,
    /// A rebuild forgets what a person decided.
    DecisionsOutlive,
    /// A companion counts that was there before the scan.
    FreshCompanions,
    /// An order that was touched names its patient again.
    OrdersNameOnce,
}

impl Off {
    pub const ALL: [Off; 14] = [
        Off::Nothing,
        Off::ContentNotName,
        Off::Inodes,
        Off::KnownAnswerNothing,
        Off::RefusalOpensAgain,
        Off::RefusedIsCandidate,
        Off::OrdersAddUp,
        Off::OrderAfterUnnamedPress,
        Off::FailedNamingDisarms,
        Off::JournalFirst,
        Off::KeptScansAnswer,
        Off::DecisionsOutlive,
        Off::FreshCompanions,
        Off::OrdersNameOnce,
    ];
}

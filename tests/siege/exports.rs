//! What the restless exporter does with exports, and how often.

use crate::chance::Chance;
use crate::plan::weighed;

/// What is done with exports.
#[derive(Debug, Clone, Copy)]
pub enum Act {
    /// A scan in one go.
    Whole,
    /// A scan under a temporary name that is renamed.
    Renamed,
    /// A scan in pieces.
    Pieces,
    /// So many things at once.
    Many(usize),
    /// The beginning of a scan.
    Begin,
    /// The rest of one.
    Finish,
    /// Another scan in place of one, into the same file.
    Rewrite,
    /// Another scan in place of one, by a rename.
    Replace,
    /// Another name for one.
    Rename { same_patient: bool },
    /// One is taken away.
    Remove,
    /// Its mode is changed.
    Chmod,
    /// Its time is changed.
    Touch,
    /// The same bytes under another name.
    Again(Whom),
    /// What calls itself a scan and is none.
    Garbage,
    /// What is no scan.
    NoScan,
    /// A scan that is taken away before anybody may have seen it.
    Fleeting,
}

/// Whom another name names.
#[derive(Debug, Clone, Copy)]
pub enum Whom {
    Same,
    Another,
    Nobody,
}

pub fn draw(chance: &mut Chance) -> Act {
    let same_patient = chance.below(2) == 0;
    let many = 5 + chance.below(15);
    let acts = [
        (8, Act::Whole),
        (3, Act::Renamed),
        (2, Act::Pieces),
        (1, Act::Many(many)),
        (4, Act::Begin),
        (4, Act::Finish),
        (2, Act::Rewrite),
        (2, Act::Replace),
        (3, Act::Rename { same_patient }),
        (4, Act::Remove),
        (2, Act::Chmod),
        (2, Act::Touch),
        (2, Act::Again(Whom::Same)),
        (2, Act::Again(Whom::Another)),
        (1, Act::Again(Whom::Nobody)),
        (3, Act::Garbage),
        (3, Act::NoScan),
        (2, Act::Fleeting),
    ];
    weighed(chance, &acts)
}

//! A person sets measures of a stored record.

use std::collections::BTreeSet;
use std::fmt::Display;
use std::path::PathBuf;

use gaiter_flow::ScanId;
use gaiter_record::completeness::{Completeness, Kind};
use gaiter_record::measure::amendment::{Amendment, Deed};
use jiff::{Timestamp, Zoned};
use serde::{Deserialize, Serialize};
use tracing::info;

use super::fault::ActFault;
use crate::station::booth::Booth;
use crate::station::core::Core;
use crate::station::event::short;
use crate::station::journal::ScanRow;
use crate::store::FolderStore;
use crate::store::revision::amend::amend_record;

/// What a person sets, and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// The measures, in the order in which they are set.
    pub measures: Vec<Measured>,
    pub reason: String,
    /// The person's name.
    pub by: String,
    /// They are sure of values that are far off the scan's.
    #[serde(default)]
    pub is_sure: bool,
}

/// One measure; see [`Amendment`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// `left` or `right`.
    pub leg: String,
    /// A level, `foot-length`, `foot-breadth` or `inside-leg`.
    pub measure: String,
    /// What the person did.
    pub is: Deed,
    #[serde(default)]
    pub girth_mm: Option<f64>,
    /// The height above the floor, mm.
    #[serde(default)]
    pub height_mm: Option<f64>,
    #[serde(default)]
    pub length_mm: Option<f64>,
}

impl Setting {
    /// The amendments of a record, made at this time.
    pub fn amendments(&self, at: Timestamp) -> Vec<Amendment> {
        let at = Timestamp::from_second(at.as_second()).unwrap_or(at);
        let amendment = |of: &Measured| Amendment {
            leg: of.leg.clone(),
            measure: of.measure.clone(),
            is: of.is,
            girth_mm: of.girth_mm,
            height_mm: of.height_mm,
            length_mm: of.length_mm,
            reason: self.reason.trim().to_owned(),
            by: self.by.trim().to_owned(),
            at,
        };
        self.measures.iter().map(amendment).collect()
    }
}

/// Sets measures of the record of a scan: of its only patient, of the patient named, or of the unassigned
/// one.
pub(in crate::station::operator) fn set(
    core: &Core,
    booth: &Booth,
    row: &ScanRow,
    patient: Option<&str>,
    setting: &Setting,
) -> Result<String, ActFault> {
    let journal = core.custody.journal();
    let patient = owner(core, &row.scan, patient)?;
    let no_record = || ActFault::NoOccasion { scan: row.scan.clone(), why: "act.why.no_record" };
    let folder = journal.record_folder(&row.scan, &patient)?.ok_or_else(no_record)?;
    let config = &core.config;
    let choice = config.report_choice(Zoned::now().date());
    let amendments = setting.amendments(Timestamp::now());
    let others: Vec<&str> =
        core.stores.names().into_iter().filter(|name| *name != FolderStore::FIRST).collect();
    journal.amend_begun(&row.scan, &patient, &others)?;
    let amended = amend_record(&PathBuf::from(folder), &amendments, setting.is_sure, &choice);
    let measures: BTreeSet<String> = match &amended {
        Ok(_) => amendments.iter().map(|of| format!("{} {}", of.leg, of.measure)).collect(),
        Err(_) => BTreeSet::new(),
    };
    journal.amend_ended(&row.scan, &patient, &Vec::from_iter(measures))?;
    let amended = amended?;
    let completeness = Completeness::from_record(&amended.record, &config.garment);
    let lacks = matches!(completeness.kind(), Kind::ByHand | Kind::ScanAgain);
    journal.still_lacks_measures(&row.scan, lacks)?;
    let sentences = completeness.sentences(config.language);
    let verdict = sentences.join(" ");
    booth.amended(&row.scan, sentences);
    let (scan, revision) = (short(&row.scan), amended.record.revision);
    info!(event = "record-amended", scan, revision);
    let words: [(&str, &dyn Display); 3] =
        [("scan", &scan), ("revision", &revision), ("verdict", &verdict)];
    Ok(config.language.filled("act.amended", &words))
}

/// The patient whose record is amended, as the journal's column holds it.
fn owner(core: &Core, scan: &ScanId, patient: Option<&str>) -> Result<String, ActFault> {
    let owners = core.custody.journal().owners(scan)?;
    match (owners.as_slice(), patient) {
        ([], None) => Ok(String::new()),
        ([owner], None) => Ok(owner.clone()),
        (owners, Some(patient)) if owners.iter().any(|owner| owner == patient) => {
            Ok(patient.to_owned())
        }
        (_, Some(_)) => {
            Err(ActFault::NoOccasion { scan: scan.clone(), why: "act.why.not_this_patient" })
        }
        (_, None) => Err(ActFault::NoOccasion { scan: scan.clone(), why: "act.why.amend_several" }),
    }
}

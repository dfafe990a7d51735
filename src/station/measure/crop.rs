//! Crops scans for an archive, each in a process of its own.

use std::fs;
use std::path::Path;
use std::time::Duration;

use gaiter_confined::{Blame, Ended};
use gaiter_flow::ScanId;
use gaiter_record::RecordFile;

use super::job::{CropJob, Job, JobAnswer, Purpose};
use super::parent::measure;
use crate::config::MeasureConfig;
use crate::station::runtime::chain;
use crate::store::archive::{CropScan, Cropped};
use crate::store::{Rejection, StoreFault};

/// The files of the answer: the crop, and what the whole body told.
pub(super) const CROP: &str = "crop.ply";
pub(super) const WHOLE_BODY: &str = "whole-body.json";

/// Crops scans in processes with these limits.
#[derive(Debug)]
pub struct ConfinedCrop {
    pub limits: MeasureConfig,
    /// How scans are measured and cropped.
    pub job: CropJob,
}

impl CropScan for ConfinedCrop {
    fn crop(&self, scan: &ScanId, file: &Path, ending: &str) -> Result<Cropped, StoreFault> {
        let never = |why| StoreFault::Permanent(Rejection::CropDiffers { why });
        let metadata = fs::metadata(file).map_err(|error| StoreFault::NoCrop(error.to_string()))?;
        let purpose = Purpose::Crop(Box::new(self.job.clone()));
        let job = Job::new(&self.limits, purpose, ending, metadata.len());
        let ended = measure(scan, &job, file, None);
        match ended.map_err(|fault| StoreFault::NoCrop(chain(&fault)))? {
            Ended::Answered(JobAnswer::Files { files, .. }) => cropped(files),
            Ended::Answered(JobAnswer::Refused { message, .. }) => Err(never(message)),
            Ended::Answered(JobAnswer::Inspected(_) | JobAnswer::Checked(_)) => Err(no_answer()),
            Ended::Trouble(trouble) if trouble.blame() == Blame::Scan => {
                Err(never(trouble.to_string()))
            }
            Ended::Trouble(trouble) => Err(StoreFault::NoCrop(trouble.to_string())),
        }
    }

    fn longest(&self) -> Duration {
        self.limits.wall
    }
}

fn cropped(files: Vec<RecordFile>) -> Result<Cropped, StoreFault> {
    let (mut ply, mut whole) = (None, None);
    for RecordFile { name, bytes } in files {
        match name.as_str() {
            CROP => ply = Some(bytes),
            WHOLE_BODY => whole = serde_json::from_slice(&bytes).ok(),
            _ => {}
        }
    }
    let (ply, whole) = ply.zip(whole).ok_or_else(no_answer)?;
    Ok(Cropped { ply, whole })
}

fn no_answer() -> StoreFault {
    StoreFault::NoCrop("the measuring process gave no crop".to_owned())
}

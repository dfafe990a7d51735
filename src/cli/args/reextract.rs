//! `gaiter reextract`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use jiff::Timestamp;
use jiff::civil::Date;
use jiff::tz::TimeZone;

/// `gaiter reextract`
#[derive(Debug, clap::Args)]
pub struct ReextractArgs {
    /// The store's folder, one patient's folder in it, or one record's
    #[arg(value_name = "RECORDS")]
    pub records: PathBuf,
    /// Only scans first seen on this day or later, UTC: 2026-11-21, or 2026-11-21T09:15:00Z
    #[arg(long, value_name = "DATE", value_parser = since)]
    pub since: Option<Timestamp>,
    /// Measure with this configuration: its method, its description of the scanner's exports, its
    /// files. Without it: the default method, and the description in each record
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Number of scans to process at a time [default: number of processors]
    #[arg(long, value_name = "N")]
    pub jobs: Option<NonZeroUsize>,
    /// Also write a revision if all figures are the same but the record lacks keys that an older gaiter
    /// did not write
    #[arg(long)]
    pub complete: bool,
    /// Only show what would change; write nothing
    #[arg(long)]
    pub dry_run: bool,
    /// Name records by their folders, which show the patient, instead of by their scans
    #[arg(long)]
    pub names: bool,
    /// Print one JSON object per record and line, for programs
    #[arg(long)]
    pub json: bool,
}

/// Parses a day, which stands for its beginning, or a moment.
fn since(text: &str) -> Result<Timestamp, String> {
    let moment = text.parse::<Timestamp>().ok();
    // If a moment without a zone were parsed as a day, its time would be lost.
    let day = || Date::strptime("%Y-%m-%d", text).ok()?.to_zoned(TimeZone::UTC).ok();
    moment
        .or_else(|| day().map(|day| day.timestamp()))
        .ok_or_else(|| "write a day as 2026-11-21, a moment as 2026-11-21T09:15:00Z".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_begins_at_midnight_utc() {
        let midnight = "2026-11-21T00:00:00Z".parse().unwrap();
        assert_eq!(since("2026-11-21"), Ok(midnight));
        assert_eq!(since("2026-11-21T01:00:00+01:00"), Ok(midnight));
        for text in ["", "yesterday", "21.11.2026", "2026-13-01", "2026-11-21T09:15"] {
            assert!(since(text).is_err(), "{text}");
        }
    }
}

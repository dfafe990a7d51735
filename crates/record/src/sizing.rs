//! The sizes of tables for a record, and where its girth changes too fast for a circular knit.

pub mod calibre;
mod readings;
pub mod words;

use gaiter_leg::Side;
use gaiter_sizes::table::{Basis, Limits, Status};
use gaiter_sizes::verdict::{LegVerdict, NotComparable, PointVerdict, leg_verdict};
use gaiter_sizes::{Garment, Point, SizeTable};
use jiff::civil::Date;
use serde::{Deserialize, Serialize};

use self::calibre::Stretch;
pub use self::readings::{TAPE_GIRTH_MM, reading};
use super::Record;

/// Name and number of the schema of the verdicts as JSON.
pub const SCHEMA: &str = "gaiter.size-verdicts/1";

/// Standard error of all girths of a scan in common, mm, where nothing better is known: scanners and tapes
/// differ by 1 to 4 mm, and a scanner that is checked with a phantom stays within about 1 mm.
pub const SCANNER_GIRTH_MM: f64 = 1.0;

/// By which tables a report judges a record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SizeChoice {
    /// The tables, in the order in which they are shown.
    pub tables: Vec<SizeTable>,
    /// The day of the report: a table may be expired by then.
    pub today: Date,
    /// A standard error that is common to all girths of the scanner, mm; 0 to leave it out.
    pub scanner_girth_mm: f64,
}

impl Default for SizeChoice {
    fn default() -> SizeChoice {
        let today = Date::default();
        SizeChoice { tables: Vec::new(), today, scanner_girth_mm: SCANNER_GIRTH_MM }
    }
}

/// The verdicts of tables on a record.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SizeVerdicts {
    /// The name and number of this schema.
    pub schema: &'static str,
    /// SHA-256 of the scan.
    pub scan: String,
    /// The revision of the record.
    pub revision: u32,
    /// The garment that is ordered.
    pub garment: String,
    /// The day on which the tables were looked at.
    pub today: Date,
    /// The standard error that is common to all girths of the scanner, mm.
    pub scanner_girth_mm: f64,
    /// The standard error of a girth that a person took with a tape, mm.
    pub tape_girth_mm: f64,
    /// The tables, in their order.
    pub tables: Vec<TableVerdict>,
    /// How fast the girth changes between adjacent points of the form.
    pub calibre: Vec<Stretch>,
}

/// A table's verdict on a record.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TableVerdict {
    /// The table's name.
    pub id: String,
    /// Who makes the garment.
    pub maker: String,
    /// The garment.
    pub product: String,
    /// Edition or date of the table.
    pub edition: String,
    /// Where its figures were read.
    pub source: String,
    /// SHA-256 of its file.
    pub sha256: String,
    /// What it may be used for.
    pub status: Status,
    /// Who entered its figures; null if none is named.
    pub entered_by: Option<String>,
    /// Who checked them; null if none is named.
    pub checked_by: Option<String>,
    /// The last day on which it is valid; null if not stated.
    pub valid_until: Option<Date>,
    /// Whether it is no longer valid.
    pub is_expired: bool,
    /// Whether its girths are of skin; null if not stated.
    pub basis: Option<Basis>,
    /// Whether a limit belongs to its range.
    pub limits: Limits,
    /// The point by which the size is sought; null if no point is.
    pub decides: Option<Point>,
    /// Why it has no verdict on this garment; null if it has one.
    pub not_comparable: Option<NotComparable>,
    /// Each leg of the record, the right one first; empty if it has no verdict.
    pub legs: Vec<LegSizes>,
}

/// A table's verdict on a leg.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LegSizes {
    /// The patient's `left` or `right`.
    pub side: &'static str,
    /// Its verdicts.
    #[serde(flatten)]
    pub verdict: LegVerdict,
}

impl SizeVerdicts {
    /// The tables' verdicts on a record for an order of this garment.
    pub fn new(record: &Record, garment: &Garment, choice: &SizeChoice) -> SizeVerdicts {
        SizeVerdicts {
            schema: SCHEMA,
            scan: record.scan.sha256.clone(),
            revision: record.revision,
            garment: garment.name().to_owned(),
            today: choice.today,
            scanner_girth_mm: choice.scanner_girth_mm,
            tape_girth_mm: TAPE_GIRTH_MM,
            tables: choice.tables.iter().map(|of| table(record, garment, of, choice)).collect(),
            calibre: calibre::stretches(record, garment),
        }
    }

    /// Whether something holds for a point that a table asks for.
    pub fn has(&self, holds: impl Fn(&PointVerdict) -> bool) -> bool {
        let legs = self.tables.iter().flat_map(|table| &table.legs).map(|leg| &leg.verdict);
        let mut points = legs.flat_map(|leg| {
            let sizes = leg.sizes.iter().flat_map(|of| &of.points);
            sizes.chain(leg.lengths.iter().flat_map(|of| &of.points))
        });
        points.any(holds)
    }
}

fn table(
    record: &Record,
    garment: &Garment,
    table: &SizeTable,
    choice: &SizeChoice,
) -> TableVerdict {
    let leg = |side: Side| {
        let reading = |point| reading(record, side, point, choice.scanner_girth_mm);
        leg_verdict(table, garment, reading).map(|verdict| LegSizes { side: side.word(), verdict })
    };
    let (not_comparable, legs) = match record.sides().map(leg).collect::<Result<Vec<_>, _>>() {
        Ok(legs) => (None, legs),
        Err(why) => (Some(why), Vec::new()),
    };
    TableVerdict {
        id: table.id.clone(),
        maker: table.maker.clone(),
        product: table.product.clone(),
        edition: table.edition.clone(),
        source: table.source.clone(),
        sha256: table.sha256.clone(),
        status: table.status,
        entered_by: table.entered_by.clone(),
        checked_by: table.checked_by.clone(),
        valid_until: table.valid_until,
        is_expired: table.is_expired(choice.today),
        basis: table.basis,
        limits: table.limits,
        decides: table.decides,
        not_comparable,
        legs,
    }
}

//! What a person should know of the size tables that reports are made with.

use jiff::Zoned;

use super::row::{Row, Verdict};
use crate::cli::sizes::remark_in_words;
use crate::config::Config;
use crate::language::Language;
use crate::sizes::Garment;
use crate::sizes::check::remarks;

/// The check's name in the table.
const CHECK: &str = "size table";

/// A row for each remark on a table; one that says so for a table without remarks.
pub(super) fn rows(config: &Config) -> Vec<Row> {
    let today = Zoned::now().date();
    let names: Vec<&str> = config.garments.iter().map(Garment::name).collect();
    let mut rows = Vec::new();
    for table in &config.tables {
        let remarks = remarks(table, today, &names);
        if remarks.is_empty() {
            rows.push(Row::at(CHECK, &table.id, Verdict::Ok, "no remark"));
        }
        for remark in remarks {
            let said = remark_in_words(&remark, Language::En);
            rows.push(Row::at(CHECK, &table.id, Verdict::Warn, said));
        }
    }
    rows
}

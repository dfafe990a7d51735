//! What a person should know of the size tables that reports are made with.

use gaiter_language::Language;
use gaiter_record::shown::id;
use gaiter_sizes::check::{Remark, remarks};
use gaiter_sizes::{Garment, SizeTable};
use jiff::Zoned;

use super::row::{Row, Verdict};
use crate::cli::sizes::remark_in_words;
use crate::config::Config;

/// The check's name in the table.
const CHECK: &str = "size table";

/// A row for each remark on a table. How neighbouring sizes lie is in one row, which is no warning.
pub(super) fn rows(config: &Config) -> Vec<Row> {
    let today = Zoned::now().date();
    let names: Vec<&str> = config.garments.iter().map(Garment::name).collect();
    let mut rows = Vec::new();
    for table in &config.tables {
        let (of_neighbours, warnings): (Vec<Remark>, Vec<Remark>) =
            remarks(table, today, &names).into_iter().partition(Remark::is_of_neighbours);
        rows.push(Row::at(CHECK, &table.id, Verdict::Ok, in_use(table, of_neighbours.len())));
        for remark in warnings {
            let text = remark_in_words(&remark, Language::En);
            rows.push(Row::at(CHECK, &table.id, Verdict::Warn, text));
        }
    }
    rows
}

fn in_use(table: &SizeTable, of_neighbours: usize) -> String {
    let text = format!("{}, {}: in use", id(&table.product), id(&table.edition));
    match of_neighbours {
        0 => text,
        count => format!(
            "{text}; gaps, overlaps and touching limits: {count}, gaiter sizes check names them"
        ),
    }
}

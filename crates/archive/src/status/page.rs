//! The state of the archive as a page. It runs no script, and what others wrote is escaped.

use std::fmt::Display;
use std::slice::from_ref;

use gaiter_record::shown::escaped;

use super::{LetterRow, MethodRow, Status, WorkerRow};

/// What is before the tables.
const HEAD: &str = "<!DOCTYPE html>
<html lang=\"en\"><head><meta charset=\"utf-8\"><meta http-equiv=\"refresh\" content=\"60\">
<meta name=\"viewport\" content=\"width=device-width\"><title>gaiter archive</title><style>
body { font: 1rem/1.4 sans-serif; margin: 2rem }
table { border-collapse: collapse; margin-bottom: 2rem }
caption { text-align: left; font-weight: bold }
th, td { text-align: left; padding: .2rem .8rem .2rem 0; border-bottom: 1px solid #ccc }
.fault { background: #fdd }
</style></head><body>
";

impl Status {
    pub(super) fn page(&self) -> String {
        let stations = self.stations.iter().map(|of| {
            let class = if of.is_well() { "" } else { "fault" };
            (class, [from_ref(&of.station), &of.cells()[..]].concat())
        });
        let methods = self.methods.iter().map(|of| {
            let MethodRow { method, is_current, results, refused, waiting, claimed, dead } = of;
            let current = if *is_current { "current" } else { "" };
            let counts = [results, refused, waiting, claimed, dead].map(i64::to_string);
            ("", [&[method.clone(), current.to_owned()][..], &counts[..]].concat())
        });
        let workers = self.workers.iter();
        let workers = workers
            .map(|WorkerRow { worker, claimed }| ("", vec![worker.clone(), claimed.to_string()]));
        let letters = self.dead_letters.iter().map(|LetterRow { scan, method, reason }| {
            ("fault", vec![scan.clone(), method.clone(), reason.clone()])
        });
        let of_station =
            ["station", "heard", "version", "undelivered", "refusals", "phantom", "scans"];
        let of_method =
            ["method", "", "results", "refused", "waiting", "claimed or put off", "dead letters"];
        [
            HEAD.to_owned(),
            format!("<p>{} scans</p>\n", self.scans),
            table("Stations", &of_station, stations),
            table("Methods", &of_method, methods),
            table("Workers", &["worker", "claimed"], workers),
            table("Dead letters", &["scan", "method", "reason"], letters),
            "</body></html>\n".to_owned(),
        ]
        .concat()
    }
}

/// A table, of rows with a class; nothing if there are none.
fn table(
    caption: &str,
    heads: &[&str],
    rows: impl Iterator<Item = (&'static str, Vec<String>)>,
) -> String {
    let rows: Vec<String> = rows
        .map(|(class, texts)| format!("<tr class=\"{class}\">{}</tr>\n", cells("td", &texts)))
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let head = format!("<tr>{}</tr>\n", cells("th", heads));
    format!("<table><caption>{caption}</caption>\n{head}{}</table>\n", rows.concat())
}

fn cells(element: &str, texts: &[impl Display]) -> String {
    let cell = |text: String| format!("<{element}>{}</{element}>", escaped(&text));
    texts.iter().map(|text| cell(text.to_string())).collect()
}

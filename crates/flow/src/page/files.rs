//! The files of a record on the page: their order, and what a browser may do with each.

/// The names that the page shows first, with words of their own: those for people, and last the record.
pub const FIRST: [&str; 6] = [
    "report.html",
    "report.pdf",
    "legs.svg",
    "measurements-spreadsheet.csv",
    "order-spreadsheet.csv",
    "record.json",
];

/// The names of the files of a preview. It has no table: nothing is ordered of a scan that is held.
pub const PREVIEW: [&str; 4] = ["report.html", "report.pdf", "legs.svg", "record.json"];

/// How a file of a record is served.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Served {
    /// Its media type.
    pub kind: &'static str,
    /// Its content security policy.
    pub policy: &'static str,
    /// The browser opens it; it saves every other file.
    pub opens: bool,
}

/// A drawing runs nothing and fetches nothing.
const DRAWING: &str = "default-src 'none'; style-src 'unsafe-inline'; frame-ancestors 'none'";

/// A report runs its own viewer, as a page of no origin: it can access neither the token nor the
/// station.
const REPORT: &str = "sandbox allow-scripts allow-modals; default-src 'none'; \
                      script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; \
                      font-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Data for programs.
const DATA: &str = "default-src 'none'; frame-ancestors 'none'";

/// The browser's own viewer for such files uses styles of its own.
const PAPER: &str = "default-src 'self'; style-src 'unsafe-inline'; script-src 'none'; \
                     frame-ancestors 'self'";

/// How a file of this name is served. A scan comes from the scanner, so it is bytes and nothing that a
/// browser opens.
pub fn served(name: &str) -> Served {
    let opened = |kind, policy| Served { kind, policy, opens: true };
    let saved = |kind| Served { kind, policy: DATA, opens: false };
    match name {
        "report.html" => return opened("text/html; charset=utf-8", REPORT),
        "SHA256SUMS" => return opened("text/plain; charset=utf-8", DATA),
        _ if name.starts_with("scan.") => return saved("application/octet-stream"),
        _ => {}
    }
    match name.rsplit_once('.').map_or("", |(_, ending)| ending) {
        "pdf" => opened("application/pdf", PAPER),
        "svg" => opened("image/svg+xml", DRAWING),
        "json" => opened("application/json", DATA),
        "csv" => saved("text/csv; charset=utf-8"),
        "step" => saved("model/step"),
        "igs" => saved("model/iges"),
        "stl" => saved("model/stl"),
        "obj" => saved("model/obj"),
        "glb" => saved("model/gltf-binary"),
        _ => saved("application/octet-stream"),
    }
}

/// The names of a record's files in the order in which the page shows them.
pub fn in_order(mut names: Vec<String>) -> Vec<String> {
    names.sort_by_key(|name| FIRST.iter().position(|first| first == name).unwrap_or(FIRST.len()));
    names
}

#[cfg(test)]
mod tests {
    use gaiter_language::Language;

    use super::*;

    #[test]
    fn nothing_that_a_scanner_wrote_is_opened_by_a_browser() {
        for name in ["scan.obj", "scan.wrl", "scan.svg", "scan.html", "scanner.ord", "notes.html"] {
            assert!(!served(name).opens, "{name}");
        }
        for name in PREVIEW {
            assert!(served(name).opens, "{name}");
        }
    }

    #[test]
    fn the_report_is_first_then_come_the_tables_for_people_and_all_others_keep_their_order() {
        let names = [
            "record.json",
            "measurements.csv",
            "measurements-spreadsheet.csv",
            "order.csv",
            "order-spreadsheet.csv",
            "left.step",
            "legs.svg",
            "SHA256SUMS",
            "report.html",
        ];
        let order = [
            "report.html",
            "legs.svg",
            "measurements-spreadsheet.csv",
            "order-spreadsheet.csv",
            "record.json",
            "measurements.csv",
            "order.csv",
            "left.step",
            "SHA256SUMS",
        ];
        assert_eq!(in_order(names.map(str::to_owned).into()), order);
    }

    #[test]
    fn what_the_page_shows_first_has_words_of_its_own_in_every_language() {
        for name in FIRST {
            for language in Language::ALL {
                assert!(language.find(&format!("page.label.{name}")).is_some(), "{name}");
            }
        }
        assert!(PREVIEW.iter().all(|name| FIRST.contains(name)));
    }
}

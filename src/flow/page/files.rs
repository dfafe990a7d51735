//! The files of a record that the page shows, and what a browser may do with each.

/// A file of a record that the page shows.
#[derive(Debug)]
pub struct ShownFile {
    /// Its name.
    pub name: &'static str,
    /// Its media type.
    pub kind: &'static str,
    /// Its content security policy.
    pub policy: &'static str,
    /// It identifies the patient.
    pub names_patient: bool,
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

/// The only files that are served.
pub const FILES: [ShownFile; 4] = [
    ShownFile {
        name: "report.html",
        kind: "text/html; charset=utf-8",
        policy: REPORT,
        names_patient: true,
    },
    ShownFile { name: "report.pdf", kind: "application/pdf", policy: PAPER, names_patient: true },
    ShownFile { name: "legs.svg", kind: "image/svg+xml", policy: DRAWING, names_patient: false },
    ShownFile { name: "record.json", kind: "application/json", policy: DATA, names_patient: true },
];

//! Writes what is printed of records: `report.pdf`, in every language.
//!
//! `cargo run --example report_paper -- OUT RECORD.json…`

#![allow(clippy::disallowed_methods, clippy::disallowed_types, clippy::print_stdout)]

use std::error::Error;
use std::path::Path;
use std::time::Instant;
use std::{env, fs};

use gaiter_language::Language;
use gaiter_record::Record;
use gaiter_record::picture::figures;
use gaiter_record::report::{self, Print, ReportContent};
use gaiter_sizes::Garment;

/// The other work of a machine makes single times longer, never shorter.
const TIMES: usize = 20;

fn fastest_ms<T>(work: impl Fn() -> T) -> f64 {
    let time = |_| {
        let begun = Instant::now();
        let _ = work();
        begun.elapsed().as_secs_f64() * 1e3
    };
    (0..TIMES).map(time).fold(f64::INFINITY, f64::min)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = env::args().skip(1);
    let out = args.next().ok_or("OUT RECORD.json…")?;
    for (index, path) in args.enumerate() {
        let record: Record = serde_json::from_slice(&fs::read(&path)?)?;
        for language in Language::ALL {
            let drawn = figures::all(&record, language);
            let content = ReportContent::from_record(&record, language, &Garment::default());
            let document = content.document(&record, &drawn);
            let paper = report::paper(&document, Print::default())?;
            let milliseconds = fastest_ms(|| report::paper(&document, Print::default()));
            let stem = format!("{index}-{}", language.tag());
            println!("{stem} {path}: {} bytes in {milliseconds:.1} ms", paper.len());
            fs::write(Path::new(&out).join(format!("{stem}.pdf")), paper)?;
        }
    }
    Ok(())
}

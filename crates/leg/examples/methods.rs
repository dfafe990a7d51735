//! The methods beside each other on a folder of scans with truth:
//! `cargo run --release --example methods -- FOLDER`.
//!
//! First every scan of the folder as it is, then its clean bodies with noise and fewer points.

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

#[path = "support/degraded.rs"]
mod degraded;
#[path = "support/tally.rs"]
mod tally;
#[path = "support/truth.rs"]
mod truth;

use std::error::Error;
use std::io::{self, Write};
use std::path::Path;

use degraded::{mean_edge, noisy, thinned};
use gaiter_leg::Method;
use gaiter_leg::method::{AxisFit, SectionFit, Tape, Unit};
use gaiter_scan::{Format, Scan, read};
use rayon::prelude::*;
use support::writers::obj;
use tally::Tally;
use truth::{Case, cases};

/// The methods that are compared.
const METHODS: [(&str, SectionFit, Tape); 6] = [
    ("skin", SectionFit::Skin, Tape::Shank),
    ("skin, whole leg", SectionFit::Skin, Tape::Leg(AxisFit::Centroids)),
    ("skin, horizontal", SectionFit::Skin, Tape::Horizontal),
    ("periodic", SectionFit::Periodic, Tape::Shank),
    ("paper's sections, our planes", SectionFit::Paper, Tape::Shank),
    ("paper", SectionFit::Paper, Tape::Leg(AxisFit::Principal)),
];

/// Standard deviations of the noise, mm. Scanners have 0.5 to 1.5.
const NOISE_MM: [f64; 5] = [0.0, 0.5, 1.0, 1.5, 2.0];

/// One point in so many is kept.
const ONE_IN: [usize; 4] = [1, 2, 4, 8];

/// Each cell of the second table rests on at least this many draws of noise and points.
const DRAWS_MIN: usize = 8;

const HEADER: &str = "\
| method | girth B mm | girth C mm | girth D mm | heights mm | girth curve B to D mm | seam mm | \
levels missed | invented | legs refused |
|---|---|---|---|---|---|---|---|---|---|";

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: methods FOLDER")?;
    let cases = cases(Path::new(&folder))?;
    let mut out = io::stdout().lock();
    as_they_are(&mut out, &cases)?;
    let clean: Vec<Case> = cases.into_iter().filter(is_clean).collect();
    if clean.is_empty() {
        writeln!(out, "\nNo body of {folder} is clean: there is none to add noise to.")?;
        return Ok(());
    }
    degraded_table(&mut out, &clean)
}

/// Whether nothing is wrong with the export but the soles.
fn is_clean(case: &Case) -> bool {
    case.truth["defects"].as_object().is_some_and(|defects| defects.is_empty())
}

fn method(case: &Case, (_, fit, tape): (&str, SectionFit, Tape)) -> Method {
    Method { up: case.up, fit, tape, ..Method::default() }
}

/// All scans by all methods.
fn as_they_are(out: &mut impl Write, cases: &[Case]) -> io::Result<()> {
    writeln!(out, "Absolute errors: median / 95th percentile / largest.\n\n{HEADER}")?;
    let mut refusals = Vec::new();
    for kind in METHODS {
        let one =
            |case: &Case| Tally::measure(&case.bytes, &method(case, kind), &case.truth, &case.name);
        let tally: Tally = cases.par_iter().map(one).collect::<Vec<_>>().into_iter().sum();
        writeln!(out, "| {} | {tally} |", kind.0)?;
        refusals.extend(tally.refusals.into_iter().map(|why| format!("{}: {why}", kind.0)));
    }
    refusals.iter().try_for_each(|why| writeln!(out, "\nRefused by {why}"))
}

/// The clean bodies with noise and fewer points by all methods.
fn degraded_table(out: &mut impl Write, clean: &[Case]) -> Result<(), Box<dyn Error>> {
    let draws = DRAWS_MIN.div_ceil(clean.len());
    writeln!(
        out,
        "\nAbsolute girth error at B, C and D, mm: median / 95th percentile over {draws} draws of \
         points and noise on each of {} clean bodies.\n",
        clean.len()
    )?;
    writeln!(out, "| noise mm | points | mm apart | {} |", METHODS.map(|kind| kind.0).join(" | "))?;
    writeln!(out, "|---|---|---|{}", "---|".repeat(METHODS.len()))?;
    let mut rows = vec![Row::default(); NOISE_MM.len() * ONE_IN.len()];
    for case in clean {
        let scan = read(&case.bytes, Format::Obj)?;
        for (density, one_in) in ONE_IN.into_iter().enumerate() {
            for seed in 1..=draws {
                let thin = thinned(&scan, one_in, seed as u64);
                let found: Vec<Row> = NOISE_MM
                    .par_iter()
                    .map(|noise_mm| Row::measure(case, &thin, *noise_mm, seed as u64))
                    .collect();
                let all = rows.iter_mut().skip(density).step_by(ONE_IN.len());
                all.zip(found).for_each(|(sum, row)| sum.add(row));
            }
        }
    }
    let kinds = NOISE_MM.iter().flat_map(|noise| ONE_IN.map(|one_in| (noise, one_in)));
    for ((noise_mm, one_in), row) in kinds.zip(rows) {
        let points = if one_in == 1 { "all".to_owned() } else { format!("1 in {one_in}") };
        let apart_mm = row.apart_mm / (draws * clean.len()) as f64;
        let cells = row.tallies.each_ref().map(Tally::girth_cell).join(" | ");
        writeln!(out, "| {noise_mm:.1} | {points} | {apart_mm:.1} | {cells} |")?;
    }
    Ok(())
}

/// One kind of noise and points, by all methods.
#[derive(Clone, Default)]
struct Row {
    /// Mean length of the edges, mm, summed over the draws.
    apart_mm: f64,
    tallies: [Tally; METHODS.len()],
}

impl Row {
    /// One draw of noise on a body.
    fn measure(case: &Case, thin: &Scan, noise_mm: f64, seed: u64) -> Row {
        let in_mm = unit_in_mm(case);
        let bytes = obj(&noisy(thin, noise_mm / in_mm, seed));
        let one = |kind| Tally::measure(&bytes, &method(case, kind), &case.truth, &case.name);
        Row { apart_mm: in_mm * mean_edge(thin), tallies: METHODS.map(one) }
    }

    fn add(&mut self, other: Row) {
        self.apart_mm += other.apart_mm;
        self.tallies.iter_mut().zip(other.tallies).for_each(|(sum, tally)| sum.add(tally));
    }
}

fn unit_in_mm(case: &Case) -> f64 {
    let is_said = |unit: &Unit| case.truth["unit"] == unit.word();
    Unit::ALL.into_iter().find(is_said).unwrap_or(Unit::Mm).in_mm()
}

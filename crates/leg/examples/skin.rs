//! How far the surface of each leg lies from the true skin, over a folder of scans with truth:
//! `cargo run --release --example skin -- FOLDER [40x32]`, with the number of control points.
//!
//! Beside each `NAME.obj` lies `NAME.skin.ply`, the skin without noise and holes in the export's
//! frame and unit. Its vertices lie on the skin, its facets are chords; so vertices are compared,
//! each for a third of its facets' area, from 20 mm below B to 20 mm above D (without D, to the
//! knee).

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

#[path = "support/skin.rs"]
mod skin;
#[path = "support/truth.rs"]
mod truth;

use std::error::Error;
use std::io::{self, Write};
use std::path::Path;

use gaiter_leg::{LegReport, Method, extract};
use gaiter_scan::Format;
use skin::{Off, Skin, range_mm};
use truth::{Case, cases};

const HEADER: &str = "\
| scan | leg | noise mm | mm | control points | mean relative | allowed | rms mm | 95 % mm | max mm | in holes |
|---|---|---|---|---|---|---|---|---|---|---|";

/// The mean relative error that a clean scan may have, and what each mm of noise adds, percent.
const ALLOWED: [f64; 2] = [0.05, 0.15];

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let folder = words.next().ok_or("usage: skin FOLDER [40x32]")?;
    let surface_control_points = words.next().map(|word| net(&word)).transpose()?;
    let mut out = io::stdout().lock();
    writeln!(out, "{HEADER}")?;
    for case in cases(Path::new(&folder))? {
        let method = Method { up: case.up, surface_control_points, ..Method::default() };
        let extraction = extract(&case.bytes, Format::Obj, &method)?;
        let skin = Skin::read(Path::new(&folder), &case.name, &extraction)?;
        for leg in &extraction.legs {
            row(&mut out, &case, leg, &skin)?;
        }
    }
    Ok(())
}

/// The net that a word such as `40x32` asks for.
fn net(word: &str) -> Result<[usize; 2], Box<dyn Error>> {
    let (along, around) = word.split_once('x').ok_or(format!("what is {word:?}?"))?;
    Ok([along.parse()?, around.parse()?])
}

fn row(out: &mut impl Write, case: &Case, leg: &LegReport, skin: &Skin) -> io::Result<()> {
    let (name, side, noise) = (&case.name, leg.side.word(), case.noise_mm());
    let Some(found) = &leg.surface else {
        return writeln!(out, "| {name} | {side} | {noise} | no surface |");
    };
    let [low, high] = range_mm(leg, &found.surface);
    let all = skin.off(&found.surface, &leg.axis, [low, high]);
    let (in_holes, seen): (Vec<Off>, Vec<Off>) =
        all.into_iter().partition(|off| found.coverage.is_in_hole(off.at.0, off.at.1));
    let net = [found.surface.along().count(), found.surface.around().count()];
    let (share, [rms_mm, p95_mm, max_mm]) = (Off::relative(&seen), Off::sizes_mm(&seen));
    let holes = if in_holes.is_empty() {
        "-".to_owned()
    } else {
        format!("{:.3} %", 100.0 * Off::relative(&in_holes))
    };
    writeln!(
        out,
        "| {name} | {side} | {noise} | {low:.0}-{high:.0} | {}x{} | {:.4} % | {:.3} % | {rms_mm:.3} | \
         {p95_mm:.3} | {max_mm:.3} | {holes} |",
        net[0],
        net[1],
        100.0 * share,
        ALLOWED[0] + ALLOWED[1] * noise,
    )
}

//! The surface's distance from the true skin, leg by leg, over a folder of scans with truth:
//! `cargo run --release --example skin -- FOLDER`.
//!
//! Beside each `NAME.obj` lies `NAME.skin.ply`, the skin without noise or holes in the export's own
//! frame and unit. Its vertices lie on the skin, its facets are chords; so vertices are compared,
//! each for a third of the area of its facets, from 20 mm below B to 20 mm above D.

#[path = "support/truth.rs"]
mod truth;

use std::error::Error;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

use gaiter::leg::{LegReport, Level, Method, extract};
use gaiter::scan::{Format, read};
use nalgebra::Point3;
use rayon::prelude::*;
use truth::{Case, cases, found};

const HEADER: &str = "\
| scan | leg | mm | control points | mean relative | allowed | rms mm | 95 % mm | max mm |
|---|---|---|---|---|---|---|---|---|";

/// Skin further from a leg's surface than this is another part of the body.
const OWN_MM: f64 = 15.0;
static HOLES: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(false);

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: skin FOLDER")?;
    let mut out = io::stdout().lock();
    writeln!(out, "{HEADER}")?;
    for case in cases(Path::new(&folder))? {
        let method = Method { up: case.up, surface: surface_method(), ..Method::default() };
        let extraction = extract(&case.bytes, Format::Obj, &method)?;
        let skin = read(
            &fs::read(Path::new(&folder).join(format!("{}.skin.ply", case.name)))?,
            Format::Ply,
        )?;
        let to_body = extraction.body.from_export;
        let points: Vec<Point3<f64>> =
            skin.points.iter().map(|p| to_body.transform_point(p)).collect();
        let mut areas = vec![0.0; points.len()];
        for t in &skin.triangles {
            let [a, b, c] = t.map(|i| points[i as usize]);
            let third = (b - a).cross(&(c - a)).norm() / 6.0;
            t.iter().for_each(|i| areas[*i as usize] += third);
        }
        for leg in &extraction.legs {
            row(&mut out, &case, leg, &points, &areas)?;
        }
    }
    Ok(())
}

fn row(
    out: &mut impl Write,
    case: &Case,
    leg: &LegReport,
    points: &[Point3<f64>],
    areas: &[f64],
) -> io::Result<()> {
    let Some(surface) = &leg.surface else { return Ok(()) };
    let (low, high) = surface.surface.along().domain();
    eprintln!(
        "{} {} extent {low:.0}-{high:.0} to_sections {:?} holes {:?} in {:?} ridges {:?}",
        case.name,
        leg.side.word(),
        surface.to_sections,
        surface.holes(),
        surface.in_holes,
        surface.columns.ridges.iter().map(|r| r.to_degrees() as i32).collect::<Vec<_>>()
    );
    let low = found(leg, Level::B).map_or(low, |b| (b.along_mm - 20.0).max(low));
    let high = found(leg, Level::D).map_or(high, |d| (d.along_mm + 20.0).min(high));
    let d: Vec<Option<(f64, f64, f64)>> = points
        .par_iter()
        .zip(areas)
        .map(|(p, area)| {
            let along = leg.axis.along(p);
            if along < low || along > high {
                return None;
            }
            let rows = &leg.girth_curve.rows;
            let _ = rows;
            let arm = leg.axis.in_plane(p);
            let ring: Vec<_> = (0..24)
                .map(|i| {
                    leg.axis.in_plane(
                        &surface.surface.point(along, i as f64 * std::f64::consts::TAU / 24.0),
                    )
                })
                .collect();
            let c = ring.iter().map(|p| p.coords).sum::<nalgebra::Vector2<f64>>() / 24.0;
            let arm = arm.coords - c;
            let foot = surface.surface.closest(p, along, arm.y.atan2(arm.x));
            if surface.coverage.is_in_hole(foot.u, foot.v)
                != HOLES.load(std::sync::atomic::Ordering::Relaxed)
            {
                return None;
            }
            (foot.distance_mm < OWN_MM).then_some((*area, foot.distance_mm, arm.norm()))
        })
        .collect();
    let d: Vec<_> = d.into_iter().flatten().collect();
    let a: f64 = d.iter().map(|d| d.0).sum();
    let rel: f64 = d.iter().map(|d| d.0 * d.1 / d.2).sum::<f64>() / a;
    let rms = (d.iter().map(|d| d.0 * d.1 * d.1).sum::<f64>() / a).sqrt();
    let mut s: Vec<f64> = d.iter().map(|d| d.1).collect();
    s.sort_by(f64::total_cmp);
    let noise = case.truth["defects"]["noise"].as_f64().unwrap_or(0.0);
    let allowed = 0.05 + 0.15 * noise;
    writeln!(
        out,
        "| {} | {} | {:.0}-{:.0} | {}x{} | {:.4} % | {:.3} % | {:.3} | {:.3} | {:.3} | {}",
        case.name,
        leg.side.word(),
        low,
        high,
        surface.surface.along().count(),
        surface.surface.around().count(),
        100.0 * rel,
        allowed,
        rms,
        s[s.len() * 95 / 100],
        s[s.len() - 1],
        s.len()
    )
}

fn surface_method() -> gaiter::leg::method::SurfaceMethod {
    let a: Vec<String> = std::env::args().skip(2).collect();
    let mut m = gaiter::leg::method::SurfaceMethod::default();
    for w in &a {
        match w.as_str() {
            "points" => m.from = gaiter::leg::method::SurfaceFrom::Points,
            "uniform" => m.knots = gaiter::spline::Knots::Uniform,
            "polished" => m.knots = gaiter::spline::Knots::Polished,
            "adaptive" => m.knots = gaiter::spline::Knots::Adaptive,
            other => {
                let (a, b) = other.split_once('x').unwrap();
                m.control_points = Some([a.parse().unwrap(), b.parse().unwrap()]);
            }
        }
    }
    m
}

//! The true skin of a body, and how far a leg's surface lies from it.

// Each program uses its own part.
#![allow(dead_code)]

use std::error::Error;
use std::f64::consts::TAU;
use std::fs;
use std::io::{self, Read};
use std::path::Path;

use flate2::read::GzDecoder;
use gaiter_leg::sections::axis::LegAxis;
use gaiter_leg::{Extraction, LegReport, Level};
use gaiter_scan::{Format, read};
use gaiter_spline::Surface;
use nalgebra::{Point2, Point3, Vector2};
use rayon::prelude::*;

use super::truth::{found, quantiles};

/// Skin further from a leg's surface than this belongs to another part of the body.
const OWN_MM: f64 = 15.0;

/// The surface is compared from this far below B to this far above D.
const MARGIN_MM: f64 = 20.0;

/// Places around that give the middle of a surface.
const MIDDLE_PLACES: usize = 24;

/// The true skin in the body frame.
pub struct Skin {
    points: Vec<Point3<f64>>,
    /// The area that each point stands for, mm².
    areas: Vec<f64>,
}

/// A place of the true skin and how far the surface is from it.
pub struct Off {
    /// Where on the surface.
    pub at: (f64, f64),
    area: f64,
    distance_mm: f64,
    radius_mm: f64,
}

impl Off {
    /// Mean of distance over radius, weighted by area.
    pub fn relative(all: &[Off]) -> f64 {
        let area: f64 = all.iter().map(|off| off.area).sum();
        all.iter().map(|off| off.area * off.distance_mm / off.radius_mm).sum::<f64>() / area
    }

    /// Root mean square, weighted by area; 95th percentile; largest.
    pub fn sizes_mm(all: &[Off]) -> [f64; 3] {
        let area: f64 = all.iter().map(|off| off.area).sum();
        let squares: f64 = all.iter().map(|off| off.area * off.distance_mm.powi(2)).sum();
        let distances: Vec<f64> = all.iter().map(|off| off.distance_mm).collect();
        let [_, p95_mm, max_mm] = quantiles(&distances);
        [(squares / area).sqrt(), p95_mm, max_mm]
    }
}

/// Where on its axis a leg's surface is compared: from below B to above D or, without D, the knee.
pub fn range_mm(leg: &LegReport, surface: &Surface) -> [f64; 2] {
    let (low, high) = surface.along().domain();
    let knee = || leg.estimates.iter().find(|at| at.level == Level::E).map(|e| e.along_mm);
    let top = found(leg, Level::D).map(|d| d.along_mm + MARGIN_MM).or_else(knee);
    let bottom = found(leg, Level::B).map(|b| b.along_mm - MARGIN_MM);
    [bottom.map_or(low, |mm| mm.max(low)), top.map_or(high, |mm| mm.min(high))]
}

impl Skin {
    /// The skin beside a scan, brought into the body frame of its extraction.
    pub fn read(
        folder: &Path,
        name: &str,
        extraction: &Extraction,
    ) -> Result<Skin, Box<dyn Error>> {
        let skin = read(&skin_bytes(&folder.join(format!("{name}.skin.ply")))?, Format::Ply)?;
        let to_body = extraction.body.from_export;
        let points: Vec<Point3<f64>> =
            skin.points.iter().map(|point| to_body.transform_point(point)).collect();
        let mut areas = vec![0.0; points.len()];
        for triangle in &skin.triangles {
            let corners = triangle.map(|corner| corner as usize);
            let [a, b, c] = corners.map(|corner| points[corner]);
            let third = (b - a).cross(&(c - a)).norm() / 6.0;
            corners.iter().for_each(|corner| areas[*corner] += third);
        }
        Ok(Skin { points, areas })
    }

    /// How far a leg's surface is from the skin between two distances along the axis.
    pub fn off(&self, surface: &Surface, axis: &LegAxis, [low, high]: [f64; 2]) -> Vec<Off> {
        let near = |(point, area): (&Point3<f64>, &f64)| {
            let along_mm = axis.along(point);
            let is_within = (low..=high).contains(&along_mm);
            let arm = is_within.then(|| arm(surface, axis, point, along_mm))?;
            let foot = surface.closest(point, along_mm, arm.y.atan2(arm.x));
            let off = Off {
                at: (foot.u, foot.v),
                area: *area,
                distance_mm: foot.distance_mm,
                radius_mm: arm.norm(),
            };
            (off.distance_mm < OWN_MM).then_some(off)
        };
        self.points.par_iter().zip(&self.areas).filter_map(near).collect()
    }
}

/// The bytes of a skin, plain or as `.gz`.
fn skin_bytes(path: &Path) -> io::Result<Vec<u8>> {
    if path.exists() {
        return fs::read(path);
    }
    let mut bytes = Vec::new();
    GzDecoder::new(fs::File::open(path.with_extension("ply.gz"))?).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// From the middle of the surface to a point at a distance along the axis, (front, lateral).
fn arm(surface: &Surface, axis: &LegAxis, point: &Point3<f64>, along_mm: f64) -> Vector2<f64> {
    let v: Vec<f64> = (0..MIDDLE_PLACES).map(|i| TAU * i as f64 / MIDDLE_PLACES as f64).collect();
    let ring = surface.grid(&[along_mm], &v);
    let sum: Vector2<f64> = ring.iter().map(|on_ring| axis.place(on_ring).1.coords).sum();
    axis.place(point).1 - Point2::from(sum / MIDDLE_PLACES as f64)
}

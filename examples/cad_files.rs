//! Writes every kind of CAD file and mesh of the legs of a scan, and what must be read from them.
//!
//! ```text
//! cargo run --release --example cad_files -- fixtures/scans/f_average_clean.obj.gz FOLDER
//! python3 tests/cad_read_back.py FOLDER
//! ```
//!
//! `figures.json` holds, for each leg, the area of its surface and the volume between that and the
//! planes at its ends, by quadrature: 6 Gauss points along and around in each span between knots.
//! A mirror image of the right leg is among the legs, so that both hands are.

#![allow(clippy::print_stdout)]

use std::error::Error;
use std::fs;
use std::io::Read;
use std::path::Path;

use gaiter::cad::{FileHeader, Output};
use gaiter::config::words::FILES;
use gaiter::leg::{Method, extract};
use gaiter::scan::Format;
use gaiter::spline::Surface;
use nalgebra::{Point3, Vector3};

/// Places and weights of Gauss's rule on −1…1; exact for polynomials of degree 11.
const GAUSS: [(f64, f64); 6] = [
    (-0.932_469_514_203_152, 0.171_324_492_379_170),
    (-0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (-0.238_619_186_083_196_9, 0.467_913_934_572_691),
    (0.238_619_186_083_196_9, 0.467_913_934_572_691),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152, 0.171_324_492_379_170),
];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scan, folder] = &arguments[..] else { return Err("usage: SCAN.obj.gz FOLDER".into()) };
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(fs::File::open(scan)?).read_to_end(&mut bytes)?;
    let extraction = extract(&bytes, Format::Obj, &Method::default())?;

    let mut legs = Vec::new();
    for leg in &extraction.legs {
        let surface = leg.surface.as_ref().ok_or("a leg has no surface")?;
        legs.push((leg.side.word(), surface.surface.clone()));
    }
    let right = legs.last().ok_or("there is no leg")?;
    legs.push(("mirrored", mirrored(&right.1)?));
    fs::create_dir_all(folder)?;
    let figures: Result<serde_json::Map<_, _>, Box<dyn Error>> = legs
        .iter()
        .map(|(name, surface)| Ok(((*name).to_owned(), files(Path::new(folder), name, surface)?)))
        .collect();
    let text = serde_json::to_string_pretty(&figures?)?;
    fs::write(Path::new(folder).join("figures.json"), text + "\n")?;
    Ok(())
}

/// Writes all files of a leg; its figures.
fn files(
    folder: &Path,
    name: &str,
    surface: &Surface,
) -> Result<serde_json::Value, Box<dyn Error>> {
    let tolerance_mm = Output::default().mesh_tolerance_mm;
    let mut written = serde_json::Map::new();
    for (word, kind) in FILES {
        let file_name = format!("{name}{}", kind.ending());
        let product = format!("{name} leg");
        let header = FileHeader { file_name: &file_name, product: &product };
        let bytes = kind.bytes(surface, tolerance_mm, &header)?;
        println!("{:9} bytes  {file_name}", bytes.len());
        fs::write(folder.join(&file_name), bytes)?;
        written.insert((*word).to_owned(), file_name.into());
    }
    let (area_mm2, volume_mm3) = measured(surface);
    Ok(serde_json::json!({
        "area_mm2": area_mm2,
        "volume_mm3": volume_mm3,
        "control_points": [surface.along().count(), surface.around().count()],
        "mesh_tolerance_mm": tolerance_mm,
        "files": written,
    }))
}

/// The mirror image of a surface across the plane x = 0.
fn mirrored(surface: &Surface) -> Result<Surface, Box<dyn Error>> {
    let points = surface.control_points().iter().map(|p| Point3::new(-p.x, p.y, p.z)).collect();
    Ok(Surface::new(surface.along().clone(), surface.around().clone(), points)?)
}

/// Area of the surface and the volume between it and the planes of its ends.
fn measured(surface: &Surface) -> (f64, f64) {
    let (along, around) = (nodes(surface.along()), nodes(surface.around()));
    let (low, high) = surface.along().domain();
    // From a place in the plane of the first end that end is seen edge-on and adds nothing.
    let from = surface.point(low, 0.0);
    let (mut area, mut volume) = (0.0, 0.0);
    for (u, du) in &along {
        for (v, dv) in &around {
            let at = surface.derivatives(*u, *v);
            let normal = at.du.cross(&at.dv) * (du * dv);
            area += normal.norm();
            volume += (at.point - from).dot(&normal) / 3.0;
        }
    }
    let ring = around.iter().map(|(v, dv)| {
        let at = surface.derivatives(high, *v);
        (at.point - from).cross(&at.dv) * (dv / 2.0)
    });
    let lid: Vector3<f64> = ring.sum();
    // The lid's area points the way of v; the tube's normals u × v the other way round.
    volume -= (surface.point(high, 0.0) - from).dot(&lid) / 3.0;
    (area, volume.abs())
}

/// Places and weights along a basis.
fn nodes(basis: &gaiter::spline::Basis) -> Vec<(f64, f64)> {
    let spans = basis.breakpoints().windows(2);
    let nodes = spans.flat_map(|span| {
        let (middle, half) = ((span[0] + span[1]) / 2.0, (span[1] - span[0]) / 2.0);
        GAUSS.map(|(place, weight)| (middle + half * place, half * weight))
    });
    nodes.collect()
}

//! Writes every kind of CAD file and mesh of the legs of a scan, and what must be read from them.
//!
//! ```text
//! cargo run --release --example cad_files -- fixtures/scans/f_average_clean.obj.gz FOLDER
//! python3 tests/cad_read_back.py FOLDER
//! ```
//!
//! `figures.json` holds, for each leg, the area of its surface, the volume between that and the planes
//! at its ends, and the knots and control points that the exact files must give back. A mirror image of the right leg is among the legs, so that both hands are.

#![allow(clippy::print_stdout)]

use std::error::Error;
use std::fs;
use std::io::Read;
use std::path::Path;

use gaiter::config::words::FILES;
use gaiter_cad::{FileHeader, Output};
use gaiter_leg::{Method, extract};
use gaiter_scan::Format;
use gaiter_spline::Surface;
use nalgebra::Point3;

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
    let (around, net) = surface.clamped_around();
    let net: Vec<[f64; 3]> = net.iter().map(|point| point.coords.into()).collect();
    Ok(serde_json::json!({
        "knots": [surface.along().knots(), around],
        "net_mm": net,
        "area_mm2": surface.area_mm2(),
        "volume_mm3": surface.volume_mm3().abs(),
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

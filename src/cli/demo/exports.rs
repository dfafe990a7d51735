//! What the simulated scanner exports in the demo.

use std::io::{self, Read};
use std::path::Path;
use std::time::Duration;

use flate2::read::GzDecoder;

use crate::station::demo::Export;

const WOMAN: &[u8] = include_bytes!("../../../fixtures/scans/f_average_tc2.obj.gz");
const MAN: &[u8] = include_bytes!("../../../fixtures/scans/m_average_clean.obj.gz");

pub struct DemoExport {
    /// The file, and how long the scanner takes to write it.
    pub export: Export,
    /// Whether it must lead to a record; if not, it must be refused and goes to quarantine.
    pub is_whole: bool,
    /// When the scanner begins, from the start of the demo.
    pub after: Duration,
}

/// Two complete scans, one that is aborted half-way, and one that shows no body.
///
/// # Errors
/// If a recorded scan cannot be decompressed.
pub fn exports(folder: &Path) -> io::Result<Vec<DemoExport>> {
    let export = |name: &str, bytes: Vec<u8>, seconds: u64, is_whole, after: u64| {
        let takes = Duration::from_secs(seconds);
        let export = Export { path: folder.join(name), bytes, takes };
        DemoExport { export, is_whole, after: Duration::from_secs(after) }
    };
    let (woman, man) = (decompressed(WOMAN)?, decompressed(MAN)?);
    // Not half of `man`, which follows: that export would count as the rest of this one and be held.
    let half = woman[..woman.len() / 2].to_vec();
    Ok(vec![
        export("4711_first.obj", woman, 3, true, 1),
        export("4712_aborted.obj", half, 2, false, 3),
        export("4713_ball.obj", ball().into_bytes(), 1, false, 4),
        export("4714_last.obj", man, 3, true, 6),
    ])
}

fn decompressed(gzip: &[u8]) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    GzDecoder::new(gzip).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// A ball as high as a person: a scan without a body.
fn ball() -> String {
    const RINGS: u32 = 60;
    const SIDES: u32 = 120;
    const RADIUS_MM: f64 = 850.0;
    let mut text = String::from("# nobody\n");
    for ring in 0..=RINGS {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(RINGS);
        for side in 0..SIDES {
            let turn = std::f64::consts::TAU * f64::from(side) / f64::from(SIDES);
            let (x, z) = (polar.sin() * turn.cos(), polar.sin() * turn.sin());
            let [x, y, z] = [x, polar.cos(), z].map(|c| RADIUS_MM * c);
            text.push_str(&format!("v {x:.3} {y:.3} {z:.3}\n"));
        }
    }
    for (ring, side) in (0..RINGS).flat_map(|ring| (0..SIDES).map(move |side| (ring, side))) {
        let [a, b] = [side, (side + 1) % SIDES].map(|side| ring * SIDES + side + 1);
        text.push_str(&format!("f {a} {b} {} {}\n", b + SIDES, a + SIDES));
    }
    text
}

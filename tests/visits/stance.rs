//! Scans of one body in other stances, with other noise, compared with each other.

#![allow(clippy::unwrap_used)]

use gaiter::leg::{Method, Side};
use gaiter::record::Record;
use gaiter::scan::Scan;
use gaiter::visits::{Choice, Course, GIRTH_COMMON_MM};
use support::geometry::bodies::{obj, record_of, truth};
use support::geometry::mesh::Mesh;
use support::geometry::noise::roughened;
use support::geometry::stance::Stance;

pub const CHOICE: Choice =
    Choice { volume: None, affected: None, girth_common_mm: GIRTH_COMMON_MM };

fn scanned(name: &str, stance: Stance, noise_mm: f64, seed: u64) -> Record {
    let crotch_mm = truth(name)["crotch_height_mm"].as_f64().unwrap();
    let mesh = stance.of(Mesh::body(name), crotch_mm);
    let points = mesh.points.iter().map(|p| (*p).into()).collect();
    let corners = mesh.triangles.iter().map(|t| t.map(|corner| corner as u32)).collect();
    let scan = Scan { points, triangles: corners };
    record_of(&obj(&roughened(&scan, noise_mm, seed)), &Method::default()).1
}

#[test]
fn look() {
    for name in ["f_average_clean", "m_average_clean"] {
        let plain = scanned(name, Stance::default(), 0.5, 1);
        for (apart, bent, noise) in [
            (0.0, 0.0, 0.5),
            (1.0, 0.0, 0.5),
            (2.0, 0.0, 0.5),
            (-1.0, 0.0, 0.5),
            (-2.0, 0.0, 0.5),
            (0.0, 3.0, 0.5),
            (0.0, 6.0, 0.5),
            (2.0, 6.0, 1.0),
            (0.0, 10.0, 0.5),
        ] {
            let other = scanned(
                name,
                Stance { apart_deg: apart, bent_deg: bent },
                noise,
                7 + (apart * 10.0) as u64,
            );
            let course = Course::comparable(&[plain.clone(), other], CHOICE).unwrap();
            let compared = course.last_compared(&course.groups[0]).remove(0);
            for side in Side::BOTH {
                let Some(leg) = compared.legs.get(side) else {
                    println!("no leg");
                    continue;
                };
                let v = leg.volume.unwrap();
                let [a, b] = [0, 1].map(|i| course.visits[i].legs.get(side).clone().unwrap());
                let girths: Vec<String> = a
                    .places
                    .iter()
                    .filter_map(|(s, p)| {
                        Some(format!("{}:{:+.1}", s * 4, b.places.get(s)?.girth_mm - p.girth_mm))
                    })
                    .collect();
                println!(
                    "{name} {apart} {bent} {noise} {} {:.2} % of {:.2} % (random {:.1} common {:.1} ml) tilt {:.1}->{:.1} bend {:.1}->{:.1} pieces {} {:?} {}",
                    side.word(),
                    v.percent,
                    v.detectable_percent(),
                    v.random,
                    v.common,
                    a.tilt_deg,
                    b.tilt_deg,
                    a.bend_deg.unwrap(),
                    b.bend_deg.unwrap(),
                    course.groups[0].pieces.get(side).len(),
                    compared.cautions.iter().map(|c| c.code()).collect::<Vec<_>>(),
                    girths.join(" ")
                );
            }
        }
    }
}

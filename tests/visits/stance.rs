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
        let mut others = vec![];
        for (apart_deg, bent_deg) in [
            (0.0, 0.0),
            (0.0, 0.0),
            (1.0, 0.0),
            (2.0, 0.0),
            (3.0, 0.0),
            (-1.0, 0.0),
            (-2.0, 0.0),
            (0.0, 2.0),
            (0.0, 4.0),
            (0.0, 6.0),
            (0.0, 8.0),
        ] {
            others.push((
                format!("{apart_deg} {bent_deg}"),
                scanned(name, Stance { apart_deg, bent_deg }, 0.5, 50 + others.len() as u64),
            ));
        }
        if name.starts_with('f') {
            others.push((
                "tc2".into(),
                record_of(&support::geometry::bodies::export("f_average_tc2"), &Method::default())
                    .1,
            ));
        }
        for (what, other) in others {
            let course = Course::comparable(&[plain.clone(), other], CHOICE).unwrap();
            for side in Side::BOTH {
                let group = &course.groups[0];
                let v: Vec<f64> =
                    (0..2).map(|i| course.volume(group, i, side).unwrap().value).collect();
                let [a, b] = [0, 1].map(|i| course.visits[i].legs.get(side).clone().unwrap());
                let girths: Vec<String> = a
                    .places
                    .iter()
                    .filter(|(s, _)| **s > 2)
                    .filter_map(|(s, p)| {
                        Some(format!("{}:{:+.1}", s * 4, b.places.get(s)?.girth_mm - p.girth_mm))
                    })
                    .collect();
                println!(
                    "LOOK {name} {what} {} {:+.2} % tilt {:+.2} bend {:+.2} {}",
                    side.word(),
                    100.0 * (v[1] / v[0] - 1.0),
                    b.tilt_deg - a.tilt_deg,
                    b.bend_deg.unwrap() - a.bend_deg.unwrap(),
                    girths.join(" ")
                );
            }
        }
    }
}

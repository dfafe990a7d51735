//! A body whose one leg is swollen by a known amount.

#![allow(clippy::unwrap_used)]

use std::f64::consts::TAU;

use gaiter_leg::{Method, Side};
use gaiter_record::Record;
use gaiter_visits::overlay::Overlay;
use gaiter_visits::{Comparison, Shown};
use support::mesh::Mesh;
use support::noise::roughened;
use support::records::record_of_scan;

use crate::stance::{NOISE_MM, compared};

/// A swelling of the left leg.
#[derive(Clone, Copy)]
struct Swelling {
    /// By how much the girth is larger at its middle, mm.
    girth_mm: f64,
    /// Height of its middle, mm.
    at_mm: f64,
    /// Height over which it falls to 1/e, mm.
    over_mm: f64,
}

impl Swelling {
    fn girth_at_mm(&self, height_mm: f64) -> f64 {
        self.girth_mm * (-((height_mm - self.at_mm) / self.over_mm).powi(2)).exp()
    }

    /// The body, with every section of the left leg blown up about its middle: by δ outwards, so that the
    /// girth grows by 2 π δ.
    fn of(&self, body: Mesh) -> Mesh {
        let low = body.points.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min);
        let middles: Vec<[f64; 2]> = (0..200)
            .map(|slice| {
                let near = |p: &&[f64; 3]| p[0] > 0.0 && ((p[1] - low) / 10.0) as usize == slice;
                let (mut sum, mut count) = ([0.0, 0.0], 0.0_f64);
                for point in body.points.iter().filter(near) {
                    sum = [sum[0] + point[0], sum[1] + point[2]];
                    count += 1.0;
                }
                sum.map(|of| of / count.max(1.0))
            })
            .collect();
        body.moved(|[x, y, z]| {
            let height = y - low;
            if x <= 0.0 || height > 700.0 {
                return [x, y, z];
            }
            let [cx, cz] = middles[(height / 10.0) as usize];
            let (dx, dz) = (x - cx, z - cz);
            let out = self.girth_at_mm(height) / TAU / dx.hypot(dz).max(1.0);
            [x + dx * out, y, z + dz * out]
        })
    }
}

fn scanned(mesh: Mesh, seed: u64) -> Record {
    record_of_scan(&roughened(&mesh.scan(), NOISE_MM, seed), &Method::default())
}

fn visits(name: &str, swelling: Swelling) -> (Record, Record, Comparison) {
    let before = scanned(Mesh::body(name), 1);
    let after = scanned(swelling.of(Mesh::body(name)), 2);
    let compared = compared(&before, after.clone());
    (before, after, compared)
}

const CALF: Swelling = Swelling { girth_mm: 20.0, at_mm: 300.0, over_mm: 90.0 };

#[test]
fn slices_find_a_swelling_where_it_is_and_nowhere_else() {
    for name in ["f_average_clean", "m_average_clean"] {
        let (_, _, compared) = visits(name, CALF);
        // The left leg of the patient is at positive x.
        let [left, right] =
            [Side::Left, Side::Right].map(|side| compared.legs.get(side).clone().unwrap());
        assert!(
            right.pieces.iter().chain(&right.girths).all(|of| of.change.shown() == Shown::NoChange)
        );
        let mut found = 0;
        for of in &left.girths {
            let true_mm = CALF.girth_at_mm(40.0 * f64::from(of.step));
            let sd_mm = of.change.random.hypot(of.change.common);
            let allowed_mm = f64::max(1.5, 2.0 * sd_mm);
            assert!(
                (of.change.by - true_mm).abs() < allowed_mm,
                "{name} {of:?}, {true_mm} are true"
            );
            if true_mm > 1.25 * of.change.detectable() {
                assert_eq!(of.change.shown(), Shown::Larger, "{name} {of:?}");
                found += 1;
            }
            if true_mm < 1.0 {
                assert_eq!(of.change.shown(), Shown::NoChange, "{name} {of:?}");
            }
        }
        assert!(found >= 4, "{name}: {found}");
        for of in &left.pieces {
            let middle_mm = 40.0 * f64::from(of.step) + 20.0;
            match CALF.girth_at_mm(middle_mm) {
                true_mm if true_mm > 8.0 => {
                    assert_eq!(of.change.shown(), Shown::Larger, "{name} {of:?}")
                }
                true_mm if true_mm < 1.0 => {
                    assert_eq!(of.change.shown(), Shown::NoChange, "{name} {of:?}")
                }
                _ => {}
            }
        }
    }
}

/// A growth of the girth C by c over a short height h adds C c h / 2π of volume; here it is summed over the
/// girths of the leg.
#[test]
fn the_change_of_the_volume_is_that_of_the_swelling() {
    for name in ["f_average_clean", "m_average_clean"] {
        let (before, _, compared) = visits(name, CALF);
        let leg = before.leg(Side::Left).unwrap();
        let curve = leg.girth_curve.height_mm.iter().zip(&leg.girth_curve.tape_mm);
        let girths: Vec<[f64; 2]> =
            curve.filter_map(|(height, girth)| Some([(*height)?, (*girth)?])).collect();
        let added: f64 = girths
            .windows(2)
            .filter(|pair| pair[0][0] > 120.0)
            .map(|pair| {
                let [low, high] = [pair[0], pair[1]];
                let more = CALF.girth_at_mm(f64::midpoint(low[0], high[0]));
                let girth = f64::midpoint(low[1], high[1]);
                (2.0 * girth * more + more * more) * (high[0] - low[0]) / (2.0 * TAU)
            })
            .sum::<f64>()
            / 1000.0;
        let volume = compared.legs.left.as_ref().unwrap().volume.unwrap();
        let share = 0.1;
        assert!(
            (volume.by - added).abs() < share * added,
            "{name}: {volume:?}, {added} mL are true"
        );
        assert_eq!(volume.shown(), Shown::Larger);
    }
}

#[test]
fn two_visits_laid_over_each_other_show_the_swelling_and_not_the_other_stance() {
    use support::recorded::truth;
    use support::stance::Stance;
    let name = "m_average_clean";
    let crotch_mm = truth(name)["crotch_height_mm"].as_f64().unwrap();
    let before = scanned(Mesh::body(name), 1);
    let stance = Stance { apart_deg: 2.0, bent_deg: 0.0 };
    let after = scanned(stance.of(CALF.of(Mesh::body(name)), crotch_mm), 2);
    let overlay = Overlay::new(&before, &after).unwrap();
    for side in Side::BOTH {
        let error_mm = overlay.error_mm.get(side).unwrap();
        assert!(error_mm < 0.6, "{side:?}: {error_mm}");
        let surface = overlay.record.leg(side).unwrap().shape.surface.as_ref().unwrap();
        let points = surface.points.as_points();
        let off = points.iter().zip(surface.error.as_errors_mm());
        let mut seen = 0;
        for (point, error_mm) in off.filter_map(|(point, error)| Some(((*point)?, error?))) {
            if !(150.0..420.0).contains(&point.z) {
                continue;
            }
            let true_mm = match side {
                Side::Left => CALF.girth_at_mm(point.z) / TAU,
                Side::Right => 0.0,
            };
            assert!(
                (error_mm - true_mm).abs() < 1.6,
                "{side:?} at {}: {error_mm}, {true_mm} are true",
                point.z
            );
            seen += 1;
        }
        assert!(seen > 500, "{side:?}: {seen}");
    }
}

//! A floor, plate or platform that was scanned with the feet is the floor, whatever its size.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::sync::LazyLock;

use gaiter_leg::{Extraction, Level, Method};
use nalgebra::Point3;
use support::chance::Chance;
use support::mesh::Mesh;
use support::recorded::extract_scan;

/// How many floors are drawn.
const FLOORS: u64 = 40;

/// Edge of a floor's facets, mm.
const EDGE_MM: f64 = 6.0;

static BODY: LazyLock<Mesh> = LazyLock::new(|| Mesh::body("f_average_clean"));

static WITHOUT: LazyLock<Extraction> = LazyLock::new(|| measured(&BODY).unwrap());

fn measured(mesh: &Mesh) -> Result<Extraction, gaiter_leg::Refusal> {
    extract_scan(&mesh.scan(), &Method::default())
}

/// A level sheet at y = 0, with noise, turned upwards.
pub(super) fn sheet(chance: &mut Chance, half: [f64; 2], noise_mm: f64) -> Mesh {
    let [columns, rows] = half.map(|half| (2.0 * half / EDGE_MM).ceil() as usize + 1);
    let mut mesh = Mesh::default();
    for row in 0..rows {
        for column in 0..columns {
            let at = |index: usize, half: f64| EDGE_MM * index as f64 - half;
            let y = noise_mm * chance.normal();
            mesh.points.push([at(column, half[0]), y, at(row, half[1])]);
        }
    }
    for (row, column) in (1..rows).flat_map(|row| (1..columns).map(move |column| (row, column))) {
        let at = (row - 1) * columns + column - 1;
        mesh.triangles.push([at, at + columns, at + 1]);
        mesh.triangles.push([at + 1, at + columns, at + columns + 1]);
    }
    mesh
}

/// The walls of a box down to `depth_mm` below the floor.
fn walls([x, z]: [f64; 2], depth_mm: f64) -> Mesh {
    Mesh::cuboid([x, z], -depth_mm, 0.0)
}

/// The body on a floor that is drawn: its size, its noise, its place, a platform's depth, a hole where the feet
/// stand, and whether it hangs on the feet.
fn on_floor(seed: u64) -> (Mesh, String) {
    let mut chance = Chance(seed);
    // Both feet stand on it.
    let half = [270.0 + 130.0 * chance.unit(), 270.0 + 130.0 * chance.unit()];
    let noise_mm = 1.2 * chance.unit();
    let depth_mm = if chance.below(2) == 0 { 0.0 } else { 3.0 + 150.0 * chance.unit() };
    let (has_hole, hangs_on) = (chance.below(2) == 0, chance.below(2) == 0);
    let [dx, dz] = [chance.even(40.0), chance.even(40.0)];
    let mut floor = sheet(&mut chance, half, noise_mm);
    if has_hole {
        let low: Vec<[f64; 3]> =
            BODY.points.iter().filter(|p| p[1] < 25.0).step_by(2).copied().collect();
        let is_free =
            |[x, _, z]: [f64; 3]| low.iter().all(|p| (p[0] - x - dx).hypot(p[2] - z - dz) > 8.0);
        floor = floor.kept(is_free);
    }
    if depth_mm > 0.0 {
        floor = floor.and(walls(half, depth_mm));
    }
    let mut mesh = BODY.clone().and(floor.moved(|[x, y, z]| [x + dx, y, z + dz]));
    if hangs_on {
        join(&mut mesh);
    }
    let told = format!(
        "{seed}: {half:?}, noise {noise_mm}, {depth_mm} deep, hole {has_hole}, joined {hangs_on}"
    );
    (mesh, told)
}

/// Joins the floor to the feet by some facets.
fn join(mesh: &mut Mesh) {
    let first = BODY.points.len();
    let lowest: Vec<usize> =
        (0..first).filter(|&at| mesh.points[at][1] < 6.0).step_by(60).collect();
    for own in lowest {
        let far = |at: &usize| {
            let [p, q] = [mesh.points[own], mesh.points[*at]];
            (p[0] - q[0]).hypot(p[2] - q[2])
        };
        let nearest = (first..mesh.points.len()).min_by(|a, b| far(a).total_cmp(&far(b)));
        if let Some(nearest) = nearest.filter(|at| far(at) < 30.0 && at + 1 < mesh.points.len()) {
            mesh.triangles.push([own, nearest, nearest + 1]);
        }
    }
}

#[test]
fn a_body_on_any_floor_is_measured_as_without_it() {
    for seed in 0..FLOORS {
        let (mesh, told) = on_floor(seed);
        let found = measured(&mesh).unwrap_or_else(|fault| panic!("{told}: {fault}"));
        assert_eq!(found.legs.len(), WITHOUT.legs.len(), "{told}");
        for (own, without) in found.legs.iter().zip(&WITHOUT.legs) {
            assert_eq!(own.side, without.side, "{told}");
            for level in [Level::B, Level::C, Level::D] {
                let of = |leg: &gaiter_leg::LegReport| {
                    let landmark = leg.landmarks.iter().find(|landmark| landmark.level == level);
                    landmark.map(|of| (of.girth_tape_mm, of.height_mm)).unwrap()
                };
                let ((girth, height), (girth_without, height_without)) = (of(own), of(without));
                assert!(
                    (girth - girth_without).abs() < 0.3,
                    "{told}: {level:?} {girth} {girth_without}"
                );
                assert!(
                    (height - height_without).abs() < 3.0,
                    "{told}: {level:?} {height} {height_without}"
                );
            }
        }
    }
}

#[test]
fn a_floor_that_was_scanned_is_at_its_own_height_and_as_certain_as_the_feet_on_it() {
    for seed in FLOORS..FLOORS + 5 {
        let (mesh, told) = on_floor(seed);
        let body = measured(&mesh).unwrap().body;
        let at_zero = body.from_export.transform_point(&Point3::origin());
        assert!(at_zero.z.abs() < 0.5, "{told}: {at_zero}");
        // Heels and balls that noise sets apart may be a lean.
        assert!(body.floor_doubt.is_none() && body.floor_sd_mm < 1.5, "{told}: {body:?}");
    }
}

/// A board beside the feet, its top `above_mm` over the soles.
fn beside_board(seed: u64) -> (Mesh, String) {
    let mut chance = Chance(seed);
    let above_mm = 4.0 + 20.0 * chance.unit();
    let half = [150.0 + 100.0 * chance.unit(), 100.0 + 100.0 * chance.unit()];
    let board = sheet(&mut chance, half, 0.3).and(walls(half, above_mm));
    // Before the toes, behind the heels, or at a side.
    let [x, z] = match chance.below(3) {
        0 => [0.0, 260.0 + half[1]],
        1 => [0.0, -200.0 - half[1]],
        _ => [320.0 + half[0], 0.0],
    };
    (
        BODY.clone().and(board.moved(|p| [p[0] + x, p[1] + above_mm, p[2] + z])),
        format!("{seed}: {above_mm}"),
    )
}

#[test]
fn a_board_that_nobody_stands_on_is_no_floor() {
    let floor_mm = |body: &gaiter_leg::Body| body.from_export.transform_point(&Point3::origin()).z;
    for seed in 0..10 {
        let (mesh, told) = beside_board(seed);
        // It may be refused, as what stands on the floor is no foot; it is never taken for the floor.
        if let Ok(found) = measured(&mesh) {
            let off_mm = floor_mm(&found.body) - floor_mm(&WITHOUT.body);
            assert!(off_mm.abs() < 3.0, "{told}: {off_mm}");
        }
    }
}

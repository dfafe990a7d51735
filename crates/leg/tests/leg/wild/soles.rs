//! Heights over soles that are not a bare foot's on a level floor: of shoes, of exports that lean, and soles that an
//! exporter closed. They are right within what is stated, or a finding says why not.

use nalgebra::Point3;
use support::mesh::Ring;

use super::*;

/// How many of each kind are drawn.
const DRAWS: u64 = 6;

/// A body with noise of up to 0.8 mm, and what is true of it.
pub(super) fn drawn(chance: &mut Chance) -> (Mesh, &'static Extraction) {
    let Sample { mesh, truth } = &SAMPLES[chance.below(SAMPLES.len())];
    let noise_mm = 0.8 * chance.unit();
    (noisy(mesh, noise_mm, chance), truth)
}

/// The levels B, C and D whose height is off by more than `beside_mm` and three stated standard errors without a
/// doubt.
pub(super) fn off_in_height(
    found: &Extraction,
    truth: &Extraction,
    beside_mm: f64,
) -> Vec<(Side, Level, f64)> {
    let levels = [Level::B, Level::C, Level::D];
    let mut wrong = Vec::new();
    for (leg, level) in found.legs.iter().flat_map(|leg| levels.map(|level| (leg, level))) {
        let of = |extraction: &Extraction| {
            let leg = extraction.legs.iter().find(|other| other.side == leg.side)?;
            leg.landmarks.iter().find(|landmark| landmark.level == level).cloned()
        };
        let (Some(own), Some(truth)) = (of(found), of(truth)) else { continue };
        let off_mm = own.height_mm - truth.height_mm;
        if off_mm.abs() > beside_mm + 3.0 * own.height_sd_mm && own.doubts.is_empty() {
            wrong.push((leg.side, level, off_mm));
        }
    }
    wrong
}

/// Whether a finding says that the floor is uncertain.
pub(super) fn is_floor_doubted(found: &Extraction) -> bool {
    is_told(found, "floor-uneven") || is_told(found, "feet-cut")
}

/// Height of the floor in the export of a body that stands upright, mm.
fn floor_mm(found: &Extraction) -> f64 {
    -found.body.from_export.transform_point(&Point3::origin()).z
}

/// Where the points of one foot are, on the positive or the negative side of x, below a height.
fn places_of_foot(mesh: &Mesh, sign: f64, below_mm: f64) -> Vec<usize> {
    let is_foot = |at: &usize| {
        let [x, y, _] = mesh.points[*at];
        y < below_mm && (5.0..250.0).contains(&(x * sign))
    };
    (0..mesh.points.len()).filter(is_foot).collect()
}

/// The lowest and the highest of points along an axis.
fn range(points: &[[f64; 3]], axis: usize) -> [f64; 2] {
    points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], point| {
        [low.min(point[axis]), high.max(point[axis])]
    })
}

/// Leaning forwards or backwards, or to a side.
fn leaning(mesh: Mesh, degrees: f64, is_to_side: bool) -> Mesh {
    let (sin, cos) = degrees.to_radians().sin_cos();
    mesh.moved(|[x, y, z]| {
        if is_to_side {
            [x * cos + y * sin, y * cos - x * sin, z]
        } else {
            [x, y * cos - z * sin, z * cos + y * sin]
        }
    })
}

/// On soles of shoes that are drawn: the edge of the foot itself drawn down, or an oval plate with a round edge that is
/// seen until it has turned under by 40 to 75°.
fn on_soles(mesh: Mesh, thick_mm: f64, chance: &mut Chance) -> Mesh {
    if chance.below(2) == 0 {
        let high_mm = 4.0 + 16.0 * chance.unit();
        return mesh.moved(|[x, y, z]| {
            let share = ((12.0 + high_mm / 2.0 - y) / high_mm).clamp(0.0, 1.0);
            [x, y - thick_mm * share, z]
        });
    }
    let beside_mm = 2.0 + 6.0 * chance.unit();
    let edge_mm = 3.0 + ((thick_mm - 2.0).min(12.0) - 3.0) * chance.unit();
    let turn_deg = 40.0 + 35.0 * chance.unit();
    let soles = [-1.0, 1.0].map(|sign| {
        let foot = places_of_foot(&mesh, sign, 25.0);
        let foot: Vec<[f64; 3]> = foot.iter().map(|at| mesh.points[*at]).collect();
        let [[x_low, x_high], [z_low, z_high]] = [range(&foot, 0), range(&foot, 2)];
        let ring = |y: f64, inside_mm: f64| {
            let half = [x_high - x_low, z_high - z_low].map(|w| w / 2.0 + beside_mm - inside_mm);
            Ring { y, middle: [(x_low + x_high) / 2.0, (z_low + z_high) / 2.0], half }
        };
        let upright_mm = thick_mm - edge_mm;
        let round = (0..=(turn_deg / 12.0) as u32).rev().map(|step| {
            let (sin, cos) = (12.0 * f64::from(step)).to_radians().sin_cos();
            ring(-upright_mm - edge_mm * sin, edge_mm * (1.0 - cos))
        });
        let rows = ((upright_mm + 4.0) / 4.0) as u32;
        let wall = (1..=rows).map(|row| ring(4.0 * f64::from(row) - upright_mm, 0.0));
        Mesh::tube(&round.chain(wall).collect::<Vec<_>>(), 140)
    });
    soles.into_iter().fold(mesh, Mesh::and)
}

/// Cut off at a height, and closed there by a flat sole that hangs on the skin.
fn closed_at(mesh: Mesh, cut_mm: f64, chance: &mut Chance) -> Mesh {
    // Facets of the skin reach 3 mm below their middle.
    let mut mesh = mesh.kept(|[_, y, _]| y > cut_mm + 3.0);
    for sign in [-1.0, 1.0] {
        let places = places_of_foot(&mesh, sign, cut_mm + 16.0);
        let foot: Vec<[f64; 3]> = places.iter().map(|at| mesh.points[*at]).collect();
        let [[x_low, x_high], [z_low, z_high]] = [range(&foot, 0), range(&foot, 2)];
        let half = [(x_high - x_low) / 2.0, (z_high - z_low) / 2.0];
        let [x, z] = [(x_low + x_high) / 2.0, (z_low + z_high) / 2.0];
        let plate = floors::sheet(chance, half, 0.1).moved(|p| [p[0] + x, p[1] + cut_mm, p[2] + z]);
        let mut sole = plate.kept(|[x, _, z]| {
            let near = foot.iter().filter(|point| (point[2] - z).abs() < 5.0);
            let [low, high] = range(&near.copied().collect::<Vec<_>>(), 0);
            low < x && x < high
        });
        sole.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        hang_on(&mut mesh, sole, &places);
    }
    mesh
}

/// Adds a sole, and joins its rim to the skin of its foot by some facets.
fn hang_on(mesh: &mut Mesh, sole: Mesh, foot: &[usize]) {
    let (own, count) = (mesh.points.len(), sole.points.len());
    *mesh = std::mem::take(mesh).and(sole);
    for at in (own..own + count - 1).step_by(3) {
        let far = |other: &usize| {
            let [p, q] = [mesh.points[at], mesh.points[*other]];
            (0..3).map(|axis| (p[axis] - q[axis]).powi(2)).sum::<f64>()
        };
        let nearest = foot.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b)));
        if let Some(nearest) = nearest.filter(|nearest| far(nearest) < 81.0) {
            mesh.triangles.push([at, nearest, at + 1]);
        }
    }
}

#[test]
fn heights_of_a_body_that_leans_in_its_export_are_right_within_what_is_stated() {
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let (mesh, truth) = drawn(&mut chance);
        let lean_deg = 1.0 + 5.0 * chance.unit();
        let sign = if chance.below(2) == 0 { 1.0 } else { -1.0 };
        let is_to_side = chance.below(2) == 0;
        let found = measured(&leaning(mesh, sign * lean_deg, is_to_side));
        let told = format!("{seed}: {lean_deg} {sign}, to a side {is_to_side}");
        let wrong = off_in_height(&found, truth, 3.0);
        assert!(wrong.is_empty(), "{told}: {wrong:?}");
        assert!(lean_deg < 4.5 || is_told(&found, "floor-uneven"), "{told}");
    }
}

#[test]
fn heights_over_shoes_are_never_quietly_wrong_and_thick_soles_are_said() {
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let (mesh, truth) = drawn(&mut chance);
        let thick_mm = 10.0 + 30.0 * chance.unit();
        let found = measured(&on_soles(mesh, thick_mm, &mut chance));
        let told = format!("{seed}: {thick_mm} mm");
        let wrong = off_in_height(&found, truth, 5.0);
        assert!(wrong.is_empty() || is_floor_doubted(&found), "{told}: {wrong:?}");
        assert!(thick_mm < 22.0 || is_told(&found, "feet-cut"), "{told}");
    }
}

#[test]
fn a_sole_that_is_there_is_the_floor() {
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let (mesh, truth) = drawn(&mut chance);
        let cut_mm = 3.0 + 8.0 * chance.unit();
        let found = measured(&closed_at(mesh, cut_mm, &mut chance));
        let told = format!("{seed}: closed at {cut_mm} mm");
        let off_mm = floor_mm(&found) - cut_mm;
        assert!(off_mm.abs() < 2.0, "{told}: {off_mm}");
        // That the exporter closed a foot above its sole is possible.
        let wrong = off_in_height(&found, truth, 5.0);
        assert!(wrong.is_empty() || is_floor_doubted(&found), "{told}: {wrong:?}");
    }
}

#[test]
fn bare_feet_on_a_level_floor_leave_no_doubt() {
    for seed in 0..DRAWS {
        let mut chance = Chance(seed);
        let (mesh, _) = drawn(&mut chance);
        let found = measured(&mesh);
        assert!(!is_floor_doubted(&found), "{seed}");
        assert!(found.body.floor_sd_mm < 1.6, "{seed}: {}", found.body.floor_sd_mm);
    }
}

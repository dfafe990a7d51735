//! A body whose head was cut off is measured by its feet and its crotch.

use super::*;

/// How many cuts are drawn for each body.
const CUTS: u64 = 12;

/// A lid over the cut at a height: a fan about the middle of the highest points.
fn with_lid(mesh: Mesh, cut_mm: f64) -> Mesh {
    let rim: Vec<usize> =
        (0..mesh.points.len()).filter(|at| mesh.points[*at][1] > cut_mm - 8.0).collect();
    let sum =
        |axis: usize| rim.iter().map(|at| mesh.points[*at][axis]).sum::<f64>() / rim.len() as f64;
    let middle = [sum(0), cut_mm, sum(2)];
    let mut mesh = mesh;
    let mut rim = rim;
    let turn = |p: [f64; 3]| (p[2] - middle[2]).atan2(p[0] - middle[0]);
    rim.sort_by(|a, b| turn(mesh.points[*a]).total_cmp(&turn(mesh.points[*b])));
    let own = mesh.points.len();
    mesh.points.push(middle);
    mesh.triangles.extend(rim.windows(2).map(|pair| [own, pair[1], pair[0]]));
    mesh
}

#[test]
fn girths_without_a_head_are_those_of_the_whole_body_within_what_is_stated() {
    for body in ["f_average_clean", "m_average_clean"] {
        let whole = Mesh::body(body);
        let top_mm = whole.points.iter().map(|point| point[1]).fold(0.0, f64::max);
        let expected = measured(&whole);
        assert!(
            !is_told(&expected, "crown-not-seen") && expected.body.stature_mm.is_some(),
            "{body}"
        );
        for seed in 0..CUTS {
            let mut chance = Chance(seed);
            // From the chest to the mouth.
            let cut_mm = top_mm * (0.68 + 0.20 * chance.unit());
            let cut = whole.clone().kept(|[_, y, _]| y < cut_mm);
            let cut = if chance.below(2) == 0 { with_lid(cut, cut_mm) } else { cut };
            let found = measured(&cut);
            let told = format!("{body}, cut at {cut_mm}");
            assert!(is_told(&found, "crown-not-seen") && found.body.stature_mm.is_none(), "{told}");
            for (own, whole) in found.legs.iter().zip(&expected.legs) {
                for level in [Level::B, Level::C, Level::D] {
                    let [own, whole] = [own, whole].map(|leg| {
                        leg.landmarks.iter().find(|landmark| landmark.level == level).unwrap()
                    });
                    let off_mm = own.girth_tape_mm - whole.girth_tape_mm;
                    assert!(
                        off_mm.abs() < 2.0 + 2.0 * own.girth_of_level_sd_mm,
                        "{told}: {level:?} {off_mm}, sd {}",
                        own.girth_of_level_sd_mm
                    );
                }
            }
        }
    }
}

#[test]
fn a_head_with_a_hole_in_its_crown_is_a_head() {
    let whole = Mesh::body("m_average_clean");
    let top_mm = whole.points.iter().map(|point| point[1]).fold(0.0, f64::max);
    for hole_mm in [4.0, 10.0, 14.0] {
        let found = measured(&whole.clone().kept(|[_, y, _]| y < top_mm - hole_mm));
        assert!(!is_told(&found, "crown-not-seen"), "{hole_mm}");
    }
}

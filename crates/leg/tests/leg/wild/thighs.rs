//! Thighs that touch and are one skin in the export: where the crotch is, and how sure that is.

use gaiter_leg::CrotchFrom;

use super::*;

/// How many are drawn for each body.
const DRAWS: u64 = 16;

/// Above this standard error of the crotch there is no G and no F, mm.
const LEVELS_MAX_SD_MM: f64 = 25.0;

/// How far legs are moved inwards at each mm of height, so that they touch over `length_mm` below the crotch, pressed
/// by `press_mm`.
fn inwards_mm(body: &Mesh, crotch_mm: f64, length_mm: f64, press_mm: f64) -> Vec<f64> {
    let crotch = crotch_mm as usize;
    let mut gaps = vec![f64::INFINITY; crotch + 1];
    for point in &body.points {
        let at = point[1].max(0.0) as usize;
        if at <= crotch {
            gaps[at] = gaps[at].min(point[0].abs());
        }
    }
    let mut moved = vec![0.0; crotch + 1];
    for at in (0..crotch).rev() {
        let below_mm = (crotch - at) as f64;
        let touches = below_mm <= length_mm && gaps[at].is_finite();
        // The press begins softly.
        let wanted = if touches { gaps[at] + press_mm * (below_mm / 20.0).min(1.0) } else { 0.0 };
        // Below, the legs part again.
        let above_mm = if below_mm <= length_mm { moved[at + 1] } else { moved[at + 1] - 0.6 };
        moved[at] = f64::max(above_mm, wanted);
    }
    moved
}

/// A body whose thighs touch: what passes the middle is gone, and the borders on both sides of it are sewn up.
fn touching(body: &Mesh, crotch_mm: f64, length_mm: f64, press_mm: f64) -> Mesh {
    let moved = inwards_mm(body, crotch_mm, length_mm, press_mm);
    let mut mesh = body.clone().moved(|[x, y, z]| {
        let by = moved.get(y.max(0.0) as usize).copied().unwrap_or(0.0);
        [x.signum() * (x.abs() - by).max(0.0), y, z]
    });
    let is_middle = |mesh: &Mesh, at: usize| {
        let [x, y, _] = mesh.points[at];
        x == 0.0 && y < crotch_mm && body.points[at][0] != 0.0
    };
    let kept = mesh.triangles.iter().filter(|t| !t.iter().all(|at| is_middle(&mesh, *at)));
    let kept: Vec<[usize; 3]> = kept.copied().collect();
    mesh.triangles = kept;
    let mut rims: [[Vec<usize>; 2]; 2] = Default::default();
    let mut used: Vec<usize> = mesh.triangles.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let rim: Vec<usize> = used.into_iter().filter(|at| is_middle(&mesh, *at)).collect();
    let middle_z = rim.iter().map(|at| mesh.points[*at][2]).sum::<f64>() / rim.len().max(1) as f64;
    for at in rim {
        let side = usize::from(body.points[at][0] > 0.0);
        let front = usize::from(mesh.points[at][2] > middle_z);
        rims[front][side].push(at);
    }
    for [left, right] in &mut rims {
        let height = |at: &usize| mesh.points[*at][1];
        left.sort_by(|a, b| height(a).total_cmp(&height(b)));
        right.sort_by(|a, b| height(a).total_cmp(&height(b)));
        mesh.triangles.extend(sewn(&mesh.points, left, right));
    }
    // Without the points that nothing uses any more.
    mesh.kept(|_| true)
}

/// Triangles between two rows of points that ascend side by side.
fn sewn(points: &[[f64; 3]], left: &[usize], right: &[usize]) -> Vec<[usize; 3]> {
    let (mut l, mut r) = (0, 0);
    let mut found = Vec::new();
    while l + 1 < left.len() && r + 1 < right.len() {
        let is_left_next = points[left[l + 1]][1] < points[right[r + 1]][1];
        if is_left_next {
            found.push([left[l], right[r], left[l + 1]]);
            l += 1;
        } else {
            found.push([left[l], right[r], right[r + 1]]);
            r += 1;
        }
    }
    found
}

#[test]
fn the_crotch_of_thighs_that_are_one_skin_lies_within_what_is_stated() {
    for body in ["f_average_clean", "m_average_clean"] {
        let mesh = Mesh::body(body);
        let apart = measured(&mesh);
        let true_mm = apart.crotch.height_mm;
        let (mut inside, mut without) = (0, 0);
        for seed in 0..DRAWS {
            let mut chance = Chance(seed);
            let (length_mm, press_mm) = (40.0 + 150.0 * chance.unit(), 4.0 + 16.0 * chance.unit());
            let found = measured(&touching(&mesh, true_mm, length_mm, press_mm));
            let crotch = found.crotch;
            let off_mm = (crotch.height_mm - true_mm).abs();
            let told = format!(
                "{body} {length_mm} {press_mm}: {:?} off {off_mm}, {}",
                crotch.from, crotch.sd_mm
            );
            assert!(off_mm < 3.0 * crotch.sd_mm + 2.0, "{told}");
            inside += u64::from(off_mm < 2.0 * crotch.sd_mm);
            let has_levels = found.legs.iter().any(|leg| {
                leg.landmarks.iter().any(|landmark| landmark.level == Level::G)
                    || leg.estimates.iter().any(|estimate| estimate.level == Level::F)
            });
            assert!(crotch.sd_mm <= LEVELS_MAX_SD_MM || !has_levels, "{told}");
            without += u64::from(!has_levels);
            if length_mm > 80.0 {
                assert!(crotch.from != CrotchFrom::Saddle && crotch.sd_mm > 10.0, "{told}");
            }
        }
        assert!(inside * 10 >= DRAWS * 9, "{body}: {inside} of {DRAWS} within two standard errors");
        assert!(without > 0, "{body}: long contacts leave G to the tape");
    }
}

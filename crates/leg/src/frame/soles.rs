//! Whether the soles of the feet show the floor: they lie in one level plane, and their skin turns under
//! where it ends.

use nalgebra::Vector2;

use super::long_axis::long_axis;

/// Share of a foot's points that may lie below its lowest skin: noise and stray points.
const STRAY_SHARE: f64 = 0.002;

/// Heel and ball lie in these two shares of a foot's length from its two ends.
const END_SHARE: f64 = 0.45;

/// Heels and balls of standing feet end this far from one plane at most, mm, by how far down their skin
/// was seen; a body that leans by 3° in the export exceeds it.
const EVEN_MAX_MM: f64 = 8.0;

/// Directions around a foot in which its skin is looked at.
const DIRECTIONS: usize = 32;

/// Its lowest part there, and the part above, from the lowest point, mm.
const LOW_BAND_MM: [f64; 2] = [0.0, 3.0];
const HIGH_BAND_MM: [f64; 2] = [5.0, 9.0];

/// Skin that is seen down to the sole turns under: its lowest part lies further inwards, by 0.6 to 1
/// mm per mm of height. The side of a shoe, or of a foot that was cut, stands upright.
const UNDERCUT_MIN: f64 = 0.4;

/// Standard error of the floor below skin that ends while it is upright, mm: feet are cut by up to
/// 20 mm, and soles of shoes are 20 to 30 mm thick.
const CUT_SD_MM: f64 = 12.0;

/// Why the soles do not show the floor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FloorDoubt {
    /// The soles do not lie in a level plane.
    Uneven {
        /// From the lowest to the highest, mm.
        spread_mm: f64,
    },
    /// The skin of the feet ends before it turns under.
    NotTurning,
}

impl FloorDoubt {
    /// What it adds to the standard error of the floor, mm.
    pub fn sd_mm(self) -> f64 {
        match self {
            FloorDoubt::Uneven { spread_mm } => spread_mm / 2.0,
            FloorDoubt::NotTurning => CUT_SD_MM,
        }
    }

    /// The stable code used in records and docs/codes.md.
    pub fn code(&self) -> &'static str {
        match self {
            FloorDoubt::Uneven { .. } => "floor-uneven",
            FloorDoubt::NotTurning => "feet-cut",
        }
    }
}

/// What speaks against a floor that these feet show.
pub(crate) fn doubt(feet: &[Vec<[f64; 3]>]) -> Option<FloorDoubt> {
    let spread_mm = spread_mm(feet);
    if spread_mm > EVEN_MAX_MM {
        return Some(FloorDoubt::Uneven { spread_mm });
    }
    undercut(feet).filter(|share| *share < UNDERCUT_MIN).map(|_| FloorDoubt::NotTurning)
}

/// How far apart the lowest skin of heels and balls is, mm; 0 if there is one at most.
fn spread_mm(feet: &[Vec<[f64; 3]>]) -> f64 {
    let ends = feet.iter().flat_map(|foot| {
        let direction = long_axis(foot).direction;
        let along = |point: &[f64; 3]| Vector2::new(point[0], point[1]).dot(&direction);
        let reach = foot.iter().map(along);
        let (from, to) = reach
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), r| (low.min(r), high.max(r)));
        let end_mm = END_SHARE * (to - from);
        let part = |keeps: &dyn Fn(f64) -> bool| -> Vec<[f64; 3]> {
            foot.iter().filter(|point| keeps(along(point))).copied().collect()
        };
        [part(&|r| r < from + end_mm), part(&|r| r > to - end_mm)]
    });
    let lowest: Vec<f64> = ends.filter_map(|end| lowest_mm(&end)).collect();
    let highest = lowest.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = lowest.iter().copied().fold(f64::INFINITY, f64::min);
    (highest - least).max(0.0)
}

/// Height of a foot's lowest skin, mm.
pub(crate) fn lowest_mm(foot: &[[f64; 3]]) -> Option<f64> {
    let mut heights: Vec<f64> = foot.iter().map(|point| point[2]).collect();
    let stray = (STRAY_SHARE * heights.len() as f64) as usize;
    (stray < heights.len()).then(|| *heights.select_nth_unstable_by(stray, f64::total_cmp).1)
}

/// How far the skin of the feet runs inwards at its lower end, mm per mm of height: the median of
/// directions around each foot. `None` if no direction shows it.
fn undercut(feet: &[Vec<[f64; 3]>]) -> Option<f64> {
    let mut shares: Vec<f64> = feet.iter().flat_map(|foot| undercuts(foot)).collect();
    shares.sort_by(f64::total_cmp);
    shares.get(shares.len() / 2).copied()
}

/// As [`undercut`], in each direction around one foot that shows it.
fn undercuts(foot: &[[f64; 3]]) -> Vec<f64> {
    let count = foot.len().max(1) as f64;
    let sum = foot.iter().fold(Vector2::zeros(), |sum, p| sum + Vector2::new(p[0], p[1]));
    let middle: Vector2<f64> = sum / count;
    // Distance from the middle and height, by direction.
    let mut around: Vec<Vec<[f64; 2]>> = vec![Vec::new(); DIRECTIONS];
    for point in foot {
        let arm = Vector2::new(point[0], point[1]) - middle;
        let turn = arm.y.atan2(arm.x) / std::f64::consts::TAU + 0.5;
        let direction = (turn * DIRECTIONS as f64) as usize;
        around[direction.min(DIRECTIONS - 1)].push([arm.norm(), point[2]]);
    }
    let share = |side: &Vec<[f64; 2]>| {
        let low_mm = side.iter().map(|[_, z]| *z).fold(f64::INFINITY, f64::min);
        let mean = |[from, to]: [f64; 2]| {
            let band = side.iter().filter(|[_, z]| (low_mm + from..low_mm + to).contains(z));
            let (count, r, z) =
                band.fold((0.0, 0.0, 0.0), |(n, r, z), p| (n + 1.0, r + p[0], z + p[1]));
            (count > 0.0).then(|| [r / count, z / count])
        };
        let ([low_r, low_z], [high_r, high_z]) = (mean(LOW_BAND_MM)?, mean(HIGH_BAND_MM)?);
        Some((high_r - low_r) / (high_z - low_z))
    };
    around.iter().filter_map(share).collect()
}

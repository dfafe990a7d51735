//! Whether the soles of the feet show the floor: they lie in one level plane, their skin turns under where it
//! ends, and the toes lie no higher than a bare foot's.

use nalgebra::{Rotation2, Vector2};
use serde::{Deserialize, Serialize};

use crate::statistics::{median, quantile, range};

/// Share of a foot's points that may lie below its lowest skin: noise and stray points.
const STRAY_SHARE: f64 = 0.002;

/// Heel and ball lie in these two shares of a foot's length from its two ends.
const END_SHARE: f64 = 0.45;

/// Heels and balls of standing feet end this far from one plane at most, mm, by how far down their skin
/// was seen; a body that leans by 3° in the export exceeds it.
const EVEN_MAX_MM: f64 = 8.0;

/// … and by this much whatever the export, mm: of generated bodies that stand upright, half differ by less than 1 mm,
/// most by less than 3 mm. What is more may be a lean, which shifts the heights of a leg by up to as much.
const EVEN_USUAL_MM: f64 = 3.0;

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

/// Length of a foot whose toes are there and seen, as a share of the stature: of generated bodies, whose soles are not
/// seen, 0.129 to 0.150; with a shoe more.
const WHOLE_FOOT_SHARE: [f64; 2] = [0.125, 0.19];

/// Where the toes are looked at, from the tip of the foot, as shares of its length: 5 to 20 mm, on the nail.
const TOES_SHARE: [f64; 2] = [0.02, 0.08];

/// With fewer points the toes were not seen.
const TOES_POINTS_MIN: usize = 6;

/// This share of the points on them lies below their top: noise and stray points.
const TOES_TOP_SHARE: f64 = 0.95;

/// Usual height of the toes above the lowest skin, at most, as a share of the stature: of generated bodies 15 to 21 mm
/// at 1 650 mm. Judgement for people: great toes are 20 to 25 mm high, of which the lowest 3 mm are not seen.
const TOES_HIGH_SHARE: f64 = 22.0 / 1650.0;

/// What toes are higher than that makes the floor uncertain by this share: it is the sole of a shoe, or swollen.
const TOES_SD_SHARE: f64 = 0.6;

/// Toes that are higher than usual by more than this, mm, are in shoes; swollen ones hardly are.
const SHOE_MIN_MM: f64 = 12.0;

/// A sole is looked at in this many strips across the foot, of which the first and the last are its tips.
const STRIPS: usize = 12;

/// Skin of the sole lies up to this far above the lowest skin, as a share of the stature: 10 mm of 1 650 mm, less than
/// the radius of a foot's edge.
const SOLE_SHARE: f64 = 10.0 / 1650.0;

/// A strip of it that is narrower, as a share of the stature, is the outer edge of the foot beside the arch: 33 mm.
const STRIP_MIN_SHARE: f64 = 0.02;

/// In a strip that shows the sole no gap is wider than this share of it; between two edges without a sole it is 0.7.
const STRIP_GAP_MAX_SHARE: f64 = 0.5;

/// Evidence of the soles about the floor.
pub(crate) struct Soles {
    /// A reason to doubt it.
    pub doubt: Option<FloorDoubt>,
    /// What they add to its standard error, mm.
    pub sd_mm: f64,
}

coded_enum! {
    /// Why the soles do not show the floor.
    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    pub enum FloorDoubt {
        /// The soles do not lie in a level plane.
        Uneven {
            /// From the lowest to the highest, mm.
            spread_mm: f64,
        } => "floor-uneven",
        /// The skin of the feet ends before it turns under.
        NotTurning => "feet-cut",
        /// The toes lie higher than a bare foot's.
        Raised {
            /// Their height above the lowest skin of the foot, mm.
            toes_mm: f64,
        } => "feet-cut",
    }
}

/// The evidence of these feet, of a body with this stature, about the floor.
pub(crate) fn soles(feet: &[Vec<[f64; 3]>], stature_mm: f64) -> Soles {
    let parts: Vec<Foot> = feet.iter().map(|foot| Foot::from_points(foot)).collect();
    let spread_mm = spread_mm(&parts);
    // Of both feet: toes of one may be missing or swollen, shoes come in pairs.
    let toes_mm = parts.iter().filter_map(|foot| foot.toes_mm(stature_mm)).reduce(f64::min);
    let high_mm = toes_mm.map_or(0.0, |mm| (mm - TOES_HIGH_SHARE * stature_mm).max(0.0));
    let doubt = if spread_mm > EVEN_MAX_MM {
        Some(FloorDoubt::Uneven { spread_mm })
    } else if undercut(feet).is_some_and(|share| share < UNDERCUT_MIN) {
        Some(FloorDoubt::NotTurning)
    } else {
        let toes_mm = toes_mm.filter(|_| high_mm > SHOE_MIN_MM);
        toes_mm.map(|toes_mm| FloorDoubt::Raised { toes_mm })
    };
    let uneven_mm = (spread_mm.powi(2) - EVEN_USUAL_MM.powi(2)).max(0.0).sqrt();
    let cut_sd_mm = if doubt == Some(FloorDoubt::NotTurning) { CUT_SD_MM } else { 0.0 };
    let sd_mm = (uneven_mm / 2.0).hypot(TOES_SD_SHARE * high_mm).hypot(cut_sd_mm);
    Soles { doubt, sd_mm }
}

/// One end of a foot: of each point the distance from the tip, as a share of the foot's length, and the height, mm.
type End = Vec<[f64; 2]>;

/// A foot as its heel and its ball see it.
struct Foot {
    length_mm: f64,
    ends: [End; 2],
}

impl Foot {
    fn from_points(points: &[[f64; 3]]) -> Foot {
        let LongAxis { direction, length: length_mm, .. } = long_axis(points);
        let along = |point: &[f64; 3]| Vector2::new(point[0], point[1]).dot(&direction);
        let from = points.iter().map(along).fold(f64::INFINITY, f64::min);
        let mut ends = [Vec::new(), Vec::new()];
        for point in points {
            let share = (along(point) - from) / length_mm;
            for (end, share) in ends.iter_mut().zip([share, 1.0 - share]) {
                if share < END_SHARE {
                    end.push([share, point[2]]);
                }
            }
        }
        Foot { length_mm, ends }
    }

    /// How high the toes reach above the lowest skin at their end, mm. `None` if they may be missing, or were not
    /// seen. The heel's end is higher.
    fn toes_mm(&self, stature_mm: f64) -> Option<f64> {
        let share = self.length_mm / stature_mm;
        if !(WHOLE_FOOT_SHARE[0]..=WHOLE_FOOT_SHARE[1]).contains(&share) {
            return None;
        }
        let [one, other] = self.ends.each_ref().map(|end| reach_mm(end));
        Some(one?.min(other?))
    }
}

/// How high the skin near the tip reaches above the lowest of an end, mm.
fn reach_mm(end: &[[f64; 2]]) -> Option<f64> {
    let near = end.iter().filter(|[share, _]| (TOES_SHARE[0]..TOES_SHARE[1]).contains(share));
    let heights: Vec<f64> = near.map(|[_, z]| *z).collect();
    if heights.len() < TOES_POINTS_MIN {
        return None;
    }
    Some(quantile(heights, TOES_TOP_SHARE)? - lowest(end.iter().map(|[_, z]| *z))?)
}

/// How far apart the lowest skin of heels and balls is, mm; 0 if there is one at most.
fn spread_mm(feet: &[Foot]) -> f64 {
    let ends = feet.iter().flat_map(|foot| &foot.ends);
    let [least, highest] = range(ends.filter_map(|end| lowest(end.iter().map(|[_, z]| *z))));
    (highest - least).max(0.0)
}

/// Whether the sole of a foot is in the scan, and not its edge alone: an exporter closed it, or it is a model's.
pub(crate) fn is_sole_seen(foot: &[[f64; 3]], stature_mm: f64) -> bool {
    let LongAxis { direction, length, .. } = long_axis(foot);
    let across = Vector2::new(-direction.y, direction.x);
    let place = |point: &[f64; 3]| Vector2::new(point[0], point[1]);
    let from = foot.iter().map(|p| place(p).dot(&direction)).fold(f64::INFINITY, f64::min);
    let Some(lowest_mm) = lowest_mm(foot) else { return false };
    let mut strips = vec![Vec::new(); STRIPS];
    for point in foot.iter().filter(|p| p[2] < lowest_mm + SOLE_SHARE * stature_mm) {
        let share = (place(point).dot(&direction) - from) / length;
        let strip = ((share * STRIPS as f64) as usize).min(STRIPS - 1);
        strips[strip].push(place(point).dot(&across));
    }
    let inner = strips[1..STRIPS - 1].iter_mut();
    let bridged: Vec<bool> =
        inner.filter_map(|strip| is_bridged(strip, STRIP_MIN_SHARE * stature_mm)).collect();
    2 * bridged.iter().filter(|is_bridged| **is_bridged).count() > bridged.len()
}

/// Whether there is skin all across a strip of a sole, given where its points are; `None` if it is too narrow.
fn is_bridged(strip: &mut [f64], width_min_mm: f64) -> Option<bool> {
    strip.sort_by(f64::total_cmp);
    let width_mm = strip.last()? - strip.first()?;
    let gap_mm = strip.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    (width_mm >= width_min_mm).then_some(gap_mm < STRIP_GAP_MAX_SHARE * width_mm)
}

/// Height of a foot's lowest skin, mm.
pub(crate) fn lowest_mm(foot: &[[f64; 3]]) -> Option<f64> {
    lowest(foot.iter().map(|point| point[2]))
}

/// The lowest of heights, stray ones left out.
fn lowest(heights: impl Iterator<Item = f64>) -> Option<f64> {
    quantile(heights.collect(), STRAY_SHARE)
}

/// How far the skin of the feet runs inwards at its lower end, mm per mm of height: the median of
/// directions around each foot. `None` if no direction shows it.
fn undercut(feet: &[Vec<[f64; 3]>]) -> Option<f64> {
    median(feet.iter().flat_map(|foot| undercuts(foot)).collect())
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

/// The long axis of points seen from above, and their extents.
pub(super) struct LongAxis {
    /// Unit vector along it, of arbitrary sign.
    pub direction: Vector2<f64>,
    /// Extent along it, in the unit of the points.
    pub length: f64,
    /// Extent across it.
    pub width: f64,
}

/// The first principal axis of points seen from above.
pub(super) fn long_axis(of: &[[f64; 3]]) -> LongAxis {
    let points: Vec<Vector2<f64>> = of.iter().map(|p| Vector2::new(p[0], p[1])).collect();
    let middle = points.iter().sum::<Vector2<f64>>() / points.len().max(1) as f64;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for d in points.iter().map(|p| p - middle) {
        (xx, xy, yy) = (xx + d.x * d.x, xy + d.x * d.y, yy + d.y * d.y);
    }
    let direction = Rotation2::new((2.0 * xy).atan2(xx - yy) / 2.0) * Vector2::x();
    let [length, width] = [direction, Vector2::new(-direction.y, direction.x)].map(|axis| {
        let [low, high] = range(points.iter().map(|p| p.dot(&axis)));
        high - low
    });
    LongAxis { direction, length, width }
}

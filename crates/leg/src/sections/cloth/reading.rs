//! What a step looks like from near by: how sharp, how even all around, step or furrow.

use super::Edge;
use super::rows::{DIRECTIONS, Lean, ROW_MM, Rows, SECTORS, of_sector};
use super::search::SHARP;
use super::step::{BETTER_MIN, Furrow, ROUND_SCALE_MIN_MM, Step};

/// In this many of them a step must be measured.
const SECTORS_MIN: usize = 9;

/// In a sector the edge may lie up to this far from the plane, mm: edges wave.
const WAVE_OFFSETS_MM: [f64; 7] = [-4.5, -3.0, -1.5, 0.0, 1.5, 3.0, 4.5];

/// A step of this many standard errors is clear enough in each sector to align the sectors.
const ALIGN_MIN_SDS: f64 = 12.0;

/// How often the sectors are aligned.
const ALIGNMENTS: usize = 2;

/// An edge is sharp if its scale is at most this, mm: 8 mm wide, and waved by 4 mm.
const SHARP_SCALE_MAX_MM: f64 = 2.5;

/// … or this for large steps, whose width is well known: fat that steps by 8 mm or more takes 15 mm for it, 2.1 mm of
/// scale.
const LARGE_SCALE_MAX_MM: f64 = 1.8;

/// A large step, mm.
const LARGE_MM: f64 = 7.0;

/// … and it must fit better than round ones by this sum: five standard errors.
const LARGE_BETTER_MIN: f64 = 25.0;

/// A wider step than this is no edge at all, mm.
const SOFT_SCALE_MAX_MM: f64 = 6.0;

/// A soft edge must fit better than a furrow by this sum.
const SOFT_BETTER_MIN: f64 = 4.0;

/// … and step by this at least, mm, and by this many standard errors.
const SOFT_MIN_MM: f64 = 1.5;
const SOFT_MIN_SDS: f64 = 5.0;

/// Where a soft edge has an opposite one of equal size, that need not fit better, and may have this many standard
/// errors only.
const PARTNER_MIN_SDS: f64 = 4.5;

/// Beside a furrow, such a share of the step must remain.
const REMAINS_SHARE: [f64; 2] = [0.6, 1.6];

/// What lies this close to an edge is the same edge, mm.
const SAME_MM: f64 = 15.0;

/// At least this share of the sectors must step by a third of the mean or more; the noise of a single sector hides
/// 2 mm at times.
const EVEN_MIN_SHARE: f64 = 0.75;

/// Steps of cloth differ between sectors by at most this share, beyond noise (as variance): seams and waves of the
/// edge. Folds and furrows of swollen knees differ by 0.6 to 5.
const SPREAD_MAX_SHARE: f64 = 0.45;
const SPREAD_MAX_NOISE: f64 = 1.6;

/// Loose cloth, such as trousers, stands off more on one side than on another: where an edge is large and fits better
/// than anything else by this sum (ten standard errors), its steps may differ by that share.
const PLAIN_BETTER_MIN: f64 = 100.0;
const PLAIN_SPREAD_MAX_SHARE: f64 = 0.6;

/// Two opposite edges that are closer than this bound a fold, a furrow, or cloth too narrow to matter, mm.
const FOLD_MM: f64 = 60.0;

/// … even if the other edge is rounder or smaller, down to this share.
const FOLD_SHARE: f64 = 0.5;
const FOLD_BETTER_MIN: f64 = 0.0;
const FOLD_EVEN_BETTER_MIN: f64 = -5.0;

/// The lowest part of the span holds the instep, which is no other side of a fold, mm.
const INSTEP_MM: f64 = 30.0;

/// The two edges of a bandage step equally within this share, or within three standard errors.
const EQUAL_SHARE: f64 = 0.4;
const EQUAL_SDS: f64 = 3.0;

/// What a step looks like.
#[derive(Debug, Clone)]
pub(super) struct Reading {
    pub(super) along_mm: f64,
    pub(super) step: Step,
    sd_mm: f64,
    /// The height if the step had another scale, as (scale, height).
    heights_mm: Vec<(f64, f64)>,
    /// By how much it fits better than a round step, and than a furrow, in squared standard errors.
    better_than_round: f64,
    better_than_furrow: f64,
    /// What remains of it beside a furrow, mm.
    remains_mm: f64,
    /// Its height in the sectors, and the standard error, mm.
    sectors: Vec<(f64, f64)>,
    is_at_instep: bool,
}

impl Rows {
    /// The shape of a step; `None` if it is unclear. Where its edge waves, the directions are aligned first: the waves
    /// would make it look round.
    pub(super) fn reading(&self, border: usize, lean: Lean) -> Option<Reading> {
        let mut shifts = self.shifts(lean);
        for _ in 0..ALIGNMENTS {
            let means = self.window(border, &shifts, 0..DIRECTIONS);
            let step = Step::clearest(&Step::all(&means), means.len(), self.noise_mm)?;
            if step.height_mm.abs() < ALIGN_MIN_SDS * step.sd * self.noise_mm {
                break;
            }
            for (sector, here) in self.sectors(border, &shifts, &step).into_iter().enumerate() {
                let Some(here) = here else { continue };
                let rows = ((here.at_mm - step.at_mm) / ROW_MM).round() as isize;
                shifts[of_sector(sector)].iter_mut().for_each(|shift| *shift += rows);
            }
        }
        self.reading_along(border, &shifts)
    }

    /// What a step looks like along a line around the leg.
    fn reading_along(&self, border: usize, shifts: &[isize; DIRECTIONS]) -> Option<Reading> {
        let means = self.window(border, shifts, 0..DIRECTIONS);
        let steps = Step::all(&means);
        let step = Step::clearest(&steps, means.len(), self.noise_mm)?;
        let furrow = Furrow::best(&means)?;
        let (remains_mm, _) = furrow.step_beside(&means, step.at_mm)?;
        let scatter_mm = step.scatter_mm(means.len(), self.noise_mm);
        let better = |misfit: f64| (misfit - step.misfit) / scatter_mm.powi(2);
        let round = steps.iter().filter(|step| step.scale_mm > ROUND_SCALE_MIN_MM);
        let round = round.map(|step| step.misfit).fold(f64::INFINITY, f64::min);
        let sectors = self.sectors(border, shifts, &step).into_iter().flatten();
        Some(Reading {
            along_mm: self.from_mm + ROW_MM * border as f64 + step.at_mm,
            step,
            sd_mm: step.sd * scatter_mm,
            heights_mm: steps.iter().map(|step| (step.scale_mm, step.height_mm)).collect(),
            better_than_round: better(round),
            better_than_furrow: better(furrow.misfit),
            remains_mm,
            sectors: sectors.map(|step| (step.height_mm, step.sd * self.noise_mm)).collect(),
            is_at_instep: (border as f64) * ROW_MM < INSTEP_MM,
        })
    }

    /// A step in each sector, where it fits best; `None` where too little is seen.
    fn sectors(
        &self,
        border: usize,
        shifts: &[isize; DIRECTIONS],
        step: &Step,
    ) -> [Option<Step>; SECTORS] {
        std::array::from_fn(|sector| {
            let means = self.window(border, shifts, of_sector(sector));
            let steps = WAVE_OFFSETS_MM
                .iter()
                .filter_map(|off_mm| Step::at(&means, step.scale_mm, step.at_mm + off_mm));
            steps.min_by(|a, b| a.misfit.total_cmp(&b.misfit))
        })
    }
}

impl Reading {
    fn height_mm(&self) -> f64 {
        self.step.height_mm.abs()
    }

    pub(super) fn sds(&self) -> f64 {
        self.height_mm() / self.sd_mm
    }

    /// Whether all directions step alike.
    pub(super) fn is_even(&self) -> bool {
        let count = self.sectors.len() as f64;
        if self.sectors.len() < SECTORS_MIN {
            return false;
        }
        let third = self.height_mm() / 3.0;
        let along = |height: &f64| height * self.step.height_mm.signum() > third;
        let heights = self.sectors.iter().map(|(height, _)| *height);
        let alike = heights.clone().filter(along).count() as f64;
        let mean = heights.clone().sum::<f64>() / count;
        let spread = heights.map(|height| (height - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let noise = self.sectors.iter().map(|(_, sd)| sd * sd).sum::<f64>() / count;
        let share = if self.is_plain() { PLAIN_SPREAD_MAX_SHARE } else { SPREAD_MAX_SHARE };
        let spread_max = (share * self.height_mm()).powi(2) + SPREAD_MAX_NOISE * noise;
        alike >= EVEN_MIN_SHARE * count && spread <= spread_max
    }

    /// Whether it is the edge of loose cloth: large and sharp beyond doubt.
    fn is_plain(&self) -> bool {
        self.height_mm() > LARGE_MM
            && self.step.scale_mm <= LARGE_SCALE_MAX_MM
            && self.better_than_round.min(self.better_than_furrow) >= PLAIN_BETTER_MIN
    }

    /// Whether it is an edge that is sharper than flesh.
    pub(super) fn is_sharp(&self) -> bool {
        let (scale_max_mm, better_min) = if self.height_mm() > LARGE_MM {
            (LARGE_SCALE_MAX_MM, LARGE_BETTER_MIN)
        } else {
            (SHARP_SCALE_MAX_MM, BETTER_MIN)
        };
        let remains = self.remains_mm * self.step.height_mm.signum();
        self.step.scale_mm <= scale_max_mm
            && self.height_mm() >= SHARP.step_min_mm.max(SHARP.step_min_sds * self.sd_mm)
            && self.better_than_round >= better_min
            && self.better_than_furrow >= BETTER_MIN
            && (REMAINS_SHARE[0]..REMAINS_SHARE[1]).contains(&(remains / self.height_mm()))
    }

    /// Whether it may be a soft edge.
    pub(super) fn is_soft(&self) -> bool {
        self.step.scale_mm <= SOFT_SCALE_MAX_MM
            && self.height_mm() >= SOFT_MIN_MM.max(SOFT_MIN_SDS * self.sd_mm)
            && self.better_than_furrow >= SOFT_BETTER_MIN
            && !self.is_at_instep
            && self.remains_mm * self.step.height_mm > 0.0
    }

    /// Whether it may be the other edge of cloth of which a soft edge was found.
    pub(super) fn is_partner(&self) -> bool {
        self.is_even()
            && self.step.scale_mm <= SOFT_SCALE_MAX_MM
            && self.height_mm() >= SHARP.step_min_mm.max(PARTNER_MIN_SDS * self.sd_mm)
            && self.better_than_furrow >= 0.0
            && !self.is_at_instep
    }

    pub(super) fn edge(&self, is_sharp: bool) -> Edge {
        Edge { along_mm: self.along_mm, step_mm: self.step.height_mm, is_sharp }
    }

    /// Whether another one is the other side of a fold.
    pub(super) fn folds_back(&self, other: &Reading) -> bool {
        let better_min = if other.is_even() { FOLD_EVEN_BETTER_MIN } else { FOLD_BETTER_MIN };
        (self.along_mm - other.along_mm).abs() < FOLD_MM
            && self.step.height_mm * other.step.height_mm < 0.0
            && other.height_mm() >= FOLD_SHARE * self.height_mm()
            && other.step.scale_mm <= SOFT_SCALE_MAX_MM
            && other.better_than_furrow >= better_min
            && !other.is_at_instep
    }

    /// Whether another look at the same edge shows a furrow.
    pub(super) fn is_furrow_by(&self, other: &Reading) -> bool {
        (self.along_mm - other.along_mm).abs() < SAME_MM
            && self.step.height_mm * other.step.height_mm > 0.0
            && other.better_than_furrow < 0.0
    }

    /// The nearest of others that may be the other edge of the same cloth: above where it begins, below where it ends.
    pub(super) fn partner<'r>(&self, others: &'r [Reading]) -> Option<&'r Reading> {
        let way = self.step.height_mm.signum();
        let far_mm = |other: &Reading| way * (other.along_mm - self.along_mm);
        let is_opposite = |other: &Reading| {
            far_mm(other) >= FOLD_MM && other.step.height_mm * way < 0.0 && self.pairs(other)
        };
        let partners = others.iter().filter(|other| other.is_partner() && is_opposite(other));
        partners.min_by(|a, b| far_mm(a).total_cmp(&far_mm(b)))
    }

    /// Whether cloth that begins here may end there, or the other way round.
    pub(super) fn pairs(&self, other: &Reading) -> bool {
        let scale_mm = self.step.scale_mm.max(other.step.scale_mm);
        let height = |reading: &Reading| {
            let same = reading.heights_mm.iter().find(|(scale, _)| *scale == scale_mm);
            same.map_or(reading.step.height_mm, |(_, height)| *height)
        };
        let [out_mm, in_mm] = [self, other].map(|reading| height(reading).abs());
        let sd_mm = self.sd_mm.hypot(other.sd_mm);
        let off_max_mm = (EQUAL_SHARE * (out_mm + in_mm) / 2.0).max(EQUAL_SDS * sd_mm);
        (out_mm - in_mm).abs() <= off_max_mm
    }
}

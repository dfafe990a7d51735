//! The limits that extractions are held to, over all scans of a folder.

use std::fmt;

use gaiter_leg::{Extraction, Landmark, LegReport, Level, Side};
use nalgebra::Vector3;
use serde_json::Value;

use super::curve::Curve;
use super::truth::{Case, Compared, Profile, compared, found, quantiles};

/// Girths may be off by this much on a scan without noise, mm.
const GIRTH_MM: f64 = 0.3;

/// … and by this share of the scan's noise besides.
const GIRTH_NOISE_SHARE: f64 = 0.8;

/// Heights may be off by this much, or by the truth's `flat_mm` where that is more, mm.
const HEIGHT_MM: f64 = 5.0;

/// The worst may be off by this many times as much.
const GIRTH_WORST: f64 = 2.0;
const HEIGHT_WORST: f64 = 2.0;

/// The least true slope at the reported B1, as a share of the largest.
const SLOPE_SHARE: f64 = 0.93;

const FACING_DEG: f64 = 25.0;

/// Along the curve, a height may be off by this much, mm, which a girth follows by its slope.
const CURVE_HEIGHT_MM: f64 = 1.5;

/// The heights of a curve may be off by this much on average, and by this much at the 95th percentile, mm.
const OFFSET_MEAN_MM: f64 = 0.5;
const OFFSET_MM: f64 = 2.0;

/// The crotch may be off by this much where it was seen, mm, and G's girth from that at its true height.
const CROTCH_MM: f64 = 5.0;
const CROTCH_COVERED_SHARE: f64 = 0.95;
const G_MM: f64 = 3.0;

/// G lies so far below the crotch by default, mm.
const G_BELOW_CROTCH_MM: f64 = 50.0;

/// At most this share of the levels that are not weak in the truth carries a doubt.
const DOUBTED_SHARE: f64 = 0.02;

/// A girth or a height without a doubt is quietly wrong if it is off by this, mm, and by three standard errors more. None
/// may be.
const QUIET_MM: [f64; 2] = [2.0, 5.0];

/// At least this share of the landmarks lies within two standard errors of the truth.
const COVERED_SHARE: f64 = 0.93;

/// The median standard error is at most this many times the median error.
const SD_PER_ERROR: f64 = 3.0;

/// What figures claim of themselves: errors and standard errors, mm.
#[derive(Default)]
struct Claims(Vec<(f64, f64)>);

impl Claims {
    /// The share that lies within two standard errors.
    fn covered(&self) -> f64 {
        let covered = self.0.iter().filter(|(error, sd)| error.abs() <= 2.0 * sd).count();
        covered as f64 / self.0.len() as f64
    }

    /// The median standard error over the median error.
    fn sd_per_error(&self) -> f64 {
        let (errors, sds): (Vec<f64>, Vec<f64>) =
            self.0.iter().map(|(error, sd)| (error.abs(), *sd)).unzip();
        quantiles(&sds)[0] / quantiles(&errors)[0]
    }
}

/// The errors of all scans.
#[derive(Default)]
pub struct Limits {
    refused: usize,
    legs_refused: usize,
    swapped: usize,
    missed: usize,
    invented: usize,
    /// Absolute errors at B, C and D over what is allowed.
    girth: Vec<f64>,
    height: Vec<f64>,
    /// Absolute errors of the girth curves over what is allowed, and of the girths at B1.
    curve: Vec<f64>,
    b1: Vec<f64>,
    /// How far the curves must be raised to fit best, mm.
    offset_mm: Vec<f64>,
    slope_share: Vec<f64>,
    facing_deg: Vec<f64>,
    /// Girths and heights of B, C and D, and of B1.
    claims: [Claims; 2],
    claims_of_b1: [Claims; 2],
    /// Signed errors, without a limit.
    height_mm: Vec<f64>,
    tilt_deg: Vec<f64>,
    /// Errors and standard errors of the height of the crotch, mm.
    crotch: Claims,
    g_mm: Vec<f64>,
    /// Girths and heights at B, C and D that are quietly wrong.
    quiet: [usize; 2],
    /// Levels that are not weak in the truth, and how many of them carry a doubt.
    firm: usize,
    doubted: usize,
}

impl Limits {
    /// Takes in a scan that was refused.
    pub fn refused(&mut self) {
        self.refused += 1;
    }

    /// Takes in a scan that was measured.
    pub fn measured(&mut self, case: &Case, extraction: &Extraction) {
        let noise_mm = case.truth["defects"]["noise"].as_f64().unwrap_or(0.0);
        let allowed_mm = GIRTH_MM + GIRTH_NOISE_SHARE * noise_mm;
        let facing = case.truth["facing_deg"].as_f64().unwrap_or(f64::NAN);
        let off = (extraction.body.facing_deg - facing + 180.0).rem_euclid(360.0) - 180.0;
        self.facing_deg.push(off.abs());
        let crotch_mm = case.truth["crotch_height_mm"].as_f64().unwrap_or(f64::NAN);
        let crotch = Some(&extraction.crotch).filter(|crotch| crotch.is_seen());
        self.crotch.0.extend(crotch.map(|crotch| (crotch.height_mm - crotch_mm, crotch.sd_mm)));
        for side in Side::BOTH {
            let [own, other] = [side, side.other()].map(|side| &case.truth["legs"][side.word()]);
            let leg = extraction.legs.iter().find(|leg| leg.side == side);
            Level::SOUGHT.into_iter().for_each(|level| self.level(leg, level, own, allowed_mm));
            match leg {
                Some(leg) => self.leg(leg, [own, other], crotch_mm, allowed_mm),
                None => self.legs_refused += 1,
            }
        }
    }

    fn level(&mut self, leg: Option<&LegReport>, level: Level, truth: &Value, allowed_mm: f64) {
        match compared(leg, level, truth) {
            Compared::Errors { girth_mm, height_mm } => {
                let claims =
                    if level == Level::B1 { &mut self.claims_of_b1 } else { &mut self.claims };
                if let Some(landmark) = leg.and_then(|leg| found(leg, level)) {
                    claim(claims, landmark, [girth_mm, height_mm]);
                    let off_mm = [girth_mm, height_mm].map(f64::abs);
                    let sds_mm = [landmark.girth_of_level_sd_mm, landmark.height_sd_mm];
                    let is_sure = level != Level::B1 && landmark.doubts.is_empty();
                    for (at, quiet) in self.quiet.iter_mut().enumerate() {
                        let is_off = off_mm[at] > QUIET_MM[at] + 3.0 * sds_mm[at];
                        *quiet += usize::from(is_sure && is_off);
                    }
                    let is_firm = truth["landmarks"][level.name()]["weak"] != true;
                    self.firm += usize::from(is_firm);
                    self.doubted += usize::from(is_firm && !landmark.doubts.is_empty());
                }
                if level != Level::B1 {
                    let flat_mm = truth["landmarks"][level.name()]["flat_mm"].as_f64();
                    self.girth.push(girth_mm.abs() / allowed_mm);
                    self.height.push(height_mm.abs() / HEIGHT_MM.max(flat_mm.unwrap_or(0.0)));
                    self.height_mm.push(height_mm);
                }
            }
            Compared::Missed => self.missed += 1,
            Compared::Invented => self.invented += 1,
            Compared::Absent | Compared::Undecidable => {}
        }
    }

    fn leg(&mut self, leg: &LegReport, truths: [&Value; 2], crotch_mm: f64, allowed_mm: f64) {
        let [own, other] = truths.map(|truth| Curve::new(leg, truths[0], truth, crotch_mm));
        // Legs that are alike within the noise fit each other's truth as well.
        let [own_square, other_square] =
            [&own, &other].map(|curve| curve.mean_square(curve.shift_mm));
        self.swapped += usize::from(own_square > other_square + allowed_mm * allowed_mm);
        let truth = truths[0];
        let [girths, slopes] = ["tape_mm", "slope"].map(|name| Profile::named(truth, name));
        let share = |height_mm: f64, girth_mm: f64| {
            let allowed_mm = allowed_mm + CURVE_HEIGHT_MM * slopes.at(height_mm)?.abs();
            Some((girth_mm - girths.at(height_mm)?).abs() / allowed_mm)
        };
        self.offset_mm.push(own.shift_mm);
        self.curve.extend(own.measured.iter().filter_map(|(height, girth)| share(*height, *girth)));
        let b1 = found(leg, Level::B1);
        self.b1.extend(b1.and_then(|b1| share(b1.height_mm, b1.girth_tape_mm)));
        let true_g = girths.at(crotch_mm - G_BELOW_CROTCH_MM);
        let g = found(leg, Level::G).zip(true_g);
        self.g_mm.extend(g.map(|(g, true_mm)| (g.girth_tape_mm - true_mm).abs()));
        let slope = b1.and_then(|b1| slopes.at(b1.height_mm));
        let largest = truth["landmarks"]["B1"]["slope"].as_f64();
        self.slope_share.extend(slope.zip(largest).map(|(slope, largest)| slope / largest));
        self.tilt_deg.extend(off_deg(truth, leg));
    }
}

/// Angle between the true axis of the shank and the one found, degrees.
fn off_deg(truth: &Value, leg: &LegReport) -> Option<f64> {
    let direction = truth["shank"]["direction"].as_array()?;
    let [x, y, z] = [0, 1, 2].map(|axis| direction.get(axis).and_then(Value::as_f64));
    Some(leg.axis.foot.normal.angle(&Vector3::new(x?, y?, z?)).to_degrees())
}

fn claim([girth, height]: &mut [Claims; 2], landmark: &Landmark, [girth_mm, height_mm]: [f64; 2]) {
    girth.0.push((girth_mm, landmark.girth_of_level_sd_mm));
    height.0.push((height_mm, landmark.height_sd_mm));
}

/// The greatest or the least that a figure may be.
#[derive(Clone, Copy)]
enum Limit {
    AtMost(f64),
    AtLeast(f64),
}

impl Limit {
    /// The end of a row: the figure, its limit, and whether it is kept; what is no number does not.
    fn row(self, f: &mut fmt::Formatter<'_>, what: &str, figure: f64) -> fmt::Result {
        let (sign, limit, is_kept) = match self {
            Limit::AtMost(most) => ('≤', most, figure <= most),
            Limit::AtLeast(least) => ('≥', least, figure >= least),
        };
        let mark = if is_kept { "ok" } else { "beyond" };
        let figure = (100.0 * figure).round() / 100.0;
        writeln!(f, "| {what} | {figure} | {sign} {limit} | {mark} |")
    }
}

/// Rows of signed errors: the median, the lowest and the highest.
fn signed(f: &mut fmt::Formatter<'_>, what: &str, errors: &[f64]) -> fmt::Result {
    let [median, _, most] = quantiles(errors);
    let least = errors.iter().copied().fold(f64::NAN, f64::min);
    writeln!(f, "| {what}, median (from … to) | {median:+.2} ({least:+.2} to {most:+.2}) | | |")
}

impl Limits {
    fn errors(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [_, girth, worst_girth] = quantiles(&self.girth);
        let [_, height, worst_height] = quantiles(&self.height);
        let [curve, b1, g] = [&self.curve, &self.b1, &self.g_mm].map(|all| quantiles(all)[1]);
        let offsets: Vec<f64> = self.offset_mm.iter().map(|offset| offset.abs()).collect();
        let mean = self.offset_mm.iter().sum::<f64>() / self.offset_mm.len() as f64;
        let crotches: Vec<f64> = self.crotch.0.iter().map(|(error, _)| error.abs()).collect();
        let slope = self.slope_share.iter().copied().fold(f64::NAN, f64::min);
        let facing = quantiles(&self.facing_deg)[2];
        Limit::AtMost(1.0).row(f, "girth at B, C, D: error / allowed, 95th percentile", girth)?;
        Limit::AtMost(GIRTH_WORST).row(f, "… worst", worst_girth)?;
        Limit::AtMost(1.0).row(f, "girth curve: error / allowed, 95th percentile", curve)?;
        Limit::AtMost(1.0).row(f, "girth at B1: error / allowed, 95th percentile", b1)?;
        let offset = quantiles(&offsets)[1];
        Limit::AtMost(OFFSET_MEAN_MM).row(f, "offset of the curve in mm, mean", mean.abs())?;
        Limit::AtMost(OFFSET_MM).row(f, "… 95th percentile", offset)?;
        Limit::AtMost(1.0).row(f, "height of B, C, D: error / allowed, 95th percentile", height)?;
        Limit::AtMost(HEIGHT_WORST).row(f, "… worst", worst_height)?;
        Limit::AtLeast(SLOPE_SHARE).row(f, "true slope at B1 / largest, least", slope)?;
        Limit::AtMost(FACING_DEG).row(f, "facing, worst error in degrees", facing)?;
        let crotch = quantiles(&crotches)[1];
        Limit::AtMost(CROTCH_MM).row(f, "height of the crotch in mm, 95th percentile", crotch)?;
        let covered = self.crotch.covered();
        Limit::AtLeast(CROTCH_COVERED_SHARE).row(
            f,
            "… share within two standard errors",
            covered,
        )?;
        Limit::AtMost(G_MM).row(f, "girth at G in mm, 95th percentile", g)?;
        let doubted = self.doubted as f64 / self.firm as f64;
        Limit::AtMost(DOUBTED_SHARE).row(f, "share of firm levels with a doubt", doubted)
    }

    fn counts(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts = [
            ("girths at B, C, D quietly wrong", self.quiet[0]),
            ("heights of B, C, D quietly wrong", self.quiet[1]),
            ("sides swapped", self.swapped),
            ("scans refused", self.refused),
            ("legs refused", self.legs_refused),
            ("landmarks missed", self.missed),
            ("landmarks invented", self.invented),
        ];
        counts.into_iter().try_for_each(|(what, n)| Limit::AtMost(0.0).row(f, what, n as f64))
    }

    fn claims(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [girth, height] = &self.claims;
        let [b1_girth, b1_height] = &self.claims_of_b1;
        let all = [
            ("girth at B, C, D", girth),
            ("height of B, C, D", height),
            ("girth at B1", b1_girth),
            ("height of B1", b1_height),
        ];
        for (what, claims) in all {
            let within = format!("{what}: share within two standard errors");
            Limit::AtLeast(COVERED_SHARE).row(f, &within, claims.covered())?;
            let ratio = "… median standard error / median error";
            Limit::AtMost(SD_PER_ERROR).row(f, ratio, claims.sd_per_error())?;
        }
        Ok(())
    }
}

/// The table of the limits.
impl fmt::Display for Limits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "| what | figure | limit | |\n|---|---|---|---|")?;
        self.errors(f)?;
        self.counts(f)?;
        self.claims(f)?;
        signed(f, "height of B, C, D, error in mm", &self.height_mm)?;
        let crotch: Vec<f64> = self.crotch.0.iter().map(|(error, _)| *error).collect();
        signed(f, "height of the crotch, error in mm", &crotch)?;
        signed(f, "tilt, error in degrees", &self.tilt_deg)
    }
}

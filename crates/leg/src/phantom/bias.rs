//! How measured girths differ from the known ones.

use crate::statistics::range;

/// Known girths must differ by this much to distinguish scale from offset, mm …
const SPREAD_MIN_MM: f64 = 50.0;

/// … and the girth may change by this much per mm of height at most. On a cone they cannot be distinguished:
/// a wrong scale is in the heights, too, and makes all its girths differ by the same.
const SLOPE_MAX: f64 = 0.05;

/// A girth of the phantom as it was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GirthCheck {
    /// Height above the phantom's lower end, along its axis, mm.
    pub height_mm: f64,
    /// The known girth, mm.
    pub known_mm: f64,
    /// The girth that was measured, mm.
    pub measured_mm: f64,
    /// Its standard error, mm.
    pub sd_mm: f64,
    /// How much the measured girth changes with height there, mm per mm.
    pub slope: f64,
}

impl GirthCheck {
    /// Measured minus known, mm.
    pub fn difference_mm(&self) -> f64 {
        self.measured_mm - self.known_mm
    }
}

/// The result of a check with a phantom.
#[derive(Debug, Clone, PartialEq)]
pub struct PhantomCheck {
    /// The girths, lowest first; at least one.
    pub girths: Vec<GirthCheck>,
    /// Angle between the phantom's axis and the vertical, degrees.
    pub tilt_deg: f64,
}

/// The difference as a straight line over the known girth, of a body of several cylinders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BiasLine {
    /// What every girth is too large by, mm; two layers of skin stand apart by this over π.
    pub offset_mm: f64,
    /// Its standard error, mm.
    pub offset_sd_mm: f64,
    /// By what share lengths are too large.
    pub scale: f64,
    /// Its standard error.
    pub scale_sd: f64,
}

impl PhantomCheck {
    /// The mean difference, mm.
    pub fn bias_mm(&self) -> f64 {
        mean(self.girths.iter().map(GirthCheck::difference_mm))
    }

    /// The difference that is farthest from zero, mm.
    pub fn worst_mm(&self) -> f64 {
        let differences = self.girths.iter().map(GirthCheck::difference_mm);
        differences.fold(0.0, |worst: f64, mm| if mm.abs() > worst.abs() { mm } else { worst })
    }

    /// Whether every girth is within a tolerance.
    pub fn is_within(&self, tolerance_mm: f64) -> bool {
        self.worst_mm().abs() <= tolerance_mm
    }

    /// Offset and scale, by least squares; `None` if the known girths are too much alike, or not those of
    /// cylinders.
    pub fn line(&self) -> Option<BiasLine> {
        let known = || self.girths.iter().map(|girth| girth.known_mm);
        let [least, most] = range(known());
        let is_conical = self.girths.iter().any(|girth| girth.slope.abs() > SLOPE_MAX);
        if most - least < SPREAD_MIN_MM || is_conical {
            return None;
        }
        let (middle, bias) = (mean(known()), self.bias_mm());
        let spread: f64 = known().map(|mm| (mm - middle).powi(2)).sum();
        let moments =
            self.girths.iter().map(|girth| (girth.known_mm - middle) * girth.difference_mm());
        let scale = moments.sum::<f64>() / spread;
        let variance = mean(self.girths.iter().map(|girth| girth.sd_mm.powi(2)));
        let count = self.girths.len() as f64;
        Some(BiasLine {
            offset_mm: bias - scale * middle,
            offset_sd_mm: (variance * (1.0 / count + middle * middle / spread)).sqrt(),
            scale,
            scale_sd: (variance / spread).sqrt(),
        })
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
    sum / count
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(measured: impl Fn(f64) -> f64, known: &[f64]) -> PhantomCheck {
        let girth = |known_mm: &f64| {
            let measured_mm = measured(*known_mm);
            let (height_mm, sd_mm, slope) = (100.0, 0.2, 0.0);
            GirthCheck { height_mm, known_mm: *known_mm, measured_mm, sd_mm, slope }
        };
        PhantomCheck { girths: known.iter().map(girth).collect(), tilt_deg: 0.0 }
    }

    #[test]
    fn scale_and_offset_are_told_apart() {
        let line = check(|known| 0.97 * known + 6.0, &[200.0, 350.0, 500.0]).line().unwrap();
        assert!(
            (line.scale + 0.03).abs() < 1e-12 && (line.offset_mm - 6.0).abs() < 1e-9,
            "{line:?}"
        );
        // σ / √Σ(x − x̄)², and σ √(1/n + x̄² / Σ(x − x̄)²).
        assert!((line.scale_sd - 0.2 / 45_000_f64.sqrt()).abs() < 1e-12);
        let offset_sd_mm = 0.2 * (1.0 / 3.0 + 350_f64.powi(2) / 45_000.0).sqrt();
        assert!((line.offset_sd_mm - offset_sd_mm).abs() < 1e-12);
    }

    #[test]
    fn a_cone_does_not_tell_them_apart() {
        let mut cone = check(|known| 0.97 * known, &[200.0, 350.0, 500.0]);
        cone.girths[1].slope = -0.6;
        assert_eq!(cone.line(), None);
    }

    #[test]
    fn a_cylinder_tells_the_bias_only() {
        let check = check(|known| known - 1.5, &[350.0; 5]);
        assert_eq!(check.line(), None);
        assert!((check.bias_mm() + 1.5).abs() < 1e-12 && (check.worst_mm() + 1.5).abs() < 1e-12);
        assert!(check.is_within(1.5 + 1e-9) && !check.is_within(1.4));
    }
}

//! Fixed places along a leg.

use gaiter_leg::levels::at_height::PROFILE_STEP_MM;

/// The number of a fixed place: its length along the leg's axis from the floor in steps of 4 cm.
pub type Step = u32;

/// The length along the axis of a place, mm.
pub fn along_mm(step: Step) -> f64 {
    PROFILE_STEP_MM * f64::from(step)
}

//! Whether a refused scan can be measured with another axis up: only for the message, because the operator
//! must decide which way is up.

use gaiter_leg::method::Up;
use gaiter_leg::{BodyFault, Method, Refusal, extract};
use gaiter_scan::Format;

/// The axis with which the scan can be measured, if the declared one may be what is wrong.
pub fn other_up(bytes: &[u8], format: Format, method: &Method, refusal: &Refusal) -> Option<Up> {
    let Refusal::Body(fault) = refusal else { return None };
    if !may_be_lying(fault) {
        return None;
    }
    let others = [Up::Y, Up::Z, Up::X].into_iter().filter(|up| *up != method.up);
    let measures = |up: &Up| extract(bytes, format, &Method { up: *up, ..method.clone() }).is_ok();
    others.into_iter().find(measures)
}

/// Whether a body that lies on its side, by the declared axis, can lead to this fault.
fn may_be_lying(fault: &BodyFault) -> bool {
    match fault {
        BodyFault::NoPlausibleUnit { .. }
        | BodyFault::UnitImplausible { .. }
        | BodyFault::NotTwoLegs { .. }
        | BodyFault::FacingUnclear(_)
        | BodyFault::FacingContradicted { .. }
        | BodyFault::SideUnclear { .. }
        | BodyFault::NoPlausibleLeg { .. }
        | BodyFault::TwoLegs => true,
        BodyFault::OnlyFragments
        | BodyFault::FacingVertical
        | BodyFault::WoundInward
        | BodyFault::WoundOutward
        | BodyFault::Layers { .. } => false,
    }
}

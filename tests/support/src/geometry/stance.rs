//! A standing body that stands otherwise: the legs apart, the knees bent a little.

use super::mesh::Mesh;

/// How a body stands, compared with how it was made.
#[derive(Debug, Clone, Copy, Default)]
pub struct Stance {
    /// By how much each leg is moved outwards about its hip, degrees. The foot stays flat.
    pub apart_deg: f64,
    /// By how much each knee is bent, degrees; the ankle stays below the hip.
    pub bent_deg: f64,
}

/// The joints of a leg of a body with y up, the toes along z, as shares of the crotch's height.
const ANKLE_SHARE: f64 = 0.10;
const KNEE_SHARE: f64 = 0.58;
const HIP_SHARE: f64 = 1.10;

/// Half the length over which a joint bends, as the same share.
const BEND_SHARE: f64 = 0.06;

/// Horizontal distance of the joints from the body's middle, as the same share.
const ASIDE_SHARE: f64 = 0.12;

impl Stance {
    /// The body in this stance.
    pub fn of(self, body: Mesh, crotch_mm: f64) -> Mesh {
        let joints = Joints { crotch_mm };
        body.moved(|[x, y, z]| {
            let side = if x < 0.0 { -1.0 } else { 1.0 };
            let aside = side * ASIDE_SHARE * crotch_mm;
            let [mut u, mut v, mut w] = [x - aside, y, z];
            // From the foot up, so that each joint carries what is below it.
            let knee = self.bent_deg.to_radians();
            let hip = knee * (KNEE_SHARE - ANKLE_SHARE) / (HIP_SHARE - ANKLE_SHARE);
            let turns = [(ANKLE_SHARE, hip - knee), (KNEE_SHARE, knee), (HIP_SHARE, -hip)];
            for (share, angle) in turns {
                let part = angle * joints.below(share, y);
                (v, w) = joints.turned(share, [v, w], part);
            }
            let apart = side * self.apart_deg.to_radians();
            for (share, angle) in [(ANKLE_SHARE, -apart), (HIP_SHARE, apart)] {
                let part = angle * joints.below(share, y);
                (v, u) = joints.turned(share, [v, u], part);
            }
            [u + aside, v, w]
        })
    }
}

struct Joints {
    crotch_mm: f64,
}

impl Joints {
    /// Which part of a joint's turn a place at a height takes part in: all below it, none above.
    fn below(&self, share: f64, y: f64) -> f64 {
        let t = (share + BEND_SHARE - y / self.crotch_mm) / (2.0 * BEND_SHARE);
        let t = t.clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }

    /// Height and the coordinate across, turned about a joint: a positive angle moves what is below it
    /// along the positive direction.
    fn turned(&self, share: f64, [v, across]: [f64; 2], angle: f64) -> (f64, f64) {
        let (sin, cos) = angle.sin_cos();
        let v = v - share * self.crotch_mm;
        (share * self.crotch_mm + v * cos + across * sin, across * cos - v * sin)
    }
}

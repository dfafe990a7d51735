//! A standing body that stands otherwise: the legs apart, the knees bent, a foot ahead, the heels up.

use super::mesh::Mesh;

/// How a body stands, compared with how it was made.
#[derive(Debug, Clone, Copy, Default)]
pub struct Stance {
    /// By how much each leg is moved outwards about its hip, degrees. The foot stays flat.
    pub apart_deg: f64,
    /// By how much each knee is bent, degrees; the ankle stays below the hip.
    pub bent_deg: f64,
}

/// How the joints of one leg are turned, compared with how it was made, degrees.
#[derive(Debug, Clone, Copy, Default)]
pub struct LegPose {
    /// The thigh forwards.
    pub hip_deg: f64,
    /// The shank backwards from the thigh.
    pub knee_deg: f64,
    /// The heel up, the toes down, from a foot that is flat on the floor.
    pub heel_deg: f64,
}

impl LegPose {
    /// A knee that is bent; the ankle stays below the hip.
    pub fn bent(knee_deg: f64) -> LegPose {
        let hip_deg = knee_deg * (KNEE_SHARE - ANKLE_SHARE) / (HIP_SHARE - ANKLE_SHARE);
        LegPose { hip_deg, knee_deg, heel_deg: 0.0 }
    }
}

/// Heights of the joints of a leg, of a body with y up and the toes along z, as shares of the crotch's height.
const ANKLE_SHARE: f64 = 0.10;
const KNEE_SHARE: f64 = 0.58;
const HIP_SHARE: f64 = 1.10;

/// Height at which the middle of the leg is taken for the hip joint: above the crotch a section is of both legs.
const UPPER_SHARE: f64 = 0.95;

/// Half the length over which a joint bends, as the same share.
const BEND_SHARE: f64 = 0.06;

impl Stance {
    /// The body in this stance.
    pub fn of(self, body: Mesh, crotch_mm: f64) -> Mesh {
        let legs = [-1.0, 1.0].map(|side| Joints::new(&body, crotch_mm, side));
        let knee = self.bent_deg.to_radians();
        let hip = knee * (KNEE_SHARE - ANKLE_SHARE) / (HIP_SHARE - ANKLE_SHARE);
        body.moved(|at| {
            let side = if at[0] < 0.0 { -1.0 } else { 1.0 };
            let leg = if at[0] < 0.0 { &legs[0] } else { &legs[1] };
            let apart = side * self.apart_deg.to_radians();
            // From the foot up, so that each joint carries what is below it.
            let turns = [
                (leg.ankle, 2, hip - knee),
                (leg.knee, 2, knee),
                (leg.hip, 2, -hip),
                (leg.ankle, 0, -apart),
                (leg.hip, 0, apart),
            ];
            let mut moved = at;
            for (joint, across, angle) in turns {
                moved = turned(moved, joint, across, angle * leg.below(joint[1], at[1]));
            }
            moved
        })
    }
}

/// The body with the joints of its right and of its left leg turned.
pub fn posed(body: Mesh, crotch_mm: f64, poses: [LegPose; 2]) -> Mesh {
    let legs = [-1.0, 1.0].map(|side| Joints::new(&body, crotch_mm, side));
    body.moved(|at| {
        let own = usize::from(at[0] >= 0.0);
        let (leg, by) = (&legs[own], poses[own]);
        let ankle_deg = by.knee_deg - by.hip_deg - by.heel_deg;
        let turns = [(leg.ankle, ankle_deg), (leg.knee, -by.knee_deg), (leg.hip, by.hip_deg)];
        // From the foot up, so that each joint carries what is below it.
        turns.into_iter().fold(at, |moved, (joint, degrees)| {
            turned(moved, joint, 2, degrees.to_radians() * leg.below(joint[1], at[1]))
        })
    })
}

/// The middles of the joints of a leg.
struct Joints {
    crotch_mm: f64,
    ankle: [f64; 3],
    knee: [f64; 3],
    hip: [f64; 3],
}

impl Joints {
    fn new(body: &Mesh, crotch_mm: f64, side: f64) -> Joints {
        let middle = |share: f64| {
            let near = |p: &&[f64; 3]| {
                side * p[0] > 0.0 && (p[1] / crotch_mm - share).abs() < BEND_SHARE / 3.0
            };
            let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
            for point in body.points.iter().filter(near) {
                for (index, value) in [point[0], point[2]].into_iter().enumerate() {
                    low[index] = low[index].min(value);
                    high[index] = high[index].max(value);
                }
            }
            [0, 1].map(|index| (low[index] + high[index]) / 2.0)
        };
        let joint = |share: f64, [x, z]: [f64; 2]| [x, share * crotch_mm, z];
        Joints {
            crotch_mm,
            ankle: joint(ANKLE_SHARE, middle(ANKLE_SHARE)),
            knee: joint(KNEE_SHARE, middle(KNEE_SHARE)),
            hip: joint(HIP_SHARE, middle(UPPER_SHARE)),
        }
    }

    /// Which part of a joint's turn a place at a height takes part in: all below it, none above.
    fn below(&self, joint_mm: f64, y_mm: f64) -> f64 {
        let t = (joint_mm - y_mm) / (2.0 * BEND_SHARE * self.crotch_mm) + 0.5;
        let t = t.clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }
}

/// A point turned about a joint in the plane of the height and one coordinate across it: a positive angle moves
/// what is below the joint along the positive direction.
fn turned(mut at: [f64; 3], joint: [f64; 3], across: usize, angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    let (up, aside) = (at[1] - joint[1], at[across] - joint[across]);
    at[1] = joint[1] + up * cos + aside * sin;
    at[across] = joint[across] + aside * cos - up * sin;
    at
}

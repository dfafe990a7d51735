//! Where something lies around a leg, in words, because degrees are a language of machines.

/// Within this many degrees of the front, the back or a side, a place is there and not between two of them.
const STRAIGHT_DEG: f64 = 15.0;

word_enum! {
    /// One of eight parts of the way around a leg, from the front by the outer side. Inner is medial, outer lateral.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Around {
        /// On the shin.
        Front => "front",
        /// Between front and outer side.
        FrontOuter => "front-outer",
        /// On the lateral side.
        Outer => "outer",
        /// Between back and outer side.
        BackOuter => "back-outer",
        /// Behind.
        Back => "back",
        /// Between back and inner side.
        BackInner => "back-inner",
        /// On the medial side.
        Inner => "inner",
        /// Between front and inner side.
        FrontInner => "front-inner",
    }
}

impl Around {
    /// The part in which an angle lies, degrees: 0 front, 90 lateral.
    pub fn at(angle_deg: f64) -> Around {
        let turned_deg = angle_deg.rem_euclid(360.0);
        // The quarter that begins next to this angle, and the way from there.
        let quarter = (turned_deg / 90.0).round();
        let off_deg = turned_deg - quarter * 90.0;
        let eighth = 2 * quarter as usize;
        let parts = Around::ALL.len();
        let index = if off_deg.abs() <= STRAIGHT_DEG {
            eighth
        } else if off_deg > 0.0 {
            eighth + 1
        } else {
            eighth + parts - 1
        };
        Around::ALL[index % parts]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_angle_lies_in_one_part_and_the_inner_side_is_at_negative_angles() {
        for (angle_deg, part) in [
            (0.0, Around::Front),
            (15.0, Around::Front),
            (-16.0, Around::FrontInner),
            (45.0, Around::FrontOuter),
            (90.0, Around::Outer),
            (106.0, Around::BackOuter),
            (180.0, Around::Back),
            (-180.0, Around::Back),
            (-160.0, Around::BackInner),
            (-90.0, Around::Inner),
            (-75.0, Around::Inner),
            (359.0, Around::Front),
        ] {
            assert_eq!(Around::at(angle_deg), part, "{angle_deg}");
        }
    }
}

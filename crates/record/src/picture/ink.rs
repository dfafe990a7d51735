//! The inks of pictures. An ink has a meaning; its colour depends on the theme.

use gaiter_leg::Side;

/// Red, green, blue.
pub type Colour = [u8; 3];

/// The meaning of a line or area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ink {
    /// The background.
    Paper,
    /// Text and important lines.
    Text,
    /// Explanatory text.
    Muted,
    /// Grid lines.
    Grid,
    /// Skin.
    Skin,
    /// The patient's left leg.
    Left,
    /// The patient's right leg.
    Right,
    /// The scan's own points.
    Scan,
    /// A distance from the surface, as a share of the scale: −1 inside, 1 outside.
    Off(f64),
    /// What the scanner did not see.
    Unseen,
}

/// Whether pictures are dark on light or light on dark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Theme {
    /// For paper, and for screens by day.
    Light,
    /// For screens in a dark room.
    Dark,
}

/// Colours of distances from −1 to 1: purple, pale, orange (ColorBrewer PuOr, which colour-blind people
/// can read too, and whose ends differ in grey).
const OFF: [Colour; 9] = [
    [84, 39, 136],
    [128, 115, 172],
    [178, 171, 210],
    [216, 218, 235],
    [247, 247, 247],
    [254, 224, 182],
    [253, 184, 99],
    [224, 130, 20],
    [179, 88, 6],
];

impl Ink {
    /// The ink for a leg.
    pub fn for_side(side: Side) -> Ink {
        match side {
            Side::Left => Ink::Left,
            Side::Right => Ink::Right,
        }
    }

    /// Its colour in a theme.
    pub fn colour(self, theme: Theme) -> Colour {
        let [light, dark] = match self {
            Ink::Paper => [[255, 255, 255], [21, 25, 31]],
            Ink::Text => [[27, 34, 48], [232, 236, 242]],
            Ink::Muted => [[92, 101, 117], [160, 170, 186]],
            Ink::Grid => [[221, 225, 233], [52, 60, 73]],
            Ink::Skin => [[240, 242, 247], [38, 45, 56]],
            Ink::Left => [[0, 115, 97], [63, 196, 168]],
            Ink::Right => [[180, 66, 31], [240, 138, 93]],
            Ink::Scan => [[132, 112, 196], [168, 150, 230]],
            Ink::Unseen => [[150, 156, 168], [96, 104, 118]],
            // The scale must have the same meaning in both themes.
            Ink::Off(share) => [off(share); 2],
        };
        match theme {
            Theme::Light => light,
            Theme::Dark => dark,
        }
    }

    /// The name of its colour in a page's style sheet. `None` for inks with the same colour in both
    /// themes.
    pub fn name(self) -> Option<&'static str> {
        Ink::NAMED.into_iter().find(|(ink, _)| *ink == self).map(|(_, name)| name)
    }

    /// The inks with names.
    pub const NAMED: [(Ink, &str); 9] = [
        (Ink::Paper, "paper"),
        (Ink::Text, "text"),
        (Ink::Muted, "muted"),
        (Ink::Grid, "grid"),
        (Ink::Skin, "skin"),
        (Ink::Left, "left"),
        (Ink::Right, "right"),
        (Ink::Scan, "scan"),
        (Ink::Unseen, "unseen"),
    ];
}

/// The colour of a distance, interpolated between those of the scale.
fn off(share: f64) -> Colour {
    let last = OFF.len() - 1;
    let place = (share.clamp(-1.0, 1.0) + 1.0) / 2.0 * last as f64;
    let below = (place as usize).min(last - 1);
    let part = place - below as f64;
    let mixed = |channel: usize| {
        let [low, high] = [below, below + 1].map(|at| f64::from(OFF[at][channel]));
        (low + part * (high - low)).round() as u8
    };
    std::array::from_fn(mixed)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contrast ratio of WCAG 2.2, from the relative luminances.
    fn contrast(a: Colour, b: Colour) -> f64 {
        let luminance = |colour: Colour| {
            let linear = colour.map(|channel| {
                let c = f64::from(channel) / 255.0;
                if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
            });
            0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
        };
        let [a, b] = [luminance(a), luminance(b)];
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn words_can_be_read_on_paper_and_on_skin_in_both_themes() {
        for theme in [Theme::Light, Theme::Dark] {
            for ground in [Ink::Paper, Ink::Skin] {
                for ink in [Ink::Text, Ink::Muted, Ink::Left, Ink::Right] {
                    let ratio = contrast(ink.colour(theme), ground.colour(theme));
                    // WCAG 2.2, 1.4.3: 4.5 for text.
                    assert!(ratio >= 4.5, "{ink:?} on {ground:?}, {theme:?}: {ratio:.2}");
                }
                let scan = contrast(Ink::Scan.colour(theme), ground.colour(theme));
                // 1.4.11: 3 for graphics.
                assert!(scan >= 3.0, "{theme:?}: {scan:.2}");
            }
        }
    }

    #[test]
    fn the_scale_of_distances_is_symmetric_in_place_and_palest_at_none() {
        assert_eq!(off(0.0), OFF[4]);
        assert_eq!((off(-1.0), off(1.0), off(-7.0)), (OFF[0], OFF[8], OFF[0]));
        assert_eq!(off(0.125), [251, 236, 215]);
    }
}

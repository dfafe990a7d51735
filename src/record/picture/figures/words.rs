//! The texts of the figures in each language.

use crate::leg::Side;
use crate::record::Language;

/// The texts of the figures.
pub(super) struct Words {
    pub left: &'static str,
    pub right: &'static str,
    pub front: &'static str,
    pub back: &'static str,
    pub medial: &'static str,
    pub lateral: &'static str,
    pub outer_side: &'static str,
    pub views: &'static str,
    pub girths: &'static str,
    pub girth_cm: &'static str,
    pub height_cm: &'static str,
    pub slope: &'static str,
    pub peak: &'static str,
    pub valley: &'static str,
    pub steepest: &'static str,
    pub proportion: &'static str,
    pub sections: &'static str,
    pub curvature: &'static str,
    pub from_feet: &'static str,
    pub absent: &'static str,
    pub fit: &'static str,
    pub radius_mm: &'static str,
    pub points: &'static str,
    pub fitted: &'static str,
    pub error: &'static str,
    pub outside_mm: &'static str,
    pub unseen: &'static str,
    pub no_surface: &'static str,
}

const EN: Words = Words {
    left: "left leg",
    right: "right leg",
    front: "front",
    back: "back",
    medial: "inner",
    lateral: "outer",
    outer_side: "outer side",
    views: "Both legs with their sections, levels and feature points",
    girths: "Girth over height, and how fast it grows",
    girth_cm: "tape girth, cm",
    height_cm: "height, cm",
    slope: "growth, cm per cm",
    peak: "peak",
    valley: "valley",
    steepest: "steepest",
    proportion: "by proportion",
    sections: "Sections at the levels, their curvature and feature points",
    curvature: "curvature, 1/m",
    from_feet: "seen from the feet, front up",
    absent: "not found",
    fit: "The scan's own points and the fitted curve, as radius around the section",
    radius_mm: "radius, mm",
    points: "points of the scan",
    fitted: "fitted curve",
    error: "How far the scan lies off the surface, unrolled",
    outside_mm: "mm outside the surface",
    unseen: "not seen",
    no_surface: "no surface",
};

const DE: Words = Words {
    left: "linkes Bein",
    right: "rechtes Bein",
    front: "vorn",
    back: "hinten",
    medial: "innen",
    lateral: "außen",
    outer_side: "Außenseite",
    views: "Beide Beine mit ihren Schnitten, Messpunkten und Merkmalspunkten",
    girths: "Umfang über der Höhe, und wie schnell er zunimmt",
    girth_cm: "Bandumfang, cm",
    height_cm: "Höhe, cm",
    slope: "Zunahme, cm je cm",
    peak: "Maximum",
    valley: "Minimum",
    steepest: "steilste Stelle",
    proportion: "nach Proportion",
    sections: "Schnitte an den Messpunkten, ihre Krümmung und Merkmalspunkte",
    curvature: "Krümmung, 1/m",
    from_feet: "von den Füßen gesehen, vorn oben",
    absent: "nicht gefunden",
    fit: "Die Punkte des Scans und die angepasste Kurve, als Radius um den Schnitt",
    radius_mm: "Radius, mm",
    points: "Punkte des Scans",
    fitted: "angepasste Kurve",
    error: "Wie weit der Scan neben der Oberfläche liegt, abgerollt",
    outside_mm: "mm außerhalb der Oberfläche",
    unseen: "nicht gesehen",
    no_surface: "keine Oberfläche",
};

impl Words {
    pub(super) fn of(language: Language) -> &'static Words {
        match language {
            Language::En => &EN,
            Language::De => &DE,
        }
    }

    pub(super) fn side(&self, side: Side) -> &'static str {
        match side {
            Side::Left => self.left,
            Side::Right => self.right,
        }
    }
}

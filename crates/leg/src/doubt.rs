//! Reasons not to trust a landmark blindly.

coded_enum! {
    /// A reason not to trust a landmark blindly.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub enum Doubt {
        /// The extremum is hardly prominent.
        Shallow {
            /// Its prominence, mm.
            prominence_mm: f64,
        } => "shallow",
        /// The height of the extremum is poorly determined.
        Flat {
            /// Standard error of the height, mm.
            height_sd_mm: f64,
        } => "flat",
        /// The girth is poorly determined: at its height, or because that is uncertain where the girth changes fast.
        GirthUncertain {
            /// Standard error of the girth, mm.
            girth_sd_mm: f64,
        } => "girth-uncertain",
        /// Another extremum of the same kind is equal to this one within the noise.
        Double {
            /// Height of the other extremum's centre above the floor, mm.
            other_height_mm: f64,
        } => "double",
        /// Another clear extremum of the same kind lies where people have the level too.
        Several {
            /// Height of the other extremum's centre above the floor, mm.
            other_height_mm: f64,
        } => "several",
        /// People do not have the level there.
        UnusualHeight {
            /// Its distance from the floor, percent of the stature.
            percent: f64,
        } => "unusual-height",
        /// The extremum lies at an end of the searched range.
        Edge {
            /// Distance to the end along the axis, mm.
            end_mm: f64,
        } => "edge",
        /// The skin at the level has a gap.
        Gap {
            /// Width of the gap as seen from the section's centre, degrees.
            gap_deg: f64,
        } => "gap",
        /// The points at the level do not form a single skin.
        Scatter {
            /// Root mean square distance of the points from the section, mm.
            rms_mm: f64,
        } => "scatter",
        /// Cloth covers the level, or ends beside it.
        Cloth {
            /// How thick it is, mm.
            step_mm: f64,
            /// Height of its lower edge above the floor, or of its upper one if that alone was seen, mm.
            height_mm: f64,
        } => "cloth",
        /// The views of the scanner's cameras do not meet, so that all girths are off alike.
        ViewsApart {
            /// How far they are apart, mm.
            step_mm: f64,
            /// How far a girth may be off by it: two standard errors, mm.
            girth_off_mm: f64,
        } => "views-apart",
        /// The scanner's software smoothed the mesh, which makes all girths too small.
        Smoothed {
            /// How far a girth may be off by it: two standard errors, mm.
            girth_off_mm: f64,
        } => "smoothed",
        /// The skin at the level is longer than a tape around it.
        Folds {
            /// Excess of the contour over the tape girth, percent.
            percent: f64,
        } => "folds",
        /// The sections at the level could not be measured; the curve bridges them.
        NotSeen => "not-seen",
        /// The planes above the calf turn by more than a straight leg's.
        KneeBent {
            /// Angle between the axes of shank and thigh, degrees.
            bend_deg: f64,
        } => "knee-bent",
        /// The knee would lie below D.
        BelowD {
            /// Height of D, mm.
            d_height_mm: f64,
        } => "below-d",
        /// The tape is closed along the floor, which no scanner sees.
        SoleNotSeen => "sole-not-seen",
    }
}

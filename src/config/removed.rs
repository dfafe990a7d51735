//! Keys that earlier versions had, each with what to do about it.

/// What to do about a key that was removed; `None` for one that never was.
pub(super) fn instead(path: &str) -> Option<&'static str> {
    REMOVED.iter().find(|(key, _)| *key == path).map(|(_, instead)| *instead)
}

const REMOVED: &[(&str, &str)] = &[
    ("scanner.file_system", "remove it; name a file on the share with scanner.marker"),
    ("scanner.mount_point", "remove it; name a file on the share with scanner.marker"),
    ("method.fit", "remove it; docs/method.md says how methods are compared"),
    ("method.axis", "remove it; with tape = \"leg\" the axis is that of the \"centroids\""),
    ("method.surface", "remove it; the surface is fitted to the \"sections\""),
    ("method.surface_knots", "remove it; the knots are \"adaptive\""),
    ("method.surface_control_points", "remove it; their number is \"auto\""),
];

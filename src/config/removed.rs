//! Keys that earlier versions had, each with what to do about it.

/// What to do about a key that was removed; `None` for one that never was.
pub(super) fn instead(path: &str) -> Option<&'static str> {
    REMOVED.iter().find(|(key, _)| *key == path).map(|(_, instead)| *instead)
}

const REMOVED: &[(&str, &str)] = &[
    ("scanner.file_system", "remove it; name a file on the share with scanner.marker"),
    ("scanner.mount_point", "remove it; name a file on the share with scanner.marker"),
    ("method.b1_above_b", "write the distance as method.b1: \"8cm\"; with \"steepest\" remove it"),
    ("method.fit", "remove it; docs/method.md says how methods are compared"),
    ("method.axis", "remove it; with tape = \"leg\" the axis is that of the \"centroids\""),
    ("method.surface", "remove it; the surface is fitted to the \"sections\""),
    ("method.surface_knots", "remove it; the knots are \"adaptive\""),
    ("method.surface_control_points", "remove it; their number is \"auto\""),
    ("scanner.overdue", "remove it; status.overdue is for files, too"),
    ("trigger.debounce", "remove it; it is always 30 ms"),
    ("trigger.long_press", "remove it; it is always 3 s"),
    ("trigger.stuck", "remove it; it is always 30 s"),
    ("trigger.serial.active", "remove it; if it was \"low\", add -low to contact: \"cts-low\""),
    ("trigger.serial.flow", "remove it; a button needs no flow control"),
    ("trigger.serial.rts", "remove it; the system switches RTS on"),
    ("trigger.serial.say", "name the section [trigger.say]"),
    ("trigger.usb.interface", "remove it; the device describes it"),
    ("trigger.usb.endpoint", "remove it; the device describes it"),
    (
        "trigger.usb.mask",
        "write it behind the value: value = \"00 01/00 0f\"; without it the bits of the value count",
    ),
    ("trigger.usb.say", "name the section [trigger.say]"),
    ("output.mesh_tolerance", "remove it; it is always 0.05 mm"),
    ("report.appendix", "remove it; gaiter report --appendix prints the figures"),
    ("orders.files", "remove it; each record has all three files"),
    ("measure.cpu", "remove it; measure.wall is the limit"),
    (
        "patient.orders.charset",
        "remove it; orders say it, or store.gdt.profile: \"tomedo\" is UTF-8, the others cp1252",
    ),
    ("patient.orders.rescan", "remove it; the folder is looked through every patient.orders.quiet"),
    ("patient.reader.keys", "write it as patient.reader.port; a path must lie in /dev/input"),
    ("patient.reader.prefix", "write it before {id} in patient.reader.code: \"]C1{id}\""),
    ("patient.reader.suffix", "write it after {id} in patient.reader.code: '{id}\\x03'"),
    ("store.copy.mode", "remove it; store.folder.mode is for both folders"),
    ("store.gdt.version", "remove it; store.gdt.profile says it"),
    ("store.gdt.charset", "remove it; store.gdt.profile says it"),
    ("store.gdt.attach_folder", "write it before each file of store.gdt.attach: \"legs/legs.svg\""),
    ("store.gdt.attach_root", "write the path as store.gdt.attach_as"),
    ("store.gdt.attachment_name", "remove it; store.gdt.profile says it"),
    ("store.gdt.attachment_format", "remove it; store.gdt.profile says it"),
    ("store.gdt.attachment_description", "remove it; store.gdt.profile says it"),
    ("store.gdt.attachment_path", "remove it; store.gdt.profile says it"),
    ("store.gdt.time", "remove it; results have the local time"),
    ("log", "remove it; journalctl -o json writes the log for programs"),
];

//! The fixed words on the page, in both languages.

use crate::record::Language;

/// The same text in English and in German.
pub type Both = (&'static str, &'static str);

/// The text in one of the languages.
pub fn say(language: Language, both: Both) -> &'static str {
    language.pick(both.0, both.1)
}

/// The message after a decision was carried out, by its verb.
pub fn done(verb: &str, language: Language) -> Option<&'static str> {
    let both = match verb {
        "retry" => ("The scan is tried again.", "Der Scan wird noch einmal versucht."),
        "release" => ("The scan is released.", "Der Scan ist freigegeben."),
        "assign" => ("The scan is assigned.", "Der Scan ist zugeordnet."),
        "unassign" => (
            "The scan is unassigned again. Results already sent to the practice software must be \
             deleted there.",
            "Der Scan gehört zu niemandem mehr. Was die Praxissoftware erhielt, ist dort zu löschen.",
        ),
        "give_up" => {
            ("The scan no longer needs a decision.", "Der Scan braucht keine Entscheidung mehr.")
        }
        "name_next" => ("The next patient is named.", "Der nächste Patient ist benannt."),
        "call_off" => ("No export is expected any longer.", "Es wird niemand mehr erwartet."),
        "pause" => (
            "Paused: scans stay at the scanner until you resume.",
            "Pause: Scans bleiben beim Scanner, bis Sie fortsetzen.",
        ),
        "resume" => ("The station continues.", "Die Station macht weiter."),
        _ => return None,
    };
    Some(say(language, both))
}

/// The page's labels by their keys, in the order of the keys.
pub const LABELS: [(&str, Both); 67] = [
    ("another", ("Another patient", "Ein anderer Patient")),
    ("assign", ("Assign …", "Zuordnen …")),
    ("assign_hint", ("Whose scan is this?", "Wessen Scan ist das?")),
    (
        "away",
        (
            "No connection to the station. Trying again.",
            "Keine Verbindung zur Station. Neuer Versuch.",
        ),
    ),
    ("away_word", ("No connection", "Keine Verbindung")),
    ("call_off", ("Call off", "Absagen")),
    (
        "call_off_hint",
        (
            "No export is expected then. Only while the scanner is not scanning.",
            "Danach wird niemand mehr erwartet. Nur solange der Scanner nicht scannt.",
        ),
    ),
    ("cancel", ("Cancel", "Abbrechen")),
    ("close", ("Close", "Schließen")),
    ("cm", ("cm", "cm")),
    ("code", ("Code", "Code")),
    ("doubted", ("doubtful", "zweifelhaft")),
    ("drawing", ("Drawing of both legs", "Zeichnung beider Beine")),
    ("files", ("Record", "Messakte")),
    ("findings", ("findings in the report", "Hinweise im Bericht")),
    ("girth", ("Girth", "Umfang")),
    ("give", ("Give to {}", "An {} geben")),
    (
        "give_hint",
        (
            "The scan is then {}'s, and its record goes to nobody else.",
            "Der Scan gehört dann zu {}, und die Messakte geht an niemand anderen.",
        ),
    ),
    ("give_up", ("Give up …", "Aufgeben …")),
    (
        "give_up_hint",
        (
            "You are not asked about the scan again. Its data are kept for the configured time; it \
             can still be tried again.",
            "Nach dem Scan wird nicht mehr gefragt. Seine Daten bleiben so lange wie eingestellt; ein neuer \
             Versuch ist weiter möglich.",
        ),
    ),
    ("height", ("Height", "Höhe")),
    ("in_booth", ("{} is in the booth", "{} ist in der Kabine")),
    ("kiosk", ("Full screen", "Vollbild")),
    ("last", ("Last scan", "Letzter Scan")),
    ("last_scans", ("Last scans", "Letzte Scans")),
    ("left", ("Left", "Links")),
    ("legs.svg", ("Drawing", "Zeichnung")),
    ("level", ("Level", "Messpunkt")),
    ("main", ("Station", "Station")),
    ("more", ("more; gaiter scans lists them all", "weitere; gaiter scans zeigt alle")),
    ("name", ("Name the next patient …", "Nächsten Patienten benennen …")),
    ("name_hint", ("Whose is the next scan?", "Von wem ist der nächste Scan?")),
    ("next", ("Next patient", "Nächster Patient")),
    ("no_measures", ("No measures yet", "Noch keine Maße")),
    ("no_scans", ("No scan yet.", "Noch kein Scan.")),
    (
        "no_script",
        (
            "This page needs JavaScript. gaiter status shows the same.",
            "Diese Seite braucht JavaScript. gaiter status sagt dasselbe.",
        ),
    ),
    ("none_undecided", ("Nothing waits for a decision.", "Nichts wartet auf eine Entscheidung.")),
    ("not_found", ("not found", "nicht gefunden")),
    ("parts", ("Parts of the station", "Teile der Station")),
    ("patient", ("Patient", "Patient")),
    ("patient_id", ("Patient's id", "Patientennummer")),
    ("pause", ("Pause", "Pause")),
    (
        "read_only_network",
        (
            "Read-only: no decisions over the network, because it is not encrypted.",
            "Nur zum Lesen: Über das Netz kann nichts entschieden werden, denn es ist unverschlüsselt.",
        ),
    ),
    (
        "read_only_token",
        (
            "Read-only: gaiter page prints the link for decisions.",
            "Nur zum Lesen: gaiter page zeigt den Link, mit dem Sie entscheiden können.",
        ),
    ),
    ("record.json", ("Data (JSON)", "Daten (JSON)")),
    ("release", ("Release", "Freigeben")),
    (
        "release_hint",
        (
            "The scan goes to the patient for whom it arrived.",
            "Der Scan geht an den Patienten, für den er kam.",
        ),
    ),
    ("release_to", ("Release to {}", "Freigeben für {}")),
    (
        "release_to_hint",
        (
            "The scan came in for {}. Its record goes to this patient and to nobody else.",
            "Der Scan kam für {}. Die Messakte geht an diesen Patienten und an niemand anderen.",
        ),
    ),
    ("replace", ("Replace", "Ersetzen")),
    (
        "replace_hint",
        (
            "{} is named and was not scanned. Replace by {}?",
            "{} ist benannt und wurde nicht gescannt. Durch {} ersetzen?",
        ),
    ),
    ("report.html", ("Report", "Bericht")),
    ("report.pdf", ("Report (PDF)", "Bericht (PDF)")),
    ("resume", ("Resume", "Fortsetzen")),
    ("retry", ("Try again", "Noch einmal versuchen")),
    ("right", ("Right", "Rechts")),
    ("scan", ("Scan", "Scan")),
    ("scan_again", ("Scan again …", "Neu scannen …")),
    (
        "scan_again_hint",
        (
            "{} is named for the next scan. Then press the button; this scan is closed once the \
             new one is good.",
            "{} ist für den nächsten Scan benannt. Dann den Knopf drücken; dieser Scan ist erledigt, wenn der \
             neue gelingt.",
        ),
    ),
    ("scan_again_of", ("Scan {} again", "{} neu scannen")),
    ("send", ("OK", "OK")),
    ("undecided", ("Needs a decision", "Braucht eine Entscheidung")),
    ("unassign", ("Take back …", "Zurücknehmen …")),
    ("unassign_from", ("Take back from {}", "Von {} zurücknehmen")),
    (
        "unassign_from_hint",
        (
            "The record leaves {}'s folder and stays unassigned until you assign it.",
            "Die Messakte verlässt den Ordner von {} und gehört zu niemandem, bis Sie sie zuordnen.",
        ),
    ),
    (
        "unassign_hint",
        (
            "The record leaves the patient's folder and stays unassigned until you assign it.",
            "Die Messakte verlässt den Ordner des Patienten und gehört zu niemandem, bis Sie sie zuordnen.",
        ),
    ),
    ("view", ("3D view", "3D-Ansicht")),
];

/// The label of a key; `None` for an unknown key.
pub fn label(key: &str, language: Language) -> Option<&'static str> {
    LABELS.iter().find(|(known, _)| *known == key).map(|(_, both)| say(language, *both))
}

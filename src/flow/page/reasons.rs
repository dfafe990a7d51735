//! Codes → the situation and what to do, each in one sentence. The README's tables say the same in more
//! detail; an unknown code is shown as it is.

use serde::Serialize;

use super::words::{Both, say};
use crate::flow::capture;
use crate::flow::health::Complaint;
use crate::flow::patient::identity;
use crate::record::Language;

/// The situation, and what the operator can do.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Advice {
    /// A sentence on the situation.
    pub what: String,
    /// A sentence on what to do.
    pub next: String,
}

/// The situation, and what to do.
type Pair = (Both, Both);

impl Advice {
    fn of((what, next): Pair, language: Language) -> Advice {
        Advice { what: say(language, what).to_owned(), next: say(language, next).to_owned() }
    }
}

/// Why a scan is held.
pub fn of_held(code: &str, language: Language) -> Advice {
    const EITHER: Both = (
        "Look at the scan and assign it to the right patient.",
        "Den Scan ansehen und dem richtigen Patienten zuordnen.",
    );
    const IF_SO: Both = (
        "Release it if it is this patient's; otherwise assign it.",
        "Freigeben, wenn er von diesem Patienten ist, sonst zuordnen.",
    );
    let pair = match code {
        identity::PATIENTS_DIFFER => (
            ("Two sources name different patients.", "Zwei Quellen nennen verschiedene Patienten."),
            EITHER,
        ),
        capture::AMBIGUOUS => (
            (
                "It could belong to more than one named or scanned patient.",
                "Er kann von mehr als einem der benannten oder gescannten Patienten sein.",
            ),
            EITHER,
        ),
        capture::UNCLEAR => (
            (
                "It may have been there before the button was pressed or a patient was named.",
                "Er lag vielleicht schon da, bevor der Knopf gedrückt oder jemand benannt wurde.",
            ),
            IF_SO,
        ),
        capture::LATE => (
            (
                "It arrived after the time allowed for the export of the press.",
                "Er kam nach der Zeit, in der der Export zum Knopfdruck erwartet wird.",
            ),
            IF_SO,
        ),
        capture::UNHEARD => (
            (
                "A press of the button may have been missed.",
                "Ein Knopfdruck wurde vielleicht nicht gehört.",
            ),
            (
                "Release it if nobody else was scanned; otherwise assign it.",
                "Freigeben, wenn sonst niemand gescannt wurde, sonst zuordnen.",
            ),
        ),
        capture::UNREAD => (
            (
                "A card or an order before it could not be read or kept: another patient may have \
                 been meant.",
                "Eine Karte oder ein Auftrag davor war nicht lesbar oder nicht zu speichern: vielleicht war \
                 jemand anders gemeint.",
            ),
            IF_SO,
        ),
        capture::REPEATED => (
            (
                "The order that names the patient came a second time with the same words.",
                "Der Auftrag mit diesem Patienten kam ein zweites Mal mit demselben Inhalt.",
            ),
            IF_SO,
        ),
        identity::NO_PRESS => {
            (("Nobody pressed the button for it.", "Niemand hat dafür den Knopf gedrückt."), IF_SO)
        }
        identity::SAME_SCAN_OTHER_PATIENT => (
            (
                "The same scan arrived before, for another patient.",
                "Derselbe Scan kam schon einmal, für einen anderen Patienten.",
            ),
            (
                "Release it only if it is right for both.",
                "Nur freigeben, wenn er für beide richtig ist.",
            ),
        ),
        _ => (
            (
                "The operator must decide whose scan it is.",
                "Jemand muss sagen, wessen Scan das ist.",
            ),
            IF_SO,
        ),
    };
    Advice::of(pair, language)
}

/// Why a scan was refused.
pub fn of_refused(code: &str, language: Language) -> Advice {
    const AGAIN: Both = ("Scan again.", "Noch einmal scannen.");
    const EXPORT: Both = ("Export it again.", "Noch einmal exportieren.");
    const TECHNICIAN: Both = ("Call the technician.", "Den Techniker rufen.");
    const RETRY: Both =
        ("Fix the cause, then try again.", "Die Ursache beheben, dann noch einmal versuchen.");
    let pair = match code {
        "scan-empty" | "scan-cut-short" => (
            (
                "The export is empty or stops in the middle.",
                "Der Export ist leer oder bricht mitten darin ab.",
            ),
            EXPORT,
        ),
        "scan-no-points" => {
            (("There is nothing in the scan.", "Im Scan ist nichts zu sehen."), AGAIN)
        }
        "scan-unknown-ending"
        | "scan-not-this-format"
        | "scan-binary"
        | "scan-malformed"
        | "scan-not-finite"
        | "scan-too-long" => {
            (("The file is not a readable scan.", "Die Datei ist kein lesbarer Scan."), EXPORT)
        }
        "scan-too-large" => {
            (("The file is too large for a scan.", "Die Datei ist zu groß für einen Scan."), EXPORT)
        }
        "body-side-unclear"
        | "body-no-plausible-leg"
        | "body-two-legs"
        | "body-not-two-legs"
        | "body-only-fragments" => (
            (
                "The scan does not show a whole body on two legs.",
                "Der Scan zeigt keinen ganzen Körper auf zwei Beinen.",
            ),
            ("Scan again with the legs apart.", "Noch einmal scannen, die Beine auseinander."),
        ),
        "body-no-plausible-unit" | "body-unit-implausible" => (
            (
                "What the scan shows is not as large as a standing person.",
                "Was der Scan zeigt, ist nicht so groß wie ein stehender Mensch.",
            ),
            (
                "Scan again, the whole body in view. If this happens again: check scanner.up and \
                 scanner.unit.",
                "Noch einmal scannen, der ganze Körper im Bild. Kommt es wieder: scanner.up und \
                 scanner.unit prüfen.",
            ),
        ),
        "body-facing-unclear" | "body-facing-contradicted" | "body-facing-vertical" => (
            ("Left and right cannot be distinguished.", "Links und rechts sind nicht zu erkennen."),
            ("Scan again with both feet in view.", "Noch einmal scannen, beide Füße im Bild."),
        ),
        "segment-legs-end" | "segment-join-too-low" | "segment-never-join" | "no-leg" => (
            ("The legs cannot be measured.", "Die Beine lassen sich nicht vermessen."),
            (
                "Scan again with the legs bare and apart.",
                "Noch einmal scannen, die Beine frei und auseinander.",
            ),
        ),
        "measuring-too-long" | "measuring-too-large" | "measuring-crashed" | "panic" => (
            ("Measuring it failed.", "Die Vermessung ist fehlgeschlagen."),
            (
                "Try again; if it fails again, call the technician.",
                "Noch einmal versuchen; scheitert es wieder, den Techniker rufen.",
            ),
        ),
        "spool-lost" | "spool-damaged" => (
            (
                "The station's own copy is damaged: the disk may be failing.",
                "Die Kopie der Station ist beschädigt, vielleicht versagt die Festplatte.",
            ),
            TECHNICIAN,
        ),
        "patient-folder-is-a-link" | "patient-folder-clash" => (
            (
                "The patient's folder in the record store cannot be distinguished from another's.",
                "Der Ordner des Patienten im Aktenspeicher ist nicht sicher von einem anderen zu \
                 unterscheiden.",
            ),
            TECHNICIAN,
        ),
        "store-place-occupied" | "store-misfit" | "record-not-written" => (
            (
                "The record store cannot take the record.",
                "Der Aktenspeicher kann die Messakte nicht aufnehmen.",
            ),
            RETRY,
        ),
        other => return said_as_it_is(other, RETRY, language),
    };
    Advice::of(pair, language)
}

/// What keeps the station from being ready.
pub fn of_complaint(complaint: &Complaint, language: Language) -> Advice {
    const SCANNER: Both = (
        "Check that the scanner's computer is on and connected.",
        "Prüfen, ob der Rechner des Scanners an und verbunden ist.",
    );
    const BUTTON: Both =
        ("Check the button, its cable and its plug.", "Knopf, Kabel und Stecker prüfen.");
    const TECHNICIAN: Both = ("Call the technician.", "Den Techniker rufen.");
    let pair = match complaint.code.as_str() {
        "paused" => (
            ("The station is paused.", "Die Station macht Pause."),
            ("Resume to continue.", "Zum Weitermachen fortsetzen."),
        ),
        "disk-low" => (
            ("The disk is nearly full.", "Die Festplatte ist fast voll."),
            (
                "Free some space; the station continues by itself.",
                "Platz schaffen; die Station macht von selbst weiter.",
            ),
        ),
        "store-fault" => (
            ("A record store accepts no records.", "Ein Aktenspeicher nimmt nichts an."),
            (
                "See that it is connected and has room. Nothing is lost meanwhile.",
                "Prüfen, ob er verbunden ist und Platz hat. Es geht nichts verloren.",
            ),
        ),
        "source-taken" => (
            (
                "Another station on this machine uses the export folder.",
                "Eine andere Station auf diesem Rechner bearbeitet den Exportordner.",
            ),
            TECHNICIAN,
        ),
        "source-out-of-reach" | "source-not-mounted" | "source-stalled" => (
            (
                "The scanner's export folder is out of reach.",
                "Der Exportordner des Scanners ist nicht erreichbar.",
            ),
            SCANNER,
        ),
        "export-not-taken" => (
            (
                "A file in the export folder is not complete.",
                "Eine Datei im Exportordner ist nicht vollständig.",
            ),
            ("Check whether the scanner hangs.", "Prüfen, ob der Scanner hängt."),
        ),
        code if code.starts_with("trigger-") => {
            (("The button does not work.", "Der Knopf arbeitet nicht."), BUTTON)
        }
        "delivery-overdue" => (
            (
                "A scan has waited too long for its record.",
                "Ein Scan wartet zu lange auf seine Messakte.",
            ),
            ("Look at the stores below.", "Die Speicher unten ansehen."),
        ),
        "reload-refused" => (
            ("A changed configuration has faults.", "Die geänderte Konfiguration ist fehlerhaft."),
            TECHNICIAN,
        ),
        "journal-failed" => {
            (("The journal cannot be read.", "Das Journal ist nicht lesbar."), TECHNICIAN)
        }
        "record-kept" => (
            (
                "A record that was taken back was changed by hand and is still stored under the \
                 wrong patient.",
                "Eine zurückgenommene Messakte wurde von Hand geändert und liegt noch beim falschen \
                 Patienten.",
            ),
            TECHNICIAN,
        ),
        "custody-made-anew" | "custody-missing" => (
            (
                "A folder in which the station keeps scans was removed.",
                "Ein Ordner, in dem die Station Scans aufbewahrt, wurde gelöscht.",
            ),
            TECHNICIAN,
        ),
        "measuring-impaired" => (
            (
                "Scans cannot be measured on this machine at the moment. None is lost.",
                "Auf diesem Rechner lässt sich zurzeit nichts vermessen. Kein Scan geht verloren.",
            ),
            TECHNICIAN,
        ),
        "journal-refuses" => (
            (
                "The station's journal cannot save new entries.",
                "Das Journal der Station nimmt nichts an.",
            ),
            TECHNICIAN,
        ),
        "page-unavailable" => (
            (
                "Another program uses the address of this page.",
                "Ein anderes Programm belegt die Adresse dieser Seite.",
            ),
            TECHNICIAN,
        ),
        "no-export" => (
            ("No export came after a press.", "Nach einem Knopfdruck kam kein Export."),
            ("Press the button and scan again.", "Knopf drücken und noch einmal scannen."),
        ),
        "order-refused" | "order-not-removed" | "orders-out-of-reach" => (
            (
                "An order of the practice software cannot be read.",
                "Ein Auftrag der Praxissoftware ist nicht lesbar.",
            ),
            (
                "Order again, or name the patient here.",
                "Neu beauftragen oder den Patienten hier benennen.",
            ),
        ),
        "order-repeated" => (
            (
                "An order came again with the same words.",
                "Ein Auftrag kam noch einmal mit gleichem Inhalt.",
            ),
            (
                "Name the patient here if this is a new scan of the same person.",
                "Den Patienten hier benennen, wenn er noch einmal gescannt wird.",
            ),
        ),
        _ if language == Language::En => {
            let next = sentence(&complaint.remedy);
            return Advice { what: sentence(&complaint.message), next };
        }
        other => return said_as_it_is(other, TECHNICIAN, language),
    };
    Advice::of(pair, language)
}

/// Why a decision was not carried out; `None` for an unknown code.
pub fn of_fault(code: &str, language: Language) -> Option<&'static str> {
    let both = match code {
        "patient-id-not-allowed" => (
            "This is not a valid patient id here. Nothing was changed.",
            "Das ist hier keine Patientennummer. Es wurde nichts geändert.",
        ),
        "another-is-named" => (
            "Another patient is named and was not scanned. Nothing was changed.",
            "Ein anderer Patient ist benannt und wurde nicht gescannt. Es wurde nichts geändert.",
        ),
        "scan-of-a-patient" => (
            "The scan is a patient's already. Nothing was changed.",
            "Der Scan gehört schon zu einem Patienten. Es wurde nichts geändert.",
        ),
        "scan-of-several" => (
            "It could be more than one patient's: assign it to the right one. Nothing was changed.",
            "Er kann von mehreren Patienten sein: bitte dem richtigen zuordnen. Es wurde nichts geändert.",
        ),
        "no-occasion" | "unknown-scan" | "scan-unknown" => (
            "The scan is no longer in that state. Nothing was changed.",
            "Der Scan ist nicht mehr in diesem Zustand. Es wurde nichts geändert.",
        ),
        "bytes-gone" => (
            "The station no longer has the scan's data. Export the scan again.",
            "Die Station hat die Daten des Scans nicht mehr. Bitte noch einmal exportieren.",
        ),
        "store-unavailable" => (
            "The record store is out of reach. Try again later.",
            "Der Aktenspeicher ist nicht erreichbar. Bitte später noch einmal versuchen.",
        ),
        _ => return None,
    };
    Some(say(language, both))
}

fn said_as_it_is(code: &str, next: Both, language: Language) -> Advice {
    let what = match language {
        Language::En => format!("The station says: {code}."),
        Language::De => format!("Die Station meldet: {code}."),
    };
    Advice { what, next: say(language, next).to_owned() }
}

/// Turns words without a full stop into a sentence.
fn sentence(words: &str) -> String {
    let mut rest = words.chars();
    let first = rest.next().map(|first| first.to_uppercase().to_string()).unwrap_or_default();
    format!("{first}{}.", rest.as_str())
}

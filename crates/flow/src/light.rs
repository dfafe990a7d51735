//! What the light at the booth shows. It follows delivery, not receipt: it shows "done" when the record
//! is in every store. It does not flicker: each signal stays for a while, but a press is answered at
//! once.

use std::time::Duration;

use gaiter_record::ScanId;

use super::account::Whole;
use super::booth::Signal;
use super::complaint::Complaint;
use super::disposition::Disposition;

/// The shortest time for which a signal is shown; a shorter one would not be seen.
const STANDS: Duration = Duration::from_secs(1);

/// How long "done" is shown: the operator is helping the patient out of the booth.
const DONE_STANDS: Duration = Duration::from_secs(30);

/// What happened last at the booth since the last press.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Last {
    /// This scan ended, or needs a person. How it stands is asked when the light is shown: a person may have
    /// decided since.
    Scan {
        scan: ScanId,
        /// What to do with the patient, in sentences.
        to_do: Vec<String>,
    },
    /// A patient was to be named, and the id could not be read.
    NameUnread,
    /// While an export is expected, or a patient named, the scanner wrote this scan again: it answers nothing.
    Known(ScanId),
}

/// What the light shows of the last event.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LastOutcome {
    /// Its record is stored.
    Delivered,
    /// Its record is stored, and some measures must be taken by hand or the patient scanned again.
    Incomplete {
        /// What to do with the patient, in sentences.
        to_do: Vec<String>,
    },
    /// The operator must decide whose it is.
    Held {
        /// Why, as a stable code.
        code: String,
    },
    /// Its record is stored without a patient: the operator must decide whose it is.
    Unassigned {
        /// What to do with the patient, in sentences.
        to_do: Vec<String>,
    },
    /// It cannot be measured, or its record cannot be stored.
    Refused {
        /// Why, as a stable code.
        code: String,
    },
    /// A patient was to be named, and the id could not be read.
    NameUnread,
    /// The scanner exported an old scan again.
    Known,
}

/// How far an export or scan is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Progress {
    /// It is measured, or its record delivered.
    Measuring,
    /// It is being written.
    ComingIn,
    /// It lacks its end, and is not being written any more.
    Stopped,
}

impl LastOutcome {
    /// That of a scan that is not in work; `None` if it needs nothing any more.
    pub fn from_whole(whole: &Whole, to_do: &[String]) -> Option<LastOutcome> {
        match whole.disposition() {
            Disposition::Refused => {
                let code = whole.summary.code.clone().unwrap_or_default();
                Some(LastOutcome::Refused { code })
            }
            Disposition::Held => {
                Some(LastOutcome::Held { code: whole.held_as().unwrap_or_default().to_owned() })
            }
            Disposition::Spooled if !whole.has_record() => None,
            Disposition::Unassigned => Some(LastOutcome::Unassigned { to_do: to_do.to_owned() }),
            Disposition::Spooled | Disposition::Delivered => Some(match whole.summary.incomplete {
                true => LastOutcome::Incomplete { to_do: to_do.to_owned() },
                false => LastOutcome::Delivered,
            }),
            Disposition::Withdrawing | Disposition::Closed | Disposition::Left => None,
        }
    }

    /// Whether a person must see it before the next patient.
    pub fn needs_person(&self) -> bool {
        !matches!(self, LastOutcome::Delivered)
    }
}

/// The current situation at the station.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Scene {
    /// The station is not ready, and has reported it.
    pub not_ready: bool,
    /// The operator has paused it.
    pub paused: bool,
    /// A button is not there: presses are missed.
    pub is_button_away: bool,
    /// No export arrived after the last press.
    pub missed: bool,
    /// The station waits for the export of a press.
    pub armed: bool,
    /// A file is arriving, or a scan that has arrived is on its way to its record: how far it is.
    pub progress: Option<Progress>,
    /// How the last scan since the last press ended, and when.
    pub last: Option<(LastOutcome, Duration)>,
}

/// The alarm for an export that did not arrive. The light has its own signal for it.
pub const NO_EXPORT: &str = "no-export";

/// The complaint that the operator has paused the station. The light has its own signal for it.
const PAUSED: &str = "paused";

/// The most serious complaint for which the light has no signal of its own; if there is one, the station is not
/// ready.
pub fn first_fault(complaints: &[Complaint]) -> Option<&Complaint> {
    let has_signal = |code: &str| [NO_EXPORT, PAUSED].contains(&code);
    complaints.iter().find(|complaint| complaint.is_fault() && !has_signal(&complaint.code))
}

/// The light, and since when it shows its signal.
#[derive(Debug, Clone, Copy)]
pub struct Light {
    shown: Signal,
    since: Duration,
}

impl Light {
    /// A light that has just been switched on: what it shows first is shown at once.
    pub fn switched_on() -> Light {
        Light { shown: Signal::Ready, since: Duration::ZERO }
    }

    /// What it shows now.
    pub fn show(&mut self, scene: &Scene, now: Duration) -> Signal {
        let wanted = wanted(scene, now);
        // What a person has just done is answered at once.
        let at_once = matches!(wanted, Signal::Armed | Signal::Paused);
        let at_once = at_once || self.shown == Signal::Paused;
        if wanted != self.shown && (at_once || now.saturating_sub(self.since) >= STANDS) {
            (self.shown, self.since) = (wanted, now);
        }
        self.shown
    }
}

/// The most important signal comes first. If the station is not ready, nothing else counts. A scan that
/// ended after the press and needs a person counts more than an export that is still expected; a press
/// forgets how earlier scans ended, so it is answered.
fn wanted(scene: &Scene, now: Duration) -> Signal {
    match scene {
        Scene { not_ready: true, .. } => Signal::Attention,
        Scene { paused: true, .. } => Signal::Paused,
        Scene { progress: Some(_), .. } => Signal::Receiving,
        // The export that is missing may be the one that was held.
        Scene { last: Some((outcome, _)), .. } if outcome.needs_person() => Signal::Attention,
        Scene { armed: true, .. } => Signal::Armed,
        Scene { is_button_away: true, .. } => Signal::Attention,
        Scene { missed: true, .. } => Signal::NoExport,
        Scene { last: Some((LastOutcome::Delivered, at)), .. }
            if now.saturating_sub(*at) < DONE_STANDS =>
        {
            Signal::Done
        }
        _ => Signal::Ready,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::complaint::Severity;

    const SECOND: Duration = Duration::from_secs(1);

    fn at(tenths: u32) -> Duration {
        Duration::from_millis(100) * (1000 + tenths)
    }

    #[test]
    fn a_scan_goes_from_ready_to_done_and_back() {
        let mut light = Light::switched_on();
        let mut scene = Scene::default();
        assert_eq!(light.show(&scene, at(20)), Signal::Ready);
        scene.armed = true;
        assert_eq!(light.show(&scene, at(21)), Signal::Armed);
        scene.progress = Some(Progress::ComingIn);
        assert_eq!(light.show(&scene, at(40)), Signal::Receiving);
        let delivered = Some((LastOutcome::Delivered, at(60)));
        scene = Scene { last: delivered, ..Scene::default() };
        assert_eq!(light.show(&scene, at(60)), Signal::Done);
        assert_eq!(light.show(&scene, at(60) + DONE_STANDS), Signal::Ready);
    }

    #[test]
    fn done_is_never_shown_while_a_record_is_still_to_be_delivered() {
        let last = Some((LastOutcome::Delivered, at(0)));
        let mut light = Light::switched_on();
        let scene = Scene { progress: Some(Progress::Measuring), last, ..Scene::default() };
        for tenths in 0..100 {
            assert_ne!(light.show(&scene, at(tenths)), Signal::Done);
        }
    }

    #[test]
    fn a_record_that_lacks_measures_is_never_done_and_stays_until_the_next_press() {
        let mut light = Light::switched_on();
        let scene = Scene {
            last: Some((LastOutcome::Incomplete { to_do: Vec::new() }, at(10))),
            ..Scene::default()
        };
        for later in [20, 400, 36_000] {
            assert_eq!(light.show(&scene, at(later)), Signal::Attention);
        }
        let pressed = Scene { armed: true, last: None, ..scene };
        assert_eq!(light.show(&pressed, at(36_001)), Signal::Armed);
    }

    #[test]
    fn a_state_that_comes_and_goes_does_not_flicker_and_a_press_is_answered_at_once() {
        let mut light = Light::switched_on();
        let mut changes = 0;
        let mut before = Signal::Ready;
        for tenths in 0..100 {
            let scene = Scene { not_ready: tenths % 2 == 0, ..Scene::default() };
            let shown = light.show(&scene, at(tenths));
            changes += u32::from(shown != before);
            before = shown;
        }
        assert!(changes <= 10, "{changes} changes in 10 s");
        let armed = Scene { armed: true, ..Scene::default() };
        assert_eq!(light.show(&armed, at(100)), Signal::Armed);
        assert_eq!(light.show(&armed, at(100) + SECOND), Signal::Armed);
    }

    #[test]
    fn an_export_that_did_not_arrive_is_shown_as_such_and_not_as_a_station_that_is_not_ready() {
        let no_export = Complaint { code: NO_EXPORT.to_owned(), ..Complaint::journal() };
        let is_not_ready = |of: &[Complaint]| first_fault(of).is_some();
        assert!(!is_not_ready(&[]) && !is_not_ready(std::slice::from_ref(&no_export)));
        let paused = Complaint { code: PAUSED.to_owned(), ..no_export.clone() };
        assert!(!is_not_ready(&[paused]));
        assert!(is_not_ready(&[no_export, Complaint::journal()]));
        let notice = Complaint { severity: Severity::Notice, ..Complaint::journal() };
        assert!(!is_not_ready(&[notice]));
    }

    #[test]
    fn what_a_person_must_see_stays_until_the_next_press() {
        let mut light = Light::switched_on();
        let outcome = LastOutcome::Held { code: "capture-unclear".to_owned() };
        let held = Scene { last: Some((outcome, at(10))), ..Scene::default() };
        assert_eq!(light.show(&held, at(20)), Signal::Attention);
        assert_eq!(light.show(&held, at(20) + 3600 * SECOND), Signal::Attention);
        let both = Scene { missed: true, ..held };
        assert_eq!(light.show(&both, at(20) + 3650 * SECOND), Signal::Attention);
        let missed = Scene { missed: true, ..Scene::default() };
        assert_eq!(light.show(&missed, at(20) + 3700 * SECOND), Signal::NoExport);
        let armed = Scene { armed: true, ..missed };
        assert_eq!(light.show(&armed, at(20) + 3701 * SECOND), Signal::Armed);
    }

    #[test]
    fn a_held_or_refused_scan_is_shown_although_another_export_is_expected() {
        let code = || "scan-empty".to_owned();
        for outcome in [
            LastOutcome::Held { code: code() },
            LastOutcome::Refused { code: code() },
            LastOutcome::Incomplete { to_do: Vec::new() },
            LastOutcome::Unassigned { to_do: Vec::new() },
            LastOutcome::NameUnread,
            LastOutcome::Known,
        ] {
            let mut light = Light::switched_on();
            let last = Some((outcome, at(10)));
            let scene = Scene { armed: true, last, ..Scene::default() };
            assert_eq!(light.show(&scene, at(20)), Signal::Attention, "{scene:?}");
        }
    }

    #[test]
    fn without_its_button_the_station_is_not_ready_and_a_scan_that_is_measured_goes_on() {
        let away = Scene { is_button_away: true, ..Scene::default() };
        let scenes = [
            (
                Scene { last: Some((LastOutcome::Delivered, at(10))), ..away.clone() },
                Signal::Attention,
            ),
            (Scene { armed: true, ..away.clone() }, Signal::Armed),
            (Scene { missed: true, ..away.clone() }, Signal::Attention),
            (Scene { progress: Some(Progress::Measuring), ..away.clone() }, Signal::Receiving),
            (Scene { paused: true, ..away }, Signal::Paused),
        ];
        for (scene, shown) in scenes {
            assert_eq!(Light::switched_on().show(&scene, at(20)), shown, "{scene:?}");
        }
    }

    #[test]
    fn a_pause_is_shown_at_once_and_so_is_its_end_and_a_fault_counts_more() {
        let mut light = Light::switched_on();
        assert_eq!(light.show(&Scene::default(), at(10)), Signal::Ready);
        let paused = Scene { paused: true, armed: true, ..Scene::default() };
        assert_eq!(light.show(&paused, at(10)), Signal::Paused);
        assert_eq!(light.show(&Scene::default(), at(10)), Signal::Ready);
        let mut light = Light::switched_on();
        let broken = Scene { not_ready: true, ..paused };
        assert_eq!(light.show(&broken, at(20)), Signal::Attention);
    }
}

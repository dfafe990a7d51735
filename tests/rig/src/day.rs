//! A short day in a practice, to be struck by a fault at each call of the station: two patients are
//! named and scanned one after the other, and a person finds that the first was somebody else. The
//! people go on where the fault has stopped them, and say again what was not heard.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs::{self, File};
use std::io::Write;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use gaiter_record::gdt::{Charset, message};
use serde_json::Value;

use crate::faults::matrix::{self, acknowledged, empty_folders, faults};
use crate::faults::tracer::Run;
use crate::invariants::{self, Moment, NOBODY, PutKind};
use crate::pty;
use crate::station::{Booth, PATIENCE, sha256};
use crate::verb::{code, gaiter_told};
use support::coarse_body;

/// The patients who are scanned, in their order, with their exports.
const PATIENTS: [(&str, &str); 2] = [("1001", "first.obj"), ("1002", "second.obj")];

/// Who the first of them turns out to be.
const TRUE_FIRST: &str = "1003";

/// How long a scan may take to be measured before the next patient's is in question: longer than it does
/// where many days are played at once on a busy machine.
const WINDOW: &str = "120s";

/// The same with a button, where each start waits so long.
const WINDOW_WITH_BUTTON: &str = "20s";

/// A day holds so many looks after a name or a press before anything is exported: what lies there at
/// the second one was not there at the first.
const LOOKS: usize = 2;

/// What happens, in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    /// The station is ready and, with a button, sure that it hears every press.
    Ready,
    /// The practice software orders a patient.
    Order(usize),
    Heard(usize),
    Press(usize),
    Pressed(usize),
    /// The folder is looked at.
    Look,
    Export(usize),
    Taken(usize),
    /// The first scan is taken back from its patient and given to another.
    TakeBack,
    Assign,
    Assigned,
}

/// A station, its people, and how far they are.
pub struct Day {
    pub booth: Booth,
    bodies: [Vec<u8>; 2],
    button: Option<Mutex<pty::Box>>,
    steps: Vec<Step>,
    progress: Mutex<Progress>,
}

#[derive(Debug, Default)]
struct Progress {
    next: usize,
    /// The step was begun before the station ended.
    is_resumed: bool,
    looks: Vec<Value>,
    presses: usize,
    /// The station has said that the first scan is somebody else's.
    is_assigned: bool,
}

impl Day {
    /// A day without a button: the order of a patient opens a capture.
    pub fn without_button() -> Day {
        Day::new(false)
    }

    /// A day with a button on a serial line.
    pub fn with_button() -> Day {
        Day::new(true)
    }

    fn new(has_button: bool) -> Day {
        let booth = matrix::booth();
        let at = booth.path("");
        let at = at.to_str().unwrap().trim_end_matches('/');
        fs::create_dir(booth.path("orders")).unwrap();
        let window = if has_button { WINDOW_WITH_BUTTON } else { WINDOW };
        let mut further = format!(
            "[patient.orders]\npath = \"{at}/orders\"\nquiet = \"50ms\"\n\
             [capture]\nwindow = \"{window}\"\nlate = \"0s\"\n"
        );
        let button = has_button.then(|| {
            let port = booth.path("button");
            further += &format!(
                "[trigger]\nsettle = \"0s\"\nlock_out = \"0s\"\n[trigger.serial]\n\
                 port = \"{}\"\ntokens = [\"PRESS\"]\n",
                port.display()
            );
            Mutex::new(pty::Box::behind(&port))
        });
        booth.reconfigure(|config| {
            let lines = config.lines().filter(|line| !line.starts_with("file_name"));
            lines.map(|line| format!("{line}\n")).collect::<String>() + &further
        });
        let mut steps = vec![Step::Ready];
        for patient in 0..PATIENTS.len() {
            steps.extend([Step::Order(patient), Step::Heard(patient)]);
            if has_button {
                steps.extend([Step::Press(patient), Step::Pressed(patient)]);
            }
            steps.extend([Step::Look, Step::Export(patient), Step::Taken(patient)]);
        }
        steps.extend([Step::TakeBack, Step::Assign, Step::Assigned]);
        let bodies = [coarse_body(1), coarse_body(2)];
        Day { booth, bodies, button, steps, progress: Mutex::default() }
    }

    /// Begins another day in empty folders.
    pub fn renew(&self) {
        empty_folders(&self.booth);
        *self.progress() = Progress::default();
    }

    fn progress(&self) -> MutexGuard<'_, Progress> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The people do what is to be done next; says whether the day is over.
    pub fn goes_on(&self) -> bool {
        let mut progress = self.progress();
        while let Some(step) = self.steps.get(progress.next) {
            if !self.is_done(*step, &mut progress) {
                return false;
            }
            progress.next += 1;
            progress.is_resumed = false;
            progress.looks.clear();
        }
        true
    }

    fn is_done(&self, step: Step, progress: &mut Progress) -> bool {
        match step {
            Step::Ready => {
                let sure = self.status().is_some_and(|status| status["booth"]["in_doubt"] == false);
                // A word at the booth since the start: nobody is there.
                sure && self.verb(&["patient", "clear"], "")
            }
            Step::Order(patient) => {
                self.order(patient);
                true
            }
            Step::Heard(patient) if progress.is_resumed => self.says(patient),
            // It is deleted when it was heard.
            Step::Heard(patient) => !self.order_file(patient).exists(),
            Step::Press(_) => {
                progress.presses = self.count("\"pressed\"");
                let button = self.button.as_ref().expect("a button");
                // On a dead line nobody hears it.
                button.lock().unwrap_or_else(PoisonError::into_inner).pours(b"PRESS\r\n");
                true
            }
            // The light shows that nobody has heard it: the scan was made all the same.
            Step::Pressed(_) if progress.is_resumed => true,
            Step::Pressed(_) => self.count("\"pressed\"") > progress.presses,
            Step::Look => {
                let look = self.status().map(|status| status["sources"][0]["last_look"].clone());
                if let Some(look) = look.filter(|look| progress.looks.last() != Some(look)) {
                    progress.looks.push(look);
                }
                progress.looks.len() > LOOKS
            }
            Step::Export(patient) => {
                self.export(patient);
                true
            }
            Step::Taken(patient) => self.has_ended(patient, progress.is_resumed),
            Step::TakeBack => {
                let is_given = self.owners(0).iter().any(|owner| owner == PATIENTS[0].0);
                !is_given || self.verb(&["unassign", &self.id(0)], "")
            }
            Step::Assign => {
                progress.is_assigned = self.verb(&["assign", &self.id(0)], TRUE_FIRST);
                progress.is_assigned || self.owners(0) == [TRUE_FIRST]
            }
            Step::Assigned => self.owners(0) == [TRUE_FIRST],
        }
    }

    fn order(&self, patient: usize) {
        let (id, _) = PATIENTS[patient];
        let fields =
            [(8315, "LEGSCAN1"), (8316, "PRAX_EDV"), (9206, "3"), (9218, "02.10"), (3000, id)];
        let fields = fields.map(|(field, text)| (field, text.to_owned()));
        let bytes = message(6302, Charset::Cp1252, &fields).unwrap();
        let new = self.booth.path("new-order");
        fs::write(&new, bytes).unwrap();
        fs::rename(new, self.order_file(patient)).unwrap();
    }

    fn order_file(&self, patient: usize) -> PathBuf {
        self.booth.path("orders").join(format!("{}.gdt", PATIENTS[patient].0))
    }

    /// The scanner's disk keeps what it has written.
    fn export(&self, patient: usize) {
        let (_, name) = PATIENTS[patient];
        let folder = self.booth.path("export");
        let mut file = File::create(folder.join(name)).unwrap();
        file.write_all(&self.bodies[patient]).unwrap();
        file.sync_all().unwrap();
        File::open(folder).unwrap().sync_all().unwrap();
        self.booth.has_put(name, &self.bodies[patient], PutKind::Whole);
    }

    fn id(&self, patient: usize) -> String {
        sha256(&self.bodies[patient])[..12].to_owned()
    }

    fn says(&self, patient: usize) -> bool {
        self.verb(&["patient", "set"], PATIENTS[patient].0)
    }

    fn verb(&self, args: &[&str], line: &str) -> bool {
        let config = self.booth.path("station.toml");
        code(&gaiter_told(&config, args, &format!("{line}\n"))) == Some(0)
    }

    /// What a running station says of itself.
    fn status(&self) -> Option<Value> {
        let config = self.booth.path("station.toml");
        let output = gaiter_told(&config, &["status", "--json"], "");
        serde_json::from_slice(&output.stdout).ok()
    }

    fn count(&self, event: &str) -> usize {
        self.booth.log().matches(event).count()
    }

    /// Whether a scan was delivered or is held. The journal is asked where the station was killed before
    /// its log could tell.
    fn has_ended(&self, patient: usize, is_resumed: bool) -> bool {
        let scan = format!("scan=\"{}", &self.id(patient)[..8]);
        let is_end = |line: &str| line.contains("scan-held") && line.contains(&scan);
        let log_tells = || self.booth.log().lines().any(is_end);
        !self.owners(patient).is_empty() || log_tells() || (is_resumed && self.is_held(patient))
    }

    fn is_held(&self, patient: usize) -> bool {
        let scan = sha256(&self.bodies[patient]);
        let held =
            format!("SELECT count(*) FROM deliveries WHERE state = 'held' AND sha256 = '{scan}'");
        self.booth.journal(&held).is_some_and(|count| count > 0)
    }

    /// Whose folders in the store hold a scan.
    fn owners(&self, patient: usize) -> Vec<String> {
        let scan = sha256(&self.bodies[patient]);
        let records = invariants::records(&self.booth.path("records")).0;
        records.into_iter().filter(|(_, sum)| *sum == scan).map(|(owner, _)| owner).collect()
    }

    /// What must hold of the right patient at any moment: no scan lies under a name that was not said
    /// of it.
    pub fn wrong_names(&self) -> Vec<String> {
        let mut found = Vec::new();
        for (patient, (id, name)) in PATIENTS.iter().enumerate() {
            let may_be: &[&str] =
                if patient == 0 { &[id, TRUE_FIRST, NOBODY] } else { &[id, NOBODY] };
            for owner in self.owners(patient) {
                if !may_be.contains(&owner.as_str()) {
                    found.push(format!("{name} of {id} lies under {owner}"));
                }
            }
        }
        found
    }

    /// The same, and the invariants that do not speak of names, right after a fault.
    pub fn found_at_once(&self, run: &Run) -> Vec<String> {
        let mut found = self.wrong_names();
        if run.hung {
            found.push("it did not end".to_owned());
        }
        found.extend(acknowledged(&self.booth));
        found.extend(self.faults(Moment::Any));
        found
    }

    fn faults(&self, moment: Moment) -> Vec<String> {
        let speaks_of_names = |fault: &String| fault.starts_with("I1:") || fault.starts_with("I2:");
        faults(&self.booth, moment).into_iter().filter(|fault| !speaks_of_names(fault)).collect()
    }

    fn is_at_rest(&self) -> bool {
        let open = "SELECT count(*) FROM deliveries WHERE state IN ('pending', 'withdrawing')";
        let spooled = "SELECT count(*) FROM scans WHERE state = 'spooled'";
        [open, spooled].iter().all(|query| self.booth.journal(query) == Some(0))
    }

    /// Starts the station without faults, lets the people go on, and stops it; what does not hold then.
    pub fn goes_on_restarted(&self) -> Vec<String> {
        {
            let mut progress = self.progress();
            progress.is_resumed = true;
            progress.looks.clear();
        }
        let ready = || self.count("station-ready");
        let before = ready();
        let mut daemon = self.booth.start();
        let deadline = Instant::now() + PATIENCE;
        let is_over = || ready() > before && self.goes_on() && self.is_at_rest();
        let mut over = is_over();
        while !over && !daemon.has_ended() && Instant::now() < deadline {
            sleep(Duration::from_millis(10));
            over = is_over();
        }
        let code = daemon.stop().code();
        let mut found = self.found_at_the_end();
        if code != Some(0) {
            found.push(format!("the station without faults ended with {code:?}"));
        }
        if !over {
            let at = self.steps.get(self.progress().next);
            found.push(format!("the day did not end: {at:?}"));
        }
        found
    }

    fn found_at_the_end(&self) -> Vec<String> {
        let mut found = self.wrong_names();
        found.extend(self.faults(Moment::Rest));
        for (patient, (_, name)) in PATIENTS.iter().enumerate() {
            if self.owners(patient).is_empty() && !self.is_held(patient) {
                found.push(format!("{name} is neither delivered nor held"));
            }
        }
        if self.progress().is_assigned && self.owners(0) != [TRUE_FIRST] {
            found.push(format!(
                "it was decided that the first is {TRUE_FIRST}'s, and he has it not"
            ));
        }
        found
    }

    /// Whether everything lies where it belongs, and nothing waits for a person.
    pub fn is_all_delivered(&self) -> bool {
        self.owners(0) == [TRUE_FIRST] && self.owners(1) == [PATIENTS[1].0]
    }
}

//! A booth as its people see it: a station with or without a button, names, presses, exports, orders,
//! and what has come of them. Every step waits for what it causes.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use rusqlite::{Connection, OpenFlags};
use serde_json::Value;

use crate::pty;
use crate::station::{Booth, Daemon, PATIENCE, Setting, sha256};
use crate::verb::{code, gaiter_told, stderr, stdout};

/// A booth whose scans' names say nothing.
pub struct Room {
    pub booth: Booth,
    button: Option<pty::Box>,
    orders: usize,
}

/// Further lines of the configuration, in which `AT` stands for the booth's folder.
pub struct At;

impl At {
    /// A folder of orders.
    pub fn orders(when: &str) -> String {
        format!(
            "[patient.orders]\npath = \"AT/orders\"\nquiet = \"100ms\"\n\
             when = \"{when}\"\n"
        )
    }
}

impl Room {
    pub fn with_button(further: &str) -> Room {
        let mut room = Room::without_button(further);
        let port = room.booth.path("button");
        room.button = Some(pty::Box::behind(&port));
        room.booth.reconfigure(|config| {
            format!(
                "{config}[trigger]\nsettle = \"0s\"\nlock_out = \"0s\"\n[trigger.serial]\n\
                 port = \"{}\"\ntokens = [\"PRESS\"]\nlong_tokens = [\"LONG\"]\n",
                port.display()
            )
        });
        room
    }

    pub fn without_button(further: &str) -> Room {
        // The window begins with a press, and its export comes after two looks: these are quick. For as long
        // as the window lasts, the station listens before it believes that it hears every press.
        let rescan = Duration::from_millis(300);
        let booth = Booth::set(&Setting { rescan, ..Setting::default() });
        fs::create_dir(booth.path("orders")).unwrap();
        let further = further.replace("AT", booth.path("").to_str().unwrap().trim_end_matches('/'));
        booth.reconfigure(|config| {
            let lines = config.lines().filter(|line| !line.starts_with("file_name"));
            let config: String = lines.map(|line| format!("{line}\n")).collect();
            format!("{config}{further}[capture]\nwindow = \"12s\"\nlate = \"0s\"\n")
        });
        Room { booth, button: None, orders: 0 }
    }

    pub fn set_short_wait(&self, wait: &str) {
        let line = |line: &str| match line.starts_with("short_wait") {
            true => format!("short_wait = \"{wait}\"\n"),
            false => format!("{line}\n"),
        };
        self.booth.reconfigure(|config| config.lines().map(line).collect());
    }

    /// A started station that has listened for long enough to believe that it hears every press. Somebody
    /// said at the booth that nobody is there since it was started first.
    #[track_caller]
    pub fn start(&self) -> Daemon {
        let is_first = !self.booth.path("state/journal.db").exists();
        let daemon = self.booth.start_ready();
        if is_first {
            self.booth.gaiter(&["patient", "clear"]);
        }
        if self.button.is_some() {
            self.booth.wait_for("a sure booth", || {
                let status = self.status();
                status["triggers"]["serial"]["state"] == "open"
                    && status["booth"]["in_doubt"] == false
            });
        }
        daemon
    }

    pub fn status(&self) -> Value {
        self.booth.status()
    }

    pub fn export(&self, name: &str) -> PathBuf {
        self.booth.path("export").join(name)
    }

    /// Writes a file of the export folder in one go, in place where there is one.
    pub fn write(&self, name: &str, bytes: &[u8]) {
        fs::write(self.export(name), bytes).unwrap();
    }

    /// Names the patient of the next scan by the verb.
    #[track_caller]
    pub fn name(&mut self, id: &str) {
        let (code, said) = self.try_name(id);
        assert_eq!(code, Some(0), "{said}");
        if self.button.is_none() {
            self.wait_for_look();
        }
    }

    pub fn try_name(&self, id: &str) -> (Option<i32>, String) {
        let config = self.booth.path("station.toml");
        let output = gaiter_told(&config, &["patient", "set"], &format!("{id}\n"));
        (code(&output), stderr(&output) + &stdout(&output))
    }

    #[track_caller]
    pub fn said(&self, args: &[&str]) -> String {
        let output = self.booth.gaiter(args);
        assert_eq!(code(&output), Some(0), "{}", stderr(&output));
        stdout(&output)
    }

    /// Presses, where there is a button, and waits until the station has looked for what lay there
    /// before.
    #[track_caller]
    pub fn press(&mut self) {
        if self.button.is_none() {
            return;
        }
        let before = self.heard("pressed");
        self.push_button();
        self.booth.wait_for("the press", || self.heard("pressed") > before);
        self.wait_for_look();
    }

    /// Presses, whether or not the station listens.
    pub fn push_button(&mut self) {
        if let Some(button) = &mut self.button {
            button.sends(b"PRESS\r\n");
        }
    }

    /// How often the journal's history has this event.
    pub fn heard(&self, event: &str) -> i64 {
        let query = format!("SELECT count(*) FROM history WHERE event = '{event}'");
        self.booth.journal(&query).unwrap()
    }

    /// Waits for a look that begins from now on.
    #[track_caller]
    pub fn wait_for_look(&self) {
        self.booth.wait_for_look();
    }

    #[track_caller]
    pub fn wait_until_waiting(&self, name: &str, why: &str) {
        self.booth.wait_until_explained(name, why);
    }

    /// Waits until the journal knows a scan.
    #[track_caller]
    pub fn wait_for_taken(&self, bytes: &[u8]) {
        let scan = sha256(bytes);
        self.booth
            .wait_for_journal(&format!("SELECT count(*) FROM scans WHERE sha256 = '{scan}'"), 1);
    }

    #[track_caller]
    pub fn wait_for_refusals(&self, count: i64) {
        self.booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'refused'", count);
    }

    /// Waits until so many files were known when they were taken.
    #[track_caller]
    pub fn wait_for_known(&self, count: usize) {
        self.booth
            .wait_for("known scans", || self.booth.log().matches("scan-known").count() >= count);
    }

    /// Waits until the bytes of a scan are in the spool.
    #[track_caller]
    pub fn wait_for_spooled(&self, bytes: &[u8]) {
        let entry = self.booth.path("state/spool").join(sha256(bytes));
        self.booth.wait_for("the spool", || entry.join("intake.json").exists());
    }

    /// Waits until no scan is on its way to a record.
    #[track_caller]
    pub fn wait_until_at_rest(&self) {
        self.booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'spooled'", 0);
    }

    /// The codes of the scans that are held.
    pub fn held(&self) -> Vec<String> {
        let output = self.booth.gaiter(&["scans", "--state", "held", "--json"]);
        let scans: Value = serde_json::from_slice(&output.stdout).unwrap();
        let codes = scans.as_array().unwrap().iter();
        codes.map(|scan| scan["code"].as_str().unwrap_or_default().to_owned()).collect()
    }

    /// Puts an order into its folder and waits until it is heard.
    #[track_caller]
    pub fn order(&mut self, id: &str) {
        let before = self.orders_taken();
        self.write_order("orders", id);
        self.booth.wait_for("the order", || self.orders_taken() > before);
    }

    /// Puts an order into a folder of the booth.
    pub fn write_order(&mut self, folder: &str, id: &str) {
        self.put_order(folder, &order(&format!("3000{id}")));
    }

    /// How many orders were heard.
    pub fn orders_taken(&self) -> usize {
        self.booth.log().matches("event=\"order-taken\"").count()
    }

    #[track_caller]
    pub fn malformed_order(&mut self) {
        let whole = order("30001009");
        self.put_order("orders", &whole[..whole.len() - 4]);
        self.booth.wait_for("the refusal", || self.booth.log().contains("order-refused"));
    }

    fn put_order(&mut self, folder: &str, bytes: &[u8]) {
        self.orders += 1;
        let folder = self.booth.path(folder);
        let (new, name) = (folder.join(".new"), folder.join(format!("{}.gdt", self.orders)));
        fs::write(&new, bytes).unwrap();
        fs::rename(new, name).unwrap();
    }

    /// What the journal of a stopped station holds is of an earlier start of the machine.
    pub fn begin_another_start_of_the_machine(&self) {
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE;
        let journal =
            Connection::open_with_flags(self.booth.path("state/journal.db"), flags).unwrap();
        let changed = journal.execute("UPDATE captures SET boot = 'another'", []).unwrap();
        assert!(changed > 0);
        journal.execute("UPDATE looks SET boot = 'another'", []).unwrap();
    }

    /// Locks the journal for writing until the connection is dropped, as another program may.
    pub fn lock_journal(&self) -> Connection {
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE;
        let journal =
            Connection::open_with_flags(self.booth.path("state/journal.db"), flags).unwrap();
        journal.busy_timeout(PATIENCE).unwrap();
        journal.execute_batch("BEGIN IMMEDIATE").unwrap();
        journal
    }
}

/// An order (GDT 6302) with this field.
fn order(field: &str) -> Vec<u8> {
    use gaiter_record::gdt::{Charset, message};
    let (number, text) = field.split_at(4);
    let fields = [(8315, "LEGSCAN1"), (8316, "PRAX_EDV"), (9206, "3"), (9218, "02.10")];
    let fields: Vec<(u16, String)> = fields
        .into_iter()
        .map(|(field, text)| (field, text.to_owned()))
        .chain([(number.parse().unwrap(), text.to_owned())])
        .collect();
    message(6302, Charset::Cp1252, &fields).unwrap()
}

//! The lying clock: the wall clock of the station jumps, and only that. libfaketime stands between the
//! station and the clock; the kernel's file times and the monotonic clock stay true.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use crate::chance::Chance;
use crate::field::Field;
use crate::plan::{Event, follow};

/// Where distributions put the library.
const LIBRARIES: [&str; 3] = ["/usr/lib", "/usr/lib64", "/usr/local/lib"];
const NAME: &str = "faketime/libfaketimeMT.so.1";

const MINUTE: i64 = 60;
const HOUR: i64 = 60 * MINUTE;
const DAY: i64 = 24 * HOUR;
const YEAR: i64 = 365 * DAY;

/// How far the clock is from the truth, seconds; none: it says 1970, as one without a battery does.
pub type Lie = Option<i64>;

/// The clock of the station, and the file that says how it lies.
#[derive(Debug)]
pub struct Clock {
    library: PathBuf,
    file: PathBuf,
}

pub fn draw(chance: &mut Chance) -> Lie {
    let steps = [2 * MINUTE, 10 * MINUTE, HOUR, 26 * HOUR, 3 * DAY, 45 * DAY, YEAR, 10 * YEAR];
    let step = chance.pick(&steps).copied().unwrap_or(HOUR);
    match chance.below(12) {
        0 => None,
        1 | 2 => Some(0),
        n if n % 2 == 0 => Some(step),
        _ => Some(-step),
    }
}

impl Clock {
    /// A clock that says the truth for now; none, with the reason, where the library is not there or does
    /// not work.
    pub fn new(file: PathBuf) -> Option<Clock> {
        let Some(library) = library() else {
            println!("SKIPPED in part: the lying clock needs libfaketime (package faketime)");
            return None;
        };
        let clock = Clock { library, file };
        clock.say(Some(YEAR));
        let mut date = Command::new("date");
        clock.lie_to(&mut date);
        let said = date.arg("+%s").output().ok();
        let said = said.and_then(|o| String::from_utf8(o.stdout).ok()?.trim().parse::<i64>().ok());
        clock.say(Some(0));
        let lies = said.is_some_and(|said| said - now() > YEAR / 2);
        if !lies {
            println!("SKIPPED in part: libfaketime does not work here");
        }
        lies.then_some(clock)
    }

    /// Lets a program ask this clock.
    pub fn lie_to(&self, command: &mut Command) {
        command.env("LD_PRELOAD", &self.library).env("FAKETIME_TIMESTAMP_FILE", &self.file);
        for name in ["FAKETIME_NO_CACHE", "FAKETIME_DONT_FAKE_MONOTONIC", "DONT_FAKE_MONOTONIC"] {
            command.env(name, "1");
        }
        command.env("NO_FAKE_STAT", "1");
    }

    /// The clock jumps.
    pub fn say(&self, lie: Lie) {
        let offset = lie.unwrap_or_else(|| 1000 - now());
        let spare = self.file.with_extension("spare");
        fs::write(&spare, format!("{offset:+}\n")).unwrap();
        // At once: half a file would be another time.
        fs::rename(spare, &self.file).unwrap();
    }
}

fn library() -> Option<PathBuf> {
    let folders = LIBRARIES.iter().flat_map(|folder| {
        let within = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
        within.chain([PathBuf::from(folder)])
    });
    folders.map(|folder| folder.join(NAME)).find(|library| library.exists())
}

fn now() -> i64 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap();
    i64::try_from(now.as_secs()).unwrap()
}

/// Lets the clock lie, and tell the truth at the end.
pub fn lie(field: &Field, events: Vec<Event<Lie>>) {
    let Some(clock) = &field.clock else { return };
    follow(field, events, |lie, _| {
        clock.say(lie);
        match lie {
            Some(offset) => field.tell(format_args!("the clock is {offset:+} s off")),
            None => field.tell("the clock says 1970"),
        }
    });
    field.wait_until(field.plan.length);
    clock.say(Some(0));
    field.tell("the clock is right");
}

/// Whether the log of the station shows that it has asked this clock: no other gives such times.
pub fn was_asked(log: &str) -> bool {
    let true_days: Vec<String> = [0, 1].into_iter().map(day).collect();
    let is_day = |day: &str| day.len() == 10 && Path::new(day).extension().is_none();
    let days = log.lines().filter_map(|line| line.split_once('T')).map(|(day, _)| day);
    days.filter(|day| is_day(day) && day.as_bytes()[4] == b'-')
        .any(|day| !true_days.iter().any(|known| known == day))
}

fn day(ago: u64) -> String {
    let time = SystemTime::now() - Duration::from_secs(ago * 86_400);
    jiff::Timestamp::try_from(time).unwrap().strftime("%Y-%m-%d").to_string()
}

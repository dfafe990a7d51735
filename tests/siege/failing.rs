//! The failing disk: the disk of the state folder is full, read-only, away or answers nothing but errors,
//! and so is the share of the records; each for some seconds, and then it is back.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use rustix::fs::{IFlags, ioctl_getflags, ioctl_setflags};

use crate::chance::Chance;
use crate::disk::{self, Disk};
use crate::field::Field;
use crate::plan::{Event, follow, seconds, weighed};
use crate::share::Share;

/// The size of the state folder's disk.
const DISK_BYTES: u64 = 1 << 30;

/// What happens to the disks.
#[derive(Debug, Clone, Copy)]
pub enum Act {
    /// Nothing fits on the state's disk.
    StateFull,
    /// The folders of the state take no new names and give none up.
    StateReadOnly,
    /// The state folder is not there.
    StateAway,
    /// The state's disk answers with EIO until the machine is started again.
    StateBroken,
    /// Every call to the records fails with EIO, or every write with another error.
    RecordsFail(&'static str),
    /// The records' share does not answer.
    RecordsStall,
    /// The records' share is dead.
    RecordsDie,
    /// The records' share is not mounted.
    RecordsUnmounted,
    /// The store's folder was moved.
    RecordsAway,
}

pub fn draw(chance: &mut Chance) -> Act {
    let acts = [
        (3, Act::StateFull),
        (2, Act::StateReadOnly),
        (2, Act::StateAway),
        (2, Act::StateBroken),
        (1, Act::RecordsFail("EIO")),
        (1, Act::RecordsFail("ENOSPC")),
        (1, Act::RecordsFail("EROFS")),
        (2, Act::RecordsStall),
        (1, Act::RecordsDie),
        (1, Act::RecordsUnmounted),
        (2, Act::RecordsAway),
    ];
    weighed(chance, &acts)
}

/// The disks under a booth; each only where the machine can have it.
#[derive(Default)]
pub struct Disks {
    state: Option<Disk>,
    records: Option<Share>,
}

impl Disks {
    /// Puts the state folder on a disk and the records on a share.
    pub fn under(field: &Field) -> Disks {
        let booth = &field.booth;
        let state = disk::can_be_cut().then(|| Disk::sized(booth.path("disk"), DISK_BYTES));
        Disks { state, records: Share::mount(booth.path("back"), booth.path("records")) }
    }

    /// Lets them fail for as long as the siege lasts.
    pub fn fail(&mut self, field: &Field, events: Vec<Event<Act>>) {
        follow(field, events, |act, chance| {
            let lasts = seconds(chance, 0.5, 4.0);
            let was_done = match act {
                Act::StateFull => self.state.is_some() && full(field, lasts, chance),
                Act::StateReadOnly => read_only(field, lasts),
                Act::StateAway => away(field, lasts),
                Act::StateBroken => self.state.as_ref().is_some_and(|d| broken(field, d, lasts)),
                _ => self.records.as_mut().is_some_and(|s| of_records(field, s, act, lasts)),
            };
            if was_done {
                field.tell(format_args!("{act:?} is over"));
            }
        });
    }
}

fn begin(field: &Field, what: &str, lasts: Duration) {
    field.tell(format_args!("{what} for {lasts:.1?}"));
}

/// Fills the disk to its last block or nearly.
fn full(field: &Field, lasts: Duration, chance: &mut Chance) -> bool {
    let filler = field.booth.path("disk/filler");
    let mut file = File::create(&filler).unwrap();
    let zeros = vec![0; 1 << 20];
    while file.write_all(&zeros).is_ok() {}
    // The last pieces, which are smaller; sometimes a little is left.
    let piece = if chance.below(2) == 0 { 512 } else { 1 << 17 };
    while file.write_all(&zeros[..piece]).is_ok() {}
    begin(field, "the state's disk is full", lasts);
    field.pass(lasts);
    drop(file);
    // A disk that is full takes away all the same.
    let _ = fs::remove_file(filler);
    true
}

/// Folders of the state that take no changes, until this is dropped.
struct Immutable(Vec<PathBuf>);

impl Immutable {
    fn set(path: &Path, immutable: bool) -> bool {
        let change = || -> rustix::io::Result<()> {
            let folder = File::open(path).map_err(|_| rustix::io::Errno::NOENT)?;
            let mut flags = ioctl_getflags(&folder)?;
            flags.set(IFlags::IMMUTABLE, immutable);
            ioctl_setflags(&folder, flags)
        };
        change().is_ok()
    }
}

impl Drop for Immutable {
    fn drop(&mut self) {
        self.0.iter().for_each(|path| _ = Immutable::set(path, false));
    }
}

fn read_only(field: &Field, lasts: Duration) -> bool {
    let state = field.booth.path("disk/state");
    let folders = ["", "spool", "quarantine", "decisions"].map(|name| state.join(name));
    let immutable = Immutable(folders.to_vec());
    let had = folders.iter().filter(|path| Immutable::set(path, true)).count();
    if had == 0 {
        println!("SKIPPED in part: folders cannot be made immutable here");
        return false;
    }
    begin(field, "the folders of the state are read-only", lasts);
    field.pass(lasts);
    drop(immutable);
    true
}

/// Not while a station starts: one that finds no state folder makes one, as it should.
fn away(field: &Field, lasts: Duration) -> bool {
    let (state, moved) = (field.booth.path("disk/state"), field.booth.path("disk/moved"));
    // Synced: a disk that breaks next would otherwise bring the folder back under its other name.
    let rename = |from: &Path, to: &Path| {
        fs::rename(from, to).unwrap();
        File::open(field.booth.path("disk")).unwrap().sync_all().unwrap();
    };
    field.keeper.in_calm(field, || {
        begin(field, "the state folder is away", lasts);
        rename(&state, &moved);
        field.pass(lasts);
        if state.exists() {
            field.fault("a running station made its state folder anew while that was away");
            rename(&state, &field.booth.path("disk/anew"));
        }
        rename(&moved, &state);
    })
}

fn broken(field: &Field, disk: &Disk, lasts: Duration) -> bool {
    begin(field, "the state's disk answers with EIO", lasts);
    disk.fail();
    field.pass(lasts);
    field.keeper.down(field, || {
        disk.unmount();
        disk.mount();
    });
    true
}

fn of_records(field: &Field, share: &mut Share, act: Act, lasts: Duration) -> bool {
    match act {
        Act::RecordsFail(error) => {
            begin(field, &format!("the records' share answers with {error}"), lasts);
            let failure = share.fail(error);
            field.pass(lasts);
            drop(failure);
        }
        Act::RecordsStall => {
            begin(field, "the records' share stalls", lasts);
            let stall = share.stall();
            field.pass(lasts);
            drop(stall);
        }
        Act::RecordsDie => {
            begin(field, "the records' share is dead", lasts);
            share.die();
            field.pass(lasts);
            share.revive();
        }
        Act::RecordsUnmounted => {
            begin(field, "the records' share is not mounted", lasts);
            share.unmount_lazily();
            field.pass(lasts);
            share.serve();
        }
        _ => {
            begin(field, "the store's folder is away", lasts);
            let moved = share.back().with_extension("moved");
            fs::rename(share.back(), &moved).unwrap();
            field.pass(lasts);
            fs::rename(&moved, share.back()).unwrap();
        }
    }
    true
}

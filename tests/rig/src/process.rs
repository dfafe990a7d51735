//! What /proc tells of a running station and its children.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs;

/// CPU time of a process, in clock ticks of 10 ms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CpuTicks {
    /// Its own, of all its threads.
    pub own: u64,
    /// That of its children that have ended.
    pub children: u64,
}

impl CpuTicks {
    /// What a running process has taken so far.
    pub fn read(pid: u32) -> CpuTicks {
        let stat = fs::read_to_string(format!("/proc/{pid}/stat")).expect("a running process");
        // Behind the name in brackets; utime, stime, cutime and cstime are fields 14 to 17.
        let (_, fields) = stat.rsplit_once(')').unwrap();
        let fields: Vec<&str> = fields.split_whitespace().collect();
        let sum = |fields: &[&str]| fields.iter().map(|field| field.parse::<u64>().unwrap()).sum();
        CpuTicks { own: sum(&fields[11..13]), children: sum(&fields[13..15]) }
    }

    /// What it has taken since an earlier time.
    pub fn since(self, earlier: CpuTicks) -> CpuTicks {
        CpuTicks { own: self.own - earlier.own, children: self.children - earlier.children }
    }
}

/// Whether a thread of the process waits for a FUSE server's answer. Only root may ask.
pub fn waits_on_share(pid: u32) -> bool {
    let tasks = fs::read_dir(format!("/proc/{pid}/task")).into_iter().flatten().flatten();
    tasks.into_iter().any(|task| {
        fs::read_to_string(task.path().join("stack")).is_ok_and(|stack| stack.contains("fuse_"))
    })
}

/// A process and all that descend from it.
pub fn family(pid: u32) -> Vec<u32> {
    let parents: Vec<(u32, u32)> =
        processes().filter_map(|pid| Some((pid, parent(pid)?))).collect();
    let mut family = vec![pid];
    let mut asked = 0;
    while let Some(asked_for) = family.get(asked).copied() {
        asked += 1;
        let children = parents.iter().filter(|(_, parent)| *parent == asked_for);
        family.extend(children.map(|(child, _)| child));
    }
    family
}

fn processes() -> impl Iterator<Item = u32> {
    let entries = fs::read_dir("/proc").unwrap().flatten();
    entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok())
}

fn parent(pid: u32) -> Option<u32> {
    let stat = fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    stat.rsplit_once(')')?.1.split_whitespace().nth(1)?.parse().ok()
}

/// What everybody on the machine can read of a process: its name, its command line and, for its
/// own user, its environment.
pub fn public_words(pid: u32) -> Vec<u8> {
    let read = |name| fs::read(format!("/proc/{pid}/{name}")).unwrap_or_default();
    let mut words: Vec<u8> = ["comm", "cmdline", "environ"].into_iter().flat_map(read).collect();
    for task in fs::read_dir(format!("/proc/{pid}/task")).into_iter().flatten().flatten() {
        words.extend(fs::read(task.path().join("comm")).unwrap_or_default());
    }
    words
}

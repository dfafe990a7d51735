//! A mock network share: a folder passed through FUSE, which can stall, die and be unmounted.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

use crate::station::PATIENCE;

const SERVER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/mock_share.py");

/// Interpreters that may have fusepy: that of the path, and that of the distribution's package.
const PYTHONS: [&str; 2] = ["python3", "/usr/bin/python3"];

/// Whether there is fusepy, under either of its names.
const IMPORT: &str = "try: import fusepy as fuse
except ImportError: import fuse
fuse.FUSE";

/// A mounted mock share.
pub struct Share {
    python: &'static str,
    /// What the other machines see: writes here give no event on the share.
    back: PathBuf,
    mount: PathBuf,
    server: Option<Child>,
}

/// A share that does not answer; it goes on when this ends.
pub struct Stall {
    server: Pid,
}

impl Drop for Stall {
    fn drop(&mut self) {
        let _ = kill_process(self.server, Signal::CONT);
    }
}

/// A share whose calls fail; they work again when this ends.
pub struct Failure {
    fault: PathBuf,
}

impl Drop for Failure {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.fault);
    }
}

impl Share {
    /// Mounts `back` on `mount`; both are made. None, with the reason on standard output, where
    /// this machine cannot.
    pub fn mount(back: PathBuf, mount: PathBuf) -> Option<Share> {
        let python = python()?;
        for folder in [&back, &mount] {
            fs::create_dir_all(folder).unwrap();
        }
        let mut share = Share { python, back, mount, server: None };
        share.serve();
        Some(share)
    }

    /// Mounts the share (again).
    pub fn serve(&mut self) {
        assert!(self.server.is_none(), "the share is served already");
        let mut command = Command::new(self.python);
        command.arg(SERVER).arg(&self.back).arg(&self.mount).arg(self.fault());
        command.stdin(Stdio::null());
        self.server = Some(command.spawn().unwrap());
        wait("the share", || is_mounted(&self.mount));
    }

    /// Another machine's write: the export appears whole under its name.
    pub fn write_remotely(&self, name: &str, bytes: &[u8]) {
        fs::write(self.back.join(name), bytes).unwrap();
    }

    /// What the other machines see.
    pub fn back(&self) -> &Path {
        &self.back
    }

    /// Every call waits for as long as the stall lives. To be made after the station, so that it
    /// ends before it: a process that waits for a share cannot be killed.
    pub fn stall(&self) -> Stall {
        let server = Pid::from_child(self.server.as_ref().expect("a server"));
        kill_process(server, Signal::STOP).unwrap();
        Stall { server }
    }

    /// Where it stands with which error calls fail.
    fn fault(&self) -> PathBuf {
        self.back.with_extension("fault")
    }

    /// Calls fail with this error: `EIO` all of them, any other those that write.
    pub fn fail(&self, error: &str) -> Failure {
        let fault = self.fault();
        let spare = fault.with_extension("spare");
        fs::write(&spare, error).unwrap();
        fs::rename(spare, &fault).unwrap();
        Failure { fault }
    }

    /// The server dies: every call fails with ENOTCONN.
    pub fn die(&mut self) {
        let mut server = self.server.take().expect("a server");
        server.kill().unwrap();
        server.wait().unwrap();
    }

    /// Brings a dead share back.
    pub fn revive(&mut self) {
        self.unmount();
        self.serve();
    }

    /// Takes the share away as `umount -l` does: the empty folder below appears.
    pub fn unmount_lazily(&mut self) {
        self.unmount();
        // The server ends by itself once nobody uses the mount any more, which may be never.
        if self.server.is_some() {
            self.die();
        }
    }

    fn unmount(&self) {
        let done = Command::new("umount").arg("-l").arg(&self.mount).status().unwrap();
        assert!(done.success(), "umount: {done}");
        wait("the unmounting", || !is_mounted(&self.mount));
    }
}

impl Drop for Share {
    /// A test that fails leaves nothing mounted.
    fn drop(&mut self) {
        if let Some(mut server) = self.server.take() {
            let _ = server.kill();
            let _ = server.wait();
        }
        if is_mounted(&self.mount) {
            let _ = Command::new("umount").arg("-l").arg(&self.mount).status();
        }
    }
}

/// An interpreter that can serve a share, if this machine can have one at all.
fn python() -> Option<&'static str> {
    if !rustix::process::geteuid().is_root() || !Path::new("/dev/fuse").exists() {
        println!("a mock share needs root and /dev/fuse");
        return None;
    }
    let can_serve = |python: &&str| {
        let mut command = Command::new(python);
        command.args(["-c", IMPORT]).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    };
    let found = PYTHONS.into_iter().find(can_serve);
    if found.is_none() {
        println!("a mock share needs the packages python3-fusepy, libfuse2 and fuse3");
    }
    found
}

/// Whether something is mounted there; asks the kernel, never the share.
pub fn is_mounted(path: &Path) -> bool {
    let path = path.to_str().expect("a path of plain letters");
    let mounts = fs::read_to_string("/proc/self/mountinfo").unwrap();
    mounts.lines().any(|line| line.split(' ').nth(4) == Some(path))
}

fn wait(what: &str, mut holds: impl FnMut() -> bool) {
    let deadline = Instant::now() + PATIENCE;
    while !holds() {
        assert!(Instant::now() < deadline, "{what} never came");
        sleep(Duration::from_millis(10));
    }
}

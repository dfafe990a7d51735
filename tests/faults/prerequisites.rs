//! What the ignored tests here need of a machine. `.ci/run` asks before it runs them, and says which it
//! leaves out; asked for by hand, a test fails where that is missing.

#![allow(clippy::unwrap_used)]

use rig::faults::{disk, share, tracer};

#[test]
#[ignore = "a question of .ci/run: can programs be traced?"]
fn tracing() {
    assert!(tracer::can_trace());
}

#[test]
#[ignore = "a question of .ci/run: can disks be made and cut off?"]
fn disks() {
    assert!(disk::can_be_cut());
}

#[test]
#[ignore = "a question of .ci/run: can a share be served and mounted?"]
fn shares() {
    let at = tempfile::TempDir::new().unwrap();
    assert!(share::Share::mount(at.path().join("back"), at.path().join("share")).is_some());
}

#[test]
#[ignore = "a question of .ci/run: can a file system be mounted, and the kernel be set?"]
fn mounting() {
    let place = tempfile::TempDir::new().unwrap();
    assert!(super::root::Overlay::mount(place.path().to_owned()).is_some());
    assert!(super::flood::ShortQueue::new(16).is_some());
}

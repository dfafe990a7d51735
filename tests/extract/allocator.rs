//! `gaiter extract` measures with the allocator's settings of the station.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};

use support::mesh::Mesh;
use tempfile::TempDir;

/// The environment of `gaiter extract` while it prints a record, which does not fit into a pipe.
fn environment_while_it_measures(folder: &Path, name: &str, value: Option<&str>) -> String {
    let mut command = Command::new(rig::verb::program());
    command.current_dir(folder).args(["extract", "--json", "a.obj"]).stdout(Stdio::piped());
    match value {
        Some(value) => command.env(name, value),
        None => command.env_remove(name),
    };
    let mut gaiter = command.spawn().unwrap();
    let mut out = gaiter.stdout.take().unwrap();
    out.read_exact(&mut [0]).unwrap();
    let environment = fs::read_to_string(format!("/proc/{}/environ", gaiter.id())).unwrap();
    out.read_to_end(&mut Vec::new()).unwrap();
    assert!(gaiter.wait().unwrap().success());
    environment
}

#[test]
fn the_allocator_has_its_settings_unless_a_person_gave_others() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("a.obj"), Mesh::mannequin().obj()).unwrap();
    let name = "GLIBC_TUNABLES";
    let own = environment_while_it_measures(folder.path(), name, None);
    assert!(own.contains("GLIBC_TUNABLES=glibc.malloc."), "{own}");
    let given = environment_while_it_measures(folder.path(), name, Some(""));
    assert!(given.contains("GLIBC_TUNABLES=\0"), "{given}");
}

//! Whether the system service may use the folders and servers that the configuration names. The station runs in a
//! sandbox of systemd, which `gaiter check` does not, so what passes here may fail there.

mod network;

use std::path::{Path, PathBuf};
use std::process::Command;

use super::row::{Row, Verdict};
use crate::config::{AfterOrder, Config};

/// The service of the package.
const SERVICE: &str = "gaiter.service";

/// The properties that decide.
const PROPERTIES: &str = "LoadState,ExecStart,StateDirectory,ReadWritePaths,ProtectSystem,\
    ProtectHome,PrivateTmp,PrivateNetwork,RestrictAddressFamilies,IPAddressAllow,IPAddressDeny";

/// The folders of `ProtectHome`.
const HOMES: [&str; 3] = ["/home", "/root", "/run/user"];

/// The folders of `PrivateTmp`.
const TEMPORARY: [&str; 2] = ["/tmp", "/var/tmp"];

/// A row for each folder or server that the service may not use as it has to. None if there is no such service, or
/// if it runs with another configuration.
pub(super) fn rows(file: &Path, config: &Config) -> Vec<Row> {
    let Some(shown) = systemctl(&["show", SERVICE, "--property", PROPERTIES]) else {
        return Vec::new();
    };
    let unit = Unit::new(&shown);
    if !unit.runs_with(file) {
        return Vec::new();
    }
    let exports = config.scanner.export_dirs.iter().map(|folder| (folder, Need::Read));
    let orders = config.patient.orders.as_ref().map(|orders| match orders.after {
        AfterOrder::Delete => (&orders.path, Need::Write),
        AfterOrder::Keep => (&orders.path, Need::Read),
    });
    let written = [
        Some(&config.station.state_dir),
        Some(&config.store.folder.path),
        config.store.copy.as_ref().map(|copy| &copy.path),
        config.store.gdt.as_ref().map(|gdt| &gdt.path),
        config.store.hl7.as_ref().and_then(|hl7| hl7.way.folder()),
    ];
    let written = written.into_iter().flatten().map(|folder| (folder, Need::Write));
    let refused = exports.chain(orders).chain(written).filter_map(|(folder, need)| {
        let why = unit.refuses(folder, need)?;
        Some(Row::at("service", folder.display(), Verdict::Fail, why))
    });
    // Credentials are not among the properties that systemctl prints.
    let files = systemctl(&["cat", SERVICE]).unwrap_or_default();
    let servers = network::rows(&unit, config).into_iter();
    refused.chain(servers).chain(network::credentials(&files, config)).collect()
}

/// The output of `systemctl`; `None` where there is no systemd.
fn systemctl(arguments: &[&str]) -> Option<String> {
    let asked = Command::new("systemctl").args(arguments).output();
    let answer = asked.ok().filter(|answer| answer.status.success())?;
    String::from_utf8(answer.stdout).ok()
}

/// What the station does with a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Need {
    Read,
    Write,
}

/// The properties of a unit.
struct Unit<'a>(Vec<(&'a str, &'a str)>);

impl<'a> Unit<'a> {
    fn new(shown: &'a str) -> Unit<'a> {
        Unit(shown.lines().filter_map(|line| line.split_once('=')).collect())
    }

    fn get(&self, property: &str) -> &'a str {
        self.0.iter().find(|(name, _)| *name == property).map_or("", |(_, value)| value)
    }

    fn runs_with(&self, config: &Path) -> bool {
        let mut words = self.get("ExecStart").split_whitespace();
        self.get("LoadState") == "loaded" && words.any(|word| Path::new(word) == config)
    }

    /// Why the service cannot use a folder, and what to do; `None` if it can.
    fn refuses(&self, folder: &Path, need: Need) -> Option<String> {
        let in_one_of = |places: &[&str]| places.iter().any(|place| folder.starts_with(place));
        let is_on = |property| !matches!(self.get(property), "" | "no");
        for (property, places) in [("ProtectHome", &HOMES[..]), ("PrivateTmp", &TEMPORARY[..])] {
            if is_on(property) && in_one_of(places) {
                return Some(format!("cannot be seen by gaiter.service ({property}); move it"));
            }
        }
        if need == Need::Read || self.get("ProtectSystem") != "strict" || self.may_write(folder) {
            return None;
        }
        Some(format!(
            "cannot be written by gaiter.service: systemctl edit gaiter, with the lines [Service] and \
             ReadWritePaths=-{}, then systemctl restart gaiter",
            folder.display()
        ))
    }

    fn may_write(&self, folder: &Path) -> bool {
        let named = self.get("ReadWritePaths").split_whitespace();
        let named = named.map(|path| PathBuf::from(path.trim_start_matches(['-', '+'])));
        let state = self.get("StateDirectory").split_whitespace();
        let state = state.map(|name| Path::new("/var/lib").join(name));
        named.chain(state).any(|path| folder.starts_with(path))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHIPPED: &str = "LoadState=loaded\n\
        ExecStart={ path=/usr/bin/gaiter ; argv[]=/usr/bin/gaiter run --config /etc/gaiter/station.toml ; }\n\
        StateDirectory=gaiter\nReadWritePaths=-/srv/records +/data/legs\nProtectSystem=strict\n\
        ProtectHome=yes\nPrivateTmp=yes\n";

    fn refused(folder: &str, need: Need) -> Option<String> {
        Unit::new(SHIPPED).refuses(Path::new(folder), need)
    }

    #[test]
    fn the_shipped_service_writes_its_state_and_the_folders_it_is_given() {
        for folder in ["/var/lib/gaiter", "/srv/records", "/srv/records/more", "/data/legs"] {
            assert_eq!(refused(folder, Need::Write), None, "{folder}");
        }
        for folder in ["/srv/records2", "/var/lib/other", "/data", "/mnt/share"] {
            let why = refused(folder, Need::Write).unwrap();
            assert!(why.contains(&format!("ReadWritePaths=-{folder},")), "{why}");
        }
        assert_eq!(refused("/mnt/share", Need::Read), None);
    }

    #[test]
    fn what_is_hidden_from_a_service_cannot_even_be_read() {
        for folder in
            ["/home/scanner/export", "/root/x", "/run/user/1000", "/tmp/export", "/var/tmp"]
        {
            assert!(refused(folder, Need::Read).is_some(), "{folder}");
        }
    }

    #[test]
    fn a_service_without_a_sandbox_refuses_nothing() {
        let unit = Unit::new("LoadState=loaded\nProtectSystem=no\nProtectHome=no\nPrivateTmp=no\n");
        assert_eq!(unit.refuses(Path::new("/home/x"), Need::Write), None);
    }

    #[test]
    fn only_the_service_of_this_configuration_is_looked_at() {
        let unit = Unit::new(SHIPPED);
        assert!(unit.runs_with(Path::new("/etc/gaiter/station.toml")));
        assert!(!unit.runs_with(Path::new("/tmp/other.toml")));
        let text = SHIPPED.replace("=loaded", "=not-found");
        assert!(!Unit::new(&text).runs_with(Path::new("/etc/gaiter/station.toml")));
    }
}

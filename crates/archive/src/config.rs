//! `archive.toml`: where database and bucket are.

use std::fs;
use std::io;
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::thread;

use gaiter_https::{BucketPlace, Endpoint, EndpointFault, Secret, TlsFiles, is_this_machine};
use gaiter_toml::{Absent, Reader, What, or_none, utf8};
use http::Uri;
use toml::de::DeTable;

/// The configuration.
#[derive(Debug, Clone)]
pub struct ArchiveConfig {
    pub database: DatabasePlace,
    pub objects: BucketPlace,
    /// `[objects]`: which authorities are trusted.
    pub objects_tls: TlsFiles,
    /// `[work]`: how many scans are measured at a time.
    pub processes: usize,
}

/// Where the database is, and who asks.
#[derive(Debug, Clone)]
pub struct DatabasePlace {
    /// A host, or the full path of the folder with its socket.
    pub host: String,
    pub port: u16,
    pub name: String,
    /// The role.
    pub user: String,
    /// Its password; `None` where the socket says who asks.
    pub password: Option<Secret>,
    /// Which authorities are trusted.
    pub tls: TlsFiles,
}

impl DatabasePlace {
    /// Whether the connection must be encrypted: all but those that stay on this machine.
    pub fn is_encrypted(&self) -> bool {
        !self.host.starts_with('/') && !is_this_machine(&self.host)
    }
}

pub type FileFault = gaiter_toml::Fault<What>;

/// Why there is no configuration.
#[derive(Debug, thiserror::Error)]
pub enum ConfigFault {
    /// The file cannot be read.
    #[error("{}", path.display())]
    Unreadable { path: PathBuf, source: io::Error },
    #[error("the configuration has faults:\n{}", lines(.0))]
    Faults(Vec<FileFault>),
}

fn lines(faults: &[FileFault]) -> String {
    faults.iter().map(|fault| format!("{fault:#}")).collect::<Vec<_>>().join("\n")
}

/// Reads the configuration.
///
/// # Errors
/// See [`ConfigFault`].
pub fn read(path: &Path) -> Result<ArchiveConfig, ConfigFault> {
    let bytes = fs::read(path)
        .map_err(|source| ConfigFault::Unreadable { path: path.to_owned(), source })?;
    let loaded = utf8(&bytes).map_err(|fault| vec![fault]).and_then(load);
    loaded.map_err(|mut faults| {
        faults.iter_mut().for_each(|fault| fault.file = path.display().to_string());
        ConfigFault::Faults(faults)
    })
}

fn load(text: &str) -> Result<ArchiveConfig, Vec<FileFault>> {
    let (root, errors) = DeTable::parse_recoverable(text);
    let mut reader = Reader::new(text, root.get_ref(), &errors, &[]);
    let found = keys(&mut reader);
    let faults = reader.finish();
    match found {
        Some(config) if faults.is_empty() => Ok(config),
        _ => Err(faults),
    }
}

fn keys(reader: &mut Reader<'_, What>) -> Option<ArchiveConfig> {
    use Absent::Required;
    let host = reader.value("database.host", "/run/postgresql", word);
    let port = reader.value("database.port", "5432", port);
    let name = reader.value("database.name", "gaiter_archive", word);
    let user = reader.value("database.user", "gaiter-archive", word);
    let password = reader.value("database.password", "", or_none(secret));
    let authorities = reader.value("database.authorities", "", or_none(full_path));
    let address = reader.text("objects.address", Required("https://s3.clinic.example"), address);
    let bucket = reader.text("objects.bucket", Required("gaiter-archive"), word);
    let region = reader.value("objects.region", "us-east-1", word);
    let key_id = reader.text("objects.key_id", Required("GK31c2f2"), word);
    let key = reader.text("objects.key", Required("credential:archive-key"), secret);
    let trusted = reader.value("objects.authorities", "", or_none(full_path));
    let processes = reader.value("work.processes", "cores", processes);
    let tls = |authorities| TlsFiles { authorities, own: None };
    Some(ArchiveConfig {
        database: DatabasePlace {
            host: host?,
            port: port?,
            name: name?,
            user: user?,
            password: password?,
            tls: tls(authorities?),
        },
        objects: BucketPlace {
            address: address?.value,
            bucket: bucket?.value,
            region: region?,
            key_id: key_id?.value,
            secret: key?.value,
        },
        objects_tls: tls(trusted?),
        processes: processes?,
    })
}

/// A text that goes into addresses and connections as it is.
fn word(text: &str) -> Result<String, What> {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_./:".contains(&byte);
    match !text.is_empty() && text.bytes().all(is_plain) {
        true => Ok(text.to_owned()),
        false => Err(What::not_a(text, "a name", "write letters, digits, -, _, ., / and :")),
    }
}

fn port(text: &str) -> Result<u16, What> {
    let port = text.parse().ok().filter(|port| *port > 0);
    port.ok_or_else(|| {
        What::not_a(text, "a port", "write a number from 1 to 65535 in quotes: \"5432\"")
    })
}

fn secret(text: &str) -> Result<Secret, What> {
    let hint = "write the full path of a file, or \"credential:NAME\"";
    Secret::at(text).ok_or_else(|| What::not_a(text, "the place of a secret", hint))
}

fn full_path(text: &str) -> Result<PathBuf, What> {
    let path = Path::new(text);
    match path.is_absolute() {
        true => Ok(path.to_owned()),
        false => Err(What::not_a(text, "a full path", "begin with /")),
    }
}

fn address(text: &str) -> Result<String, What> {
    let base = text.trim_end_matches('/');
    let of = |hint| What::not_a(text, "the address of a server", hint);
    let uri: Uri = base.parse().map_err(|_| of("write \"https://s3.clinic.example\""))?;
    if uri.path().len() > 1 || uri.query().is_some() {
        return Err(of("write it without a path: the bucket has a key of its own"));
    }
    match Endpoint::from_uri(&uri) {
        Ok(_) => Ok(base.to_owned()),
        Err(EndpointFault::NotEncrypted) => {
            Err(of("write https: http is for a server on this machine only"))
        }
        Err(EndpointFault::Address) => Err(of("write \"https://s3.clinic.example\"")),
    }
}

fn processes(text: &str) -> Result<usize, What> {
    let count = match text {
        "cores" => Some(thread::available_parallelism().map_or(1, NonZero::get)),
        text => text.parse().ok().filter(|count| (1..=1024).contains(count)),
    };
    count.ok_or_else(|| What::not_a(text, "a number of processes", "write \"cores\" or 1 to 1024"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEAST: &str = "[objects]\naddress = \"https://s3.clinic.example/\"\nbucket = \"a\"\n\
                         key_id = \"k\"\nkey = \"credential:archive-key\"\n";

    #[test]
    fn three_keys_and_a_secret_are_enough() {
        let config = load(LEAST).unwrap();
        assert_eq!(config.objects.address, "https://s3.clinic.example");
        assert!(!config.database.is_encrypted());
        let far = load(&format!("{LEAST}[database]\nhost = \"db.clinic.example\"\n")).unwrap();
        assert!(far.database.is_encrypted());
    }

    #[test]
    fn the_shipped_file_has_every_key_with_its_default() {
        let shipped = load(include_str!("../../../systemd/archive/archive.toml")).unwrap();
        let usual = load(LEAST).unwrap();
        assert_eq!(format!("{:?}", shipped.database), format!("{:?}", usual.database));
        assert_eq!(shipped.processes, usual.processes);
    }

    #[test]
    fn all_faults_are_told_at_once() {
        let text = LEAST.replace("https", "http").replace("credential:", "");
        let faults = load(&format!("{text}[database]\nport = \"0\"\nhosts = \"x\"\n")).unwrap_err();
        let keys: Vec<&str> = faults.iter().map(|fault| fault.key.as_str()).collect();
        assert_eq!(keys, ["objects.address", "objects.key", "database.port", "database.hosts"]);
    }
}

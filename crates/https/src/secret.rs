//! Secrets: a password, a token or a key in a file of its own, or a credential of systemd; never in the
//! configuration, in an argument or in a log.

use std::env;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::endpoint::Secret;

/// The folder in which systemd puts the credentials of a service.
const CREDENTIALS: &str = "CREDENTIALS_DIRECTORY";

/// The longest secret, bytes: a key of 4096 bits as PEM has 3300.
const BYTES_MOST: u64 = 64 * 1024;

/// Why a secret cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum SecretFault {
    #[error("{}: {source}", path.display())]
    Unreadable { path: PathBuf, source: io::Error },
    /// The service has no credentials.
    #[error("there is no credential \"{0}\", because systemd has given none: LoadCredential={0}:…")]
    NoCredentials(String),
    /// It is empty, too long, or no text.
    #[error("{}: it holds no secret: a line of text, or a key as PEM", .0.display())]
    NotASecret(PathBuf),
}

/// Reads a secret. A file may be renewed while the station runs.
///
/// # Errors
/// See [`SecretFault`]; none contains what is in the file.
pub fn read(secret: &Secret) -> Result<String, SecretFault> {
    let path = path(secret)?;
    let unreadable = |source| SecretFault::Unreadable { path: path.clone(), source };
    if fs::metadata(&path).map_err(unreadable)?.len() > BYTES_MOST {
        return Err(SecretFault::NotASecret(path));
    }
    let bytes = fs::read(&path).map_err(unreadable)?;
    let text = String::from_utf8(bytes).map_err(|_| SecretFault::NotASecret(path.clone()))?;
    let text = text.trim_end_matches(['\n', '\r']);
    match text.is_empty() {
        true => Err(SecretFault::NotASecret(path)),
        false => Ok(text.to_owned()),
    }
}

/// The file that a secret is in.
///
/// # Errors
/// If it is a credential, and systemd has given none.
pub fn path(secret: &Secret) -> Result<PathBuf, SecretFault> {
    match secret {
        Secret::File(path) => Ok(path.clone()),
        Secret::Credential(name) => {
            let folder = env::var_os(CREDENTIALS);
            let folder = folder.ok_or_else(|| SecretFault::NoCredentials(name.clone()))?;
            Ok(Path::new(&folder).join(name))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_secret_is_read_without_its_line_end_and_anew_each_time() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("token");
        let secret = Secret::File(path.clone());
        assert!(matches!(read(&secret), Err(SecretFault::Unreadable { .. })));
        fs::write(&path, "abc\r\n").unwrap();
        assert_eq!(read(&secret).unwrap(), "abc");
        fs::write(&path, "def").unwrap();
        assert_eq!(read(&secret).unwrap(), "def");
    }

    #[test]
    fn what_holds_no_secret_is_told_without_its_content() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("token");
        for bytes in [&b"\n"[..], b"", b"\xff\xfe", &[b'x'; 70_000]] {
            fs::write(&path, bytes).unwrap();
            let fault = read(&Secret::File(path.clone())).unwrap_err();
            assert!(matches!(fault, SecretFault::NotASecret(_)), "{fault}");
        }
    }
}

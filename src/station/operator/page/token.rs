//! The token that is needed to decide on the page: a file in the state folder, for the station's user
//! only, like the control socket.

use std::fs::File;
use std::hint::black_box;
use std::io::{self, Read};
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use axum::http::{HeaderMap, header};
use gaiter_record::{hex, sha256};
use rustix::fs::{Mode, OFlags, open};
use rustix::io::Errno;
use tracing::{info, warn};

use crate::store::{OTHERS, durable};

/// The token's file in the state folder.
pub const FILE: &str = "page-token";

/// The system's random source, which never ends and is fit for secrets.
const RANDOM: &str = "/dev/urandom";

/// The length of a token: 256 bits cannot be guessed.
const BYTES: usize = 32;

/// More than a token's file holds, in bytes.
const LONGEST: u64 = 1024;

/// The cookie that only allows reading, for pages and files that a browser opens by itself.
const COOKIE: &str = "gaiter-reader";

/// The station's token, and the word for reading that is derived from it.
pub struct Token {
    word: String,
    reading: String,
}

/// A token must never be printed, least of all in a log.
impl std::fmt::Debug for Token {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Token")
    }
}

impl Token {
    /// The token of this state folder; created if it is missing or malformed, or if somebody else may have
    /// written or read it.
    ///
    /// # Errors
    /// If its file can be neither read nor created.
    pub fn take(state_dir: &Path) -> io::Result<Token> {
        if let Some(word) = kept(&state_dir.join(FILE))? {
            return Ok(Token::from_word(&word));
        }
        let mut random = [0_u8; BYTES];
        File::open(RANDOM)?.read_exact(&mut random)?;
        let word = hex(&random);
        durable::replace_file(state_dir, FILE, format!("{word}\n").as_bytes())?;
        Ok(Token::from_word(&word))
    }

    /// Replaces the token of this state folder with a new one.
    ///
    /// # Errors
    /// As for [`Token::take`].
    pub fn renew(state_dir: &Path) -> io::Result<Token> {
        durable::remove_file(&state_dir.join(FILE))?;
        info!(event = "page-token-renewed");
        Token::take(state_dir)
    }

    fn from_word(word: &str) -> Token {
        let reading = sha256(format!("reading with {word}").as_bytes());
        Token { word: word.to_owned(), reading }
    }

    /// The token itself, for the link.
    pub fn word(&self) -> &str {
        &self.word
    }

    /// The cookie that allows reading. Cookies are sent to every port of this machine, so it is not the
    /// token and cannot decide anything.
    pub fn cookie(&self) -> String {
        format!("{COOKIE}={}; Path=/; HttpOnly; SameSite=Strict", self.reading)
    }

    /// Whether a request shows the token.
    pub fn is_shown_in(&self, headers: &HeaderMap) -> bool {
        let shown = headers.get(header::AUTHORIZATION).and_then(|value| value.to_str().ok());
        shown.and_then(|shown| shown.strip_prefix("Bearer ")).is_some_and(|it| same(it, &self.word))
    }

    /// Whether a request has the cookie.
    pub fn is_read_with(&self, headers: &HeaderMap) -> bool {
        let lines = headers.get_all(header::COOKIE).into_iter();
        let pairs = lines.filter_map(|line| line.to_str().ok()).flat_map(|line| line.split(';'));
        let mut values =
            pairs.filter_map(|pair| pair.trim().strip_prefix(COOKIE)?.strip_prefix('='));
        values.any(|value| same(value, &self.reading))
    }
}

/// The token that lies there; `None` if it is half a token, or lies not in a file of one name that only this user may
/// use.
fn kept(path: &Path) -> io::Result<Option<String>> {
    let refused = || {
        warn!(event = "page-token-refused");
        Ok(None)
    };
    // A link leads to a file that somebody else chose, and a pipe would never answer.
    let flags = OFlags::RDONLY | OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::CLOEXEC;
    let file = match open(path, flags, Mode::empty()) {
        Ok(file) => File::from(file),
        Err(Errno::NOENT) => return Ok(None),
        Err(Errno::LOOP | Errno::ACCESS | Errno::NXIO) => return refused(),
        Err(error) => return Err(error.into()),
    };
    let found = file.metadata()?;
    let is_own = found.uid() == rustix::process::geteuid().as_raw();
    if !found.is_file() || !is_own || found.mode() & OTHERS != 0 || found.nlink() != 1 {
        return refused();
    }
    let mut bytes = Vec::new();
    file.take(LONGEST).read_to_end(&mut bytes)?;
    let text = String::from_utf8_lossy(&bytes);
    let word = text.trim();
    Ok(is_one(word).then(|| word.to_owned()))
}

fn is_one(text: &str) -> bool {
    text.len() == 2 * BYTES && text.bytes().all(|byte| byte.is_ascii_hexdigit())
}

/// Whether two words are the same, in a time that does not reveal how far they agree.
fn same(a: &str, b: &str) -> bool {
    let differ = a.bytes().zip(b.bytes()).fold(0, |differ, (a, b)| black_box(differ | (a ^ b)));
    a.len() == b.len() && differ == 0
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::os::unix::fs::{PermissionsExt, chown, symlink};

    use rustix::fs::{CWD, mkfifoat};

    use super::*;

    fn headers(name: header::HeaderName, value: &str) -> HeaderMap {
        HeaderMap::from_iter([(name, value.parse().unwrap())])
    }

    #[test]
    fn a_token_is_made_once_for_its_owner_only_and_is_never_shown() {
        let dir = tempfile::tempdir().unwrap();
        let token = Token::take(dir.path()).unwrap();
        assert!(is_one(token.word()));
        let mode = fs::metadata(dir.path().join(FILE)).unwrap().mode();
        assert_eq!(mode & 0o777, 0o600);
        assert_eq!(Token::take(dir.path()).unwrap().word(), token.word());
        assert_eq!(format!("{token:?}"), "Token");
        let other = tempfile::tempdir().unwrap();
        assert_ne!(Token::take(other.path()).unwrap().word(), token.word());
    }

    fn write(path: &Path, text: &str, mode: u32) {
        fs::write(path, text).unwrap();
        fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
    }

    #[test]
    fn half_a_token_is_made_anew_and_a_whole_one_is_kept() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join(FILE);
        for half in [b"ab12\n".as_slice(), b"", b"\xff\xfe"] {
            fs::write(&path, half).unwrap();
            fs::set_permissions(&path, fs::Permissions::from_mode(0o600)).unwrap();
            assert!(is_one(Token::take(dir.path()).unwrap().word()));
        }
        let word = "ab".repeat(BYTES);
        write(&path, &word, 0o600);
        assert_eq!(Token::take(dir.path()).unwrap().word(), word);
    }

    #[test]
    fn a_token_that_somebody_else_may_have_written_or_read_is_made_anew() {
        /// Puts a token, the second path, in the place of the station's, the first.
        type Plant = fn(&Path, &Path);
        let word = "ab".repeat(BYTES);
        let plants: [(&str, Plant); 6] = [
            ("open to others", |at, word| write(at, &fs::read_to_string(word).unwrap(), 0o644)),
            ("open to a group", |at, word| write(at, &fs::read_to_string(word).unwrap(), 0o620)),
            ("a link", |at, word| symlink(word, at).unwrap()),
            ("a second name", |at, word| fs::hard_link(word, at).unwrap()),
            ("a pipe", |at, _| mkfifoat(CWD, at, Mode::RUSR | Mode::WUSR).unwrap()),
            ("another user's", |at, word| {
                write(at, &fs::read_to_string(word).unwrap(), 0o600);
                // Only root can give a file away.
                if chown(at, Some(65_534), None).is_err() {
                    fs::remove_file(at).unwrap();
                }
            }),
        ];
        for (what, plant) in plants {
            let dir = tempfile::tempdir().unwrap();
            let (path, elsewhere) = (dir.path().join(FILE), dir.path().join("elsewhere"));
            write(&elsewhere, &word, 0o600);
            plant(&path, &elsewhere);
            let token = Token::take(dir.path()).unwrap();
            assert!(is_one(token.word()) && token.word() != word, "{what}");
            let made = fs::symlink_metadata(&path).unwrap();
            assert!(made.is_file(), "{what}");
            assert_eq!((made.mode() & 0o777, made.nlink()), (0o600, 1), "{what}");
            assert_eq!(fs::read_to_string(&elsewhere).unwrap(), word, "{what}");
            assert_eq!(Token::take(dir.path()).unwrap().word(), token.word(), "{what}");
        }
    }

    #[test]
    fn only_the_whole_token_counts_and_the_cookie_is_another_word() {
        let word = "ab".repeat(BYTES);
        let token = Token::from_word(&word);
        let bearer = |text: &str| headers(header::AUTHORIZATION, text);
        assert!(token.is_shown_in(&bearer(&format!("Bearer {word}"))));
        for wrong in ["", "Bearer ", "Bearer ab", &word, &format!("Bearer {word}0")] {
            assert!(!token.is_shown_in(&bearer(wrong)), "{wrong}");
        }
        let cookie = token.cookie();
        let cookie = cookie.split(';').next().unwrap();
        assert!(!cookie.contains(&word));
        assert!(token.is_read_with(&headers(header::COOKIE, &format!("a=b; {cookie}"))));
        assert!(!token.is_read_with(&headers(header::COOKIE, &format!("{COOKIE}={word}"))));
        assert!(!token.is_shown_in(&headers(header::COOKIE, cookie)));
        let reading = cookie.split_once('=').unwrap().1;
        assert!(!token.is_shown_in(&bearer(&format!("Bearer {reading}"))), "it is for reading");
    }
}

//! The exit codes of the verbs, after `sysexits.h`.

use std::io::{self, ErrorKind};
use std::process::ExitCode;

use crate::config::ConfigError;
use crate::config::sizes::beside::NoFiles;

/// The exit of a verb. Later variants are worse, so the worst of several is their `max`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Exit {
    /// Success.
    Done = 0,
    /// The command line is wrong.
    Usage = 64,
    /// A scan cannot be measured, or a file with a size table or garment has faults.
    Unmeasurable = 65,
    /// A named file does not exist.
    NoFile = 66,
    /// A fault of gaiter itself.
    Internal = 70,
    /// Reading, writing or the folders around the station failed.
    Io = 74,
    /// The configuration has faults.
    Config = 78,
}

impl Exit {
    /// The exit code of the process.
    pub fn code(self) -> u8 {
        self as u8
    }
}

/// The exit of a verb that cannot read a file or folder that it was given.
impl From<&io::Error> for Exit {
    fn from(error: &io::Error) -> Exit {
        match error.kind() {
            ErrorKind::NotFound => Exit::NoFile,
            _ => Exit::Io,
        }
    }
}

/// The exit of a verb that has no usable configuration.
impl From<&ConfigError> for Exit {
    fn from(error: &ConfigError) -> Exit {
        match error {
            ConfigError::Faults { .. } => Exit::Config,
            ConfigError::Unreadable { source, .. } => Exit::from(source),
        }
    }
}

impl From<&NoFiles> for Exit {
    fn from(why: &NoFiles) -> Exit {
        match why {
            NoFiles::Io { source, .. } => Exit::from(source),
            _ => Exit::Unmeasurable,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(exit.code())
    }
}

#[cfg(test)]
mod tests {
    use super::Exit;

    #[test]
    fn the_codes_are_those_of_the_contract_and_the_largest_is_the_worst() {
        let all = [
            (Exit::Done, 0),
            (Exit::Usage, 64),
            (Exit::Unmeasurable, 65),
            (Exit::NoFile, 66),
            (Exit::Internal, 70),
            (Exit::Io, 74),
            (Exit::Config, 78),
        ];
        for (exit, code) in all {
            assert_eq!(exit.code(), code);
        }
        assert!(all.is_sorted());
    }
}

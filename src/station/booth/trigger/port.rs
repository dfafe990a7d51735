//! What every port of the booth is, real or played.

use std::io;
use std::time::Duration;

use crate::flow::trigger::{FaultKind, Input, PortFault};

/// A port that was opened; dropping it closes it.
pub trait Port {
    /// What it gives next; [`Input::Nothing`] where that takes longer than `timeout`.
    ///
    /// # Errors
    /// Any fault means that the port is lost: close it and look for it again.
    fn read(&mut self, timeout: Duration) -> Result<Input, PortFault>;

    /// Says something at the booth.
    ///
    /// # Errors
    /// Where it could not be said. The port may give presses all the same.
    fn write(&mut self, bytes: &[u8]) -> Result<(), PortFault>;

    /// Whether it is still the port that its name means: one that was pulled out may be silent for
    /// ever, and another may have its name by now.
    ///
    /// # Errors
    /// [`FaultKind::Absent`] where it is not.
    fn is_in_place(&mut self) -> Result<(), PortFault>;
}

/// Where a port is looked for.
pub trait PortOpener: Send {
    /// Finds and opens it.
    ///
    /// # Errors
    /// It is absent, busy, denied or does not work.
    fn open(&mut self) -> Result<Box<dyn Port>, PortFault>;
}

/// A fault of this kind.
pub fn fault(kind: FaultKind, why: impl Into<String>) -> PortFault {
    PortFault { kind, why: why.into() }
}

/// A fault that the system gave.
pub fn of_io(error: &io::Error) -> PortFault {
    use io::ErrorKind;
    use rustix::io::Errno;
    let errno = error.raw_os_error().map(Errno::from_raw_os_error);
    let kind = match (error.kind(), errno) {
        (ErrorKind::NotFound | ErrorKind::BrokenPipe, _)
        | (_, Some(Errno::NODEV | Errno::NXIO)) => FaultKind::Absent,
        (ErrorKind::PermissionDenied, _) => FaultKind::Denied,
        (ErrorKind::ResourceBusy | ErrorKind::WouldBlock, _) => FaultKind::Busy,
        _ => FaultKind::Failed,
    };
    fault(kind, error.to_string())
}

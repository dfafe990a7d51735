//! What every port of the booth provides, real or simulated.

use std::io;
use std::time::Duration;

use gaiter_flow::cause::Cause;
use gaiter_flow::trigger::{Input, PortFault, PortFaultKind};

/// An open port; dropping it closes it.
pub trait Port {
    /// Its next input; [`Input::Nothing`] if none comes within `timeout`.
    ///
    /// # Errors
    /// Any fault means that the port is lost: close it and look for it again.
    fn read(&mut self, timeout: Duration) -> Result<Input, PortFault>;

    /// Writes to the device at the booth, if it shows anything.
    ///
    /// # Errors
    /// If it could not be written. The port may still deliver presses.
    fn write(&mut self, _bytes: &[u8]) -> Result<(), PortFault> {
        Ok(())
    }

    /// Checks that it is still the port that its name refers to. An unplugged port may stay silent
    /// forever, and another port may have its name by now. Where every read of an unplugged one fails, there
    /// is nothing to check.
    ///
    /// # Errors
    /// [`PortFaultKind::Absent`] if it is not.
    fn is_in_place(&mut self) -> Result<(), PortFault> {
        Ok(())
    }
}

/// Finds a port.
pub trait PortOpener: Send {
    /// Finds and opens it.
    ///
    /// # Errors
    /// It is absent, busy, denied or does not work.
    fn open(&mut self) -> Result<Box<dyn Port>, PortFault>;
}

/// A fault of this kind.
pub fn fault(kind: PortFaultKind, why: impl Into<Cause>) -> PortFault {
    PortFault { kind, why: why.into() }
}

/// Converts an I/O error of the system.
pub fn of_io(error: &io::Error) -> PortFault {
    use io::ErrorKind;
    use rustix::io::Errno;
    let errno = error.raw_os_error().map(Errno::from_raw_os_error);
    let kind = match (error.kind(), errno) {
        (ErrorKind::NotFound | ErrorKind::BrokenPipe, _)
        | (_, Some(Errno::NODEV | Errno::NXIO)) => PortFaultKind::Absent,
        (ErrorKind::PermissionDenied, _) => PortFaultKind::Denied,
        (ErrorKind::ResourceBusy | ErrorKind::WouldBlock, _) => PortFaultKind::Busy,
        _ => PortFaultKind::Failed,
    };
    fault(kind, Cause::of_system(error))
}

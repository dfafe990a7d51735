//! A serial port by its path or its USB adapter: lines of text, and a contact on a modem line.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use gaiter_flow::cause::Cause;
use gaiter_flow::trigger::{Input, PortFault, PortFaultKind};
use rustix::fs::OFlags;
use rustix::termios::{ControlModes, OptionalActions, tcgetattr, tcsetattr};
use serialport::{
    ClearBuffer, DataBits, ErrorKind, Parity, SerialPort, SerialPortType, StopBits, TTYPort,
    available_ports,
};

use super::port::{Port, PortOpener, fault, of_io};
use crate::config::port::{self as written, ModemLine, SerialPlace, UsbName};
use crate::config::trigger::SerialLine;

/// How many bytes are read at once.
const PIECE: usize = 256;

/// How long a write may take. A USB adapter accepts it at once.
const WRITING: Duration = Duration::from_millis(200);

/// Where to look for a serial port.
#[derive(Debug)]
pub struct SerialOpener(pub SerialLine);

impl PortOpener for SerialOpener {
    fn open(&mut self) -> Result<Box<dyn Port>, PortFault> {
        let name = match &self.0.place {
            SerialPlace::Path(path) => path.clone(),
            SerialPlace::Usb(usb) => of_adapter(usb)?,
        };
        let device = fs::canonicalize(&name).map_err(|error| of_io(&error))?;
        let port = open(&device, &self.0)?;
        let contact = self.0.contact;
        Ok(Box::new(OpenSerial { port, name, device, contact, sample_next: true }))
    }
}

/// The path of the port at a USB adapter.
fn of_adapter(usb: &UsbName) -> Result<PathBuf, PortFault> {
    let ports = available_ports().map_err(|error| of_serial(&error))?;
    let found = ports.into_iter().find(|port| match &port.port_type {
        SerialPortType::UsbPort(info) => {
            let serial = usb.serial.is_none() || info.serial_number == usb.serial;
            (info.vid, info.pid) == (usb.vendor, usb.product) && serial
        }
        _ => false,
    });
    let absent = || fault(PortFaultKind::Absent, Cause::known("no-adapter", []));
    found.map(|port| PathBuf::from(port.port_name)).ok_or_else(absent)
}

fn open(device: &Path, line: &SerialLine) -> Result<TTYPort, PortFault> {
    let flags = OFlags::NOCTTY | OFlags::NONBLOCK;
    let flags = flags.bits().cast_signed();
    // A file of our own beside the port's. Through it the line can be set to stay up when the port is
    // closed, which the crate does not offer.
    let file = OpenOptions::new().read(true).write(true).custom_flags(flags).open(device);
    let file = file.map_err(|error| of_io(&error))?;
    let settings = line.settings;
    let builder = serialport::new(device.to_string_lossy(), settings.baud)
        .data_bits(if settings.data_bits == 7 { DataBits::Seven } else { DataBits::Eight })
        .parity(match settings.parity {
            written::Parity::None => Parity::None,
            written::Parity::Even => Parity::Even,
            written::Parity::Odd => Parity::Odd,
        })
        .stop_bits(if settings.stop_bits == 2 { StopBits::Two } else { StopBits::One })
        .timeout(WRITING);
    let mut port = TTYPort::open(&builder).map_err(|error| of_serial(&error))?;
    // All best effort: a pseudo-terminal has no such wires.
    let _ = stay_up(&file);
    let _ = line.dtr.map(|on| port.write_data_terminal_ready(on));
    let _ = port.clear(ClearBuffer::Input);
    Ok(port)
}

/// Keeps DTR up when the port is closed, because a falling DTR would reset some boxes.
fn stay_up(file: &File) -> io::Result<()> {
    let mut settings = tcgetattr(file)?;
    settings.control_modes.remove(ControlModes::HUPCL);
    Ok(tcsetattr(file, OptionalActions::Now, &settings)?)
}

/// An open serial port.
#[derive(Debug)]
struct OpenSerial {
    port: TTYPort,
    /// The path by which it was found.
    name: PathBuf,
    /// What that path resolved to.
    device: PathBuf,
    contact: Option<(ModemLine, bool)>,
    /// The contact is sampled before the next bytes, so that a flood of bytes cannot hide it.
    sample_next: bool,
}

impl Port for OpenSerial {
    fn read(&mut self, timeout: Duration) -> Result<Input, PortFault> {
        if let Some((line, high)) = self.contact
            && self.sample_next
        {
            self.sample_next = false;
            return self.level(line).map(|level| Input::Closed(level == high));
        }
        self.sample_next = true;
        self.port.set_timeout(timeout).map_err(|error| of_serial(&error))?;
        let mut piece = [0; PIECE];
        match self.port.read(&mut piece) {
            // An unplugged port reports the end of the file.
            Ok(0) => Err(fault(PortFaultKind::Absent, Cause::known("hung-up", []))),
            Ok(count) => Ok(Input::Bytes(piece[..count].to_vec())),
            Err(error) => match error.kind() {
                io::ErrorKind::TimedOut | io::ErrorKind::Interrupted => Ok(Input::Nothing),
                // A device that is gone gives EIO, which has no `ErrorKind` of its own.
                _ => Err(fault(PortFaultKind::Absent, Cause::of_system(&error))),
            },
        }
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), PortFault> {
        let written = self.port.set_timeout(WRITING).map_err(io::Error::from);
        written.and_then(|()| self.port.write_all(bytes)).map_err(|error| of_io(&error))
    }

    fn is_in_place(&mut self) -> Result<(), PortFault> {
        let leads_to = fs::canonicalize(&self.name).map_err(|error| of_io(&error))?;
        if leads_to == self.device {
            Ok(())
        } else {
            Err(fault(PortFaultKind::Absent, Cause::known("other-port", [])))
        }
    }
}

impl OpenSerial {
    fn level(&mut self, line: ModemLine) -> Result<bool, PortFault> {
        let level = match line {
            ModemLine::Cts => self.port.read_clear_to_send(),
            ModemLine::Dsr => self.port.read_data_set_ready(),
            ModemLine::Dcd => self.port.read_carrier_detect(),
            ModemLine::Ri => self.port.read_ring_indicator(),
        };
        level.map_err(|error| {
            fault(PortFaultKind::Failed, format!("its modem lines cannot be read: {error}"))
        })
    }
}

/// Converts a fault of the crate. Its `NoDevice` means that another program has the port.
fn of_serial(error: &serialport::Error) -> PortFault {
    match error.kind() {
        ErrorKind::NoDevice => fault(PortFaultKind::Busy, Cause::known("other-program", [])),
        ErrorKind::Io(kind) => {
            PortFault { why: Cause::verbatim(error), ..of_io(&io::Error::from(kind)) }
        }
        ErrorKind::InvalidInput | ErrorKind::Unknown => {
            fault(PortFaultKind::Failed, error.to_string())
        }
    }
}

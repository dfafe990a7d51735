//! A button, pedal or reader that appears as a keyboard, reserved for the station.

use std::collections::VecDeque;
use std::io;
use std::path::PathBuf;
use std::time::Duration;

use evdev::{Device, EventSummary};
use gaiter_flow::trigger::{FaultKind, Input, PortFault};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::port::{Port, PortOpener, fault, of_io};
use crate::config::port::InputPlace;

/// The values of a key event: up and down. 2 is a key that repeats while it is held.
const UP: i32 = 0;
const DOWN: i32 = 1;

/// Where to look for an input device.
#[derive(Debug)]
pub struct KeysOpener(pub InputPlace);

impl PortOpener for KeysOpener {
    fn open(&mut self) -> Result<Box<dyn Port>, PortFault> {
        let path = match &self.0 {
            InputPlace::Path(path) => path.clone(),
            InputPlace::Name(name) => named(name)?,
        };
        let mut device = Device::open(&path).map_err(|error| of_io(&error))?;
        device.set_nonblocking(true).map_err(|error| of_io(&error))?;
        // Exclusive for the first program that grabs it: the pedal must not type into a console too.
        device.grab().map_err(|error| of_io(&error))?;
        Ok(Box::new(OpenKeys { device, events: VecDeque::new() }))
    }
}

/// The path of the device that reports this name.
fn named(name: &str) -> Result<PathBuf, PortFault> {
    let found = evdev::enumerate().find(|(_, device)| device.name() == Some(name));
    found.map(|(path, _)| path).ok_or_else(|| {
        // Devices that the station may not open are not listed.
        fault(FaultKind::Absent, "no input device that the station may open has this name")
    })
}

/// A grabbed input device.
struct OpenKeys {
    device: Device,
    /// Keys that were read but not returned yet.
    events: VecDeque<Input>,
}

impl Port for OpenKeys {
    fn read(&mut self, timeout: Duration) -> Result<Input, PortFault> {
        if let Some(event) = self.events.pop_front() {
            return Ok(event);
        }
        let timeout = Timespec::try_from(timeout).ok();
        let mut waits = [PollFd::new(&self.device, PollFlags::IN)];
        match poll(&mut waits, timeout.as_ref()) {
            Ok(0) | Err(rustix::io::Errno::INTR) => return Ok(Input::Nothing),
            Ok(_) => {}
            Err(error) => return Err(of_io(&error.into())),
        }
        let events = match self.device.fetch_events() {
            Ok(events) => events,
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Ok(Input::Nothing),
            Err(error) => return Err(of_io(&error)),
        };
        self.events.extend(events.filter_map(|event| match event.destructure() {
            EventSummary::Key(_, code, value @ (UP | DOWN)) => {
                Some(Input::Key { code: code.0, down: value == DOWN })
            }
            _ => None,
        }));
        Ok(self.events.pop_front().unwrap_or(Input::Nothing))
    }

    fn write(&mut self, _: &[u8]) -> Result<(), PortFault> {
        // The station does not control the lights of a keyboard.
        Ok(())
    }

    fn is_in_place(&mut self) -> Result<(), PortFault> {
        // Reading fails with ENODEV as soon as it is unplugged.
        Ok(())
    }
}

//! A button, pedal or reader that appears as a keyboard, reserved for the station.

use std::collections::VecDeque;
use std::io;
use std::path::PathBuf;
use std::time::Duration;

use evdev::raw_stream::{self, RawDevice};
use evdev::{EventSummary, InputEvent, SynchronizationCode};
use gaiter_flow::cause::Cause;
use gaiter_flow::trigger::{Input, KeyAction, PortFault, PortFaultKind};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::ioctl_fionbio;

use super::port::{Port, PortOpener, fault, of_io};
use crate::config::port::InputPlace;

/// Where to look for an input device.
#[derive(Debug)]
pub struct KeysOpener(pub InputPlace);

impl PortOpener for KeysOpener {
    fn open(&mut self) -> Result<Box<dyn Port>, PortFault> {
        let path = match &self.0 {
            InputPlace::Path(path) => path.clone(),
            InputPlace::Name(name) => named(name)?,
        };
        // Not the device that the crate repairs: it would report no lost keys.
        let mut device = RawDevice::open(&path).map_err(|error| of_io(&error))?;
        ioctl_fionbio(&device, true).map_err(|error| of_io(&error.into()))?;
        // Exclusive for the first program that grabs it: the pedal must not type into a console too.
        device.grab().map_err(|error| of_io(&error))?;
        // A device that is gone by now fails when it is read.
        let inputs = held(&device).map(Input::KeysHeld).into_iter().collect();
        Ok(Box::new(OpenKeys { device, inputs }))
    }
}

/// The path of the device that reports this name.
fn named(name: &str) -> Result<PathBuf, PortFault> {
    let found = raw_stream::enumerate().find(|(_, device)| device.name() == Some(name));
    found.map(|(path, _)| path).ok_or_else(|| {
        // Devices that the station may not open are not listed.
        fault(PortFaultKind::Absent, Cause::known("no-input-device", []))
    })
}

/// The keys that are down. The system drops the events of keys up to now.
fn held(device: &RawDevice) -> io::Result<Vec<u16>> {
    Ok(device.get_key_state()?.iter().map(|key| key.0).collect())
}

/// A grabbed input device.
struct OpenKeys {
    device: RawDevice,
    /// What was read but not returned yet.
    inputs: VecDeque<Input>,
}

impl Port for OpenKeys {
    fn read(&mut self, timeout: Duration) -> Result<Input, PortFault> {
        if let Some(input) = self.inputs.pop_front() {
            return Ok(input);
        }
        let timeout = Timespec::try_from(timeout).ok();
        let mut waits = [PollFd::new(&self.device, PollFlags::IN)];
        match poll(&mut waits, timeout.as_ref()) {
            Ok(0) | Err(rustix::io::Errno::INTR) => return Ok(Input::Nothing),
            Ok(_) => {}
            Err(error) => return Err(of_io(&error.into())),
        }
        let events: Vec<InputEvent> = match self.device.fetch_events() {
            Ok(events) => events.collect(),
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Ok(Input::Nothing),
            Err(error) => return Err(of_io(&error)),
        };
        self.take(&events).map_err(|error| of_io(&error))?;
        Ok(self.inputs.pop_front().unwrap_or(Input::Nothing))
    }
}

impl OpenKeys {
    /// Takes what was read at once, up to a place where the system had to drop events: what follows there
    /// is a part of what it had, and older than the keys that are down.
    fn take(&mut self, events: &[InputEvent]) -> io::Result<()> {
        for event in events {
            match event.destructure() {
                EventSummary::Key(_, code, value) => {
                    let action = action(value);
                    self.inputs.extend(action.map(|action| Input::Key { code: code.0, action }));
                }
                EventSummary::Synchronization(_, SynchronizationCode::SYN_DROPPED, _) => {
                    self.inputs.push_back(Input::KeysLost(held(&self.device)?));
                    break;
                }
                _ => {}
            }
        }
        Ok(())
    }
}

/// What the value of a key event means.
fn action(value: i32) -> Option<KeyAction> {
    match value {
        0 => Some(KeyAction::Up),
        1 => Some(KeyAction::Down),
        2 => Some(KeyAction::Repeat),
        _ => None,
    }
}

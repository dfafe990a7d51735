//! The ports of the booth: a button at a serial port, on USB or showing as a keyboard, and a reader
//! of ids. Each has a thread of its own, for each may hang in its driver.

pub mod attend;
pub mod mock;
pub mod port;

mod keys;
mod serial;
mod usb;
mod worker;

use std::collections::BTreeMap;

pub use attend::{Attendant, Manner};
pub use worker::worker;

use crate::config::TriggerConfig;
use crate::config::trigger::ReaderPlace;
use crate::flow::trigger::Ear;
use crate::flow::trigger::ear::Shows;
use keys::KeysDoor;
use port::Door;
use serial::SerialDoor;
use usb::UsbDoor;

/// A port of the configuration, not attended yet.
pub struct Attended {
    /// Its name in status, metrics and logs.
    pub name: &'static str,
    /// Where it is looked for.
    pub door: Box<dyn Door>,
    /// What it is listened to for.
    pub ear: Ear,
    /// How.
    pub manner: Manner,
}

/// The ports that a configuration names.
pub fn of_config(config: &TriggerConfig) -> Vec<Attended> {
    let silent = Manner { settle: config.settle, sampled: false, say: BTreeMap::new() };
    let mut ports = Vec::new();
    if let Some(serial) = &config.serial {
        let shows = Shows::Serial { tokens: serial.tokens.clone() };
        ports.push(Attended {
            name: "serial",
            ear: Ear::for_button(shows, config.hearing),
            manner: Manner {
                sampled: serial.line.contact.is_some(),
                say: serial.say.clone(),
                ..silent.clone()
            },
            door: Box::new(SerialDoor(serial.line.clone())),
        });
    }
    if let Some(usb) = &config.usb {
        let shows = Shows::Report(usb.pattern.clone());
        ports.push(Attended {
            name: "usb",
            ear: Ear::for_button(shows, config.hearing),
            manner: Manner { say: usb.say.clone(), ..silent.clone() },
            door: Box::new(UsbDoor(usb.clone())),
        });
    }
    if let Some(keys) = &config.keys {
        ports.push(Attended {
            name: "keys",
            ear: Ear::for_button(Shows::Key(keys.key), config.hearing),
            manner: silent.clone(),
            door: Box::new(KeysDoor(keys.device.clone())),
        });
    }
    if let Some(reader) = &config.reader {
        let door: Box<dyn Door> = match &reader.at {
            ReaderPlace::Serial(line) => Box::new(SerialDoor(line.clone())),
            ReaderPlace::Keys(place) => Box::new(KeysDoor(place.clone())),
        };
        let ear = Ear::for_ids(reader.codes.clone());
        ports.push(Attended { name: "reader", door, ear, manner: silent });
    }
    ports
}

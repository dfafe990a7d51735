//! The ports of the booth: a button on a serial port, on USB or as a keyboard, and a reader of ids.
//! Each port has its own thread, because each may hang in its driver.

pub mod attend;
pub mod port;

mod keys;
mod serial;
mod usb;
mod worker;

use std::collections::BTreeMap;

pub use attend::{Attendant, Manner};
pub use worker::worker;

use gaiter_flow::trigger::InputDecoder;
use gaiter_flow::trigger::input_decoder::Shows;

use crate::config::TriggerConfig;
use crate::config::trigger::ReaderPlace;
use keys::KeysOpener;
use port::PortOpener;
use serial::SerialOpener;
use usb::UsbOpener;

/// A port of the configuration, not attended yet.
pub struct Attended {
    /// Its name in status, metrics and logs.
    pub name: &'static str,
    /// Finds and opens it.
    pub opener: Box<dyn PortOpener>,
    /// Decodes its input.
    pub decoder: InputDecoder,
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
            decoder: InputDecoder::for_button(shows, config.lock_out),
            manner: Manner {
                sampled: serial.line.contact.is_some(),
                say: config.say.clone(),
                ..silent.clone()
            },
            opener: Box::new(SerialOpener(serial.line.clone())),
        });
    }
    if let Some(usb) = &config.usb {
        let shows = Shows::Report(usb.pattern.clone());
        // A box at the serial port has the light: its bytes are no reports.
        let say = if config.serial.is_none() { config.say.clone() } else { BTreeMap::new() };
        ports.push(Attended {
            name: "usb",
            decoder: InputDecoder::for_button(shows, config.lock_out),
            manner: Manner { say, ..silent.clone() },
            opener: Box::new(UsbOpener(usb.clone())),
        });
    }
    if let Some(keys) = &config.keys {
        ports.push(Attended {
            name: "keys",
            decoder: InputDecoder::for_button(Shows::Key(keys.key), config.lock_out),
            manner: silent.clone(),
            opener: Box::new(KeysOpener(keys.device.clone())),
        });
    }
    if let Some(reader) = &config.reader {
        let opener: Box<dyn PortOpener> = match &reader.at {
            ReaderPlace::Serial(line) => Box::new(SerialOpener(line.clone())),
            ReaderPlace::Keys(place) => Box::new(KeysOpener(place.clone())),
        };
        let decoder = InputDecoder::for_ids(reader.codes.clone());
        ports.push(Attended { name: "reader", opener, decoder, manner: silent });
    }
    ports
}

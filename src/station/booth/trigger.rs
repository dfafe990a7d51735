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
    let button = |shows| InputDecoder::for_button(shows, config.lock_out);
    let serial = config.serial.as_ref().map(|serial| Attended {
        name: "serial",
        opener: Box::new(SerialOpener(serial.line.clone())),
        decoder: button(Shows::Serial { tokens: serial.tokens.clone() }),
        manner: Manner {
            sampled: serial.line.contact.is_some(),
            say: config.say.clone(),
            ..silent.clone()
        },
    });
    // A box at the serial port has the light: its bytes are no reports.
    let say = if serial.is_none() { config.say.clone() } else { BTreeMap::new() };
    let usb = config.usb.as_ref().map(|usb| Attended {
        name: "usb",
        opener: Box::new(UsbOpener(usb.clone())),
        decoder: button(Shows::Report(usb.pattern.clone())),
        manner: Manner { say, ..silent.clone() },
    });
    let keys = config.keys.as_ref().map(|keys| Attended {
        name: "keys",
        opener: Box::new(KeysOpener(keys.device.clone())),
        decoder: button(Shows::Key(keys.key)),
        manner: silent.clone(),
    });
    let reader = config.reader.as_ref().map(|reader| Attended {
        name: "reader",
        opener: match &reader.at {
            ReaderPlace::Serial(line) => Box::new(SerialOpener(line.clone())),
            ReaderPlace::Keys(place) => Box::new(KeysOpener(place.clone())),
        },
        decoder: InputDecoder::for_ids(reader.codes.clone()),
        manner: silent.clone(),
    });
    [serial, usb, keys, reader].into_iter().flatten().collect()
}

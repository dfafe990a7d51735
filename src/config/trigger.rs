//! The keys of `[patient.reader]` and `[trigger]`: the devices on the ports of the booth.

use std::collections::BTreeMap;
use std::time::Duration;

use gaiter_flow::booth::Signal;
use gaiter_flow::trigger::code::Codes;
use gaiter_flow::trigger::lines::Tokens;
use gaiter_flow::trigger::report::Pattern;

use super::parse::{self, Absent, Found, Reader, What, or_none};
use super::port::{
    self, CONTACTS, InputPlace, ModemLine, ReaderPort, SerialPlace, Settings, UsbName, WIRES,
};

/// The devices on the ports of the booth; none unless the configuration names them.
#[derive(Debug, Clone)]
pub struct TriggerConfig {
    /// After a press, no other press counts for this time.
    pub lock_out: Duration,
    /// Input within this time after a port is opened is ignored.
    pub settle: Duration,
    /// What is sent to the button's box: to the serial port, without one to the USB device.
    pub say: Say,
    /// A button at a serial port.
    pub serial: Option<SerialTrigger>,
    /// A button that is a USB device of its own.
    pub usb: Option<UsbTrigger>,
    /// A button that appears as a keyboard.
    pub keys: Option<KeysTrigger>,
    /// A reader of ids.
    pub reader: Option<ReaderConfig>,
}

/// A serial line and its settings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SerialLine {
    /// Where the port is.
    pub place: SerialPlace,
    /// Speed and frame.
    pub settings: Settings,
    /// What DTR is set to.
    pub dtr: Option<bool>,
    /// The modem line that is sampled, and whether it is high while the contact is closed.
    pub contact: Option<(ModemLine, bool)>,
}

/// What is sent to the booth for each signal of its light.
pub type Say = BTreeMap<Signal, Vec<u8>>;

/// `[trigger.serial]`
#[derive(Debug, Clone)]
pub struct SerialTrigger {
    pub line: SerialLine,
    /// The lines of text that count as presses.
    pub tokens: Tokens,
}

/// `[trigger.usb]`
#[derive(Debug, Clone)]
pub struct UsbTrigger {
    pub device: UsbName,
    /// What its reports contain while the button is down.
    pub pattern: Pattern,
}

/// `[trigger.keys]`
#[derive(Debug, Clone)]
pub struct KeysTrigger {
    pub device: InputPlace,
    /// The key that is the button.
    pub key: u16,
}

/// `[patient.reader]`
#[derive(Debug, Clone)]
pub struct ReaderConfig {
    pub at: ReaderPlace,
    /// What it puts around an id.
    pub codes: Codes,
}

/// How a reader appears to the system.
#[derive(Debug, Clone)]
pub enum ReaderPlace {
    /// A serial port.
    Serial(SerialLine),
    /// A keyboard.
    Keys(InputPlace),
}

/// What is sent for each signal, in the order of [`Signal::ALL`].
const SAY: [&str; 7] = [
    "trigger.say.ready",
    "trigger.say.armed",
    "trigger.say.receiving",
    "trigger.say.done",
    "trigger.say.attention",
    "trigger.say.no_export",
    "trigger.say.paused",
];

/// Reads the keys.
pub(super) fn config(reader: &mut Reader) -> Option<TriggerConfig> {
    let (ids, ids_at) = reader_config(reader)?;
    let lock_out = reader.value("trigger.lock_out", "1s", parse::duration_in("0s"..="1m"))?;
    let settle = reader.value("trigger.settle", "500ms", parse::duration_in("0s"..="10s"))?;
    let say = say(reader)?;
    let (serial, serial_at) = serial(reader)?;
    let usb = usb(reader)?;
    let (keys, keys_at) = keys(reader)?;
    twice(reader, "trigger.serial.port", serial_at, ids_at.as_ref(), ReaderPort::Serial);
    twice(reader, "trigger.keys.device", keys_at, ids_at.as_ref(), ReaderPort::Keys);
    Some(TriggerConfig { lock_out, settle, say, serial, usb, keys, reader: ids })
}

/// Notes a port of a trigger that is that of the reader, too.
fn twice<T>(
    reader: &mut Reader,
    key: &'static str,
    trigger: Option<Found<T>>,
    ids: Option<&ReaderPort>,
    port: impl FnOnce(T) -> ReaderPort,
) {
    let Some(Found { value: place, at }) = trigger else { return };
    if ids == Some(&port(place)) {
        let hint = "a port can have only one use: remove one";
        reader.note(at, key, What::own("is also the port of patient.reader", hint));
    }
}

/// The reader of ids, and where it is.
fn reader_config(reader: &mut Reader) -> Option<(Option<ReaderConfig>, Option<ReaderPort>)> {
    let port = reader.value("patient.reader.port", "", or_none(port::reader_port))?;
    let settings = reader.value("patient.reader.settings", "9600 8N1", port::settings)?;
    let codes = reader.value("patient.reader.code", "{id}", port::code)?;
    let at = port.clone().map(|port| match port {
        ReaderPort::Serial(place) => {
            ReaderPlace::Serial(SerialLine { place, settings, dtr: None, contact: None })
        }
        ReaderPort::Keys(place) => ReaderPlace::Keys(place),
    });
    Some((at.map(|at| ReaderConfig { at, codes }), port))
}

fn serial(reader: &mut Reader) -> Option<(Option<SerialTrigger>, Option<Found<SerialPlace>>)> {
    use Absent::Default;
    let key = "trigger.serial.port";
    let place = reader.text(key, Default(""), or_none(port::serial_place));
    let place = place.and_then(parse::if_set);
    let settings = reader.value("trigger.serial.settings", "9600 8N1", port::settings)?;
    let short = reader.list("trigger.serial.tokens", Default(""), port::token);
    let long = reader.list("trigger.serial.long_tokens", Default(""), port::token);
    let contact = reader.text("trigger.serial.contact", Default("none"), parse::word(CONTACTS));
    let dtr = reader.value("trigger.serial.dtr", "leave", parse::word(WIRES))?;
    let deaf = short.is_empty() && matches!(&contact, Some(Found { value: None, .. }));
    if let Some(Found { at, .. }) = &place
        && deaf
    {
        let message = "has neither tokens nor a contact: no press could be detected";
        let what = What::own(message, r#"write tokens = ["PRESS"] or contact = "cts""#);
        reader.note(at.clone(), key, what);
    }
    let contact = contact.and_then(|found| found.value);
    let texts = |tokens: Vec<Found<String>>| tokens.into_iter().map(|token| token.value).collect();
    let tokens = Tokens { short: texts(short), long: texts(long) };
    let line = |place| SerialLine { place, settings, dtr, contact };
    let serial = place.clone().map(|place| SerialTrigger { line: line(place.value), tokens });
    Some((serial, place))
}

fn usb(reader: &mut Reader) -> Option<Option<UsbTrigger>> {
    let device = reader.value("trigger.usb.device", "", or_none(port::usb_name))?;
    let pattern = reader.value("trigger.usb.value", "01", port::pattern)?;
    Some(device.map(|device| UsbTrigger { device, pattern }))
}

fn keys(reader: &mut Reader) -> Option<(Option<KeysTrigger>, Option<Found<InputPlace>>)> {
    let device = or_none(port::input_place);
    let device = reader.text("trigger.keys.device", Absent::Default(""), device);
    let device = device.and_then(parse::if_set);
    let key = reader.value("trigger.keys.key", "KEY_B", port::key)?;
    let keys = device.clone().map(|device| KeysTrigger { device: device.value, key });
    Some((keys, device))
}

/// What is sent for each signal; signals without a text are left out. A pause without a text is sent as
/// attention: a light must not stay green through it.
fn say(reader: &mut Reader) -> Option<Say> {
    let texts = SAY.map(|key| reader.value(key, "", port::bytes));
    let mut say = Say::new();
    for (signal, text) in Signal::ALL.into_iter().zip(texts) {
        let bytes = text?;
        if !bytes.is_empty() {
            say.insert(signal, bytes);
        }
    }
    if let (false, Some(attention)) =
        (say.contains_key(&Signal::Paused), say.get(&Signal::Attention).cloned())
    {
        say.insert(Signal::Paused, attention);
    }
    Some(say)
}

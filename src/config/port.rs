//! How ports are written in the configuration: their names, line settings and data.

use std::fmt;
use std::path::{Path, PathBuf};

use gaiter_flow::trigger::code::Codes;
use gaiter_flow::trigger::lines::LINE_MOST;
use gaiter_flow::trigger::report::Pattern;

use super::parse::{self, What};
use super::words::Words;

/// Where Linux has keyboards: a path in this folder is no serial port.
const INPUT_DEVICES: &str = "/dev/input";

/// What stands for the id in the code of a reader.
const ID: &str = "{id}";

/// A USB device by the ids that it reports.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UsbName {
    pub vendor: u16,
    pub product: u16,
    /// Serial number; `None` for any device of the product.
    pub serial: Option<String>,
}

impl fmt::Display for UsbName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04x}:{:04x}", self.vendor, self.product)?;
        self.serial.as_ref().map_or(Ok(()), |serial| write!(f, ":{serial}"))
    }
}

/// Where a serial port is found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SerialPlace {
    /// At this path, usually a link with a stable name.
    Path(PathBuf),
    /// On this USB adapter.
    Usb(UsbName),
}

/// Where an input device is found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum InputPlace {
    Path(PathBuf),
    /// By the name that it reports.
    Name(String),
}

/// Where a reader is found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ReaderPort {
    Serial(SerialPlace),
    /// As a keyboard.
    Keys(InputPlace),
}

/// The parity bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parity {
    None,
    Even,
    Odd,
}

/// The speed and the frame of a serial line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Bits per second.
    pub baud: u32,
    /// 7 or 8.
    pub data_bits: u8,
    pub parity: Parity,
    /// 1 or 2.
    pub stop_bits: u8,
}

/// A modem line that a contact can switch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModemLine {
    /// Clear to send.
    Cts,
    /// Data set ready.
    Dsr,
    /// Data carrier detect.
    Dcd,
    /// Ring indicator.
    Ri,
}

/// `trigger.serial.contact`: the line, and whether it is high while the contact is closed.
pub const CONTACTS: Words<Option<(ModemLine, bool)>> = &[
    ("none", None),
    ("cts", Some((ModemLine::Cts, true))),
    ("dsr", Some((ModemLine::Dsr, true))),
    ("dcd", Some((ModemLine::Dcd, true))),
    ("ri", Some((ModemLine::Ri, true))),
    ("cts-low", Some((ModemLine::Cts, false))),
    ("dsr-low", Some((ModemLine::Dsr, false))),
    ("dcd-low", Some((ModemLine::Dcd, false))),
    ("ri-low", Some((ModemLine::Ri, false))),
];

/// `trigger.serial.dtr`: `None` leaves the wire as the system sets it.
pub const WIRES: Words<Option<bool>> = &[("leave", None), ("on", Some(true)), ("off", Some(false))];

/// Speeds that serial adapters support, bits per second.
const BAUDS: std::ops::RangeInclusive<u32> = 300..=921_600;

/// `"vendor:product"` or `"vendor:product:serial"`, the numbers as four hexadecimal digits.
pub(super) fn usb_name(text: &str) -> Result<UsbName, What> {
    let mut parts = text.splitn(3, ':');
    let mut id = || {
        let digits = parts.next().filter(|digits| digits.len() == 4)?;
        digits.bytes().all(|digit| digit.is_ascii_hexdigit()).then_some(())?;
        u16::from_str_radix(digits, 16).ok()
    };
    let ids = id().zip(id());
    let serial = parts.next().map(str::to_owned);
    let plain = serial.as_ref().is_none_or(|serial| {
        !serial.is_empty() && serial.bytes().all(|byte| byte.is_ascii_graphic())
    });
    let hint = r#"write "0403:6001" or "0403:6001:A50285BI""#;
    ids.filter(|_| plain)
        .map(|(vendor, product)| UsbName { vendor, product, serial })
        .ok_or_else(|| What::not_a(text, "a valid name of a USB device", hint))
}

/// A full path, or `"usb:…"`.
pub(super) fn serial_place(text: &str) -> Result<SerialPlace, What> {
    match text.strip_prefix("usb:") {
        Some(name) => usb_name(name).map(SerialPlace::Usb),
        None => parse::full_path(text).map(SerialPlace::Path),
    }
}

/// A full path, or `"name:…"`.
pub(super) fn input_place(text: &str) -> Result<InputPlace, What> {
    let hint = r#"write "name:PCsensor FootSwitch""#;
    match text.strip_prefix("name:") {
        Some("") => Err(What::not_a(text, "a valid name of an input device", hint)),
        Some(name) => Ok(InputPlace::Name(name.to_owned())),
        None => parse::full_path(text).map(InputPlace::Path),
    }
}

/// A keyboard if it is `"name:…"` or in the folder of input devices, else a serial port.
pub(super) fn reader_port(text: &str) -> Result<ReaderPort, What> {
    if text.starts_with("name:") || Path::new(text).starts_with(INPUT_DEVICES) {
        return input_place(text).map(ReaderPort::Keys);
    }
    serial_place(text).map(ReaderPort::Serial)
}

/// `"9600 8N1"`.
pub(super) fn settings(text: &str) -> Result<Settings, What> {
    let hint = r#"write "9600 8N1", "115200 7E2""#;
    let wrong = || What::not_a(text, "a valid setting of a serial line", hint);
    let (baud, frame) = text.split_once(' ').ok_or_else(wrong)?;
    let baud: u32 = baud.parse().ok().filter(|baud| BAUDS.contains(baud)).ok_or_else(wrong)?;
    let &[data, parity, stop] = frame.as_bytes() else { return Err(wrong()) };
    let parity = match parity {
        b'N' => Parity::None,
        b'E' => Parity::Even,
        b'O' => Parity::Odd,
        _ => return Err(wrong()),
    };
    match (data, stop) {
        (b'7' | b'8', b'1' | b'2') => {
            Ok(Settings { baud, data_bits: data - b'0', parity, stop_bits: stop - b'0' })
        }
        _ => Err(wrong()),
    }
}

/// A line of text by which a button reports a press.
pub(super) fn token(text: &str) -> Result<String, What> {
    let plain = text.bytes().all(|byte| byte.is_ascii_graphic() || byte == b' ');
    if plain && (1..=LINE_MOST).contains(&text.len()) {
        Ok(text.to_owned())
    } else {
        let hint = r#"write 1 to 64 plain characters, without the line end: "PRESS""#;
        Err(What::not_a(text, "a valid line of a button", hint))
    }
}

/// A code as a reader sends it, with `{id}` for the id.
pub(super) fn code(text: &str) -> Result<Codes, What> {
    let around = text.split_once(ID).filter(|(_, after)| !after.contains(ID));
    let codes = around
        .and_then(|(before, after)| Some(Codes { prefix: affix(before)?, suffix: affix(after)? }));
    let hint = r#"write {id} and around it at most 64 plain characters and control signs, without the line end: "]C1{id}", '\x02{id}\x03'"#;
    codes.ok_or_else(|| What::not_a(text, "a valid code of a reader", hint))
}

/// The characters and control signs before or after an id, with the escapes of [`bytes`]. A carriage
/// return or line feed cannot be among them: it ends the line.
fn affix(text: &str) -> Option<String> {
    let is_part = |byte: &u8| byte.is_ascii() && !matches!(byte, b'\r' | b'\n');
    let bytes = escaped(text).filter(|bytes| bytes.len() <= LINE_MOST && bytes.iter().all(is_part));
    bytes.and_then(|bytes| String::from_utf8(bytes).ok())
}

/// Bytes to send, with `\r`, `\n`, `\t`, `\\` and `\xNN` for those that are not characters.
pub(super) fn bytes(text: &str) -> Result<Vec<u8>, What> {
    let bytes = escaped(text).filter(|bytes| bytes.len() <= LINE_MOST);
    let hint = r#"write 'OK\r\n'; \xNN is the byte NN"#;
    bytes.ok_or_else(|| What::not_a(text, "a valid text for a port", hint))
}

/// The bytes of a text with escapes; `None` if an escape is invalid.
pub fn escaped(text: &str) -> Option<Vec<u8>> {
    let (mut bytes, mut rest) = (Vec::new(), text.chars());
    while let Some(character) = rest.next() {
        if character != '\\' {
            bytes.extend(character.encode_utf8(&mut [0; 4]).bytes());
            continue;
        }
        bytes.push(match rest.next() {
            Some('r') => b'\r',
            Some('n') => b'\n',
            Some('t') => b'\t',
            Some('\\') => b'\\',
            Some('x') => {
                let digits: String = rest.by_ref().take(2).collect();
                hex_byte(&digits)?
            }
            _ => return None,
        });
    }
    Some(bytes)
}

/// `"00 01"`: the bits of a report that are set while the button is down, in 1 to 64 bytes. In
/// `"00 01/00 0f"` the second part has the bits that count.
pub(super) fn pattern(text: &str) -> Result<Pattern, What> {
    let (value, mask) = text.split_once('/').unwrap_or((text, text));
    let bytes = |part: &str| part.split(' ').map(hex_byte).collect::<Option<Vec<u8>>>();
    let pattern = bytes(value).zip(bytes(mask)).map(|(value, mask)| Pattern { mask, value });
    let shows_a_button = |Pattern { mask, value }: &Pattern| {
        mask.len() == value.len()
            && mask.len() <= LINE_MOST
            && mask.iter().any(|byte| *byte != 0)
            && value.iter().zip(mask).all(|(value, mask)| value & !mask == 0)
    };
    let hint = r#"write bytes with two hexadecimal digits each: "00 01", or "00 01/00 0f" with the bits that count"#;
    pattern
        .filter(shows_a_button)
        .ok_or_else(|| What::not_a(text, "a valid value of a report", hint))
}

fn hex_byte(digits: &str) -> Option<u8> {
    let two = digits.len() == 2 && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
    two.then(|| u8::from_str_radix(digits, 16).ok()).flatten()
}

/// A key by its Linux name or by its number.
pub(super) fn key(text: &str) -> Result<u16, What> {
    let number = text.parse::<evdev::KeyCode>().map(|key| key.0).or_else(|_| text.parse());
    let hint = r#"write "KEY_B" or "BTN_LEFT", as evtest shows it"#;
    number.map_err(|_| What::not_a(text, "a valid key", hint))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_usb_device_is_two_numbers_and_perhaps_a_serial() {
        let name = usb_name("0403:6001:A5:B").unwrap();
        assert_eq!(
            (name.vendor, name.product, name.serial.as_deref()),
            (0x403, 0x6001, Some("A5:B"))
        );
        assert_eq!(
            (name.to_string(), usb_name("0403:6001").unwrap().serial),
            ("0403:6001:A5:B".into(), None)
        );
        for text in ["", "403:6001", "0403", "0403:", "0403:60010", "0403:6001:", "+403:6001"] {
            assert!(usb_name(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_line_is_its_speed_and_its_frame() {
        let line = settings("115200 7E2").unwrap();
        assert_eq!(
            (line.baud, line.data_bits, line.parity, line.stop_bits),
            (115_200, 7, Parity::Even, 2)
        );
        for text in [
            "",
            "9600",
            "9600 8",
            "9600 8N",
            "9600 9N1",
            "9600 8M1",
            "9600 8N3",
            "1 8N1",
            "9600  8N1",
        ] {
            assert!(settings(text).is_err(), "{text}");
        }
    }

    #[test]
    fn bytes_are_written_with_the_usual_escapes() {
        assert_eq!(bytes(r"OK\r\n\x00\xfF\\\t").unwrap(), b"OK\r\n\x00\xff\\\t");
        assert_eq!(bytes("\r\n").unwrap(), b"\r\n", "double quotes have made them already");
        for text in [r"\", r"\q", r"\x", r"\x1", r"\xg0", r"\x+1"] {
            assert!(bytes(text).is_err(), "{text}");
        }
    }

    #[test]
    fn around_an_id_stand_characters_and_control_signs() {
        for (text, prefix, suffix) in [
            ("{id}", "", ""),
            ("]C1 {id}", "]C1 ", ""),
            (r"\x02{id}\x03", "\u{2}", "\u{3}"),
            ("\u{2}{id}", "\u{2}", ""),
            (r"{id}\t\\%", "", "\t\\%"),
        ] {
            let codes = Codes { prefix: prefix.into(), suffix: suffix.into() };
            assert_eq!(code(text).unwrap(), codes, "{text:?}");
        }
        for text in ["", "id", "{id}{id}", "]C1"] {
            assert!(code(text).is_err(), "{text:?}");
        }
        for text in [r"\r", "\n", r"\", r"\x2", r"\x80", "ä", &"x".repeat(65)] {
            assert!(code(&format!("{text}{{id}}")).is_err(), "{text:?}");
            assert!(code(&format!("{{id}}{text}")).is_err(), "{text:?}");
        }
    }

    #[test]
    fn a_reader_is_a_keyboard_by_its_name_or_among_input_devices_and_else_at_a_serial_port() {
        for text in ["name:Honeywell 1900", "/dev/input/by-id/usb-reader-event-kbd"] {
            assert!(matches!(reader_port(text), Ok(ReaderPort::Keys(_))), "{text}");
        }
        for text in ["usb:0c2e:0200", "/dev/gaiter/A50285BI", "/dev/inputs"] {
            assert!(matches!(reader_port(text), Ok(ReaderPort::Serial(_))), "{text}");
        }
        for text in ["", "name:", "usb:0c2e", "event3"] {
            assert!(reader_port(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_report_shows_a_button_by_bits_that_are_set_or_by_a_value_of_those_that_count() {
        let of = |value: &[u8], mask: &[u8]| Pattern { mask: mask.into(), value: value.into() };
        assert_eq!(pattern("00 fF"), Ok(of(&[0, 255], &[0, 255])));
        assert_eq!(pattern("02 00/0f 01"), Ok(of(&[2, 0], &[15, 1])));
        for text in ["", "0", "00  01", "001", "+1", "00", "01/", "01/00", "01/01 00", "10/0f"] {
            assert!(pattern(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_key_is_a_name_or_a_number() {
        assert_eq!((key("KEY_B").unwrap(), key("48").unwrap()), (48, 48));
        assert!(key("KEY_FOOT").is_err());
    }
}

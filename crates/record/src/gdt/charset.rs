//! The character sets of GDT. A character that a set lacks is a fault and is never replaced, because a
//! changed name or id may be that of another patient.

use encoding_rs::{Encoding, WINDOWS_1252};

/// The upper half of IBM code page 437, from 0x80 on.
const CP437: &str = "ÇüéâäàåçêëèïîìÄÅÉæÆôöòûùÿÖÜ¢£¥₧ƒáíóúñÑªº¿⌐¬½¼¡«»░▒▓│┤╡╢╖╕╣║╗╝╜╛┐\
                     └┴┬├─┼╞╟╚╔╩╦╠═╬╧╨╤╥╙╘╒╓╫╪┘┌█▄▌▐▀αßΓπΣσµτΦΘΩδ∞φε∩≡±≥≤⌠⌡÷≈°∙·√ⁿ²■\u{a0}";

/// A character set of GDT messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Charset {
    /// 7 bit; field 9206 is 1.
    Ascii,
    /// IBM code page 437; field 9206 is 2.
    Cp437,
    /// Windows code page 1252; field 9206 is 3, as in nearly all messages.
    Cp1252,
    /// UTF-8, which GDT 2.1 does not know: field 9206 is left out. Newer programs read and write it.
    Utf8,
}

/// A character that cannot be written, or must not be because it would end the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the character {character:?} cannot be written in {}", charset.name())]
pub struct Unwritable {
    /// The character.
    pub character: char,
    /// The character set.
    pub charset: Charset,
}

/// Bytes that are not text in a character set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("byte {at} of the content is not a character of {}", charset.name())]
pub struct Unreadable {
    /// Position of the byte, from 1.
    pub at: usize,
    /// The character set.
    pub charset: Charset,
}

impl Charset {
    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Charset::Ascii => "7 bit",
            Charset::Cp437 => "code page 437",
            Charset::Cp1252 => "code page 1252",
            Charset::Utf8 => "UTF-8",
        }
    }

    /// Its value in field 9206; `None` if GDT 2.1 has no number for it.
    pub const fn number(self) -> Option<&'static str> {
        match self {
            Charset::Ascii => Some("1"),
            Charset::Cp437 => Some("2"),
            Charset::Cp1252 => Some("3"),
            Charset::Utf8 => None,
        }
    }

    /// The set with this value in field 9206.
    pub fn of_number(number: &[u8]) -> Option<Charset> {
        let known = [Charset::Ascii, Charset::Cp437, Charset::Cp1252];
        known.into_iter().find(|set| set.number().map(str::as_bytes) == Some(number))
    }

    /// Encodes a text.
    ///
    /// # Errors
    /// The first character that the set lacks or that is a control character.
    pub fn encode(self, text: &str) -> Result<Vec<u8>, Unwritable> {
        let mut bytes = Vec::with_capacity(text.len());
        for character in text.chars() {
            let known = !character.is_control() && self.push(character, &mut bytes);
            if !known {
                return Err(Unwritable { character, charset: self });
            }
        }
        Ok(bytes)
    }

    /// Adds a character; `false` if the set lacks it.
    pub(crate) fn push(self, character: char, bytes: &mut Vec<u8>) -> bool {
        let mut utf8 = [0; 4];
        let text = character.encode_utf8(&mut utf8);
        match self {
            Charset::Utf8 => bytes.extend(text.bytes()),
            _ if character.is_ascii() => bytes.extend(text.bytes()),
            Charset::Ascii => return false,
            Charset::Cp437 => {
                let place = CP437.chars().position(|known| known == character);
                let Some(byte) = place.and_then(|place| u8::try_from(place + 128).ok()) else {
                    return false;
                };
                bytes.push(byte);
            }
            Charset::Cp1252 => {
                let encoding: &Encoding = WINDOWS_1252;
                let (encoded, _, lacks) = encoding.encode(text);
                if lacks {
                    return false;
                }
                bytes.extend(encoded.iter());
            }
        }
        true
    }

    /// Decodes bytes.
    ///
    /// # Errors
    /// The first byte that the set lacks or that is a control character.
    pub fn decode(self, bytes: &[u8]) -> Result<String, Unreadable> {
        let unreadable = |at: usize| Unreadable { at: at + 1, charset: self };
        if self == Charset::Utf8 {
            let text = std::str::from_utf8(bytes);
            let text = text.map_err(|error| unreadable(error.valid_up_to()))?;
            let control = text.char_indices().find(|(_, character)| character.is_control());
            return control.map_or_else(|| Ok(text.to_owned()), |(at, _)| Err(unreadable(at)));
        }
        let characters = bytes.iter().enumerate().map(|(at, byte)| {
            let character = self.character(*byte).filter(|character| !character.is_control());
            character.ok_or_else(|| unreadable(at))
        });
        characters.collect()
    }

    /// The character of one byte, in the single-byte sets.
    fn character(self, byte: u8) -> Option<char> {
        if byte.is_ascii() {
            return Some(char::from(byte));
        }
        match self {
            Charset::Ascii | Charset::Utf8 => None,
            Charset::Cp437 => CP437.chars().nth(usize::from(byte - 128)),
            Charset::Cp1252 => WINDOWS_1252.decode_without_bom_handling(&[byte]).0.chars().next(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_umlauts_have_the_bytes_of_their_code_pages() {
        // From the tables of code pages 437 and 1252.
        assert_eq!(Charset::Cp437.encode("ÄÖÜäöüß°").unwrap(), b"\x8e\x99\x9a\x84\x94\x81\xe1\xf8");
        assert_eq!(
            Charset::Cp1252.encode("ÄÖÜäöüß°€").unwrap(),
            b"\xc4\xd6\xdc\xe4\xf6\xfc\xdf\xb0\x80"
        );
        assert_eq!(Charset::Utf8.encode("Ä").unwrap(), "Ä".as_bytes());
    }

    #[test]
    fn every_byte_that_is_a_character_is_written_as_it_was_read() {
        for set in [Charset::Ascii, Charset::Cp437, Charset::Cp1252] {
            let read = (0..=255_u8).filter_map(|byte| Some((byte, set.decode(&[byte]).ok()?)));
            let read: Vec<(u8, String)> = read.collect();
            let expected = match set {
                Charset::Cp437 => 95 + 128,
                // Five places of the upper half are unassigned.
                Charset::Cp1252 => 95 + 128 - 5,
                _ => 95,
            };
            assert_eq!(read.len(), expected, "{set:?}");
            for (byte, text) in read {
                assert_eq!(set.encode(&text).unwrap(), [byte], "{set:?} {text}");
            }
        }
    }

    #[test]
    fn what_a_set_lacks_is_a_fault_and_never_another_character() {
        for (set, text) in [
            (Charset::Ascii, "ä"),
            (Charset::Cp437, "€"),
            (Charset::Cp1252, "ł"),
            (Charset::Cp1252, "\u{81}"),
            (Charset::Utf8, "a\r\nb"),
        ] {
            let fault = set.encode(text).unwrap_err();
            assert!(text.contains(fault.character) && fault.charset == set, "{fault}");
        }
        assert_eq!(Charset::Utf8.decode(b"M\xfcller").unwrap_err().at, 2);
    }
}

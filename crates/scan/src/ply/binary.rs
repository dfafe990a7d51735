//! The elements of a binary PLY file, of either byte order.

use super::super::fault::{CutSign, ScanFault, SourcePosition, cut_short};
use super::super::text::{SECTOR_BYTES, spelled};
use super::header::{Element, Encoding, Header, Kind, Meaning, Property, Scalar, Shape};
use super::values::{Record, Values, length};

/// The end of the elements. Only the lengths of lists are read.
///
/// # Errors
/// [`ScanFault::CutShort`] if the file ends earlier, or was not written to its end;
/// [`ScanFault::Malformed`] for a list of negative length.
pub(super) fn extent(bytes: &[u8], header: &Header) -> Result<usize, ScanFault> {
    let mut values = Bytes::after_header(bytes, header);
    for element in header.elements.iter().filter(|element| !element.properties.is_empty()) {
        if let Some(stride) = stride(element) {
            let room = (bytes.len() - values.at) / stride;
            if room < element.count {
                return Err(element.missing(room));
            }
            values.at += stride * element.count;
            values.refuse_unwritten_points(element)?;
            continue;
        }
        for number in 1..=element.count {
            let record = Record { element, number };
            for property in &element.properties {
                values.pass(property, record)?;
            }
        }
    }
    Ok(values.at)
}

/// The size of a record, bytes, if all records have the same size.
fn stride(element: &Element) -> Option<usize> {
    element
        .properties
        .iter()
        .map(|property| match property.shape {
            Shape::One(kind) => Some(kind.bytes()),
            Shape::List { .. } => None,
        })
        .sum()
}

/// The records of a binary file.
pub(super) struct Bytes<'a> {
    bytes: &'a [u8],
    /// Offset of the next number.
    at: usize,
    /// Offset of the last number read.
    last: usize,
    /// Offset of the zeros at the end of the file.
    written: usize,
    is_big_endian: bool,
}

impl<'a> Bytes<'a> {
    /// The records after a header.
    pub(super) fn after_header(bytes: &'a [u8], header: &Header) -> Bytes<'a> {
        let is_big_endian = header.encoding == Encoding::BigEndian;
        let written = bytes.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
        Bytes { bytes, at: header.end, last: header.end, written, is_big_endian }
    }

    /// The next bytes in little-endian order.
    fn next<const N: usize>(&mut self, record: Record) -> Result<[u8; N], ScanFault> {
        let part = self.bytes.get(self.at..).and_then(|rest| rest.first_chunk::<N>());
        let mut part = *part.ok_or_else(|| record.element.missing(record.number - 1))?;
        self.last = self.at;
        self.at += N;
        if self.is_big_endian {
            part.reverse();
        }
        Ok(part)
    }

    fn real(&mut self, kind: Scalar, record: Record) -> Result<f64, ScanFault> {
        Ok(match kind {
            Scalar::F32 => f64::from(f32::from_le_bytes(self.next(record)?)),
            Scalar::F64 => f64::from_le_bytes(self.next(record)?),
            // Every whole number of a PLY file has at most 32 bits.
            _ => self.whole(kind, record)? as f64,
        })
    }

    /// A cloud of points that ends in this many zeros was reserved and not yet filled; a single
    /// point at zero may be intended.
    fn refuse_unwritten_points(&self, element: &Element) -> Result<(), ScanFault> {
        let zeros = self.bytes.len() - self.written;
        if element.kind == Kind::Vertex && self.at == self.bytes.len() && zeros >= SECTOR_BYTES {
            return Err(cut_short(CutSign::Unwritten { bytes: zeros }));
        }
        Ok(())
    }

    fn pass(&mut self, property: &Property, record: Record) -> Result<(), ScanFault> {
        match property.shape {
            Shape::One(kind) => self.skip(kind, 1, record),
            Shape::List { count, item } => {
                let start = self.at;
                let count = length(self, count, record)?;
                // Windows and network shares reserve space for a file before they fill it. No
                // exporter writes faces without corners.
                if count == 0 && property.meaning == Meaning::Corners && start >= self.written {
                    let bytes = self.bytes.len() - self.written;
                    return Err(cut_short(CutSign::Unwritten { bytes }));
                }
                self.skip(item, count, record)
            }
        }
    }
}

impl Values for Bytes<'_> {
    fn begin(&mut self, _: Record) -> Result<(), ScanFault> {
        Ok(())
    }

    fn coordinate(&mut self, kind: Scalar, record: Record) -> Result<f64, ScanFault> {
        let value = self.real(kind, record)?;
        if value.is_finite() {
            return Ok(value);
        }
        Err(ScanFault::NotFinite { place: self.place(record), found: spelled(value) })
    }

    fn whole(&mut self, kind: Scalar, record: Record) -> Result<i64, ScanFault> {
        Ok(match kind {
            Scalar::I8 => i64::from(i8::from_le_bytes(self.next(record)?)),
            Scalar::U8 => i64::from(u8::from_le_bytes(self.next(record)?)),
            Scalar::I16 => i64::from(i16::from_le_bytes(self.next(record)?)),
            Scalar::U16 => i64::from(u16::from_le_bytes(self.next(record)?)),
            Scalar::I32 => i64::from(i32::from_le_bytes(self.next(record)?)),
            Scalar::U32 => i64::from(u32::from_le_bytes(self.next(record)?)),
            // The header refuses lists whose length or corners are not integers.
            Scalar::F32 | Scalar::F64 => self.real(kind, record)? as i64,
        })
    }

    fn skip(&mut self, kind: Scalar, count: usize, record: Record) -> Result<(), ScanFault> {
        let room = (self.bytes.len() - self.at) / kind.bytes();
        if room < count {
            return Err(record.element.missing(record.number - 1));
        }
        self.last = self.at;
        self.at += count * kind.bytes();
        Ok(())
    }

    fn end(&mut self, _: Record) -> Result<(), ScanFault> {
        Ok(())
    }

    fn place(&self, record: Record) -> SourcePosition {
        let Record { element, number } = record;
        let [name, _] = element.kind.names();
        SourcePosition::Record { name, number, byte: self.last }
    }
}

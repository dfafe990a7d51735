//! Data sets of answers. Their lengths are looked at before they are read: the reader takes memory for as many bytes as
//! an element claims, and goes as deep as its sequences do.

use dicom_core::{Tag, VR};
use dicom_object::InMemDicomObject;

use super::DimseFault;
use crate::dataset::{Syntax, vr};

/// How deep sequences may lie within each other: an entry of a worklist has three.
const DEPTH_MOST: usize = 8;

/// The length of what ends with a delimiter.
const UNDEFINED: u32 = u32::MAX;

const ITEM: Tag = Tag(0xfffe, 0xe000);
const ITEM_END: Tag = Tag(0xfffe, 0xe00d);
const SEQUENCE_END: Tag = Tag(0xfffe, 0xe0dd);

/// Reads a data set.
pub(super) fn read(syntax: Syntax, bytes: &[u8]) -> Result<InMemDicomObject, DimseFault> {
    whole(syntax.elements(bytes, 0)?)?;
    let read = InMemDicomObject::read_dataset_with_ts(bytes, &syntax.transfer_syntax());
    read.map_err(|_| DimseFault::Unreadable)
}

impl Syntax {
    /// Goes over the elements of a data set, to its end or the delimiter of its item. Returns what follows.
    fn elements(self, mut bytes: &[u8], depth: usize) -> Result<&[u8], DimseFault> {
        while !bytes.is_empty() {
            let (tag, rest) = tag(bytes)?;
            if tag == ITEM_END && depth > 0 {
                return Ok(length(rest)?.1);
            }
            let (vr, length, rest) = self.head(tag, rest)?;
            bytes = match (vr, length) {
                // What is unknown is written as is a data set in the default syntax (PS3.5, 6.2.2).
                (VR::UN, UNDEFINED) => Syntax::ImplicitLittleEndian.items(rest, depth)?,
                (_, UNDEFINED) => self.items(rest, depth)?,
                (VR::SQ, _) => {
                    let (items, rest) = split(rest, length)?;
                    whole(self.items(items, depth)?)?;
                    rest
                }
                _ => split(rest, length)?.1,
            };
        }
        Ok(bytes)
    }

    /// Goes over the items of a sequence, to its end or its delimiter. Returns what follows.
    fn items(self, mut bytes: &[u8], depth: usize) -> Result<&[u8], DimseFault> {
        if depth == DEPTH_MOST {
            return Err(DimseFault::TooDeep { most: DEPTH_MOST });
        }
        while !bytes.is_empty() {
            let (tag, rest) = tag(bytes)?;
            let (length, rest) = length(rest)?;
            bytes = match (tag, length) {
                (SEQUENCE_END, _) => return Ok(rest),
                (ITEM, UNDEFINED) => self.elements(rest, depth + 1)?,
                (ITEM, _) => {
                    let (item, rest) = split(rest, length)?;
                    whole(self.elements(item, depth + 1)?)?;
                    rest
                }
                _ => return Err(DimseFault::Cut),
            };
        }
        Ok(bytes)
    }

    /// How the value of an element is represented, its length, and what follows.
    fn head(self, tag: Tag, bytes: &[u8]) -> Result<(VR, u32, &[u8]), DimseFault> {
        if tag.group() == ITEM.group() {
            return Err(DimseFault::Cut);
        }
        if self == Syntax::ImplicitLittleEndian {
            let (length, rest) = length(bytes)?;
            return Ok((vr(tag), length, rest));
        }
        let (code, rest) = bytes.split_first_chunk::<2>().ok_or(DimseFault::Cut)?;
        let vr = VR::from_binary(*code).unwrap_or(VR::UN);
        let (short, rest) = rest.split_first_chunk::<2>().ok_or(DimseFault::Cut)?;
        if is_short(vr) {
            return Ok((vr, u32::from(u16::from_le_bytes(*short)), rest));
        }
        let (length, rest) = length(rest)?;
        Ok((vr, length, rest))
    }
}

/// Whether the length has two bytes (PS3.5, 7.1.2).
fn is_short(vr: VR) -> bool {
    use VR::{AE, AS, AT, CS, DA, DS, DT, FD, FL, IS, LO, LT, PN, SH, SL, SS, ST, TM, UI, UL, US};
    [AE, AS, AT, CS, DA, DS, DT, FD, FL, IS, LO, LT, PN, SH, SL, SS, ST, TM, UI, UL, US]
        .contains(&vr)
}

/// Nothing follows what has told its length.
fn whole(rest: &[u8]) -> Result<(), DimseFault> {
    if rest.is_empty() { Ok(()) } else { Err(DimseFault::Cut) }
}

fn tag(bytes: &[u8]) -> Result<(Tag, &[u8]), DimseFault> {
    let (&[a, b, c, d], rest) = bytes.split_first_chunk::<4>().ok_or(DimseFault::Cut)?;
    Ok((Tag(u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d])), rest))
}

fn length(bytes: &[u8]) -> Result<(u32, &[u8]), DimseFault> {
    let (length, rest) = bytes.split_first_chunk::<4>().ok_or(DimseFault::Cut)?;
    Ok((u32::from_le_bytes(*length), rest))
}

fn split(bytes: &[u8], length: u32) -> Result<(&[u8], &[u8]), DimseFault> {
    bytes.split_at_checked(length as usize).ok_or(DimseFault::Cut)
}

//! A checker of GDT 2.1 messages that shares no code with the program: from the description of the
//! format alone.

#![allow(clippy::unwrap_used, clippy::panic)]

/// A line: field and content.
pub type Line = (String, Vec<u8>);

/// The lines of a message, or what is wrong with it.
pub fn check(bytes: &[u8]) -> Result<Vec<Line>, String> {
    let mut lines: Vec<Line> = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let here = format!("line {} at byte {at}", lines.len() + 1);
        let head = bytes.get(at..at + 7).ok_or(format!("{here}: no length and field"))?;
        let head = std::str::from_utf8(head).map_err(|_| format!("{here}: head is no text"))?;
        if !head.bytes().all(|b| b.is_ascii_digit()) {
            return Err(format!("{here}: {head:?} is no length and field"));
        }
        let length: usize = head[..3].parse().unwrap();
        let line = bytes.get(at..at + length).ok_or(format!("{here}: runs over the end"))?;
        if length < 9 || &line[length - 2..] != b"\r\n" {
            return Err(format!("{here}: does not end with CR LF after {length} bytes"));
        }
        let content = &line[7..length - 2];
        if content.iter().any(|byte| *byte < 0x20 || *byte == 0x7f) {
            return Err(format!("{here}: holds a control character"));
        }
        lines.push((head[3..].to_owned(), content.to_vec()));
        at += length;
    }
    whole(bytes, &lines)?;
    Ok(lines)
}

fn whole(bytes: &[u8], lines: &[Line]) -> Result<(), String> {
    let field = |at: usize| lines.get(at).map(|(field, _)| field.as_str());
    if field(0) != Some("8000") || field(1) != Some("8100") {
        return Err(format!("begins with {:?} and {:?}", field(0), field(1)));
    }
    let total = &lines[1].1;
    if total.len() != 5 || *total != format!("{:05}", bytes.len()).into_bytes() {
        return Err(format!("8100 says {total:?}, the message has {} bytes", bytes.len()));
    }
    charset(lines)
}

/// Every byte is one of the character set that 9206 names; without it, UTF-8.
fn charset(lines: &[Line]) -> Result<(), String> {
    let named = lines.iter().find(|(field, _)| field == "9206").map(|(_, named)| named.as_slice());
    for (field, content) in lines {
        let fits = match named {
            Some(b"1") => content.is_ascii(),
            Some(b"2") => true,
            // 1252 leaves five places empty.
            Some(b"3") => !content.iter().any(|b| [0x81, 0x8d, 0x8f, 0x90, 0x9d].contains(b)),
            Some(_) => false,
            None => std::str::from_utf8(content).is_ok(),
        };
        if !fits {
            return Err(format!("field {field} does not fit character set {named:?}"));
        }
    }
    Ok(())
}

/// The lines of a message that must be right.
#[track_caller]
pub fn checked(bytes: &[u8]) -> Vec<Line> {
    check(bytes).unwrap_or_else(|wrong| panic!("{wrong}:\n{}", String::from_utf8_lossy(bytes)))
}

/// The contents of a field, in their order.
pub fn contents(lines: &[Line], field: &str) -> Vec<String> {
    let of_field = lines.iter().filter(|(its, _)| its == field);
    of_field.map(|(_, content)| String::from_utf8_lossy(content).into_owned()).collect()
}

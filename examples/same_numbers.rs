//! Whether two builds measure the same: compares the records that they made of the same scans.
//!
//! `cargo run --release --example same_numbers -- BEFORE AFTER`
//!
//! BEFORE and AFTER are folders of records with equal names, from `gaiter extract --json`. A number may
//! move by [`SD_SHARE`] of its own standard error, or by [`RELATIVE`] of itself where it has none. Records
//! are rounded, so a number may besides step by one unit of its last digit; how many do so is printed:
//! one in a thousand means that numbers moved by about a thousandth of that unit. All texts, counts and
//! nulls must be equal.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Map, Value};

/// A number may move by this share of its own standard error.
const SD_SHARE: f64 = 1e-3;

/// A number without a standard error may move by this share of itself.
const RELATIVE: f64 = 1e-6;

/// Texts of the record that are packed 16-bit whole numbers; see docs/record.md.
const PACKED: [&str; 2] = ["points", "error"];

/// What a comparison found.
#[derive(Default)]
struct Tally {
    /// For each key the smallest unit of a last digit: zeros at the end of a decimal are not written.
    steps: BTreeMap<String, f64>,
    numbers: usize,
    /// Numbers that differ by one unit of their last digit and no more.
    stepped: usize,
    /// Places that differ by more, with both values.
    moved: Vec<String>,
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(before), Some(after)) = (arguments.next(), arguments.next()) else {
        return Err("usage: same_numbers BEFORE AFTER".into());
    };
    let mut names: Vec<_> = fs::read_dir(&before)?.collect::<io::Result<_>>()?;
    names.sort_by_key(fs::DirEntry::file_name);
    let mut out = io::stdout().lock();
    writeln!(out, "| record | numbers | a step of the last digit | moved |\n|---|---|---|---|")?;
    let mut all_same = true;
    for name in names.iter().map(fs::DirEntry::file_name) {
        let [old, new] = [&before, &after].map(|folder| read(&Path::new(folder).join(&name)));
        let (old, new) = (old?, new?);
        let mut tally = Tally::default();
        [&old, &new].into_iter().for_each(|record| tally.look_at_digits("", record));
        tally.compare("", "", &old, &new, None);
        let Tally { numbers, stepped, moved, .. } = tally;
        let name = name.to_string_lossy();
        writeln!(out, "| {name} | {numbers} | {stepped} | {} |", moved.len())?;
        moved.iter().try_for_each(|line| writeln!(out, "  {line}"))?;
        all_same &= moved.is_empty();
    }
    Ok(if all_same { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn read(path: &Path) -> Result<Value, Box<dyn Error>> {
    let text = fs::read(path).map_err(|fault| format!("{}: {fault}", path.display()))?;
    Ok(serde_json::from_slice(&text)?)
}

impl Tally {
    fn look_at_digits(&mut self, kind: &str, value: &Value) {
        match value {
            Value::Object(fields) => {
                let each = |(key, value)| self.look_at_digits(&format!("{kind}.{key}"), value);
                fields.iter().for_each(each);
            }
            Value::Array(values) => {
                values.iter().for_each(|value| self.look_at_digits(kind, value))
            }
            Value::Number(number) => {
                let step = self.steps.entry(kind.to_owned()).or_insert(f64::INFINITY);
                *step = step.min(last_digit(&number.to_string()));
            }
            Value::Null | Value::Bool(_) | Value::String(_) => {}
        }
    }

    fn compare(&mut self, place: &str, kind: &str, old: &Value, new: &Value, sd: Option<f64>) {
        match (old, new) {
            (Value::Object(old), Value::Object(new)) if old.keys().eq(new.keys()) => {
                for (key, value) in old {
                    let (place, kind) = (format!("{place}.{key}"), format!("{kind}.{key}"));
                    match (value, &new[key]) {
                        (Value::String(old), Value::String(new)) if PACKED.contains(&&**key) => {
                            self.compare_packed(&place, old, new);
                        }
                        (value, other) => {
                            self.compare(&place, &kind, value, other, own_sd(old, key));
                        }
                    }
                }
            }
            (Value::Array(old), Value::Array(new)) if old.len() == new.len() => {
                for (index, (old, new)) in old.iter().zip(new).enumerate() {
                    self.compare(&format!("{place}[{index}]"), kind, old, new, sd);
                }
            }
            (Value::Number(old), Value::Number(new)) => {
                let step = self.steps.get(kind).copied().unwrap_or(0.0);
                let (Some(old), Some(new)) = (old.as_f64(), new.as_f64()) else { return };
                self.compare_numbers(place, [old, new], step, sd);
            }
            (old, new) if old == new => {}
            (old, new) => self.moved.push(format!("{place}: {old} → {new}")),
        }
    }

    fn compare_numbers(&mut self, place: &str, [old, new]: [f64; 2], step: f64, sd: Option<f64>) {
        self.numbers += 1;
        let moved = (new - old).abs();
        let allowed = sd.map_or(RELATIVE * old.abs(), |sd| SD_SHARE * sd);
        // Rounding of the decimal numbers themselves.
        let rounding = 1e-6 * step;
        if moved > allowed.max(step) + rounding {
            let sd = sd.map_or(String::new(), |sd| format!(", standard error {sd}"));
            self.moved.push(format!("{place}: {old} → {new}{sd}"));
        } else if moved > allowed {
            self.stepped += 1;
        }
    }

    fn compare_packed(&mut self, place: &str, old: &str, new: &str) {
        let unpacked = |text: &str| STANDARD.decode(text).unwrap_or_default();
        let (old, new) = (unpacked(old), unpacked(new));
        if old.len() != new.len() {
            self.moved.push(format!("{place}: {} → {} bytes", old.len(), new.len()));
        }
        for (index, (old, new)) in old.chunks_exact(2).zip(new.chunks_exact(2)).enumerate() {
            let [old, new] =
                [old, new].map(|pair| f64::from(i16::from_le_bytes([pair[0], pair[1]])));
            self.compare_numbers(&format!("{place}[{index}]"), [old, new], 1.0, None);
        }
    }
}

/// The standard error of a figure, which stands beside it: that of `girth_tape_mm` is `girth_sd_mm`, and a
/// position along the leg is as uncertain as its height.
fn own_sd(beside: &Map<String, Value>, key: &str) -> Option<f64> {
    if key.contains("_sd") {
        return None;
    }
    let (first, rest) = key.split_once('_').unwrap_or(("", key));
    let unit = rest.rsplit('_').next().unwrap_or(rest);
    let named = if first.is_empty() { format!("sd_{unit}") } else { format!("{first}_sd_{unit}") };
    let sd = |name: &str| beside.get(name).and_then(Value::as_f64);
    let along = ["along_axis_mm", "centre_mm", "surface_length_mm"].contains(&key);
    sd(&named).or_else(|| if along { sd("height_sd_mm") } else { None })
}

/// The unit of the last digit of a decimal number.
fn last_digit(number: &str) -> f64 {
    let (digits, exponent) = number.split_once('e').unwrap_or((number, "0"));
    let places = digits.split_once('.').map_or(0, |(_, places)| places.len() as i32);
    10.0_f64.powi(exponent.parse::<i32>().unwrap_or(0) - places)
}

//! A bad export, the refusal it must end in, and the one place that holds gaiter to it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::process::Command;

use gaiter_leg::method::{Axis, FacingChoice, Unit, UnitChoice, Up, Winding};
use gaiter_leg::{self as leg, Method};
use gaiter_scan::Format;
use tempfile::TempDir;

/// A bad export and the refusal it must end in.
pub struct Case {
    pub name: String,
    pub bytes: Vec<u8>,
    /// As on the command line.
    pub options: &'static [&'static str],
    pub code: &'static str,
    /// What the message must tell, figures above all.
    pub says: Vec<String>,
}

/// A case without options.
pub fn case(name: &str, bytes: impl Into<Vec<u8>>, code: &'static str, says: &[&str]) -> Case {
    let says = says.iter().map(|said| (*said).to_owned()).collect();
    Case { name: name.to_owned(), bytes: bytes.into(), options: &[], code, says }
}

/// The same case with options.
pub fn declared(mut case: Case, options: &'static [&'static str]) -> Case {
    case.options = options;
    case
}

/// The method that these options choose.
pub fn method(options: &[&str]) -> Method {
    let mut method = Method::default();
    for option in options {
        match *option {
            "--unit=mm" => method.unit = UnitChoice::Declared(Unit::Mm),
            "--unit=cm" => method.unit = UnitChoice::Declared(Unit::Cm),
            "--unit=in" => method.unit = UnitChoice::Declared(Unit::In),
            "--unit=m" => method.unit = UnitChoice::Declared(Unit::M),
            "--up=x" => method.up = Up::X,
            "--up=z" => method.up = Up::Z,
            "--facing=+x" => method.facing = FacingChoice::Declared(Axis::PlusX),
            "--facing=-x" => method.facing = FacingChoice::Declared(Axis::MinusX),
            "--facing=+z" => method.facing = FacingChoice::Declared(Axis::PlusZ),
            "--facing=-z" => method.facing = FacingChoice::Declared(Axis::MinusZ),
            "--winding=inward" => method.winding = Winding::Inward,
            "--facing=+y" => method.facing = FacingChoice::Declared(Axis::PlusY),
            other => panic!("{other}"),
        }
    }
    method
}

/// Measures every case through the library and through the program.
pub fn check(cases: &[Case]) {
    assert!(!cases.is_empty());
    let dir = TempDir::new().unwrap();
    for Case { name, bytes, options, code, says } in cases {
        let refusal = match leg::extract(bytes, Format::Obj, &method(options)) {
            Err(refusal) => refusal,
            Ok(found) => panic!("{name}: a record with {} legs", found.legs.len()),
        };
        let message = refusal.to_string();
        assert_eq!(refusal.code(), *code, "{name}: {message}");
        for said in says {
            assert!(message.contains(said.as_str()), "{name}: no \"{said}\" in: {message}");
        }
        assert!(!message.contains("NaN"), "{name}: {message}");

        let path = dir.path().join(format!("{}.obj", name.replace([' ', '/'], "_")));
        fs::write(&path, bytes).unwrap();
        let out = dir.path().join("records");
        let done = Command::new(crate::verb::program())
            .args(["extract", "--json"])
            .arg(&path)
            .arg("--out")
            .arg(&out)
            .args(*options)
            .output()
            .unwrap();
        let stderr = String::from_utf8(done.stderr).unwrap();
        assert_eq!(done.status.code(), Some(65), "{name}: {stderr}");
        assert_eq!(done.stdout, b"", "{name}");
        let expected =
            format!("gaiter: {}: cannot be measured [{code}]: {message}", path.display());
        let rest = stderr.strip_prefix(&expected);
        let is_advice =
            |rest: &str| rest.starts_with("; the body stands along another axis: --up ");
        assert!(rest.is_some_and(|rest| rest == "\n" || is_advice(rest)), "{name}: {stderr}");
        assert_eq!(stderr.lines().count(), 1, "{name}: {stderr}");
        assert_eq!(message.lines().count(), 1, "{name}: {message}");
        assert!(!out.exists(), "{name}: a record folder for a scan that cannot be measured");
    }
}

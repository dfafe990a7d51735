//! A list that says it holds all of an enum does.

#![allow(clippy::unwrap_used)]

use std::fs;

use regex::Regex;

use crate::rules::{collect, packages};

/// The names of an enum's variants; none if one of them holds fields.
fn variants(source: &str, name: &str) -> Option<Vec<String>> {
    let begin = format!("enum {name} {{\n");
    let (_, body) = source.split_once(&begin)?;
    let (body, _) = body.split_once("\n}\n")?;
    let variant = Regex::new(r"(?m)^    ([A-Z][A-Za-z0-9]*)([,({ ])").unwrap();
    let found: Vec<_> = variant.captures_iter(body).collect();
    let is_plain = !found.is_empty() && found.iter().all(|found| &found[2] == ",");
    is_plain.then(|| found.iter().map(|found| found[1].to_owned()).collect())
}

#[test]
fn a_list_of_all_variants_holds_each_of_them_once() {
    let list = Regex::new(r"const (?:ALL|BOTH): \[([A-Za-z]+); \d+\] =\s*\[([^\]]*)\]").unwrap();
    let mut files = Vec::new();
    packages().iter().for_each(|package| collect(&package.join("src"), &mut files));
    let mut lists = 0;
    for path in files {
        let source = fs::read_to_string(&path).unwrap();
        for found in list.captures_iter(&source) {
            let name = &found[1];
            let Some(mut variants) = variants(&source, name) else { continue };
            let prefix = format!("{name}::");
            let mut listed: Vec<String> = found[2]
                .split(',')
                .filter_map(|item| item.trim().strip_prefix(&prefix).map(str::to_owned))
                .collect();
            variants.sort();
            listed.sort();
            assert_eq!(listed, variants, "{}: {name}", path.display());
            lists += 1;
        }
    }
    assert!(lists > 0, "no list was found");
}

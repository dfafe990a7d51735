//! No files of a crate import each other in a circle, over however many steps. Read from the imports: a
//! name that is handed on by `pub use` counts for the file that defines it.

#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::rules::packages;

/// The names of a module and those above it: `station`, `booth`, `orders`.
type Names = Vec<String>;

/// A file of the crate as a module.
struct Module {
    names: Names,
    code: String,
    /// What it hands on, by name: where that is.
    handed_on: BTreeMap<String, Names>,
}

/// The modules of the crate, by their names.
type Crate = BTreeMap<Names, Module>;

fn crate_modules(source: &Path) -> Crate {
    let mut all = Crate::new();
    collect(source, source, &mut all);
    let handed_on = all.iter().map(|(names, module)| {
        let of = imports(&module.code).into_iter().filter(|(is_public, _)| *is_public);
        let of = of.filter_map(|(_, path)| {
            let name = path.last()?.clone();
            Some((name, absolute(&all, names, &path)?))
        });
        (names.clone(), of.collect())
    });
    let handed_on: BTreeMap<Names, BTreeMap<String, Names>> = handed_on.collect();
    for (names, of) in handed_on {
        all.get_mut(&names).unwrap().handed_on = of;
    }
    all
}

fn collect(root: &Path, folder: &Path, all: &mut Crate) {
    for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            collect(root, &path, all);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            let names = names(path.strip_prefix(root).unwrap());
            // Tests may use whatever is there.
            if names.last().is_some_and(|name| name == "tests") {
                continue;
            }
            let text = fs::read_to_string(&path).unwrap();
            let code = text.split("#[cfg(test)]\nmod tests").next().unwrap();
            let code = code.lines().map(|line| line.split("//").next().unwrap());
            let code = code.collect::<Vec<_>>().join("\n");
            all.insert(names.clone(), Module { names, code, handed_on: BTreeMap::new() });
        }
    }
}

fn names(path: &Path) -> Names {
    let path: PathBuf = path.with_extension("");
    let mut names: Names = path.iter().map(|name| name.to_str().unwrap().to_owned()).collect();
    if names.last().is_some_and(|name| name == "lib") {
        names.pop();
    }
    names
}

/// The paths of a file's `use` lines, groups taken apart, and whether they are public.
fn imports(code: &str) -> Vec<(bool, Names)> {
    let mut found = Vec::new();
    let mut rest = code;
    while let Some(at) = rest.find("use ") {
        let line = rest[..at].rsplit('\n').next().unwrap();
        let (statement, after) = rest[at + 4..].split_once(';').unwrap_or((&rest[at + 4..], ""));
        let is_path = statement.chars().all(|c| c.is_alphanumeric() || "_:{}*, \n".contains(c));
        if !is_path {
            // It stands in a text.
            rest = &rest[at + 4..];
        } else if ["", "pub "].contains(&line) || line.starts_with("pub(") && line.ends_with(") ") {
            let mut paths = Vec::new();
            expand(&statement.split_whitespace().collect::<Vec<_>>().join(" "), &[], &mut paths);
            found.extend(paths.into_iter().map(|path| (!line.is_empty(), path)));
            rest = after;
        } else {
            rest = &rest[at + 4..];
        }
    }
    found
}

/// Takes `a::{b, c::{d, e}}` apart.
fn expand(tree: &str, before: &[String], found: &mut Vec<Names>) {
    let (path, group) = match tree.trim().split_once('{') {
        Some((path, group)) => (path, Some(group.trim_end().strip_suffix('}').unwrap())),
        None => (tree.split(" as ").next().unwrap(), None),
    };
    let steps = path.split("::").map(str::trim).filter(|step| !step.is_empty());
    let whole: Names = before.iter().cloned().chain(steps.map(str::to_owned)).collect();
    let Some(group) = group else {
        let is_self = whole.len() > 1 && whole.last().is_some_and(|step| step == "self");
        return found.push(if is_self { whole[..whole.len() - 1].to_vec() } else { whole });
    };
    let (mut depth, mut from) = (0, 0);
    for (at, letter) in group.char_indices().chain([(group.len(), ',')]) {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                if !group[from..at].trim().is_empty() {
                    expand(&group[from..at], &whole, found);
                }
                from = at + 1;
            }
            _ => {}
        }
    }
}

/// A path of a module from the crate's root; none where it leads out of the crate.
fn absolute(all: &Crate, of: &Names, path: &[String]) -> Option<Names> {
    let (first, rest) = path.split_first()?;
    let mut from = match first.as_str() {
        "crate" => Names::new(),
        "self" => of.clone(),
        "super" => of[..of.len().checked_sub(1)?].to_vec(),
        name => {
            let child: Names = of.iter().cloned().chain([name.to_owned()]).collect();
            all.contains_key(&child).then_some(child)?
        }
    };
    for step in rest {
        match step.as_str() {
            "super" => _ = from.pop(),
            _ => from.push(step.clone()),
        }
    }
    Some(from)
}

/// The module that defines what a path leads to.
fn definer<'a>(all: &'a Crate, path: &[String]) -> Option<&'a Module> {
    let longest = (0..=path.len()).rev().find_map(|length| all.get(&path[..length]))?;
    let rest = &path[longest.names.len()..];
    let further = rest.first().and_then(|name| longest.handed_on.get(name));
    match further.filter(|further| further.as_slice() != path) {
        Some(further) => {
            definer(all, &further.iter().chain(&rest[1..]).cloned().collect::<Names>())
        }
        None => Some(longest),
    }
}

/// Paths from the crate's root that stand in the code itself.
fn inline(code: &str) -> Vec<Names> {
    let is_step = |letter: char| letter.is_alphanumeric() || "_:".contains(letter);
    let after = code.match_indices("crate::").map(|(at, _)| &code[at..]);
    let paths = after.map(|text| &text[..text.find(|c| !is_step(c)).unwrap_or(text.len())]);
    paths
        .map(|path| path.split("::").filter(|step| !step.is_empty()).map(str::to_owned).collect())
        .collect()
}

fn arrows(all: &Crate) -> BTreeMap<&Names, BTreeSet<&Names>> {
    let of = |module: &Module| {
        let imports = imports(&module.code).into_iter().filter(|(is_public, _)| !is_public);
        let paths = imports.map(|(_, path)| path).chain(inline(&module.code));
        let paths: Vec<Names> =
            paths.filter_map(|path| absolute(all, &module.names, &path)).collect();
        let to = paths.iter().filter_map(|path| definer(all, path)).map(|module| &module.names);
        // A module is made of those within it.
        to.filter(|names| !names.starts_with(&module.names)).collect::<BTreeSet<&Names>>()
    };
    all.iter().map(|(names, module)| (names, of(module))).collect()
}

/// Goes on from the end of a way, and notes each circle that it closes.
fn follow<'a>(
    arrows: &BTreeMap<&'a Names, BTreeSet<&'a Names>>,
    way: &mut Vec<&'a Names>,
    done: &mut BTreeSet<&'a Names>,
    circles: &mut Vec<String>,
) {
    let Some(here) = way.last().copied() else { return };
    for next in &arrows[here] {
        if let Some(at) = way.iter().position(|names| names == next) {
            let circle = way[at..].iter().chain([next]).map(|names| names.join("::"));
            circles.push(circle.collect::<Vec<_>>().join(" -> "));
        } else if !done.contains(next) {
            way.push(next);
            follow(arrows, way, done, circles);
            way.pop();
        }
    }
    done.insert(here);
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let (mut count, mut circles) = (0, Vec::new());
    for package in packages() {
        let all = crate_modules(&package.join("src"));
        let arrows = arrows(&all);
        count += arrows.values().map(BTreeSet::len).sum::<usize>();
        let mut done = BTreeSet::new();
        for names in arrows.keys() {
            follow(&arrows, &mut vec![names], &mut done, &mut circles);
        }
    }
    assert!(count > 1000, "only {count} imports were read");
    assert!(circles.is_empty(), "{} circles:\n{}", circles.len(), circles.join("\n"));
}

#[test]
fn groups_of_imports_are_taken_apart() {
    let code = "pub use a::B;\nuse crate::c::{D as X, e::{F, self}, g::*};\nlet reuse = 1;\n";
    let found: Vec<(bool, String)> =
        imports(code).into_iter().map(|(public, path)| (public, path.join("::"))).collect();
    let expected = ["a::B", "crate::c::D", "crate::c::e::F", "crate::c::e", "crate::c::g::*"];
    let expected = expected.map(str::to_owned);
    assert_eq!(found.iter().map(|(_, path)| path.clone()).collect::<Vec<_>>(), expected);
    assert_eq!(
        found.iter().map(|(public, _)| *public).collect::<Vec<_>>(),
        [true, false, false, false, false]
    );
}

//! The commands that documents name: their examples, benches, tests, verbs and options exist. Those that a
//! reader can copy are run word for word by `tests/pages` and `systemd/boot`.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use regex::Regex;
use rig::verb::{gaiter, stdout};

use crate::rules::{collect, packages, root};

/// A command of a page.
struct Command {
    page: String,
    words: Vec<String>,
}

impl Command {
    fn fail(&self, why: &str) -> ! {
        panic!("{}: `{}`: {why}", self.page, self.words.join(" "))
    }

    /// The word behind an option.
    fn after(&self, option: &str) -> Option<&str> {
        let at = self.words.iter().position(|word| word == option)?;
        self.words.get(at + 1).map(String::as_str)
    }
}

/// The pages for readers, by their paths.
fn pages() -> Vec<(String, String)> {
    let mut paths: Vec<_> = ["README.md", "CONTRIBUTING.md", "SECURITY.md", "ARCHITECTURE.md"]
        .map(|name| root().join(name))
        .into();
    let docs = fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path());
    paths.extend(docs.filter(|path| path.extension().is_some_and(|ending| ending == "md")));
    let name = |path: &Path| path.strip_prefix(root()).unwrap().display().to_string();
    paths.iter().map(|path| (name(path), fs::read_to_string(path).unwrap())).collect()
}

/// Every command of these pages that begins with this word, in blocks and within sentences.
fn commands(first: &str) -> Vec<Command> {
    let inline = Regex::new(r"`([^`\n]+)`").unwrap();
    let mut found = Vec::new();
    for (page, text) in pages() {
        let blocks = text.split("```").skip(1).step_by(2).flat_map(str::lines);
        let spans = inline.captures_iter(&text).map(|span| span.get(1).unwrap().as_str());
        for line in blocks.chain(spans) {
            let line = line.split(" #").next().unwrap();
            for part in line.split(['|', ';']).flat_map(|part| part.split("&&")) {
                let words: Vec<&str> = part.split_whitespace().collect();
                // `sudo -u gaiter gaiter check`, `RUST_LOG=debug gaiter run`
                let is_prefix = |word: &&&str| {
                    **word != first || words.iter().filter(|w| *w == *word).count() > 1
                };
                let skipped = match words.first() {
                    Some(&"sudo") => words.iter().rposition(|word| *word == first),
                    Some(word) if word.contains('=') => {
                        words.iter().position(|word| *word == first)
                    }
                    _ => Some(words.iter().take(1).take_while(is_prefix).count()),
                };
                let Some(skipped) = skipped else { continue };
                let words: Vec<String> =
                    words[skipped..].iter().map(|word| (*word).to_owned()).collect();
                if words.first().is_some_and(|word| word == first) && words.len() > 1 {
                    found.push(Command { page: page.clone(), words });
                }
            }
        }
    }
    found
}

/// The paths of all tests of a test binary, as `cargo test` filters them.
fn tests_of(name: &str) -> Vec<String> {
    let folder = packages().into_iter().map(|package| package.join("tests").join(name));
    let mut folder =
        folder.filter(|folder| folder.exists() || folder.with_extension("rs").exists());
    let Some(folder) = folder.next_back() else { return Vec::new() };
    let single = folder.with_extension("rs");
    let mut files = Vec::new();
    collect(&folder, &mut files);
    files.extend(single.exists().then_some(single));
    let test = Regex::new(r"#\[test\]\s*(?:#\[[^\]]*\]\s*)*fn (\w+)").unwrap();
    let mut paths = Vec::new();
    for file in files {
        let module = file.strip_prefix(&folder).unwrap_or(Path::new("main.rs")).with_extension("");
        let module: Vec<_> = module.iter().map(|part| part.to_str().unwrap()).collect();
        let module = module.join("::").replace("::mod", "");
        let source = fs::read_to_string(&file).unwrap();
        let of_file = test.captures_iter(&source).map(|found| match module.as_str() {
            "main" => found[1].to_owned(),
            module => format!("{module}::{}", &found[1]),
        });
        paths.extend(of_file);
    }
    paths
}

/// What the words behind the three marks of a block may be; `tests/pages` and `systemd/boot` say which they
/// run.
const KINDS: [&str; 13] = [
    "sh clone",
    "sh station",
    "sh install",
    "sh package",
    "sh hardware",
    "sh developer",
    "sh archive",
    "text",
    "toml",
    "json",
    "sql",
    "ini",
    "udev",
];

#[test]
fn every_block_says_what_it_is_and_so_whether_a_test_runs_it() {
    let mut blocks = 0;
    for (page, text) in pages() {
        let marks = text.lines().map(str::trim_start).filter_map(|line| line.strip_prefix("```"));
        for kind in marks.step_by(2) {
            assert!(KINDS.contains(&kind), "{page}: {kind:?}");
            blocks += 1;
        }
    }
    assert!(blocks > 130, "only {blocks}");
}

#[test]
fn what_cargo_is_asked_for_exists() {
    let commands = commands("cargo");
    assert!(commands.len() > 30, "only {}", commands.len());
    for command in &commands {
        for (option, folder) in [("--example", "examples"), ("--bench", "benches")] {
            if let Some(name) = command.after(option)
                && !packages().iter().any(|p| p.join(folder).join(format!("{name}.rs")).exists())
            {
                command.fail("there is no such file");
            }
        }
        let Some(name) = command.after("--test") else { continue };
        let tests = tests_of(name);
        if tests.is_empty() {
            command.fail("it has no tests");
        }
        let behind = command.words.iter().skip_while(|word| *word != name).skip(1);
        let filters = behind.filter(|word| !word.starts_with('-') && *word != "…" && *word != "1");
        for filter in filters {
            if !tests.iter().any(|test| test.contains(filter.as_str())) {
                command.fail("no test of this name");
            }
        }
    }
}

/// What `--help` of each verb says, and of the verbs below it.
static HELP: LazyLock<BTreeMap<String, String>> = LazyLock::new(|| {
    let verbs = verbs_in(&stdout(&gaiter(&["help"])));
    assert!(verbs.len() > 20, "{verbs:?}");
    let mut help = BTreeMap::new();
    for verb in verbs {
        let said = stdout(&gaiter(&[&verb, "--help"]));
        for below in said.split_once("Commands:").map_or(Vec::new(), |(_, list)| verbs_in(list)) {
            help.insert(format!("{verb} {below}"), stdout(&gaiter(&[&verb, &below, "--help"])));
        }
        help.insert(verb, said);
    }
    help
});

/// The verbs of a list in a help text.
fn verbs_in(help: &str) -> Vec<String> {
    let verb = Regex::new(r"(?m)^  ([a-z][a-z-]+)  ").unwrap();
    verb.captures_iter(help).map(|found| found[1].to_owned()).collect()
}

#[test]
fn every_verb_and_option_of_the_documents_exists() {
    let mut commands = commands("gaiter");
    for mut command in self::commands("cargo") {
        let behind = command.words.iter().position(|word| word == "--");
        if command.words[1] == "run" && command.after("--example").is_none() {
            command.words = command.words.split_off(behind.unwrap());
            commands.push(command);
        }
    }
    assert!(commands.len() > 100, "only {}", commands.len());
    let option = Regex::new(r"--[a-z][a-z-]*").unwrap();
    for command in &commands {
        let verb = command.words[1].as_str();
        if verb.starts_with(|c: char| !c.is_ascii_lowercase()) || verb == "help" {
            continue;
        }
        let below = command.words.get(2).and_then(|word| HELP.get(&format!("{verb} {word}")));
        let Some(help) = below.or_else(|| HELP.get(verb)) else {
            command.fail("there is no such verb")
        };
        for word in &command.words[2..] {
            for option in option.find_iter(word) {
                if !help.contains(option.as_str()) {
                    command.fail(&format!("{verb} has no {}", option.as_str()));
                }
            }
        }
    }
}

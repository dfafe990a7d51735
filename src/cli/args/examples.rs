//! The examples of every verb, for `--help` and the manual pages. A test holds them against the command
//! line: each is understood, and no verb is without one.

use clap::Command;

/// The words of each verb (`patient set`; none for gaiter itself) with its command lines, each with what it does; in the
/// order of [`GROUPS`](super::groups::GROUPS).
const EXAMPLES: &[(&str, &[[&str; 2]])] = &[
    (
        "",
        &[
            ["gaiter demo", "shows a whole station at work; needs no configuration"],
            ["gaiter extract 4711.obj --out measured", "measures a scan and writes its record"],
            ["gaiter status", "shows whether the station is ready"],
            ["gaiter help extract", "shows the options and more examples of a verb"],
        ],
    ),
    ("demo", &[["gaiter demo", "leaves the records in ./demo/records"]]),
    (
        "extract",
        &[
            ["gaiter extract 4711.obj", "prints the measures of one scan"],
            [
                "gaiter extract scans --out measured",
                "also writes a record for each scan of a folder",
            ],
            ["gaiter extract 4711.obj --garment AG", "says what a thigh stocking still needs"],
            ["gaiter extract 4711.obj --up z", "measures an export whose z axis points up"],
            [
                "gaiter extract 4711.obj --at 10,20,30.5",
                "also measures girths at these heights, cm",
            ],
            ["gaiter extract scans --json", "prints one record a line, for programs"],
        ],
    ),
    (
        "calibrate",
        &[
            ["gaiter calibrate cylinder.obj --girths 35.2", "compares a cylinder of 35.2 cm girth"],
            [
                "gaiter calibrate cone.obj --girths 10:35.2,30:38.1",
                "compares girths at two heights",
            ],
        ],
    ),
    (
        "reextract",
        &[
            ["gaiter reextract /srv/records --dry-run", "shows what would change"],
            ["gaiter reextract /srv/records/4711", "measures the scans of one patient again"],
            ["gaiter reextract /srv/records --since 2026-11-21", "leaves older scans alone"],
        ],
    ),
    (
        "report",
        &[
            ["gaiter report /srv/records/4711", "reports the newest record of a patient"],
            ["gaiter report record.json --language de --garment AG --out berichte", "in German"],
        ],
    ),
    (
        "sizes",
        &[
            ["gaiter sizes /srv/records/4711", "judges the newest record by the station's tables"],
            ["gaiter sizes record.json --table maker.toml --garment AG", "by one table"],
            ["gaiter sizes check maker.toml", "checks a table before it is used"],
        ],
    ),
    (
        "sizes check",
        &[
            ["gaiter sizes check maker.toml", "names faults, gaps and overlaps"],
            ["gaiter sizes check /etc/gaiter/sizes --language de", "of all tables, in German"],
        ],
    ),
    (
        "compare",
        &[
            ["gaiter compare /srv/records/4711", "compares all visits of a patient"],
            ["gaiter compare before.json after.json --affected left", "compares two records"],
            ["gaiter compare /srv/records/4711 --out visits", "writes a page, a PDF and JSON"],
        ],
    ),
    (
        "order",
        &[
            ["gaiter order /srv/records/4711 --garment AG", "prints the order of a thigh stocking"],
            [
                "gaiter order record.json --ref A-1042 --out orders",
                "writes tables for programs and for people, and order.json",
            ],
            ["gaiter order record.json --mapping shop.toml", "as a shop system wants it"],
            [
                "gaiter order /srv/records/4711 --reorder changes --last order.json",
                "with the changes since the last order",
            ],
            ["gaiter order check shop.toml", "checks a mapping before it is used"],
        ],
    ),
    (
        "order check",
        &[["gaiter order check /etc/gaiter/orders", "names every fault of the mappings"]],
    ),
    (
        "check",
        &[
            ["gaiter check", "checks the configuration of this machine's station"],
            ["gaiter check --config station.toml", "checks another configuration"],
        ],
    ),
    ("run", &[["gaiter run --config station.toml", "runs a station until Ctrl-C"]]),
    ("status", &[["gaiter status", "shows one screen"]]),
    ("pause", &[["gaiter pause", "leaves new scans at the scanner"]]),
    ("resume", &[["gaiter resume", "takes them in"]]),
    (
        "patient",
        &[
            ["gaiter patient set", "asks for the id of the next patient"],
            ["gaiter patient show", "shows who is next"],
            ["gaiter patient visits", "asks for an id and compares the patient's visits"],
            ["gaiter patient disclose", "asks for an id and writes all that is held of a person"],
        ],
    ),
    ("patient set", &[["gaiter patient set", "asks for the id of the next patient"]]),
    ("patient clear", &[["gaiter patient clear", "drops the name that waits"]]),
    ("patient show", &[["gaiter patient show", "shows who is next"]]),
    (
        "patient visits",
        &[
            ["gaiter patient visits", "asks for the id and prints the comparison"],
            ["gaiter patient visits --out visits", "writes a page, a PDF and JSON"],
        ],
    ),
    (
        "patient affected",
        &[
            ["gaiter patient affected left", "asks for the id and names the left leg as affected"],
            ["gaiter patient affected not-named", "asks for the id and takes it back"],
        ],
    ),
    (
        "patient disclose",
        &[
            ["gaiter patient disclose", "asks for the id and writes the folder disclosure"],
            ["gaiter patient disclose --out access-7", "writes another folder"],
        ],
    ),
    (
        "patient erase",
        &[["gaiter patient erase", "shows what would go, and asks for the id twice"]],
    ),
    (
        "scans",
        &[
            ["gaiter scans", "lists the last 20 scans"],
            ["gaiter scans --state held", "lists those that wait for a decision"],
        ],
    ),
    ("show", &[["gaiter show 1a2b3c4d", "shows a scan by the first digits of its id"]]),
    (
        "explain",
        &[
            ["gaiter explain /srv/scanner/export/4711.obj", "says what became of an export"],
            ["gaiter explain 1a2b3c4d", "says why a scan is where it is"],
        ],
    ),
    ("page", &[["gaiter page", "prints the link for decisions"]]),
    ("gdt-order", &[["gaiter gdt-order /srv/gdt/order.gdt", "names the patient of the next scan"]]),
    ("retry", &[["gaiter retry 1a2b3c4d", "measures the scan again"]]),
    ("release", &[["gaiter release 1a2b3c4d", "delivers the scan to its patient"]]),
    ("assign", &[["gaiter assign 1a2b3c4d", "asks for the id of the patient"]]),
    ("unassign", &[["gaiter unassign 1a2b3c4d", "takes the scan back from its patient"]]),
    ("give-up", &[["gaiter give-up 1a2b3c4d", "ends the question about the scan"]]),
    (
        "amend",
        &[
            [
                "gaiter amend 1a2b3c4d --leg right --level C --girth-cm 38.5 --reason swollen --by Berg",
                "sets the girth of C; its height stays the scan's",
            ],
            [
                "gaiter amend 1a2b3c4d --leg left --level B1 --height-cm 14 --reason marked --by Berg",
                "sets the height of B1; the girth is the scan's there",
            ],
            [
                "gaiter amend measured/4711 --leg left --level D --not-measurable --reason bandage --by Berg",
                "notes that D cannot be measured, in a record of gaiter extract",
            ],
            [
                "gaiter amend 1a2b3c4d --leg right --level C --take-back --reason slip --by Berg",
                "has the scan's values count again",
            ],
        ],
    ),
    (
        "schema",
        &[
            ["gaiter schema", "prints the JSON Schema of record.json"],
            ["gaiter schema order", "prints that of order.json"],
        ],
    ),
    ("completions", &[["gaiter completions bash", "prints a script for bash"]]),
    (
        "man",
        &[
            ["gaiter man", "prints the main page"],
            ["gaiter man /usr/local/share/man/man1", "writes the pages of all verbs there"],
        ],
    ),
];

/// The command line with the examples below the help of each verb.
pub fn with_examples(command: Command) -> Command {
    EXAMPLES.iter().filter(|(verb, _)| !verb.is_empty()).fold(command, |command, (verb, lines)| {
        let words: Vec<&str> = verb.split(' ').collect();
        add(command, &words, text(lines))
    })
}

/// The examples of gaiter itself.
pub fn of_gaiter() -> String {
    EXAMPLES.iter().filter(|(verb, _)| verb.is_empty()).map(|(_, lines)| text(lines)).collect()
}

/// Adds a text to the help of the verb of these words.
fn add(command: Command, words: &[&str], text: String) -> Command {
    match words {
        [] => command.after_help(text),
        [word, rest @ ..] => command.mut_subcommand(*word, |verb| add(verb, rest, text)),
    }
}

/// The lines begin with blanks, so that a manual page keeps them apart.
fn text(lines: &[[&str; 2]]) -> String {
    let line = |[line, does]: &[&str; 2]| format!("\n  {line}\n      {does}");
    format!("Examples:{}", lines.iter().map(line).collect::<String>())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::cli::args::command;

    /// The words of all visible verbs, those of `patient` too.
    fn verbs(command: &Command, before: &str) -> Vec<String> {
        let visible = command.get_subcommands().filter(|verb| !verb.is_hide_set());
        let named = |verb: &Command| format!("{before} {}", verb.get_name()).trim().to_owned();
        visible.flat_map(|verb| [vec![named(verb)], verbs(verb, &named(verb))].concat()).collect()
    }

    #[test]
    fn every_verb_has_examples_and_every_example_is_of_a_verb() {
        let all: BTreeSet<String> = verbs(&command(), "").into_iter().collect();
        let shown =
            EXAMPLES.iter().map(|(verb, _)| (*verb).to_owned()).filter(|verb| !verb.is_empty());
        assert_eq!(shown.collect::<BTreeSet<String>>(), all);
        assert!(all.contains("patient set") && all.len() > 20);
    }

    #[test]
    fn every_example_is_understood_and_is_of_its_verb() {
        for (verb, lines) in EXAMPLES {
            assert!(!lines.is_empty(), "{verb}");
            for [line, _] in *lines {
                let words: Vec<&str> = line.split(' ').collect();
                let understood = command().try_get_matches_from(&words);
                let is_help = words.get(1) == Some(&"help");
                assert!(understood.is_ok() || is_help, "{line}: {understood:?}");
                assert!(line.starts_with(format!("gaiter {verb}").trim_end()), "{line}");
            }
        }
    }
}

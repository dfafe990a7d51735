//! The examples of every verb, for `--help` and the manual pages. A test holds them against the command
//! line: each is understood, and no verb is without one.

use clap::Command;

/// The words of a verb (`patient set`; none for gaiter itself), what follows them on a command line, and what that does;
/// in the order of [`GROUPS`](super::groups::GROUPS), those of a verb one below the other.
const EXAMPLES: &[[&str; 3]] = &[
    ["", "demo", "shows a whole station at work; needs no configuration"],
    ["", "extract 4711.obj --out measured", "measures a scan and writes its record"],
    ["", "status", "shows whether the station is ready"],
    ["", "help extract", "shows the options and more examples of a verb"],
    ["demo", "", "leaves the records in ./demo/records"],
    ["extract", "4711.obj", "prints the measures of one scan"],
    ["extract", "scans --out measured", "also writes a record for each scan of a folder"],
    ["extract", "4711.obj --garment AG", "says what a thigh stocking still needs"],
    ["extract", "4711.obj --up z", "measures an export whose z axis points up"],
    ["extract", "4711.obj --at 10,20,30.5", "also measures girths at these heights, cm"],
    ["extract", "scans --json", "prints one record a line, for programs"],
    ["calibrate", "cylinder.obj --girths 35.2", "compares a cylinder of 35.2 cm girth"],
    ["calibrate", "cone.obj --girths 10:35.2,30:38.1", "compares girths at two heights"],
    ["reextract", "/srv/records --dry-run", "shows what would change"],
    ["reextract", "/srv/records/4711", "measures the scans of one patient again"],
    ["reextract", "/srv/records --since 2026-11-21", "leaves older scans alone"],
    ["report", "/srv/records/4711", "reports the newest record of a patient"],
    ["report", "record.json --language de --garment AG --out berichte", "in German"],
    ["sizes", "/srv/records/4711", "judges the newest record by the station's tables"],
    ["sizes", "record.json --table maker.toml --garment AG", "by one table"],
    ["sizes", "check maker.toml", "checks a table before it is used"],
    ["sizes check", "maker.toml", "names faults, gaps and overlaps"],
    ["sizes check", "/etc/gaiter/sizes --language de", "of all tables, in German"],
    ["compare", "/srv/records/4711", "compares all visits of a patient"],
    ["compare", "before.json after.json --affected left", "compares two records"],
    ["compare", "/srv/records/4711 --out visits", "writes a page, a PDF and JSON"],
    ["order", "/srv/records/4711 --garment AG", "prints the order of a thigh stocking"],
    [
        "order",
        "record.json --ref A-1042 --out orders",
        "writes tables for programs and for people, and order.json",
    ],
    ["order", "record.json --mapping shop.toml", "as a shop system wants it"],
    [
        "order",
        "/srv/records/4711 --reorder changes --last order.json",
        "with the changes since the last order",
    ],
    ["order", "check shop.toml", "checks a mapping before it is used"],
    ["order check", "/etc/gaiter/orders", "names every fault of the mappings"],
    ["check", "", "checks the configuration of this machine's station"],
    ["check", "--config station.toml", "checks another configuration"],
    ["run", "--config station.toml", "runs a station until Ctrl-C"],
    ["status", "", "shows one screen"],
    ["pause", "", "leaves new scans at the scanner"],
    ["resume", "", "takes them in"],
    ["patient", "set", "asks for the id of the next patient"],
    ["patient", "show", "shows who is next"],
    ["patient", "visits", "asks for an id and compares the patient's visits"],
    ["patient", "disclose", "asks for an id and writes all that is held of a person"],
    ["patient set", "", "asks for the id of the next patient"],
    ["patient clear", "", "drops the name that waits"],
    ["patient show", "", "shows who is next"],
    ["patient visits", "", "asks for the id and prints the comparison"],
    ["patient visits", "--out visits", "writes a page, a PDF and JSON"],
    ["patient affected", "left", "asks for the id and names the left leg as affected"],
    ["patient affected", "not-named", "asks for the id and takes it back"],
    ["patient disclose", "", "asks for the id and writes the folder disclosure"],
    ["patient disclose", "--out access-7", "writes another folder"],
    ["patient erase", "", "shows what would go, and asks for the id twice"],
    ["scans", "", "lists the last 20 scans"],
    ["scans", "--state held", "lists those that wait for a decision"],
    ["show", "1a2b3c4d", "shows a scan by the first digits of its id"],
    ["explain", "/srv/scanner/export/4711.obj", "says what became of an export"],
    ["explain", "1a2b3c4d", "says why a scan is where it is"],
    ["page", "", "prints the link for decisions"],
    ["gdt-order", "/srv/gdt/order.gdt", "names the patient of the next scan"],
    ["retry", "1a2b3c4d", "measures the scan again"],
    ["release", "1a2b3c4d", "delivers the scan to its patient"],
    ["assign", "1a2b3c4d", "asks for the id of the patient"],
    ["unassign", "1a2b3c4d", "takes the scan back from its patient"],
    ["give-up", "1a2b3c4d", "ends the question about the scan"],
    [
        "amend",
        "1a2b3c4d --leg right --level C --girth-cm 38.5 --reason swollen --by Berg",
        "sets the girth of C; its height stays the scan's",
    ],
    [
        "amend",
        "1a2b3c4d --leg left --level B1 --height-cm 14 --reason marked --by Berg",
        "sets the height of B1; the girth is the scan's there",
    ],
    [
        "amend",
        "measured/4711 --leg left --level D --not-measurable --reason bandage --by Berg",
        "notes that D cannot be measured, in a record of gaiter extract",
    ],
    [
        "amend",
        "1a2b3c4d --leg right --level C --take-back --reason slip --by Berg",
        "has the scan's values count again",
    ],
    ["schema", "", "prints the JSON Schema of record.json"],
    ["schema", "order", "prints that of order.json"],
    ["completions", "bash", "prints a script for bash"],
    ["man", "", "prints the main page"],
    ["man", "/usr/local/share/man/man1", "writes the pages of all verbs there"],
];

/// The command line with the examples below the help of gaiter and of each verb.
pub fn with_examples(command: Command) -> Command {
    EXAMPLES.chunk_by(|[verb, ..], [next, ..]| verb == next).fold(command, |command, rows| {
        let verb = rows.first().map_or("", |[verb, ..]| *verb);
        let words: Vec<&str> = verb.split_whitespace().collect();
        add(command, &words, text(rows))
    })
}

/// Adds a text to the help of the verb of these words.
fn add(command: Command, words: &[&str], text: String) -> Command {
    match words {
        [] => command.after_help(text),
        [word, rest @ ..] => command.mut_subcommand(*word, |verb| add(verb, rest, text)),
    }
}

/// The lines begin with blanks, so that a manual page keeps them apart.
fn text(rows: &[[&str; 3]]) -> String {
    let example = |row: &[&str; 3]| format!("\n  {}\n      {}", line(row), row[2]);
    format!("Examples:{}", rows.iter().map(example).collect::<String>())
}

/// The command line of an example.
fn line([verb, rest, _]: &[&str; 3]) -> String {
    format!("gaiter {verb} {rest}").split_whitespace().collect::<Vec<_>>().join(" ")
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
        let shown = EXAMPLES.iter().map(|[verb, ..]| *verb).collect::<BTreeSet<&str>>();
        let of_verbs = shown.iter().filter(|verb| !verb.is_empty()).map(|verb| (*verb).to_owned());
        assert_eq!(of_verbs.collect::<BTreeSet<String>>(), all);
        let together = EXAMPLES.chunk_by(|[verb, ..], [next, ..]| verb == next).count();
        assert_eq!(together, shown.len(), "the examples of a verb stand apart");
        assert!(all.contains("patient set") && all.len() > 20);
    }

    #[test]
    fn every_example_is_understood() {
        for line in EXAMPLES.iter().map(line) {
            let words: Vec<&str> = line.split(' ').collect();
            let understood = command().try_get_matches_from(&words);
            let is_help = words.get(1) == Some(&"help");
            assert!(understood.is_ok() || is_help, "{line}: {understood:?}");
        }
    }
}

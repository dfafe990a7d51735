//! The verbs in groups, for `gaiter --help`. A test holds the groups against the verbs.

use clap::Command;

/// The groups, each with its verbs, those first that a newcomer needs.
pub const GROUPS: [(&str, &[&str]); 5] = [
    (
        "Measure",
        &["demo", "extract", "calibrate", "reextract", "report", "sizes", "compare", "order"],
    ),
    ("Run a station", &["check", "run", "status", "pause", "resume"]),
    ("At the station", &["patient", "scans", "show", "explain", "page", "gdt-order"]),
    ("Decide about a scan", &["retry", "release", "assign", "unassign", "give-up", "amend"]),
    ("For shells and programs", &["schema", "completions", "man", "help"]),
];

/// What the verb that clap adds by itself does.
const HELP: &str = "Show the options and examples of a verb";

/// The command line with its verbs in groups.
pub fn with_groups(command: Command) -> Command {
    let header = *command.get_styles().get_header();
    let literal = *command.get_styles().get_literal();
    let wide =
        GROUPS.iter().flat_map(|(_, verbs)| *verbs).map(|verb| verb.len()).max().unwrap_or(0);
    let does = |verb: &str| {
        let about = command.find_subcommand(verb).and_then(Command::get_about);
        about.map_or(HELP.to_owned(), ToString::to_string)
    };
    let row = |verb: &&str| format!("  {literal}{verb:wide$}{literal:#}  {}\n", does(verb));
    let group = |(title, verbs): (&str, &[&str])| {
        format!("{header}{title}:{header:#}\n{}\n", verbs.iter().map(row).collect::<String>())
    };
    let groups: String = GROUPS.into_iter().map(group).collect();
    let template = format!(
        "{{before-help}}{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{groups}\
         {header}Options:{header:#}\n{{options}}{{after-help}}"
    );
    command.help_template(template)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::cli::args::command;

    #[test]
    fn every_verb_is_in_one_group_and_its_line_fits_a_terminal() {
        let command = command();
        let visible = command.get_subcommands().filter(|verb| !verb.is_hide_set());
        let mut verbs: BTreeSet<&str> = visible.map(Command::get_name).collect();
        verbs.insert("help");
        let grouped: Vec<&str> = GROUPS.into_iter().flat_map(|(_, verbs)| verbs).copied().collect();
        assert_eq!(grouped.iter().copied().collect::<BTreeSet<&str>>(), verbs);
        assert_eq!(grouped.len(), verbs.len(), "a verb is in two groups");
        let help = command.clone().term_width(80).render_help().to_string();
        for (title, verbs) in GROUPS {
            assert!(help.contains(&format!("{title}:\n  {}", verbs[0])), "{help}");
        }
        let wide = help.lines().filter(|line| line.chars().count() > 80);
        assert_eq!(wide.collect::<Vec<_>>(), [""; 0]);
    }
}

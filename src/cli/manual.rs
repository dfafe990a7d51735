//! `gaiter completions`, `gaiter man`, `gaiter schema`: the command line for shells and as manual pages,
//! and the record for programs.

use std::io;

use clap::Command;

use super::args::{self, CompletionsArgs, ManArgs, SchemaArgs};
use super::{Exit, complain, exit_of_printing, print, print_to, terminal_safe};

/// Prints the completions for a shell.
pub fn completions(args: &CompletionsArgs) -> Exit {
    let (mut command, mut script) = (visible(), Vec::new());
    clap_complete::generate(args.shell, &mut command, "gaiter", &mut script);
    exit_of_printing("the completions", print_to(io::stdout().lock(), &script))
}

/// Prints the main manual page, or writes the pages of all verbs to a folder.
pub fn man(args: &ManArgs) -> Exit {
    let Some(dir) = &args.dir else {
        // As for the folder: `gaiter help` gets no page.
        let mut command = visible().disable_help_subcommand(true);
        command.build();
        let mut page = Vec::new();
        let rendered = clap_mangen::Man::new(command).render(&mut page);
        let printed = rendered.and_then(|()| print_to(io::stdout().lock(), &page));
        return exit_of_printing("the manual page", printed);
    };
    match clap_mangen::generate_to(visible(), dir) {
        Ok(()) => Exit::Done,
        Err(error) => {
            complain(format_args!("gaiter: {}: {error}", terminal_safe(dir.display())));
            Exit::from(&error)
        }
    }
}

/// Prints the JSON Schema of records or orders.
pub fn schema(args: &SchemaArgs) -> Exit {
    exit_of_printing("the schema", print(args.schema))
}

/// The command line as users see it, without the verb that only the station calls.
fn visible() -> Command {
    let whole = args::command();
    let mut command = Command::new("gaiter");
    command = command.version(env!("CARGO_PKG_VERSION"));
    command = command.about(whole.get_about().cloned().unwrap_or_default());
    command = command.long_about(whole.get_long_about().cloned().unwrap_or_default());
    command = command.after_help(whole.get_after_help().cloned().unwrap_or_default());
    let verbs = whole.get_subcommands().filter(|verb| !verb.is_hide_set());
    command.subcommands(verbs.cloned()).subcommand_required(true)
}

//! `docs/reference/command-line.md` from the declarations of the commands. `FATHOM_WRITE=1 cargo test -p cli page`
//! writes the part below its head.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use clap::{Arg, Command};

use super::topics::TOPICS;

const PAGE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../docs/reference/command-line.md"
);
/// Line of the page where the generated part begins.
const BEGIN: &str = "<!-- Generated from here on by `FATHOM_WRITE=1 cargo test -p cli page`. -->\n";
/// An option with the same meaning in at least this many commands, and in most that have it, is described once.
const SHARED: usize = 7;

/// Commands by the row of an option, which is the same for options of equal name, default and meaning.
type Commands = BTreeMap<String, Vec<String>>;

fn generate() -> String {
    let mut fathom = crate::commands::command();
    fathom.build();
    let mut commands = Commands::new();
    collect_rows(&fathom, &mut commands);
    let mut page = BEGIN.to_owned();
    page += "\n## Shared options\n\n| option | default | meaning |\n|---|---|---|\n";
    page.extend(
        fathom
            .get_arguments()
            .filter(|arg| is_listed(arg))
            .map(format_row),
    );
    page.extend(
        commands
            .keys()
            .map(String::as_str)
            .filter(|row| is_shared(row, &commands)),
    );
    for topic in TOPICS {
        writeln!(page, "\n## {}", topic.title).unwrap();
        for (name, example) in topic.commands {
            let command = fathom.find_subcommand_mut(name).unwrap();
            write_command(&mut page, command, Some(example), &commands);
        }
    }
    page
}

fn collect_rows(command: &Command, commands: &mut Commands) {
    for subcommand in command.get_subcommands().filter(|command| is_shown(command)) {
        for arg in subcommand.get_arguments().filter(|arg| is_own(arg)) {
            let users = commands.entry(format_row(arg)).or_default();
            users.push(subcommand.get_name().to_owned());
        }
        collect_rows(subcommand, commands);
    }
}

/// Whether a row describes an option of many commands, which means the same in most that have it.
fn is_shared(row: &str, commands: &Commands) -> bool {
    let name = option_name(row);
    let same_name = commands.iter().filter(|(other, _)| option_name(other) == name);
    let total: usize = same_name.map(|(_, users)| users.len()).sum();
    let users = commands[row].len();
    row.starts_with("| `--") && users >= SHARED && 2 * users > total
}

/// The first cell of a row.
fn option_name(row: &str) -> &str {
    row.split(" | ").next().unwrap_or(row)
}

fn write_command(page: &mut String, command: &mut Command, example: Option<&str>, commands: &Commands) {
    let usage = command.render_usage().to_string();
    let usage = usage.trim_start_matches("Usage: ").replace("\n       ", "` or `");
    let path = command.get_bin_name().unwrap_or_default().to_owned();
    let about = command.get_about().map(ToString::to_string).unwrap_or_default();
    writeln!(page, "\n### {path}\n\n{}.\n\n`{usage}`", escape(&about)).unwrap();
    let (shared, own): (Vec<&Arg>, Vec<&Arg>) = command
        .get_arguments()
        .filter(|arg| is_own(arg))
        .partition(|arg| is_shared(&format_row(arg), commands));
    if !own.is_empty() {
        page.push_str("\n| argument | default | meaning |\n|---|---|---|\n");
        page.extend(own.into_iter().map(format_row));
    }
    if !shared.is_empty() {
        let names: Vec<_> = shared
            .iter()
            .map(|arg| format!("`--{}`", arg.get_long().unwrap_or_default()))
            .collect();
        writeln!(page, "\n[Shared](#shared-options): {}.", names.join(", ")).unwrap();
    }
    if let Some(example) = example {
        writeln!(page, "\nExample: `{example}`").unwrap();
    }
    for subcommand in command.get_subcommands_mut().filter(|command| is_shown(command)) {
        write_command(page, subcommand, None, commands);
    }
}

fn is_shown(command: &Command) -> bool {
    !command.is_hide_set() && command.get_name() != "help"
}

fn is_listed(arg: &Arg) -> bool {
    !arg.is_hide_set()
}

/// Whether the command adds the argument to those of every command.
fn is_own(arg: &Arg) -> bool {
    is_listed(arg) && !arg.is_global_set() && arg.get_id() != "help"
}

/// Name, default and meaning. The help texts contain defaults that depend on the machine as `[default: …]`.
fn format_row(arg: &Arg) -> String {
    let name = match arg.get_long() {
        Some(long) => format!("--{long} {}", name_value(arg)),
        None => name_value(arg),
    };
    let help = arg.get_help().map(ToString::to_string).unwrap_or_default();
    let (help, worded) = match help.split_once(" [default: ") {
        Some((before, after)) => {
            let (default, rest) = after.split_once(']').unwrap_or((after, ""));
            (format!("{before}{rest}"), Some(default.to_owned()))
        }
        None => (help, None),
    };
    let default = match (worded, arg.get_default_values()) {
        (Some(default), _) => escape(&default),
        (None, _) if arg.is_required_set() => "required".to_owned(),
        (None, [value]) if arg.get_action().takes_values() && !value.is_empty() => {
            format!("`{}`", value.to_string_lossy())
        }
        _ => String::new(),
    };
    let variable = arg.get_env().map_or_else(String::new, |name| {
        format!("; also the variable `{}`", name.to_string_lossy())
    });
    let help = escape(&(help + &list_values(arg))) + &variable;
    format!("| `{}` | {default} | {help} |\n", name.trim().replace('|', "\\|"))
}

/// Name of the value: an ellipsis if it would repeat that of the option.
fn name_value(arg: &Arg) -> String {
    let value = arg.get_value_names().and_then(|names| names.first());
    let Some(value) = value.filter(|_| arg.get_action().takes_values()) else {
        return String::new();
    };
    let repeats = arg
        .get_long()
        .is_some_and(|long| long.to_uppercase().replace('-', "_") == value.as_str());
    let is_list = arg.get_num_args().is_some_and(|range| range.max_values() > 1);
    match (repeats, is_list) {
        (true, _) => "…".to_owned(),
        (false, true) => format!("{value}…"),
        (false, false) => value.to_string(),
    }
}

/// The accepted values with their meanings.
fn list_values(arg: &Arg) -> String {
    let values = arg.get_possible_values();
    if !arg.get_action().takes_values() || values.is_empty() {
        return String::new();
    }
    let values = values.iter().map(|value| match value.get_help() {
        Some(help) => format!("`{}` ({help})", value.get_name()),
        None => format!("`{}`", value.get_name()),
    });
    format!(": {}", values.collect::<Vec<_>>().join(", "))
}

/// Text for a cell, without HTML, emphasis or columns in Markdown.
fn escape(text: &str) -> String {
    let text = text.replace('|', "\\|").replace('\n', " ");
    let parts = text.split('`').enumerate();
    let parts = parts.map(|(index, part)| match index % 2 {
        0 => part.replace('<', "&lt;").replace('*', "\\*"),
        _ => part.to_owned(),
    });
    parts.collect::<Vec<_>>().join("`")
}

#[test]
fn the_page_of_the_command_line_is_up_to_date() {
    let committed = std::fs::read_to_string(PAGE).unwrap();
    let head = committed
        .find(BEGIN)
        .map_or(committed.as_str(), |begin| &committed[..begin]);
    let page = format!("{head}{}", generate());
    if std::env::var_os("FATHOM_WRITE").is_some() {
        std::fs::write(PAGE, page).unwrap();
    } else {
        assert!(
            committed == page,
            "docs/reference/command-line.md is out of date: run FATHOM_WRITE=1 cargo test -p cli page"
        );
    }
}

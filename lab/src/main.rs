//! The `fathom-lab` command: measures the product and draws the figures of its pages.

mod commands;
mod drawing;
mod look;
mod machine;
mod studio;

use std::process::ExitCode;

use clap::Parser;

/// Measures Fathom and draws the figures of its pages
#[derive(Parser)]
#[command(name = "fathom-lab", version, about, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: commands::Command,
}

fn main() -> ExitCode {
    cli::exit::end("fathom-lab", Arguments::parse().command.run()).into()
}

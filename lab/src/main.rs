//! The `fathom-lab` command: measures the product and draws the charts of its pages.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use cli::exit::Failure;
use cli::styles::StyleArguments;
use lab::experiments;

/// Measures Fathom and draws the charts of its pages
#[derive(Parser)]
#[command(name = "fathom-lab", version, about, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Run an experiment and write its tables, charts and pictures; without a name, list all experiments
    Experiment {
        /// A name from the list, or a JSON file: a job, or cases, variants and measurements like those in lab/experiments
        name: Option<String>,
        /// Files that the experiment measures
        inputs: Vec<PathBuf>,
        /// A parameter of the experiment; may be repeated
        #[arg(long, value_name = "NAME=VALUE")]
        set: Vec<String>,
        /// Folder for the results
        #[arg(long, value_name = "DIR", default_value = "target/experiments")]
        out: PathBuf,
        #[command(flatten)]
        styles: StyleArguments,
    },
}

impl Command {
    fn run(self) -> Result<(), Failure> {
        let Self::Experiment {
            name,
            inputs,
            set,
            out,
            styles,
        } = self;
        match name {
            Some(name) => experiments::run(&name, &set, inputs, styles, &out),
            None => {
                println!("{}", experiments::describe_all());
                Ok(())
            }
        }
    }
}

fn main() -> ExitCode {
    cli::exit::end("fathom-lab", Arguments::parse().command.run()).into()
}

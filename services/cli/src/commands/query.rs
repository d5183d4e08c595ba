//! `fathom query`: images by their parameters and metrics.

use cli::exit::Failure;
use cli::images::Question;
use cli::remote::{Remote, ServerArguments};
use cli::table::{cell, table};
use serde_json::Value;

/// Options of `fathom query`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Which images, such as 'uiqm > 0.8 and water.style in ("muddy")'; empty: all
    #[arg(default_value = "")]
    filter: String,
    /// Only this dataset
    #[arg(long)]
    dataset: Option<String>,
    /// Order, such as uiqm or -uiqm (largest first)
    #[arg(long, value_name = "COLUMN", allow_hyphen_values = true)]
    order_by: Option<String>,
    /// Most rows to print
    #[arg(long, default_value_t = 50)]
    limit: usize,
    /// Columns to print, comma-separated
    #[arg(long, value_delimiter = ',')]
    fields: Vec<String>,
    /// Print one JSON object per image
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    server: ServerArguments,
}

/// Columns shown unless others are asked for.
pub(crate) const USUAL_FIELDS: [&str; 9] = [
    "job",
    "frame",
    "water.optics",
    "water.style",
    "alpha",
    "entropy",
    "uicm",
    "uiqm",
    "uciqe",
];
/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let remote = Remote::new(&arguments.server);
    let usual = USUAL_FIELDS.map(str::to_owned).to_vec();
    let fields = if arguments.fields.is_empty() {
        usual
    } else {
        arguments.fields.clone()
    };
    let question = Question {
        dataset: arguments.dataset.as_deref(),
        filter: &arguments.filter,
        order_by: arguments.order_by.as_deref(),
        fields: &fields,
        limit: arguments.limit,
    };
    let rows = question.ask(&remote)?;
    if arguments.json {
        rows.iter().for_each(|row| println!("{row}"));
        return Ok(());
    }
    println!("{}", rows_table(&fields, &rows));
    println!("{} images", rows.len());
    Ok(())
}

/// Image rows as a text table with these columns.
pub(crate) fn rows_table(fields: &[String], rows: &[Value]) -> String {
    let header: Vec<&str> = fields.iter().map(String::as_str).collect();
    let cells: Vec<Vec<String>> = rows
        .iter()
        .map(|row| fields.iter().map(|field| cell(&row[field])).collect())
        .collect();
    table(&header, &cells)
}

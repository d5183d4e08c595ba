//! `fathom query`: lists images by their parameters and metrics.

use cli::exit::Failure;
use cli::known;
use cli::plural::count;
use cli::remote::ServerArguments;
use cli::table::image_table;
use client::ImageQuery;

/// Options of `fathom query`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Which images, such as 'uiqm > 0.8 and water.style in ("muddy")' [default: all]
    #[arg(default_value = "")]
    filter: String,
    /// Only images of this dataset
    #[arg(long)]
    dataset: Option<String>,
    /// Sort by a column, such as uiqm, or -uiqm for largest first
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

/// Columns shown by default.
const USUAL_FIELDS: [&str; 9] = [
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
    let client = arguments.server.client();
    let mut fields = arguments.fields.clone();
    if fields.is_empty() {
        fields.extend(USUAL_FIELDS.map(str::to_owned));
    }
    let rows = client.images(ImageQuery {
        dataset: arguments.dataset.as_deref(),
        filter: &arguments.filter,
        order_by: arguments.order_by.as_deref(),
        fields: &fields,
        limit: arguments.limit,
    })?;
    if let (true, Some(dataset)) = (rows.is_empty(), &arguments.dataset) {
        known::dataset(&client, dataset)?;
    }
    if arguments.json {
        rows.iter().for_each(|row| println!("{row}"));
        return Ok(());
    }
    println!("{}", image_table(&fields, &rows));
    println!("{}", count(rows.len(), "image"));
    Ok(())
}

//! `fathom query`: lists images by their parameters and metrics.

use cli::exit::Failure;
use cli::filter::expand_jobs;
use cli::known;
use cli::plural::count;
use cli::remote::ServerArguments;
use cli::table::image_table;
use client::{ImageQuery, ImageRow};

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

/// Columns shown by default, unless no image has a value. A narrow terminal leaves out the last ones.
const USUAL_FIELDS: [&str; 10] = [
    "job",
    "frame",
    "site",
    "water.style",
    "alpha",
    "uiqm",
    "uciqe",
    "uicm",
    "entropy",
    "water.optics",
];

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let client = arguments.server.client();
    let mut fields = arguments.fields.clone();
    if fields.is_empty() {
        fields.extend(USUAL_FIELDS.map(str::to_owned));
    }
    let mut rows = client.images(ImageQuery {
        dataset: arguments.dataset.as_deref(),
        filter: &expand_jobs(&client, &arguments.filter)?,
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
    if arguments.fields.is_empty() {
        fields.retain(|field| rows.is_empty() || rows.iter().any(|row| !row.value(field).is_null()));
    }
    shorten_jobs(&mut rows);
    println!("{}", image_table(&fields, &rows));
    println!("{}", count(rows.len(), "image"));
    Ok(())
}

/// Replaces the ids of jobs by their beginnings.
fn shorten_jobs(rows: &mut [ImageRow]) {
    let ids: Vec<String> = rows
        .iter()
        .map(|row| row.text("job").unwrap_or_default().to_owned())
        .collect();
    let ids = known::shorten_ids(&ids.iter().map(String::as_str).collect::<Vec<_>>());
    for (row, id) in rows.iter_mut().zip(ids) {
        if let Some(job) = row.0.get_mut("job") {
            *job = id.into();
        }
    }
}

//! `fathom export`: writes the images of a dataset for training scripts and their libraries.
//!
//! ```text
//! OUT/README.md, croissant.json  the card of the export, for people and for catalogs
//! OUT/fields.json                unit and meaning of every array and column
//! OUT/metadata.jsonl             one line per image: paths of its files, parameters, labels, metrics
//! OUT/categories.json            id and name of every class, where semantics or boxes were exported
//! OUT/SHA256SUMS                 every file with its digest, as `sha256sum --check` reads it
//! OUT/JOB/FRAME/KIND.EXTENSION   the files of a job in the layout of `fathom render`; other formats have other files
//! ```
//!
//! With `--split`, each part is a folder with separate lists: `OUT/train/metadata.jsonl` and so on.

mod format;
pub mod formats;
mod input;
mod output;

use std::path::PathBuf;

use cli::exit::Failure;
use cli::progress::Progress;
use cli::remote::ServerArguments;
use client::ImageQuery;
use spec::ArtifactKind;

use crate::commands::service::cluster::hand_over;
use format::Format;
use formats::tables::WriteTable;
use input::object_filter::ObjectFilter;
use input::order::Order;
use input::selection::Selection;
use output::split::Splits;
use output::target::Target;
use output::work::Export;

/// Options of `fathom export`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The dataset
    dataset: String,
    /// Layout of the export
    #[arg(long, value_enum, default_value = "folder")]
    format: Format,
    /// Which images, such as 'uiqm > 0.8 and water.style in ("muddy")' [default: all]
    #[arg(long, default_value = "", hide_default_value = true)]
    filter: String,
    /// Kinds of artifacts, comma-separated; the first one becomes the `file_name` column. Formats add the kinds that they need
    #[arg(long, value_delimiter = ',', default_value = "rgb", value_parser = kind)]
    kinds: Vec<String>,
    /// Parts with their shares, such as train=.8,val=.1,test=.1, each in a folder of its name; images of one scene are never in
    /// two parts, and no image changes its part when the dataset grows
    #[arg(long, value_name = "PARTS", value_parser = Splits::parse)]
    split: Option<Splits>,
    /// Frames of each file of the formats webdataset and parquet
    #[arg(long, default_value_t = 1000, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    shard_size: u32,
    #[command(flatten)]
    objects: ObjectFilter,
    /// License for the card, such as cc-by-4.0; the card also lists the licenses of waters and styles
    #[arg(long, default_value = "other", value_name = "LICENSE")]
    license: String,
    /// The folder to fill; existing files with the right digest are kept
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    server: ServerArguments,
}

/// A kind of artifact whose name can be that of a file.
fn kind(name: &str) -> Result<String, String> {
    if ArtifactKind::parse(name).is_some()
        && name
            .chars()
            .all(|c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '.')
    {
        return Ok(name.to_owned());
    }
    let known: Vec<&str> = ArtifactKind::FIXED.iter().map(|(name, _)| *name).collect();
    Err(format!("the kinds are {} and enhanced.METHOD", known.join(", ")))
}

/// Runs the command. Without `tables`, `fathom-cluster` runs it for formats with Parquet.
pub fn run(arguments: &Arguments, tables: Option<WriteTable>) -> Result<(), Failure> {
    let format = arguments.format;
    if format.needs_tables() && tables.is_none() {
        return hand_over();
    }
    arguments.objects.check(format)?;
    let client = arguments.server.client();
    let selection = Selection::read(&client, arguments)?;
    let split = arguments.split.as_ref();
    let mut card = format.card(
        &arguments.dataset,
        split.map(Splits::to_string),
        &selection.kinds,
        arguments.shard_size as usize,
    );
    arguments.objects.describe(&mut card);
    let target = Target::open(&arguments.out, &card)?;
    let columns = selection.column_names();
    let order = Order {
        client: &client,
        target: &target,
        kinds: &selection.kinds,
        columns: &columns,
    };
    let mut export = Export::begin(arguments, &selection, order, tables)?;
    let query = ImageQuery {
        dataset: Some(&arguments.dataset),
        filter: &arguments.filter,
        order_by: None,
        fields: &columns,
        limit: usize::MAX,
    };
    let mut progress = Progress::new("export", "images", selection.images);
    for rows in client.image_pages(query) {
        export.add(rows?)?;
        progress.set(export.images());
    }
    progress.finish();
    export.finish()
}

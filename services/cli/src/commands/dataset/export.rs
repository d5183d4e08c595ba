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

mod arguments;
mod files;
mod format;
pub(crate) mod formats;
mod input;
mod object_filter;
mod output;
mod role;

use cli::exit::Failure;
use cli::filter::expand_jobs;
use cli::progress::Progress;
use client::{ImageQuery, PAGE_ROWS};

pub(crate) use arguments::Arguments;
use files::split::Splits;
use files::target::Target;
use formats::tables::list_mixed;
use input::order::Order;
use input::selection::Selection;
use output::work::Export;

/// Bounds the images listed to this multiple of those counted, which leaves room for running jobs.
const MOST_GROWTH: u64 = 2;

/// Runs the command.
pub(crate) fn run(mut arguments: Arguments) -> Result<(), Failure> {
    let format = arguments.format;
    arguments.objects.check(format)?;
    if let Some(frames) = arguments.shard_size.filter(|_| !format.is_sharded()) {
        return Err(Failure::BadInput(format!(
            "--shard-size is {frames}, but the format {} has no shards; leave it out, or choose webdataset or parquet",
            format.name()
        )));
    }
    let client = arguments.server.client();
    arguments.filter = expand_jobs(&client, &arguments.filter)?;
    let arguments = &arguments;
    let mut selection = Selection::read(&client, arguments)?;
    let split = arguments.split.as_ref();
    let mut card = format.card(
        &arguments.dataset,
        split.map(Splits::to_string),
        &selection.kinds,
        arguments.frames_per_shard(),
    );
    arguments.objects.describe(&mut card);
    let target = Target::open(&arguments.out, &card)?;
    let requested = selection.column_names();
    if format.has_times() {
        selection.add_time_columns();
    }
    let columns = selection.column_names();
    let mixed = list_mixed(&selection.columns);
    let order = Order {
        client: &client,
        target: &target,
        kinds: &selection.kinds,
        columns: &columns,
        mixed: &mixed,
    };
    let mut export = Export::begin(arguments, &selection, order)?;
    let query = ImageQuery {
        dataset: Some(&arguments.dataset),
        filter: &arguments.filter,
        order_by: None,
        fields: &requested,
        limit: usize::MAX,
    };
    let mut progress = Progress::new("export", "images", selection.images);
    let growth = selection.images.saturating_mul(MOST_GROWTH);
    let most = growth.saturating_add(PAGE_ROWS as u64);
    for rows in client.image_pages(query) {
        export.add(rows?)?;
        if export.images() > most {
            return Err(Failure::Other(anyhow::anyhow!(
                "the service counted {} images and lists more than {}; check the address of the service",
                selection.images,
                export.images()
            )));
        }
        progress.set(export.images());
    }
    progress.finish();
    export.finish()
}

//! `fathom sheet`: a contact sheet of a dataset.

use std::path::{Path, PathBuf};

use cli::exit::Failure;
use cli::files;
use cli::images::Question;
use cli::remote::{Remote, ServerArguments};
use cli::sheet::{Tile, sheet};
use cli::table::cell;
use imaging::codec;
use serde_json::Value;

/// Options of `fathom sheet`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The dataset
    dataset: String,
    /// Where to write the sheet (.png, .jpg or .webp)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Which images, such as 'uiqm > 0.8'
    #[arg(long, default_value = "")]
    filter: String,
    /// Order, such as uiqm or -uiqm
    #[arg(long, value_name = "COLUMN", allow_hyphen_values = true)]
    order_by: Option<String>,
    /// Most images on the sheet
    #[arg(long, default_value_t = 24)]
    limit: usize,
    /// Artifact kind to show
    #[arg(long, default_value = "rgb")]
    kind: String,
    #[command(flatten)]
    server: ServerArguments,
}

const COLUMNS: usize = 6;
const TILE_PX: usize = 320;
pub(crate) const FIELDS: [&str; 8] = [
    "job",
    "frame",
    "scene.seed",
    "water.optics",
    "water.style",
    "alpha",
    "uiqm",
    "uciqe",
];

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let remote = Remote::new(&arguments.server);
    let question = Question {
        dataset: Some(&arguments.dataset),
        filter: &arguments.filter,
        order_by: arguments.order_by.as_deref(),
        fields: &FIELDS.map(str::to_owned),
        limit: arguments.limit,
    };
    draw(&remote, &question, &arguments.kind, &arguments.out)?;
    println!("{}", arguments.out.display());
    Ok(())
}

/// Fetches the images that answer a question and draws them on one sheet.
pub(crate) fn draw(remote: &Remote, question: &Question<'_>, kind: &str, out: &Path) -> Result<(), Failure> {
    let rows = question.ask(remote)?;
    if rows.is_empty() {
        return Err(Failure::BadInput(
            "no image fits: the sheet would be empty".to_owned(),
        ));
    }
    let tiles = rows
        .iter()
        .map(|row| tile(remote, row, kind))
        .collect::<Result<Vec<_>, _>>()?;
    files::write_picture(out, &sheet(&tiles, COLUMNS, TILE_PX).into())
}

fn tile(remote: &Remote, row: &Value, kind: &str) -> Result<Tile, Failure> {
    let field = |name: &str| cell(&row[name]);
    let path = format!("/v1/images/{}/{}/artifacts/{kind}", field("job"), field("frame"));
    let picture = codec::decode_picture(&remote.get_bytes(&path)?)
        .map_err(anyhow::Error::from)?
        .to_rgb8();
    let short = |name: &str| {
        field(name)
            .split('/')
            .next()
            .unwrap_or_default()
            .replace('–', "-")
    };
    let caption = vec![
        format!(
            "#{} {} + {} a={}",
            field("frame"),
            short("water.optics"),
            short("water.style"),
            two(row, "alpha")
        ),
        format!(
            "seed {}  uiqm {}  uciqe {}",
            field("scene.seed"),
            two(row, "uiqm"),
            two(row, "uciqe")
        ),
    ];
    Ok(Tile { picture, caption })
}

fn two(row: &Value, name: &str) -> String {
    row[name]
        .as_f64()
        .map_or_else(|| "-".to_owned(), |value| format!("{value:.2}"))
}

//! `fathom sheet`: a contact sheet of a dataset.

mod paint;

use std::path::{Path, PathBuf};

use cli::classes::{self, Named, SceneClasses};
use cli::exit::Failure;
use cli::files;
use cli::images::Question;
use cli::known;
use cli::remote::{Remote, ServerArguments, encode};
use cli::sheet::{Tile, sheet, with_legend};
use cli::table::cell;
use serde_json::Value;

use paint::{Paint, Stored};

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
    /// Artifact kind to show: masks in the colors of their classes, range as a ramp with a scale
    #[arg(long, default_value = "rgb")]
    kind: String,
    #[command(flatten)]
    server: ServerArguments,
}

const COLUMNS: usize = 6;
const TILE_PX: usize = 320;
pub(crate) const FIELDS: [&str; 10] = [
    classes::COLUMNS[0],
    classes::COLUMNS[1],
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

/// Fetches the images of a query and draws them on one sheet.
pub(crate) fn draw(remote: &Remote, question: &Question<'_>, kind: &str, out: &Path) -> Result<(), Failure> {
    let rows = question.ask(remote)?;
    if rows.is_empty() {
        if let Some(dataset) = question.dataset {
            known::dataset(remote, dataset)?;
        }
        return Err(Failure::input("no image matches: the sheet would be empty"));
    }
    let fetch = |row: &Value| {
        let (job, frame) = (cell(&row["job"]), cell(&row["frame"]));
        let path = format!(
            "/v1/images/{}/{}/artifacts/{}",
            encode(&job),
            encode(&frame),
            encode(kind)
        );
        Stored::read(kind, &remote.get_bytes(&path)?)
    };
    let stored = rows.iter().map(fetch).collect::<Result<Vec<_>, Failure>>()?;
    let paint = Paint::new(stored.iter());
    let tile = |(row, stored): (&Value, &Stored)| Tile {
        picture: paint.picture(stored),
        caption: caption(row),
    };
    let tiles: Vec<Tile> = rows.iter().zip(&stored).map(tile).collect();
    let mut picture = sheet(&tiles, COLUMNS, TILE_PX);
    let (mut scenes, mut named) = (SceneClasses::new(remote), Named::new());
    if matches!(kind, "semantics" | "semantics.visible") {
        rows.iter().try_for_each(|row| scenes.add(row, &mut named))?;
    }
    if let Some(legend) = paint.legend(&stored, &named) {
        picture = with_legend(&picture, &legend);
    }
    files::write_picture(out, &picture.into())
}

fn caption(row: &Value) -> Vec<String> {
    let field = |name: &str| cell(&row[name]);
    let short = |name: &str| {
        field(name)
            .split('/')
            .next()
            .unwrap_or_default()
            .replace('–', "-")
    };
    vec![
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
    ]
}

fn two(row: &Value, name: &str) -> String {
    row[name]
        .as_f64()
        .map_or_else(|| "-".to_owned(), |value| format!("{value:.2}"))
}

//! `fathom sheet`: a contact sheet of a dataset.

pub(crate) mod paint;

use std::path::{Path, PathBuf};

use cli::classes::{self, Named, SceneClasses};
use cli::exit::Failure;
use cli::files;
use cli::filter::expand_jobs;
use cli::known;
use cli::remote::ServerArguments;
use cli::sheet::{Tile, sheet, with_legend};
use cli::table::cell;
use client::{Client, ImageQuery, ImageRow, encode};

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
pub(crate) const FIELDS: [&str; 11] = [
    classes::COLUMNS[0],
    classes::COLUMNS[1],
    "job",
    "frame",
    "site",
    "scene.seed",
    "water.optics",
    "water.style",
    "alpha",
    "uiqm",
    "uciqe",
];

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let client = arguments.server.client();
    let query = ImageQuery {
        dataset: Some(&arguments.dataset),
        filter: &expand_jobs(&client, &arguments.filter)?,
        order_by: arguments.order_by.as_deref(),
        fields: &FIELDS.map(str::to_owned),
        limit: arguments.limit,
    };
    draw(&client, query, &arguments.kind, &arguments.out)?;
    println!("{}", arguments.out.display());
    Ok(())
}

/// Fetches the images of a query and draws them on one sheet.
pub(crate) fn draw(client: &Client, query: ImageQuery<'_>, kind: &str, out: &Path) -> Result<(), Failure> {
    let rows = client.images(query)?;
    if rows.is_empty() {
        if let Some(dataset) = query.dataset {
            known::dataset(client, dataset)?;
        }
        return Err(Failure::input("no image matches: the sheet would be empty"));
    }
    let stored = rows.iter().map(|row| fetch(client, row, kind));
    let stored = stored.collect::<Result<Vec<_>, Failure>>()?;
    let paint = Paint::new(stored.iter());
    let tiles: Vec<Tile> = rows
        .iter()
        .zip(&stored)
        .map(|(row, stored)| Tile {
            picture: paint.picture(stored),
            caption: caption(row),
        })
        .collect();
    let mut picture = sheet(&tiles, COLUMNS, TILE_PX);
    let (mut scenes, mut named) = (SceneClasses::new(client), Named::new());
    if matches!(kind, "semantics" | "semantics.visible") {
        rows.iter().try_for_each(|row| scenes.add(row, &mut named))?;
    }
    if let Some(legend) = paint.legend(&stored, &named) {
        picture = with_legend(&picture, &legend);
    }
    files::write_picture(out, &picture.into())
}

fn fetch(client: &Client, row: &ImageRow, kind: &str) -> Result<Stored, Failure> {
    let (job, frame) = (cell(row.value("job")), cell(row.value("frame")));
    let path = format!(
        "/v1/images/{}/{}/artifacts/{}",
        encode(&job),
        encode(&frame),
        encode(kind)
    );
    match client.get_bytes(&path) {
        Err(error) if error.is_not_found() => Err(Failure::BadInput(format!(
            "--kind is `{kind}`, which image {job}/{frame} does not have; list it in `artifacts` of the job, or choose other images \
             with --filter"
        ))),
        bytes => Stored::read(kind, &bytes?),
    }
}

/// Frame and place, then seed and metrics; missing values are left out.
fn caption(row: &ImageRow) -> Vec<String> {
    let place = match row.text("site") {
        Some(site) => Some(site.to_owned()),
        None => short_name(row, "water.optics"),
    };
    let style = short_name(row, "water.style");
    let alpha = style.as_ref().and_then(|_| row.number("alpha"));
    let frame = Some(format!("#{}", cell(row.value("frame"))));
    let water = [place, style]
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join(" + ");
    let first = [
        frame,
        Some(water).filter(|water| !water.is_empty()),
        alpha.map(|alpha| format!("a={alpha:.2}")),
    ];
    let metric = |name| row.number(name).map(|value| format!("{name} {value:.2}"));
    let seed = row.value("scene.seed");
    let second = [
        (!seed.is_null()).then(|| format!("seed {}", cell(seed))),
        metric("uiqm"),
        metric("uciqe"),
    ];
    vec![join_words(first, " "), join_words(second, "  ")]
}

fn join_words(words: [Option<String>; 3], gap: &str) -> String {
    words.into_iter().flatten().collect::<Vec<_>>().join(gap)
}

/// A name without its source, in the characters of the font.
fn short_name(row: &ImageRow, column: &str) -> Option<String> {
    let name = row.text(column)?;
    Some(name.split('/').next().unwrap_or_default().replace('–', "-"))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_caption_has_the_site_and_no_missing_values() {
        let shown = |row| caption(&serde_json::from_value(row).unwrap());
        let of_site = json!({"frame": 3, "site": "shaft", "water.optics": "jerlov-3C/x", "scene.seed": 7, "uiqm": 0.514});
        assert_eq!(shown(of_site), ["#3 shaft", "seed 7  uiqm 0.51"]);
        let styled = json!({"frame": 0, "water.optics": "jerlov-3C/williamson2022", "water.style": "muddy",
            "alpha": 0.5, "uiqm": 1.0, "uciqe": 0.333});
        assert_eq!(
            shown(styled),
            ["#0 jerlov-3C + muddy a=0.50", "uiqm 1.00  uciqe 0.33"]
        );
        assert_eq!(shown(json!({"frame": 1, "alpha": 1})), ["#1", ""]);
    }
}

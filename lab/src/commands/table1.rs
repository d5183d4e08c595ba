//! `fathom-lab table1`: compares the enhancement methods over a folder of pictures or a dataset.

use std::path::{Path, PathBuf};

use anyhow::Context;
use cli::exit::Failure;
use cli::files;
use cli::progress::Progress;
use cli::remote::ServerArguments;
use client::{Client, ImageQuery, ImageRow};
use imaging::{Raster, codec};
use lab::table1::{Table, csv, figure, markdown};

use crate::{drawing, machine};

/// Options of `fathom-lab table1`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// A folder of pictures, or the name of a dataset of the service
    source: String,
    /// Folder for table1.md, .csv, .svg and .png
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Maximum number of pictures
    #[arg(long, default_value_t = 200)]
    limit: usize,
    #[command(flatten)]
    server: ServerArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let pictures = Pictures::find(arguments)?;
    let mut progress = Progress::new("table1", "pictures", pictures.len() as u64);
    let mut table = Table::default();
    for index in 0..pictures.len() {
        let (name, picture) = pictures.read(index)?;
        table
            .add(&picture.to_rgb8())
            .map_err(|error| Failure::BadInput(format!("{name}: {error}")))?;
        progress.set(index as u64 + 1);
    }
    progress.finish();
    let about = format!(
        "{} pictures of {}; {}; one thread.",
        table.pictures(),
        arguments.source,
        machine::describe()
    );
    let text = markdown(&table, &about);
    println!("{text}");
    files::write(&arguments.out.join("table1.md"), text.as_bytes())?;
    files::write(&arguments.out.join("table1.csv"), csv(&table).as_bytes())?;
    drawing::write(&arguments.out, "table1", &figure(&table))?;
    println!("written to {}", arguments.out.display());
    Ok(())
}

/// The source of the pictures, read one after the other.
enum Pictures {
    Files(Vec<PathBuf>),
    Images {
        client: Box<Client>,
        rows: Vec<ImageRow>,
    },
}

impl Pictures {
    fn find(arguments: &Arguments) -> Result<Self, Failure> {
        let folder = Path::new(&arguments.source);
        if folder.is_dir() {
            let mut files = files::pictures(folder)?;
            files.truncate(arguments.limit);
            if files.is_empty() {
                return Err(Failure::BadInput(format!(
                    "{} holds no PNG, JPEG or WebP",
                    folder.display()
                )));
            }
            return Ok(Self::Files(files));
        }
        let client = Box::new(arguments.server.client());
        let query = ImageQuery {
            dataset: Some(&arguments.source),
            filter: "",
            order_by: None,
            fields: &["job".to_owned(), "frame".to_owned()],
            limit: arguments.limit,
        };
        let rows = client.images(query)?;
        if rows.is_empty() {
            let message = format!(
                "`{}` is neither a folder nor a dataset with images",
                arguments.source
            );
            return Err(Failure::BadInput(message));
        }
        Ok(Self::Images { client, rows })
    }

    fn len(&self) -> usize {
        match self {
            Self::Files(files) => files.len(),
            Self::Images { rows, .. } => rows.len(),
        }
    }

    fn read(&self, index: usize) -> Result<(String, Raster), Failure> {
        match self {
            Self::Files(files) => Ok((
                files[index].display().to_string(),
                files::read_picture(&files[index])?,
            )),
            Self::Images { client, rows } => {
                let text = |name: &str| rows[index].value(name).to_string().trim_matches('"').to_owned();
                let name = format!("{}/{}", text("job"), text("frame"));
                let bytes = client.get_bytes(&format!("/v1/images/{name}/artifacts/rgb"))?;
                let picture = codec::decode_picture(&bytes);
                Ok((name, picture.context("the service sent no picture")?))
            }
        }
    }
}

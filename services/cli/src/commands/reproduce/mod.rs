//! `fathom reproduce`: the figures and the table of the published method as one page.

mod declaration;
mod matches;
mod options;
mod page;
mod shot;
mod table;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Instant;

use anyhow::Context;
use cli::exit::Failure;
use cli::files;
use cli::progress::Progress;
use cli::table::table as format_table;
use imaging::{Rgb8, codec};
use rayon::prelude::*;
use renderer::{Engine, Slot};
use spec::{Job, Vocabulary};
use style::Library;

use declaration::{Declaration, Figure, Row, parse_job};
use matches::match_shots;
use page::{DrawnFigure, MeasuredTable, Picture, write_page};
use shot::Shot;
use table::{METHODS, Summary, measure_frame, summarize};

/// Options of `fathom reproduce`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// A new or empty folder for index.html and its pictures
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Frames of Table 1
    #[arg(long, default_value_t = 24, value_parser = clap::value_parser!(u64).range(1..=96))]
    frames: u64,
    /// Width of all pictures and frames [default: 640, and 869 in Table 1]
    #[arg(long, value_name = "PX", value_parser = clap::value_parser!(u16).range(64..=1920))]
    width: Option<u16>,
}

/// JPEG quality of the pictures: with it the page is below 5 MB; differences are not visible in figures.
const JPEG_QUALITY: u8 = 85;
/// Columns of the pictures with matches.
const MATCHES_PX: usize = 1280;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    check_folder(&arguments.out)?;
    let begun = Instant::now();
    let declaration = Declaration::read(arguments.width)?;
    let library = Library::embedded().map_err(anyhow::Error::from)?;
    let rows: usize = declaration.figures.iter().map(|figure| figure.rows.len()).sum();
    let studio = Studio {
        vocabulary: renderer::vocabulary(&library, false),
        engine: Arc::new(Engine::new(library, None)),
        steps: Mutex::new(Steps {
            done: 0,
            progress: Progress::new("reproduce", "pictures and frames", rows as u64 + arguments.frames),
        }),
    };
    let (figures, pictures) = studio.draw_figures(&declaration)?;
    let table = studio.measure_table(&declaration, arguments.frames)?;
    let page = write_page(&figures, &table);
    let index = arguments.out.join("index.html");
    let named = pictures
        .iter()
        .map(|(file, bytes)| (arguments.out.join(file), bytes.as_slice()));
    let all: Vec<_> = named.chain([(index.clone(), page.as_bytes())]).collect();
    files::write_all(&all)?;
    drop(studio);
    print_times(&table.summaries);
    println!("{} in {:.0} s", index.display(), begun.elapsed().as_secs_f64());
    Ok(())
}

/// Creates the folder, so that a wrong one is reported before any work.
fn check_folder(out: &Path) -> Result<(), Failure> {
    let entries = fs::create_dir_all(out).and_then(|()| fs::read_dir(out));
    let reason = match entries.map(|mut entries| entries.next().is_some()) {
        Ok(false) => return Ok(()),
        Ok(true) => "the folder is not empty; name a new one".to_owned(),
        Err(error) => format!("cannot create the folder: {error}"),
    };
    Err(Failure::BadInput(format!("--out {}: {reason}", out.display())))
}

fn print_times(summaries: &[Summary]) {
    let rows = METHODS.iter().zip(summaries).map(|(method, summary)| {
        let published = method.published.as_ref();
        let published = published.map_or_else(|| "–".to_owned(), |published| published.seconds.to_string());
        vec![
            method.title.to_owned(),
            format!("{:.4}", summary.seconds.mean),
            published,
        ]
    });
    println!(
        "{}\n",
        format_table(&["method", "s", "s, published"], &rows.collect::<Vec<_>>())
    );
}

/// An encoded picture and its path from the page.
type EncodedPicture = (String, Vec<u8>);

struct Steps {
    done: u64,
    progress: Progress,
}

/// Renders jobs and counts them.
struct Studio {
    engine: Arc<Engine>,
    vocabulary: Vocabulary,
    steps: Mutex<Steps>,
}

impl Studio {
    fn draw_figures<'a>(
        &self,
        declaration: &'a Declaration,
    ) -> Result<(Vec<DrawnFigure<'a>>, Vec<EncodedPicture>), Failure> {
        let rows: Vec<(&Figure, &Row)> = declaration
            .figures
            .iter()
            .flat_map(|figure| figure.rows.iter().map(move |row| (figure, row)))
            .collect();
        let drawn: Vec<Vec<(String, Rgb8)>> = rows
            .par_iter()
            .map_init(
                || Slot::new(&self.engine),
                |slot, (_, row)| {
                    let job = parse_job(&declaration.describe_row(row), &self.vocabulary)?;
                    let drawn = draw_row(row, &job, slot);
                    self.count_step();
                    drawn
                },
            )
            .collect::<Result<_, Failure>>()?;
        let mut drawn = drawn.into_iter();
        let (mut figures, mut encoded) = (Vec::new(), Vec::new());
        for declared in &declaration.figures {
            let shown = drawn.by_ref().take(declared.rows.len()).flatten();
            let mut pictures = Vec::new();
            for (index, (label, picture)) in shown.enumerate() {
                let file = format!("pictures/figure-{:02}-{:02}.jpg", declared.number, index + 1);
                let bytes = codec::encode_jpeg(&picture, JPEG_QUALITY).context("cannot encode a picture")?;
                encoded.push((file.clone(), bytes));
                let (width, height) = (picture.width(), picture.height());
                pictures.push(Picture {
                    file,
                    label,
                    width,
                    height,
                });
            }
            let jobs = declared
                .rows
                .iter()
                .map(|row| format!("{:#}", declaration.describe_row(row)));
            figures.push(DrawnFigure {
                declared,
                pictures,
                jobs: jobs.collect(),
            });
        }
        Ok((figures, encoded))
    }

    fn measure_table(&self, declaration: &Declaration, frames: u64) -> Result<MeasuredTable, Failure> {
        let description = declaration.describe_table();
        let job = parse_job(&description, &self.vocabulary)?;
        let values = (0..frames).into_par_iter().map_init(
            || Slot::new(&self.engine),
            |slot, index| {
                let values = measure_frame(&Shot::take(&job, index, slot)?.picture("rgb")?);
                self.count_step();
                values
            },
        );
        let values: Vec<_> = values.collect::<Result<_, Failure>>()?;
        Ok(MeasuredTable {
            frames,
            job: format!("{description:#}"),
            summaries: summarize(&values),
        })
    }

    fn count_step(&self) {
        // A poisoned lock means that another thread has panicked; the panic ends the command.
        if let Ok(mut steps) = self.steps.lock() {
            steps.done += 1;
            let done = steps.done;
            steps.progress.set(done);
        }
    }
}

/// The labels and pictures of a row.
fn draw_row(row: &Row, job: &Job, slot: &mut Slot) -> Result<Vec<(String, Rgb8)>, Failure> {
    let Some(matched) = row.matched else {
        let shot = Shot::take(job, 0, slot)?;
        let panels = row.panels.iter();
        return panels
            .map(|panel| Ok((panel.label.clone(), shot.picture(&panel.artifact)?)))
            .collect();
    };
    let (previous, current) = (
        Shot::take(job, matched - 1, slot)?,
        Shot::take(job, matched, slot)?,
    );
    let panels = row.panels.iter().map(|panel| {
        let found = match_shots(&current, &previous, &panel.artifact)?;
        let [default, adaptive] = found.counts;
        let label = format!(
            "{}: {} of {} matches are correct; {} of {} with an adaptive threshold, not drawn",
            panel.label, default.correct, default.all, adaptive.correct, adaptive.all
        );
        Ok((label, codec::downscale(&found.picture, MATCHES_PX)))
    });
    panels.collect()
}

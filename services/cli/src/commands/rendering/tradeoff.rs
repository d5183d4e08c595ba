//! `fathom tradeoff`: time per frame against the distance to the Monte Carlo truth, for each fidelity and effect of one job.

mod chart;
mod choices;
mod clock;
mod measure;
mod point;
mod report;
mod size;
mod variant;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use cli::exit::Failure;
use cli::files;
use cli::job;
use cli::overrides::Override;
use cli::styles::StyleArguments;
use renderer::Engine;
use spec::{Job, SITES, SitePreset};
use style::Library;

use measure::Measuring;
use report::Report;
use size::{PictureSize, parse_size};

/// Options of `fathom tradeoff`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The job: a frame description as JSON, or the name of a site
    spec: PathBuf,
    /// Replace a field of the job, such as water.optics=jerlov-II; null removes it; may be repeated
    #[arg(long, value_name = "FIELD=VALUE")]
    set: Vec<String>,
    /// Number of frames, spread over the job [default: 3, or all of a shorter job]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=100))]
    frames: Option<u64>,
    /// Size of the pictures for the comparison with the truth [default: 64 columns in the shape of the job's pictures]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<PictureSize>,
    /// Folder for tradeoff.svg and tradeoff.json
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the content of tradeoff.json instead of tables
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    style: StyleArguments,
}

/// Frames of a site without a job, as in `fathom new`.
const SITE_FRAMES: u64 = 100;
/// Number of frames unless given.
const FRAMES: u64 = 3;
/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let library = arguments.style.library()?;
    let job = read_job(arguments, &library)?;
    for warning in job.warnings() {
        eprintln!("warning: {warning}");
    }
    let frames = spread_frames(job.frames(), arguments.frames)?;
    let engine = Arc::new(Engine::new(library, arguments.style.onnxruntime.as_deref()));
    let frames: Vec<_> = frames
        .into_iter()
        .map(|index| job.resolve(index))
        .collect::<Result<_, _>>()
        .map_err(|invalid| job::refused(&arguments.spec, &invalid))?;
    let measured = Measuring::new(&engine, &frames, arguments.size)?.run()?;
    let report = Report::new(&name_job(&arguments.spec), measured);
    if let Some(out) = &arguments.out {
        let (svg, json) = (report.chart().svg(), report.json().to_string() + "\n");
        files::write_all(&[
            (out.join("tradeoff.svg"), svg.as_bytes()),
            (out.join("tradeoff.json"), json.as_bytes()),
        ])?;
    }
    if arguments.json {
        println!("{}", report.json());
    } else {
        println!("{}", report.text());
    }
    Ok(())
}

/// Reads the job with the replaced fields. Mistakes of the options are reported together.
fn read_job(arguments: &Arguments, library: &Library) -> Result<Job, Failure> {
    let overrides = arguments.set.iter().map(|text| Override::parse(text));
    let (overrides, wrong): (Vec<_>, Vec<_>) = overrides.partition(Result::is_ok);
    if !wrong.is_empty() {
        let wrong: Vec<String> = wrong.into_iter().filter_map(Result::err).collect();
        return Err(Failure::BadInput(wrong.join("\n")));
    }
    let overrides: Vec<Override> = overrides.into_iter().flatten().collect();
    job::read_with(&arguments.spec, &read_text(&arguments.spec)?, &overrides, library)
}

/// The text of a job file, or a job of the site with this name.
fn read_text(spec: &Path) -> Result<Vec<u8>, Failure> {
    let site = spec.to_str().and_then(SitePreset::find);
    match site {
        Some(site) if !spec.exists() => Ok(serde_json::json!({"site": site.name, "count": SITE_FRAMES})
            .to_string()
            .into_bytes()),
        _ => files::read(spec).map_err(|failure| {
            let names = SITES.each_ref().map(|site| site.name).join(", ");
            Failure::BadInput(format!("{failure}; name a file, or one of the sites {names}"))
        }),
    }
}

fn name_job(spec: &Path) -> String {
    let stem = spec.file_stem().unwrap_or(spec.as_os_str());
    stem.to_string_lossy().into_owned()
}

/// The indices of some frames with equal distances, from the first to the last.
fn spread_frames(all: u64, wanted: Option<u64>) -> Result<Vec<u64>, Failure> {
    if let Some(wanted) = wanted.filter(|wanted| *wanted > all) {
        let message = format!("--frames is {wanted}, but the job has {all} frames");
        return Err(Failure::BadInput(message));
    }
    let count = wanted.unwrap_or(FRAMES.min(all));
    let last = count.saturating_sub(1).max(1);
    Ok((0..count).map(|i| i * (all - 1) / last).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_spread_from_the_first_to_the_last() {
        assert_eq!(spread_frames(100, None).unwrap(), [0, 49, 99]);
        assert_eq!(spread_frames(2, None).unwrap(), [0, 1]);
        assert_eq!(spread_frames(100, Some(1)).unwrap(), [0]);
        assert_eq!(spread_frames(7, Some(7)).unwrap(), [0, 1, 2, 3, 4, 5, 6]);
        let refused = spread_frames(2, Some(3)).unwrap_err().to_string();
        assert_eq!(refused, "--frames is 3, but the job has 2 frames");
    }
}

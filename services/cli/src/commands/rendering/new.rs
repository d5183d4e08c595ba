//! `fathom new`: a job that starts from a site.

use std::path::{Path, PathBuf};

use clap::builder::PossibleValuesParser;
use cli::exit::Failure;
use cli::files;
use serde_json::{Value, json};
use spec::{SITES, SitePreset};

/// Options of `fathom new`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The site; `fathom list sites` describes each
    #[arg(value_parser = PossibleValuesParser::new(SITES.map(|site| site.name)))]
    site: String,
    /// The file to write [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Frames of a new job.
const COUNT: u64 = 100;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Some(site) = SitePreset::find(&arguments.site) else {
        return Err(Failure::BadInput(format!("no site `{}`", arguments.site)));
    };
    let Some(path) = &arguments.out else {
        print!("{}", job(site));
        let file = PathBuf::from(format!("{}.json", site.name));
        eprintln!("{}", next_steps(site, &file));
        return Ok(());
    };
    if path.exists() {
        let message = format!("{} exists; name another file with --out", path.display());
        return Err(Failure::BadInput(message));
    }
    files::write(path, job(site).as_bytes())?;
    eprintln!("{}", next_steps(site, path));
    Ok(())
}

/// The text of a job: the site, and the fields that most jobs change with the site's values. A comment above each field
/// has its meaning, unit and limits.
fn job(site: &SitePreset) -> String {
    let site_fields = Value::from(site.description());
    let value = |pointer: &str, default: Value| site_fields.pointer(pointer).cloned().unwrap_or(default);
    let camera = [
        ("width", value("/camera/width", json!(768)).to_string()),
        ("height", value("/camera/height", json!(492)).to_string()),
        ("hfov_deg", value("/camera/hfov_deg", json!(80)).to_string()),
    ];
    let fields = [
        ("site", json!(site.name).to_string()),
        ("dataset", json!(site.name).to_string()),
        ("count", COUNT.to_string()),
        ("seed", "1".to_owned()),
        ("camera", object("camera.", "  ", &camera)),
        ("artifacts", value("/artifacts", json!(["rgb"])).to_string()),
    ];
    object("", "", &fields) + "\n"
}

/// The text of an object whose fields have this path before their names.
fn object(path: &str, indent: &str, fields: &[(&str, String)]) -> String {
    let rows = spec::table::rows();
    let lines = fields.iter().map(|(name, value)| {
        let row = rows.iter().find(|row| row.path == format!("{path}{name}"));
        let comment = row.map_or_else(String::new, |row| {
            let unit = row.unit.map_or_else(String::new, |unit| format!(" [{unit}]"));
            format!("{indent}  // {}{unit}\n", row.summary())
        });
        format!("{comment}{indent}  \"{name}\": {value}")
    });
    format!("{{\n{}\n{indent}}}", lines.collect::<Vec<_>>().join(",\n"))
}

fn next_steps(site: &SitePreset, path: &Path) -> String {
    let (name, path) = (site.name, path.display());
    let steps = [
        (
            format!("plan {path}"),
            "how a frame is rendered, with cost and error",
        ),
        (format!("render {path} --out {name}"), "render here"),
        (format!("submit {path} --wait"), "or in a service"),
        (
            "list fields".to_owned(),
            "every field that can replace the site's",
        ),
    ];
    let width = steps
        .each_ref()
        .map(|(command, _)| command.len())
        .into_iter()
        .max();
    let width = width.unwrap_or_default();
    let lines = steps.map(|(command, purpose)| format!("fathom {command:width$}   # {purpose}"));
    format!(
        "{path}: {COUNT} frames of {}\n\n{}",
        site.summary(),
        lines.join("\n")
    )
}

#[cfg(test)]
mod tests {
    use spec::Job;
    use style::Library;

    use super::*;

    #[test]
    fn every_new_job_is_valid_and_renders_the_site_as_it_is() {
        let vocabulary = renderer::vocabulary(&Library::embedded().unwrap(), true);
        for site in &SITES {
            let written = Job::parse(job(site).as_bytes(), &vocabulary);
            let written = written.unwrap_or_else(|invalid| panic!("{}: {invalid}", site.name));
            assert_eq!((written.frames(), written.dataset()), (COUNT, site.name));
            assert_eq!(written.warnings(), [""; 0], "{}", site.name);
            let plain = json!({"site": site.name, "dataset": site.name, "count": COUNT, "seed": 1});
            let plain = Job::parse(plain.to_string().as_bytes(), &vocabulary).unwrap();
            assert_eq!(written.canonical(), plain.canonical());
        }
    }

    #[test]
    fn a_file_is_written_once_and_never_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let arguments = Arguments {
            site: "tank".to_owned(),
            out: Some(folder.path().join("job.json")),
        };
        run(&arguments).unwrap();
        let written = std::fs::read_to_string(folder.path().join("job.json")).unwrap();
        assert!(
            written.contains("\n  // frames of each grid cell; 1..=100000000\n  \"count\": 100,\n"),
            "{written}"
        );
        // Every line of a field has its comment above.
        let lines: Vec<_> = written.lines().map(str::trim_start).collect();
        for pair in lines.windows(2).filter(|pair| pair[1].starts_with('"')) {
            assert!(pair[0].starts_with("// "), "{written}");
        }
        assert!(
            run(&arguments)
                .unwrap_err()
                .to_string()
                .contains("exists; name another file")
        );
    }
}

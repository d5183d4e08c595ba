//! The result of an experiment, and its files.

use std::path::Path;

use anyhow::Context;
use cli::exit::Failure;
use cli::files;
use imaging::Rgb8;
use serde_json::{Map, Value};

use crate::plot::Chart;
use crate::table::Table;

/// Longer tables are not on the page.
const MOST_ROWS: usize = 100;

/// The result of an experiment.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Report {
    /// The measured cases in a sentence.
    pub about: String,
    /// The tables.
    pub tables: Vec<Table>,
    /// Charts by the names of their files.
    pub charts: Vec<(String, Chart)>,
    /// Pictures by the names of their files.
    pub pictures: Vec<(String, Rgb8)>,
    /// Additional files.
    pub files: Vec<(String, Vec<u8>)>,
    /// Broken limits.
    pub failures: Vec<String>,
}

impl Report {
    /// A report of tables.
    #[must_use]
    pub fn new(about: String, tables: Vec<Table>) -> Self {
        Self {
            about,
            tables,
            ..Self::default()
        }
    }

    /// Adds a chart.
    pub fn add_chart(&mut self, name: impl Into<String>, chart: Chart) {
        self.charts.push((name.into(), chart));
    }

    /// The page of the report.
    #[must_use]
    pub fn markdown(&self, name: &str) -> String {
        let mut text = format!(
            "# {name}\n\n{}\n\n`fathom-lab experiment {name}`; {}.\n",
            self.about,
            describe_machine()
        );
        for table in &self.tables {
            let rows = match table.len() {
                0..=MOST_ROWS => table.markdown(),
                rows => format!("{rows} rows, as CSV.\n"),
            };
            text.push_str(&format!("\n## {}\n\n{rows}", table.name));
        }
        let charts = self.charts.iter().map(|(file, _)| format!("{file}.svg"));
        let pictures = self.pictures.iter().map(|(file, _)| format!("{file}.png"));
        for file in charts.chain(pictures) {
            text.push_str(&format!("\n![{file}]({file})\n"));
        }
        for failure in &self.failures {
            text.push_str(&format!("\n- {failure}"));
        }
        text
    }

    /// Writes the page, each table as CSV, all tables as JSON, charts and pictures into a folder.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, name: &str, folder: &Path) -> Result<(), Failure> {
        let mut json = Map::new();
        for table in &self.tables {
            let file = match self.tables.len() {
                1 => format!("{name}.csv"),
                _ => format!("{name}-{}.csv", file_name(&table.name)),
            };
            files::write(&folder.join(file), table.csv().as_bytes())?;
            json.insert(table.name.clone(), table.json());
        }
        let about = [
            ("machine", describe_machine()),
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ("about", self.about.clone()),
        ];
        json.extend(about.map(|(key, text)| (key.to_owned(), Value::String(text))));
        let json = serde_json::to_string_pretty(&json).context("the tables as JSON")?;
        files::write(&folder.join(format!("{name}.json")), json.as_bytes())?;
        for (file, chart) in &self.charts {
            files::write(&folder.join(format!("{file}.svg")), chart.svg().as_bytes())?;
        }
        for (file, picture) in &self.pictures {
            files::write_picture(&folder.join(format!("{file}.png")), &picture.clone().into())?;
        }
        for (file, bytes) in &self.files {
            files::write(&folder.join(file), bytes)?;
        }
        let page = self.markdown(name);
        println!("{page}");
        files::write(&folder.join(format!("{name}.md")), page.as_bytes())?;
        println!("written to {}", folder.display());
        if self.failures.is_empty() {
            return Ok(());
        }
        Err(Failure::BadInput(format!(
            "{} limits are broken",
            self.failures.len()
        )))
    }
}

/// The letters and digits of a title, joined by hyphens.
fn file_name(title: &str) -> String {
    let words = title.split(|c: char| !c.is_ascii_alphanumeric());
    words
        .filter(|word| !word.is_empty())
        .collect::<Vec<_>>()
        .join("-")
}

/// Processor, cores and version in one line.
fn describe_machine() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = text
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'))
        .map_or("unknown processor", |(_, name)| name.trim());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let features = renderer::cpu_features();
    format!(
        "{model}, cores: {cores}, {features}, fathom {}",
        env!("CARGO_PKG_VERSION")
    )
}

//! The result of an experiment, and its files.

use std::path::Path;

use anyhow::Context;
use cli::exit::Failure;
use cli::files;
use imaging::Rgb8;
use serde_json::{Map, Value};

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
    /// SVG charts by the names of their files.
    pub charts: Vec<(String, String)>,
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
    pub fn new(about: impl Into<String>, tables: Vec<Table>) -> Self {
        let mut report = Self::default();
        (report.about, report.tables) = (about.into(), tables);
        report
    }

    /// Adds a chart.
    pub fn add_chart(&mut self, name: impl Into<String>, svg: String) {
        self.charts.push((name.into(), svg));
    }

    /// The page of the report.
    fn markdown(&self, name: &str, machine: &str) -> String {
        let about = &self.about;
        let mut text = format!("# {name}\n\n{about}\n\n`fathom-lab experiment {name}`; {machine}.\n");
        for table in &self.tables {
            let rows = match table.rows().len() {
                0..=MOST_ROWS => table.markdown(),
                rows => format!("{rows} rows, as CSV.\n"),
            };
            text += &format!("\n## {}\n\n{rows}", table.name);
        }
        let charts = self.charts.iter().map(|(file, _)| format!("{file}.svg"));
        let pictures = self.pictures.iter().map(|(file, _)| format!("{file}.png"));
        let files = charts
            .chain(pictures)
            .map(|file| format!("\n![{file}]({file})\n"));
        let failures = self.failures.iter().map(|failure| format!("\n- {failure}"));
        text.extend(files.chain(failures));
        text
    }

    /// Writes the page, each table as CSV, all tables as JSON, charts and pictures into a folder.
    ///
    /// # Errors
    /// A file cannot be written, or limits are broken.
    pub fn write(&self, name: &str, folder: &Path) -> Result<(), Failure> {
        let machine = describe_machine();
        let mut json = Map::new();
        for table in &self.tables {
            let file = match self.tables.len() {
                1 => format!("{name}.csv"),
                _ => format!("{name}-{}.csv", file_name(&table.name)),
            };
            files::write(&folder.join(file), table.csv().as_bytes())?;
            json.insert(table.name.clone(), table.json());
        }
        json.insert("about".to_owned(), Value::String(self.about.clone()));
        json.insert("machine".to_owned(), Value::String(machine.clone()));
        let json = serde_json::to_vec_pretty(&json).context("the tables as JSON")?;
        files::write(&folder.join(format!("{name}.json")), &json)?;
        for (file, svg) in &self.charts {
            files::write(&folder.join(format!("{file}.svg")), svg.as_bytes())?;
        }
        for (file, picture) in &self.pictures {
            files::write_picture(&folder.join(format!("{file}.png")), &picture.clone().into())?;
        }
        for (file, bytes) in &self.files {
            files::write(&folder.join(file), bytes)?;
        }
        let page = self.markdown(name, &machine);
        files::write(&folder.join(format!("{name}.md")), page.as_bytes())?;
        println!("{page}\nwritten to {}", folder.display());
        match self.failures.len() {
            0 => Ok(()),
            failures => Err(Failure::BadInput(format!("{failures} limits are broken"))),
        }
    }
}

/// The letters and digits of a title, joined by hyphens.
fn file_name(title: &str) -> String {
    let words = title.split(|c: char| !c.is_ascii_alphanumeric());
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    words.join("-")
}

/// Processor, cores and version in one line.
fn describe_machine() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let mut lines = text.lines();
    let model = lines.find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let model = model.map_or("unknown processor", |(_, name)| name);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let (features, version) = (renderer::cpu_features(), env!("CARGO_PKG_VERSION"));
    format!("{model}, cores: {cores}, {features}, fathom {version}")
}

//! The figures and the frames of Table 1, declared in `figures.json`.

use cli::exit::Failure;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use spec::{Invalid, Job, Vocabulary};

/// Everything that the page shows.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Declaration {
    /// The site of every job that names no other.
    site: Value,
    width: usize,
    height: usize,
    pub(super) figures: Vec<Figure>,
    /// The job of Table 1.
    table: Map<String, Value>,
}

/// A figure of the publication.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Figure {
    pub(super) number: u8,
    pub(super) title: String,
    /// Content of the published figure, in substance.
    pub(super) caption: String,
    /// Differences from it, with reasons.
    pub(super) differs: String,
    /// Panels next to each other.
    pub(super) columns: usize,
    pub(super) rows: Vec<Row>,
}

/// Panels of one job.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Row {
    #[serde(default)]
    job: Map<String, Value>,
    /// Matches this frame of the job with the previous one; without it panels show frame 0.
    #[serde(default)]
    pub(super) matched: Option<u64>,
    pub(super) panels: Vec<Panel>,
}

/// One picture of a figure.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Panel {
    pub(super) artifact: String,
    pub(super) label: String,
}

impl Declaration {
    /// The declaration, with pictures of another width but the same proportions if one is given.
    ///
    /// # Errors
    /// The embedded text is damaged.
    pub(super) fn read(width: Option<u16>) -> Result<Self, Failure> {
        let mut declaration: Self =
            serde_json::from_str(include_str!("figures.json")).map_err(anyhow::Error::from)?;
        if let Some(width) = width.map(usize::from) {
            declaration.height = (declaration.height * width / declaration.width).max(1);
            declaration.width = width;
            let (width, height) = (declaration.width, declaration.height);
            declaration
                .table
                .insert("camera".to_owned(), json!({"width": width, "height": height}));
        }
        Ok(declaration)
    }

    /// The complete description of a row's job.
    pub(super) fn describe_row(&self, row: &Row) -> Value {
        let mut artifacts: Vec<&str> = row.panels.iter().map(|panel| panel.artifact.as_str()).collect();
        if row.matched.is_some() {
            artifacts.push("flow");
        }
        let mut job = row.job.clone();
        job.insert("artifacts".to_owned(), json!(artifacts));
        job.insert("metrics".to_owned(), json!([]));
        let camera = job.entry("camera").or_insert_with(|| json!({}));
        camera["width"] = json!(self.width);
        camera["height"] = json!(self.height);
        self.complete(job)
    }

    /// The description of the job of Table 1.
    pub(super) fn describe_table(&self) -> Value {
        self.complete(self.table.clone())
    }

    fn complete(&self, mut job: Map<String, Value>) -> Value {
        job.entry("site").or_insert_with(|| self.site.clone());
        job.insert("dataset".to_owned(), json!("reproduce"));
        Value::Object(job)
    }
}

/// Reads a description of this module.
///
/// # Errors
/// The description is not valid.
pub(super) fn parse_job(description: &Value, vocabulary: &Vocabulary) -> Result<Job, Failure> {
    Job::parse(description.to_string().as_bytes(), vocabulary).map_err(invalid)
}

/// An embedded description that is not valid, which is an error of the program.
pub(super) fn invalid(invalid: Invalid) -> Failure {
    anyhow::Error::from(invalid)
        .context("a job of figures.json")
        .into()
}

#[cfg(test)]
mod tests {
    use style::Library;

    use super::*;

    #[test]
    fn figures_3_to_11_are_declared_in_order_and_their_jobs_are_valid_at_any_width() {
        let vocabulary = renderer::vocabulary(&Library::embedded().unwrap(), false);
        for width in [None, Some(64), Some(1920)] {
            let declaration = Declaration::read(width).unwrap();
            let numbers = declaration.figures.iter().map(|figure| figure.number);
            assert!(numbers.eq(3..=11));
            for row in declaration.figures.iter().flat_map(|figure| &figure.rows) {
                let job = parse_job(&declaration.describe_row(row), &vocabulary).unwrap();
                assert!(row.matched.is_none_or(|frame| (1..job.frames()).contains(&frame)));
            }
            parse_job(&declaration.describe_table(), &vocabulary).unwrap();
        }
    }
}

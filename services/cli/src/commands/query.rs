//! `fathom query`: images by their parameters and metrics.

use serde_json::Value;

use crate::exit::Failure;
use crate::remote::{Remote, ServerArguments, query_value};
use crate::table::{cell, table};

/// Options of `fathom query`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Which images, such as 'uiqm > 0.8 and water.style in ("muddy")'; empty: all
    #[arg(default_value = "")]
    filter: String,
    /// Only this dataset
    #[arg(long)]
    dataset: Option<String>,
    /// Order, such as uiqm or -uiqm (largest first)
    #[arg(long, value_name = "COLUMN", allow_hyphen_values = true)]
    order_by: Option<String>,
    /// Most rows to print
    #[arg(long, default_value_t = 50)]
    limit: usize,
    /// Columns to print, comma-separated
    #[arg(long, value_delimiter = ',')]
    fields: Vec<String>,
    /// Print one JSON object per image
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    server: ServerArguments,
}

/// Columns shown unless others are asked for.
pub(crate) const USUAL_FIELDS: [&str; 9] = [
    "job",
    "frame",
    "water.optics",
    "water.style",
    "alpha",
    "entropy",
    "uicm",
    "uiqm",
    "uciqe",
];
/// Rows that one request asks for.
const PAGE_ROWS: usize = 500;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let remote = Remote::new(&arguments.server);
    let usual = USUAL_FIELDS.map(str::to_owned).to_vec();
    let fields = if arguments.fields.is_empty() {
        usual
    } else {
        arguments.fields.clone()
    };
    let question = Question {
        dataset: arguments.dataset.as_deref(),
        filter: &arguments.filter,
        order_by: arguments.order_by.as_deref(),
        fields: &fields,
        limit: arguments.limit,
    };
    let rows = question.ask(&remote)?;
    if arguments.json {
        rows.iter().for_each(|row| println!("{row}"));
        return Ok(());
    }
    println!("{}", rows_table(&fields, &rows));
    println!("{} images", rows.len());
    Ok(())
}

/// Image rows as a text table with these columns.
pub(crate) fn rows_table(fields: &[String], rows: &[Value]) -> String {
    let header: Vec<&str> = fields.iter().map(String::as_str).collect();
    let cells: Vec<Vec<String>> = rows
        .iter()
        .map(|row| {
            fields
                .iter()
                .map(|field| cell(row.get(field).unwrap_or(&Value::Null)))
                .collect()
        })
        .collect();
    table(&header, &cells)
}

/// A question about images.
pub(crate) struct Question<'a> {
    pub(crate) dataset: Option<&'a str>,
    pub(crate) filter: &'a str,
    pub(crate) order_by: Option<&'a str>,
    /// Columns; none: all.
    pub(crate) fields: &'a [String],
    pub(crate) limit: usize,
}

impl Question<'_> {
    /// All rows up to the limit.
    pub(crate) fn ask(&self, remote: &Remote) -> Result<Vec<Value>, Failure> {
        let mut rows = Vec::new();
        self.pages(remote, |mut page| {
            rows.append(&mut page);
            Ok(())
        })?;
        Ok(rows)
    }

    /// Hands on the rows page by page, up to the limit.
    pub(crate) fn pages(
        &self,
        remote: &Remote,
        mut take: impl FnMut(Vec<Value>) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let mut left = self.limit;
        let mut cursor: Option<String> = None;
        while left > 0 {
            let path = self.path(left.min(PAGE_ROWS), cursor.as_deref());
            let mut page = remote.get(&path)?.json()?;
            let items = page.get_mut("items").and_then(Value::as_array_mut);
            let rows = items.map(std::mem::take).unwrap_or_default();
            left = left.saturating_sub(rows.len());
            take(rows)?;
            cursor = page.get("next_cursor").and_then(Value::as_str).map(str::to_owned);
            if cursor.is_none() {
                break;
            }
        }
        Ok(())
    }

    fn path(&self, limit: usize, cursor: Option<&str>) -> String {
        let mut path = format!("/v1/images?limit={limit}");
        let fields = (!self.fields.is_empty()).then(|| self.fields.join(","));
        let filter = (!self.filter.trim().is_empty()).then_some(self.filter);
        let parameters = [
            ("dataset", self.dataset),
            ("filter", filter),
            ("order_by", self.order_by),
            ("fields", fields.as_deref()),
            ("cursor", cursor),
        ];
        for (name, value) in parameters {
            if let Some(value) = value {
                path.push_str(&format!("&{name}={}", query_value(value)));
            }
        }
        path
    }
}

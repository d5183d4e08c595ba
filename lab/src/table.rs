//! Tables as Markdown, CSV and JSON.

pub use cli::plot::format_number;
use serde_json::{Map, Value};

/// Rows of values under named columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Its title, and its name in files.
    pub name: String,
    columns: Vec<String>,
    rows: Vec<Vec<Value>>,
}

/// A row of a table from values of any type.
#[macro_export]
macro_rules! row {
    ($($value:expr),* $(,)?) => { vec![$(serde_json::json!($value)),*] };
}

impl Table {
    /// A table without rows.
    pub fn new<C: ToString>(name: impl Into<String>, columns: impl IntoIterator<Item = C>) -> Self {
        Self {
            name: name.into(),
            columns: columns.into_iter().map(|column| column.to_string()).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row.
    ///
    /// # Panics
    /// The row has another number of cells than the table.
    pub fn push(&mut self, row: Vec<Value>) {
        assert_eq!(
            row.len(),
            self.columns.len(),
            "a cell for each column of {}",
            self.name
        );
        self.rows.push(row);
    }

    /// The rows.
    #[must_use]
    pub fn rows(&self) -> &[Vec<Value>] {
        &self.rows
    }

    /// The table for people: numbers with about three digits.
    #[must_use]
    pub fn markdown(&self) -> String {
        let rule = "---|".repeat(self.columns.len());
        let mut text = format!("| {} |\n|{rule}\n", self.columns.join(" | "));
        for row in &self.rows {
            let cells: Vec<String> = row.iter().map(format_cell).collect();
            text += &format!("| {} |\n", cells.join(" | "));
        }
        text
    }

    /// The table with all digits.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut text = join_cells(self.columns.iter().map(|column| quote(column)));
        for row in &self.rows {
            text += &join_cells(row.iter().map(|cell| match cell {
                Value::Null => String::new(),
                Value::String(text) => quote(text),
                other => other.to_string(),
            }));
        }
        text
    }

    /// The table as a list of objects.
    #[must_use]
    pub fn json(&self) -> Value {
        let objects = self.rows.iter().map(|row| {
            let fields = self.columns.iter().cloned().zip(row.iter().cloned());
            Value::Object(fields.collect::<Map<_, _>>())
        });
        objects.collect()
    }
}

fn join_cells(cells: impl Iterator<Item = String>) -> String {
    cells.collect::<Vec<_>>().join(",") + "\n"
}

fn quote(text: &str) -> String {
    match text.contains([',', '"', '\n']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

fn format_cell(value: &Value) -> String {
    match value {
        Value::Null => "–".to_owned(),
        Value::Bool(flag) => if *flag { "yes" } else { "" }.to_owned(),
        Value::String(text) => text.clone(),
        Value::Number(number) if number.is_f64() => format_number(number.as_f64().unwrap_or(f64::NAN)),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_table_has_three_forms() {
        let mut table = Table::new("a", ["name", "value"]);
        table.push(row!["x, y", 1.0 / 3.0]);
        table.push(row!["z", None::<f64>]);
        assert_eq!(
            table.markdown(),
            "| name | value |\n|---|---|\n| x, y | 0.33 |\n| z | – |\n"
        );
        assert_eq!(table.csv(), "name,value\n\"x, y\",0.3333333333333333\nz,\n");
        assert_eq!(
            (&table.json()[0]["value"], table.rows().len()),
            (&serde_json::json!(1.0 / 3.0), 2)
        );
        let texts = [0.0, 2e-5, 5.0, 12.34, 123.4, 1e6].map(format_number);
        assert_eq!(texts, ["0", "2.0e-5", "5.00", "12.3", "123", "1.0e6"]);
    }
}

//! Pages as JSON text.

use client::Page;
use serde_json::{Value, json};

use super::page::ImagePage;

impl ImagePage {
    /// The text of [`Page`] with rows as objects.
    pub(super) fn to_json(&self) -> Result<String, serde_json::Error> {
        let empty = serde_json::to_string(&Page::<Value> {
            items: Vec::new(),
            next_cursor: self.page.next_cursor.clone(),
            damaged: self.page.damaged.clone(),
        })?;
        // The items are the first member of a page.
        let (head, tail) = empty.split_at(r#"{"items":["#.len());
        let keys: Vec<String> = self
            .names
            .iter()
            .map(|name| format!("{}:", json!(name)))
            .collect();
        let mut text = head.to_owned();
        for (row, cells) in self.page.items.iter().enumerate() {
            text.push_str(if row == 0 { "{" } else { ",{" });
            for (index, cell) in cells.iter().enumerate() {
                text.push_str(if index == 0 { "" } else { "," });
                text.push_str(&keys[cell.name]);
                push_value(&mut text, &cell.value);
            }
            text.push('}');
        }
        text.push_str(tail);
        Ok(text)
    }
}

/// Appends a value; most texts are names and digests, which need no escapes.
fn push_value(text: &mut String, value: &Value) {
    match value {
        Value::String(plain) if plain.bytes().all(is_plain) => {
            text.push('"');
            text.push_str(plain);
            text.push('"');
        }
        other => text.push_str(&other.to_string()),
    }
}

fn is_plain(byte: u8) -> bool {
    matches!(byte, b' '..=b'~') && !matches!(byte, b'"' | b'\\')
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pages::page::Cell;

    /// A page with cells in every second column; its first row has none.
    fn page(rows: usize, next_cursor: Option<&str>, damaged: &[&str]) -> ImagePage {
        let values = [
            json!(true),
            json!(-3),
            json!(u64::MAX),
            json!(0.1),
            json!(1e300),
            json!(""),
            json!("sha-256 ~"),
            json!("a \"b\" \\ \n \u{7f} \u{1} ä \u{2028}"),
        ];
        let names = ["a", "b", "c", "quoted \" name"].map(str::to_owned);
        let items = (0..rows).map(|row| {
            let columns = (0..names.len()).step_by(2).filter(|_| row > 0);
            let cells = columns.map(|name| Cell {
                name,
                value: values[(row * 3 + name) % values.len()].clone(),
            });
            cells.collect()
        });
        ImagePage {
            page: Page {
                items: items.collect(),
                next_cursor: next_cursor.map(str::to_owned),
                damaged: damaged.iter().map(|&row| row.to_owned()).collect(),
            },
            names: names.to_vec(),
        }
    }

    #[test]
    fn the_text_is_that_of_the_objects() {
        for rows in 0..10 {
            for (next_cursor, damaged) in [(None, &[][..]), (Some("c\""), &["d"])] {
                let objects = page(rows, next_cursor, damaged).into_objects();
                let text = page(rows, next_cursor, damaged).to_json().unwrap();
                assert_eq!(text, serde_json::to_string(&objects).unwrap());
            }
        }
    }
}

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

    #[test]
    fn the_text_is_that_of_the_objects() {
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
        for rows in 0..10 {
            for (next_cursor, damaged) in [(None, vec![]), (Some("c\"".to_owned()), vec!["d".to_owned()])] {
                let items = (0..rows).map(|row| {
                    // The first row has no cells.
                    let cells = (0..names.len()).step_by(2).filter(|_| row > 0);
                    let cell = |name| Cell {
                        name,
                        value: values[(row * 3 + name) % values.len()].clone(),
                    };
                    cells.map(cell).collect()
                });
                let page = || ImagePage {
                    names: names.to_vec(),
                    page: Page {
                        items: items.clone().collect(),
                        next_cursor: next_cursor.clone(),
                        damaged: damaged.clone(),
                    },
                };
                let expected = serde_json::to_string(&page().into_objects()).unwrap();
                assert_eq!(page().to_json().unwrap(), expected);
            }
        }
    }
}

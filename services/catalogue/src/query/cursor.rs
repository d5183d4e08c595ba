//! Cursors: the end of a page, bound to its query.
//!
//! A cursor is readable text with a checksum. It is not secret: a forged one could only start a page at another row of the same
//! query. The checksum detects mistakes.

use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use crate::error::CatalogueError;

const CHECK_CHARS: usize = 16;

/// A cursor for a place among the rows of a query.
pub(crate) fn write(query: &str, place: &Value) -> String {
    let text = place.to_string();
    let body: String = text.bytes().map(|byte| format!("{byte:02x}")).collect();
    format!("{}{body}", check(query, &text))
}

/// The place of a cursor.
pub(crate) fn read(query: &str, cursor: &str) -> Result<Value, CatalogueError> {
    let wrong = || CatalogueError::Cursor;
    let body = cursor.get(CHECK_CHARS..).ok_or_else(wrong)?;
    if body.len() % 2 != 0 || !body.is_ascii() {
        return Err(wrong());
    }
    let bytes = (0..body.len())
        .step_by(2)
        .map(|at: usize| u8::from_str_radix(&body[at..at + 2], 16).map_err(|_| wrong()))
        .collect::<Result<Vec<u8>, _>>()?;
    let text = String::from_utf8(bytes).map_err(|_| wrong())?;
    if cursor.get(..CHECK_CHARS) != Some(check(query, &text).as_str()) {
        return Err(wrong());
    }
    serde_json::from_str(&text).map_err(|_| wrong())
}

/// A query as one text that no other query has.
pub(crate) fn query_identity(parts: &[Option<&str>]) -> String {
    json!(parts).to_string()
}

/// The id after which the next page of a list starts.
pub(crate) fn read_id(query: &str, cursor: Option<&str>) -> Result<Option<String>, CatalogueError> {
    let Some(cursor) = cursor else { return Ok(None) };
    let id = read(query, cursor)?.as_str().map(str::to_owned);
    id.map(Some).ok_or(CatalogueError::Cursor)
}

fn check(query: &str, text: &str) -> String {
    let digest = Sha256::new()
        .chain_update("fathom-cursor-v1")
        .chain_update(query)
        .chain_update([0])
        .chain_update(text)
        .finalize();
    spec::hex(&digest)[..CHECK_CHARS].to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cursor_comes_back_for_its_own_question_only() {
        let query = query_identity(&[Some("bay"), None]);
        let place = json!([1.5, "job_1", 7]);
        let cursor = write(&query, &place);
        assert_eq!(read(&query, &cursor).unwrap(), place);
        assert!(matches!(read("another", &cursor), Err(CatalogueError::Cursor)));
    }

    #[test]
    fn forged_and_broken_cursors_are_refused() {
        let cursor = write("q", &json!([1]));
        let mut forged = cursor.clone();
        forged.replace_range(17..18, "9");
        for text in [
            "",
            "zz",
            "0123456789abcdef",
            &cursor[..cursor.len() - 1],
            &forged,
            "ü".repeat(20).as_str(),
        ] {
            assert!(matches!(read("q", text), Err(CatalogueError::Cursor)), "{text}");
        }
    }
}

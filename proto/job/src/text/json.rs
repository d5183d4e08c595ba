//! Strict JSON parsing: RFC 8259 within limits, without duplicate keys, with `//` comments.
//!
//! A common parser silently keeps the last of two equal keys.

use std::fmt;

use serde::de::{DeserializeSeed, Error, MapAccess, SeqAccess, Visitor};
use serde_json::error::Category;
use serde_json::{Map, Number, Value};

use crate::invalid::{FieldError, Invalid, MAX_ERRORS, quote};

/// Maximum length of a description in bytes, submitted or canonical. A grid of ten thousand scenes fits.
pub const MAX_BYTES: usize = 1 << 20;

/// Maximum nesting of lists and objects. The deepest field needs 4; each enclosing distribution adds 2.
pub const MAX_DEPTH: usize = 32;

/// Maximum length of a key in bytes. Fields and labels are far shorter.
const MAX_KEY_BYTES: usize = 256;

/// The text after a byte order mark of UTF-8, which some editors write.
#[must_use]
pub fn skip_byte_order_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// Parses one JSON document, with or without a byte order mark. Two slashes outside a string begin a comment, which
/// ends with its line.
///
/// # Errors
/// Too long, not JSON, nested too deeply, an overlong key, or duplicate keys (all of them).
pub fn read(bytes: &[u8]) -> Result<Value, Invalid> {
    if let [0xff, 0xfe, ..] | [0xfe, 0xff, ..] = bytes {
        let message = "the document begins with a byte order mark of UTF-16; save it as UTF-8";
        return Err(Invalid(vec![FieldError::new("", message)]));
    }
    let bytes = skip_byte_order_mark(bytes);
    if bytes.len() > MAX_BYTES {
        let message = format!(
            "the document has {} bytes; must be at most {MAX_BYTES}",
            bytes.len()
        );
        return Err(Invalid(vec![
            FieldError::new("", message).limit(format!("{MAX_BYTES} bytes")),
        ]));
    }
    let mut reader = Reader::default();
    let text = blank_comments(bytes);
    let mut deserializer = serde_json::Deserializer::from_slice(&text);
    let value = Seed(&mut reader).deserialize(&mut deserializer);
    match value.and_then(|value| deserializer.end().map(|()| value)) {
        Ok(value) if reader.duplicates.is_empty() => Ok(value),
        Ok(_) => Err(Invalid(reader.duplicates)),
        Err(error) => Err(Invalid(vec![FieldError::new(
            &pointer(&reader.path),
            match error.classify() {
                Category::Data => error.to_string(),
                _ if text != bytes && !bytes.contains(&b'\n') => format!(
                    "not valid JSON: {error}; a comment ends with its line, but the text is one line \
                     (`curl --data` joins lines, `curl --data-binary` keeps them)"
                ),
                _ => format!("not valid JSON: {error}"),
            },
        )])),
    }
}

/// The text with spaces in place of comments, so that errors keep their line and column.
fn blank_comments(bytes: &[u8]) -> Vec<u8> {
    let mut text = bytes.to_vec();
    let (mut position, mut is_string) = (0, false);
    while position < text.len() {
        match text[position] {
            b'\\' if is_string => position += 1,
            b'"' => is_string = !is_string,
            b'/' if !is_string && text[position..].starts_with(b"//") => {
                let rest = text[position..].iter_mut();
                rest.take_while(|byte| **byte != b'\n')
                    .for_each(|byte| *byte = b' ');
            }
            _ => {}
        }
        position += 1;
    }
    text
}

/// One step of a JSON pointer, escaped after RFC 6901.
pub(crate) fn step(key: &str) -> String {
    format!("/{}", key.replace('~', "~0").replace('/', "~1"))
}

fn pointer(path: &[String]) -> String {
    path.iter().map(|key| step(key)).collect()
}

#[derive(Default)]
struct Reader {
    path: Vec<String>,
    duplicates: Vec<FieldError>,
}

struct Seed<'r>(&'r mut Reader);

impl<'de> DeserializeSeed<'de> for Seed<'_> {
    type Value = Value;

    fn deserialize<D: serde::Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Seed<'_> {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(Value::Bool(value))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Value, E> {
        Number::from_f64(value)
            .map(Value::Number)
            .ok_or_else(|| E::custom("number is not finite"))
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(Value::String(value.to_owned()))
    }

    fn visit_string<E>(self, value: String) -> Result<Value, E> {
        Ok(Value::String(value))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Value, A::Error> {
        let mut list = Vec::new();
        loop {
            enter(self.0, list.len().to_string())?;
            let Some(item) = items.next_element_seed(Seed(self.0))? else {
                break;
            };
            self.0.path.pop();
            list.push(item);
        }
        self.0.path.pop();
        Ok(Value::Array(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut map = Map::new();
        while let Some(key) = entries.next_key::<String>()? {
            if key.len() > MAX_KEY_BYTES {
                return Err(A::Error::custom(format!(
                    "a key has {} bytes; must be at most {MAX_KEY_BYTES}",
                    key.len()
                )));
            }
            enter(self.0, key.clone())?;
            let value = entries.next_value_seed(Seed(self.0))?;
            if map.contains_key(&key) {
                let error = FieldError::new(
                    &pointer(&self.0.path),
                    format!("`{key}` occurs twice; remove one"),
                )
                .value(&value);
                if self.0.duplicates.len() < MAX_ERRORS {
                    self.0.duplicates.push(error);
                }
            } else {
                map.insert(key, value);
            }
            self.0.path.pop();
        }
        Ok(Value::Object(map))
    }
}

fn enter<E: Error>(reader: &mut Reader, key: String) -> Result<(), E> {
    if reader.path.len() == MAX_DEPTH {
        return Err(E::custom(format!("nested more than {MAX_DEPTH} deep")));
    }
    reader.path.push(key);
    Ok(())
}

/// The kind of a JSON value, for messages.
pub(crate) fn describe(value: &Value) -> String {
    match value {
        Value::Null => "null; omit the field instead".to_owned(),
        Value::String(_) => format!("the string {}", quote(value)),
        other => quote(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(text: &str) -> Vec<FieldError> {
        read(text.as_bytes()).unwrap_err().0
    }

    #[test]
    fn every_duplicate_key_is_named_with_its_place() {
        let found = errors(r#"{"a": 1, "a": 2, "l": [{"x/y": 1, "x/y": 1}]}"#);
        let pointers: Vec<_> = found.iter().map(|error| error.pointer.as_str()).collect();
        assert_eq!(pointers, ["/a", "/l/0/x~1y"]);
        assert_eq!(found[0].value, Some(2.into()));
    }

    #[test]
    fn comments_end_with_their_line_and_errors_keep_their_position() {
        let text = "// a \"job\" {\n{\"url\": \"a//b\\\"//c\\\\\", // {\r\n\"b\": [1, //2,\n3]} //";
        let expected = serde_json::json!({"url": "a//b\"//c\\", "b": [1, 3]});
        assert_eq!(read(text.as_bytes()).unwrap(), expected);
        assert!(errors("// job\n{} //\n/")[0].message.ends_with("line 3 column 1"));
        let joined = errors("{ // job  \"count\": 1}").remove(0).message;
        assert!(joined.ends_with("`curl --data-binary` keeps them)"), "{joined}");
        for text in ["{} / /", "{} /* a */", "// {}", "{\"a // b\n\": 1}"] {
            assert!(errors(text)[0].message.starts_with("not valid JSON"), "{text}");
        }
    }

    #[test]
    fn values_outside_json_are_rejected() {
        for text in [
            "",
            "{",
            "NaN",
            "[1,]",
            "{\"a\":Infinity}",
            "1e999",
            "{} {}",
            "\"\\ud800\"",
            "01",
        ] {
            assert!(errors(text)[0].message.starts_with("not valid JSON"), "{text}");
        }
        assert!(read(b"\"\xff\"").is_err());
    }

    #[test]
    fn nesting_is_limited() {
        let deep = |levels: usize| "[".repeat(levels) + &"]".repeat(levels);
        assert!(read(deep(MAX_DEPTH).as_bytes()).is_ok());
        assert!(
            errors(&deep(MAX_DEPTH + 1))[0]
                .message
                .contains("nested more than 32")
        );
        assert!(errors(&deep(400_000))[0].message.contains("nested more than 32"));
    }

    #[test]
    fn size_and_key_length_are_limited() {
        let long = format!("\"{}\"", "x".repeat(MAX_BYTES));
        assert!(errors(&long)[0].message.contains("must be at most 1048576"));
        assert!(
            errors(&format!("{{\"{}\": 1}}", "k".repeat(300)))[0]
                .message
                .contains("300 bytes")
        );
    }

    #[test]
    fn numbers_survive_writing_and_reading() {
        for number in [
            0.1,
            1.0 / 3.0,
            5e-324,
            1.797_693_134_862_315_7e308,
            0.3 - 0.1,
            123_456_789.123_456_79,
        ] {
            let text = Value::from(number).to_string();
            assert_eq!(read(text.as_bytes()).unwrap().as_f64(), Some(number), "{text}");
        }
    }
}

//! A record kept as text. Only the checked and measured parts are parsed.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::record::RecordOf;

/// The parsed parts of a record kept as text.
pub type BriefRecord = RecordOf<Sound, BTreeMap<String, Sound>>;

/// Canonical text of a [`crate::FrameRecord`]; a string in JSON.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordText {
    text: String,
    record: BriefRecord,
    digest: String,
}

impl RecordText {
    /// Parses the canonical text of a [`crate::FrameRecord`].
    ///
    /// # Errors
    /// The parser's error.
    pub fn read(text: String) -> Result<Self, serde_json::Error> {
        let record: BriefRecord = serde_json::from_str(&text)?;
        let parameters = find_parameters(&text)?;
        Ok(Self {
            digest: record.digest_with(parameters),
            record,
            text,
        })
    }

    /// The parsed parts.
    #[must_use]
    pub fn record(&self) -> &BriefRecord {
        &self.record
    }

    /// As [`crate::FrameRecord::digest`], over the text of the parameters. Non-canonical parameters have another
    /// digest.
    #[must_use]
    pub fn digest(&self) -> &str {
        &self.digest
    }

    /// The text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.text
    }
}

impl Serialize for RecordText {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.text)
    }
}

impl<'de> Deserialize<'de> for RecordText {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::read(String::deserialize(deserializer)?).map_err(D::Error::custom)
    }
}

/// The text of the parameters. In canonical text only a quote and a colon separate a name from its value, and a comma
/// and a quote precede the next name. The parameters are never the last field.
fn find_parameters(text: &str) -> Result<&str, serde_json::Error> {
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let names = deserializer.deserialize_map(Names)?;
    let found = names.and_then(|(name, next)| {
        let start = offset(text, name) + name.len() + 2;
        text.get(start..offset(text, next).saturating_sub(2))
    });
    found.ok_or_else(|| Error::custom("the record is not in canonical form"))
}

fn offset(text: &str, part: &str) -> usize {
    part.as_ptr().addr() - text.as_ptr().addr()
}

/// Finds the key of the parameters in the text, and the key after it.
struct Names;

impl<'de> Visitor<'de> for Names {
    type Value = Option<(&'de str, &'de str)>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a record")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let (mut parameters, mut next) = (None, None);
        // A key with an escape is foreign to records, and cannot be borrowed.
        while let Some(name) = map.next_key::<&'de str>()? {
            if name == "parameters" {
                parameters = Some(name);
            } else if parameters.is_some() && next.is_none() {
                next = Some(name);
            }
            map.next_value::<IgnoredAny>()?;
        }
        Ok(parameters.zip(next))
    }
}

/// A valid JSON value, parsed and discarded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sound;

impl<'de> Deserialize<'de> for Sound {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Any)
    }
}

struct Any;

impl<'de> Visitor<'de> for Any {
    type Value = Sound;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_bool<E>(self, _: bool) -> Result<Sound, E> {
        Ok(Sound)
    }

    fn visit_i64<E>(self, _: i64) -> Result<Sound, E> {
        Ok(Sound)
    }

    fn visit_u64<E>(self, _: u64) -> Result<Sound, E> {
        Ok(Sound)
    }

    fn visit_f64<E>(self, _: f64) -> Result<Sound, E> {
        Ok(Sound)
    }

    fn visit_str<E>(self, _: &str) -> Result<Sound, E> {
        Ok(Sound)
    }

    fn visit_unit<E>(self) -> Result<Sound, E> {
        Ok(Sound)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Sound, A::Error> {
        while items.next_element::<Sound>()?.is_some() {}
        Ok(Sound)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut fields: A) -> Result<Sound, A::Error> {
        while fields.next_entry::<Sound, Sound>()?.is_some() {}
        Ok(Sound)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::{ArtifactEntry, FrameRecord};

    fn record() -> FrameRecord {
        FrameRecord {
            frame: 7,
            parameters: json!({"seed": 1, "alpha": 0.1, "labels": {"a\"b,": "{\"parameters\":{}}"}, "lights": [{"x": 1e-9}, null]}),
            // Fields of an inner object do not count.
            optics: json!({"parameters": {"seed": 2}, "plan": [1.5, true]})
                .as_object()
                .cloned()
                .unwrap(),
            plan: json!({}),
            promise: None,
            artifacts: vec![ArtifactEntry {
                kind: "rgb".to_owned(),
                digest: "d".to_owned(),
                bytes: 9,
                media_type: "image/png".to_owned(),
            }],
            ..FrameRecord::default()
        }
    }

    #[test]
    fn a_text_has_the_digest_of_its_record() {
        let text = serde_json::to_value(record()).unwrap().to_string();
        let read = RecordText::read(text.clone()).unwrap();
        assert_eq!(
            (read.digest(), read.as_str()),
            (record().digest().as_str(), text.as_str())
        );
        assert_eq!(read.record().artifacts, record().artifacts);
        let line = serde_json::to_string(&read).unwrap();
        assert_eq!(serde_json::from_str::<RecordText>(&line).unwrap(), read);
    }

    #[test]
    fn parameters_in_another_form_have_another_digest() {
        let pretty = serde_json::to_string_pretty(&serde_json::to_value(record()).unwrap()).unwrap();
        let read = RecordText::read(pretty).map(|read| read.digest().to_owned());
        assert_ne!(read.ok(), Some(record().digest()));
    }

    #[test]
    fn malformed_records_are_rejected() {
        let text = serde_json::to_value(record()).unwrap().to_string();
        let wrong = [
            text.replace("0.1", "1e999"),
            text.replace("\"seed\":2", "\"seed\":[2"),
            text.replace("\"bytes\":9", "\"bytes\":-9"),
            text.replace("\"plan\":{}", "\"plan\":{},\"plan\":{}"),
            format!("{text}x"),
        ];
        for wrong in wrong {
            assert_ne!(wrong, text);
            assert!(serde_json::from_str::<FrameRecord>(&wrong).is_err(), "{wrong}");
            assert!(RecordText::read(wrong.clone()).is_err(), "{wrong}");
        }
        let mut last: Value = serde_json::to_value(record()).unwrap();
        for after in ["plan", "provenance", "timings_ms", "warnings", "scene"] {
            last.as_object_mut().unwrap().remove(after);
        }
        assert!(RecordText::read(last.to_string()).is_err());
    }
}

//! Reads the classes of an uploaded scene.
//!
//! Two formats are accepted. The short one maps each object of the instance mask to a class name, `{"1": "pile", "2":
//! "chain"}`. Names from [`CATEGORIES`] get their code there, so that procedural and uploaded scenes agree; other names
//! get codes from [`FIRST_OWN`] on in alphabetical order. The long one, `{"categories": [{"id": 1, "name": "pile"}],
//! "segments_info": [{"id": 1, "category_id": 1}]}`, follows COCO's panoptic annotations and sets the codes. Objects
//! without a class are [`UNLABELED`].

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value};
use spec::{Classes, FieldError, Invalid, SceneCategory, Segment};

use crate::categories::{CATEGORIES, Category};

/// Code of the first class that is not among [`CATEGORIES`].
pub const FIRST_OWN: u8 = 128;
/// Code and name of objects without a class. Training code conventionally ignores 255.
pub const UNLABELED: (u8, &str) = (255, "unlabeled");
/// Maximum length of a class name in characters.
pub const MAX_NAME: usize = 64;

/// Fields of COCO categories and segments that are accepted and ignored.
const BESIDE_CATEGORY: [&str; 3] = ["supercategory", "isthing", "color"];
const BESIDE_SEGMENT: [&str; 3] = ["area", "bbox", "iscrowd"];

/// Reads classes. Errors carry JSON pointers into the text.
///
/// # Errors
/// All problems of the text together.
pub fn read(text: &[u8]) -> Result<Classes, Invalid> {
    let value = spec::read_json(text)?;
    let Value::Object(map) = &value else {
        let message = "classes must be an object such as {\"1\": \"pile\", \"2\": \"chain\"}";
        return Err(Invalid(vec![FieldError::new("", message)]));
    };
    let mut reader = ClassReader::default();
    let is_long = map.contains_key("categories") || map.contains_key("segments_info");
    let classes = if is_long {
        reader.long(map)
    } else {
        reader.short(map)
    };
    if reader.errors.is_empty() {
        Ok(classes)
    } else {
        reader.errors.truncate(spec::MAX_ERRORS);
        Err(Invalid(reader.errors))
    }
}

#[derive(Default)]
struct ClassReader {
    errors: Vec<FieldError>,
}

impl ClassReader {
    fn short(&mut self, map: &Map<String, Value>) -> Classes {
        let mut named = Vec::new();
        for (key, value) in map {
            let pointer = format!("/{}", escaped(key));
            let number = key
                .parse()
                .ok()
                .filter(|number: &u16| *number > 0 && *key == number.to_string());
            if number.is_none() {
                let message = format!("`{key}` is not the number of an object in the instance mask");
                self.refuse(&pointer, message, &key.as_str().into(), "1..=65535");
            }
            let name = self.name(&pointer, value);
            named.extend(number.zip(name));
        }
        let names: BTreeSet<&str> = named.iter().map(|(_, name)| name.as_str()).collect();
        let (known, own): (Vec<&str>, Vec<&str>) =
            names.into_iter().partition(|name| known_code(name).is_some());
        let most = usize::from(UNLABELED.0 - FIRST_OWN);
        if own.len() > most {
            let message = format!(
                "there are {} classes that procedural scenes do not have; must be at most {most}",
                own.len()
            );
            self.errors.push(FieldError::new("", message));
        }
        let own = (FIRST_OWN..UNLABELED.0).zip(own);
        let codes: BTreeMap<&str, u8> = own
            .map(|(code, name)| (name, code))
            .chain(
                known
                    .into_iter()
                    .filter_map(|name| Some((name, known_code(name)?))),
            )
            .collect();
        let mut classes = Classes {
            categories: codes
                .iter()
                .map(|(name, id)| SceneCategory {
                    id: *id,
                    name: (*name).to_owned(),
                })
                .collect(),
            segments_info: named
                .iter()
                .filter_map(|(id, name)| {
                    Some(Segment {
                        id: *id,
                        category_id: *codes.get(name.as_str())?,
                    })
                })
                .collect(),
        };
        sort(&mut classes);
        classes
    }

    fn long(&mut self, map: &Map<String, Value>) -> Classes {
        self.only(map, "", &["categories", "segments_info"]);
        let mut classes = Classes::default();
        for (pointer, entry) in self.entries(map, "categories") {
            self.only(entry, &pointer, &[&["id", "name"][..], &BESIDE_CATEGORY].concat());
            let id = self.number(entry, &pointer, "id", u64::from(UNLABELED.0) - 1);
            let name = match entry.get("name") {
                Some(name) => self.name(&format!("{pointer}/name"), name),
                None => self.missing(&pointer, "name"),
            };
            if let (Some(id), Some(name)) = (id, name) {
                let id = id as u8;
                if classes
                    .categories
                    .iter()
                    .any(|other| other.id == id || other.name == name)
                {
                    let message =
                        format!("class {id}, \"{name}\": its id or its name is in the list already");
                    self.errors.push(FieldError::new(&pointer, message));
                }
                classes.categories.push(SceneCategory { id, name });
            }
        }
        let mut seen = BTreeSet::new();
        for (pointer, entry) in self.entries(map, "segments_info") {
            self.only(
                entry,
                &pointer,
                &[&["id", "category_id"][..], &BESIDE_SEGMENT].concat(),
            );
            let id = self.number(entry, &pointer, "id", u64::from(u16::MAX));
            let class = self.number(entry, &pointer, "category_id", u64::from(UNLABELED.0) - 1);
            if let (Some(id), Some(class)) = (id, class) {
                if !seen.insert(id) {
                    let message = format!("object {id} has a class already");
                    self.errors
                        .push(FieldError::new(&format!("{pointer}/id"), message));
                }
                if classes
                    .categories
                    .iter()
                    .all(|category| u64::from(category.id) != class)
                {
                    let message = format!("`category_id` is {class}, which no category has");
                    let ids = classes.categories.iter().map(|category| category.id.to_string());
                    let error =
                        FieldError::new(&format!("{pointer}/category_id"), message).value(&class.into());
                    self.errors.push(error.allowed(ids, ""));
                }
                classes.segments_info.push(Segment {
                    id: id as u16,
                    category_id: class as u8,
                });
            }
        }
        sort(&mut classes);
        classes
    }

    fn entries<'a>(
        &mut self,
        map: &'a Map<String, Value>,
        name: &str,
    ) -> Vec<(String, &'a Map<String, Value>)> {
        let Some(Value::Array(items)) = map.get(name) else {
            self.errors.push(FieldError::new(
                &format!("/{name}"),
                format!("`{name}` must be a list of objects"),
            ));
            return Vec::new();
        };
        let mut entries = Vec::new();
        for (position, item) in items.iter().enumerate() {
            let pointer = format!("/{name}/{position}");
            match item {
                Value::Object(entry) => entries.push((pointer, entry)),
                other => self.refuse(
                    &pointer,
                    format!("{name}[{position}] must be an object"),
                    other,
                    "an object",
                ),
            }
        }
        entries
    }

    fn only(&mut self, map: &Map<String, Value>, pointer: &str, allowed: &[&str]) {
        for key in map.keys().filter(|key| !allowed.contains(&key.as_str())) {
            let error = FieldError::new(
                &format!("{pointer}/{}", escaped(key)),
                format!("unknown field `{key}`"),
            );
            self.errors.push(error.allowed(allowed, key));
        }
    }

    fn number(&mut self, entry: &Map<String, Value>, pointer: &str, name: &str, most: u64) -> Option<u64> {
        let Some(value) = entry.get(name) else {
            return self.missing(pointer, name);
        };
        let number = value.as_u64().filter(|number| (1..=most).contains(number));
        if number.is_none() {
            let message = format!("`{name}` must be a whole number from 1 to {most}");
            self.refuse(
                &format!("{pointer}/{name}"),
                message,
                value,
                &format!("1..={most}"),
            );
        }
        number
    }

    fn name(&mut self, pointer: &str, value: &Value) -> Option<String> {
        let limit = format!("1 to {MAX_NAME} printable characters without space at the ends");
        let name = value.as_str().filter(|name| is_name(name));
        let reserved = [Category::Background.name(), UNLABELED.1];
        match name {
            Some(name) if reserved.contains(&name) => {
                let message = format!("\"{name}\" is not a class of an object; omit the object instead");
                self.refuse(pointer, message, value, &limit);
                None
            }
            Some(name) => Some(name.to_owned()),
            None => {
                self.refuse(
                    pointer,
                    format!("the name of a class must be {limit}"),
                    value,
                    &limit,
                );
                None
            }
        }
    }

    fn missing<T>(&mut self, pointer: &str, name: &str) -> Option<T> {
        let message = format!("`{name}` is missing");
        self.errors
            .push(FieldError::new(&format!("{pointer}/{name}"), message).limit("required"));
        None
    }

    fn refuse(&mut self, pointer: &str, message: String, value: &Value, limit: &str) {
        self.errors
            .push(FieldError::new(pointer, message).value(value).limit(limit));
    }
}

fn sort(classes: &mut Classes) {
    classes.categories.sort_unstable_by_key(|category| category.id);
    classes.segments_info.sort_unstable_by_key(|segment| segment.id);
}

/// Code of a class from [`CATEGORIES`].
fn known_code(name: &str) -> Option<u8> {
    let known = CATEGORIES.iter().find(|(_, known)| *known == name);
    known.map(|(category, _)| *category as u8)
}

/// Whether a text is safe to print on one line: no control, invisible or direction-changing characters.
fn is_name(text: &str) -> bool {
    let length = text.chars().count();
    (1..=MAX_NAME).contains(&length)
        && text.trim() == text
        && !text.chars().any(|c| c.is_control() || is_hidden(c))
}

fn is_hidden(c: char) -> bool {
    matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

fn escaped(key: &str) -> String {
    key.replace('~', "~0").replace('/', "~1")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str) -> Vec<(u8, String)> {
        let classes = read(text.as_bytes()).unwrap_or_else(|error| panic!("{error}"));
        classes
            .categories
            .into_iter()
            .map(|category| (category.id, category.name))
            .collect()
    }

    fn refused(text: &str) -> Vec<(String, String)> {
        let errors = read(text.as_bytes()).expect_err(text).0;
        errors
            .into_iter()
            .map(|error| (error.pointer, error.message))
            .collect()
    }

    #[test]
    fn names_of_procedural_scenes_keep_their_codes_and_others_follow_their_order() {
        let text = r#"{"7": "rope", "1": "pile", "300": "chain", "2": "pile"}"#;
        let own = [(2, "pile"), (128, "chain"), (129, "rope")];
        assert_eq!(names(text), own.map(|(id, name)| (id, name.to_owned())));
        let classes = read(text.as_bytes()).unwrap();
        let found = [1, 2, 7, 300, 3].map(|number| classes.class_of(number));
        assert_eq!(found, [Some(2), Some(2), Some(129), Some(128), None]);
    }

    #[test]
    fn categories_of_coco_keep_their_ids() {
        let text = r#"{"categories": [{"id": 9, "name": "chain", "supercategory": "gear"}, {"id": 1, "name": "pile"}],
                       "segments_info": [{"id": 4, "category_id": 9, "iscrowd": 0, "bbox": [1, 2, 3, 4]}]}"#;
        assert_eq!(names(text), [(1, "pile".to_owned()), (9, "chain".to_owned())]);
        let classes = read(text.as_bytes()).unwrap();
        assert_eq!(classes.class_of(4), Some(9));
        // Stored classes must parse again.
        let stored = serde_json::to_vec(&classes).unwrap();
        assert_eq!(read(&stored).unwrap(), classes);
    }

    #[test]
    fn everything_wrong_is_reported_with_its_place() {
        let wrong = refused(
            r#"{"0": "pile", "1": "", "02": "x", "3": 7, "65536": "y", "4": "a\nb", "5": "\u202egnp", "6": "background"}"#,
        );
        let pointers: BTreeSet<&str> = wrong.iter().map(|(pointer, _)| pointer.as_str()).collect();
        assert_eq!(
            pointers,
            BTreeSet::from(["/0", "/1", "/02", "/3", "/65536", "/4", "/5", "/6"])
        );
        let long = refused(
            r#"{"categories": [{"id": 255, "name": "a"}, {"id": 1}, {"id": 2, "name": "b"}, {"id": 2, "name": "c"}, 5],
                "segments_info": [{"id": 1, "category_id": 3}, {"id": 1, "category_id": 2}, {"category_id": 2}], "images": []}"#,
        );
        let pointers: BTreeSet<&str> = long.iter().map(|(pointer, _)| pointer.as_str()).collect();
        let expected = [
            "/images",
            "/categories/0/id",
            "/categories/1/name",
            "/categories/3",
            "/categories/4",
            "/segments_info/0/category_id",
            "/segments_info/1/id",
            "/segments_info/2/id",
        ];
        assert_eq!(pointers, BTreeSet::from(expected));
        for text in ["", "[]", "3", r#"{"1": "a", "1": "b"}"#, r#"{"categories": 3}"#] {
            assert!(!refused(text).is_empty(), "{text}");
        }
        let many: Map<String, Value> = (1..=128)
            .map(|i| (i.to_string(), format!("own {i}").into()))
            .collect();
        assert!(
            refused(&Value::Object(many).to_string())[0]
                .1
                .contains("must be at most 127")
        );
        let long_name = format!(r#"{{"1": "{}"}}"#, "x".repeat(65));
        assert_eq!(refused(&long_name).len(), 1);
    }
}

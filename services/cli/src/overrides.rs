//! Fields of a job that a command replaces.

use serde_json::{Map, Value};

/// A replaced field.
#[derive(Debug, Clone, PartialEq)]
pub struct Override {
    /// Names of the objects down to the field, or positions in lists.
    path: Vec<String>,
    value: Value,
}

impl Override {
    /// Reads `FIELD=VALUE`: dots separate the names, and a value that is not JSON is a text.
    pub fn parse(text: &str) -> Result<Self, String> {
        let parts = text.split_once('=');
        let (field, value) = parts.ok_or_else(|| format!("--set {text}: must be FIELD=VALUE"))?;
        let path: Vec<String> = field.split('.').map(str::to_owned).collect();
        if path.iter().any(String::is_empty) {
            return Err(format!("--set {text}: `{field}` must be names separated by dots"));
        }
        let value = serde_json::from_str(value).unwrap_or_else(|_| Value::from(value));
        Ok(Self { path, value })
    }

    /// Sets the field in a description; the value null removes it. Missing objects are created.
    pub fn apply(&self, description: &mut Value) -> Result<(), String> {
        let (last, parents) = self.path.split_last().ok_or("a field has a name")?;
        let mut at = description;
        for name in parents {
            at = self.enter(at, name)?;
        }
        if let (Value::Object(fields), Value::Null) = (&mut *at, &self.value) {
            fields.remove(last);
            return Ok(());
        }
        *self.enter(at, last)? = self.value.clone();
        Ok(())
    }

    /// The value of this name or position in an object or list.
    fn enter<'v>(&self, value: &'v mut Value, name: &str) -> Result<&'v mut Value, String> {
        if value.is_null() {
            *value = Value::Object(Map::new());
        }
        let path = self.path.join(".");
        match value {
            Value::Object(fields) => Ok(fields.entry(name).or_insert(Value::Null)),
            Value::Array(items) => {
                let count = items.len();
                let item = name
                    .parse()
                    .ok()
                    .and_then(|position: usize| items.get_mut(position));
                item.ok_or_else(|| format!("--set {path}: `{name}` is not a position in a list of {count}"))
            }
            _ => Err(format!(
                "--set {path}: the value that should hold `{name}` is not an object"
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn fields_are_replaced_in_objects_and_lists() {
        let mut job = json!({"site": "tank", "lights": [{"cone_deg": 30}], "alpha": 1});
        for text in [
            "water.optics=jerlov-II",
            "lights.0.cone_deg=45",
            "count=7",
            "camera={\"width\": 64}",
            "alpha=null",
        ] {
            Override::parse(text).unwrap().apply(&mut job).unwrap();
        }
        let expected = json!({"site": "tank", "lights": [{"cone_deg": 45}], "water": {"optics": "jerlov-II"},
            "count": 7, "camera": {"width": 64}});
        assert_eq!(job, expected);
    }

    #[test]
    fn a_wrong_path_is_named() {
        let mut job = json!({"site": "tank", "lights": []});
        assert!(
            Override::parse("count")
                .unwrap_err()
                .contains("must be FIELD=VALUE")
        );
        assert!(
            Override::parse("a..b=1")
                .unwrap_err()
                .contains("separated by dots")
        );
        let mut apply = |text: &str| Override::parse(text).unwrap().apply(&mut job).unwrap_err();
        assert!(apply("lights.0.cone_deg=1").contains("not a position in a list of 0"));
        assert!(apply("site.name=x").contains("not an object"));
    }
}

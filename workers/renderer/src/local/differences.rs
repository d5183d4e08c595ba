//! The differences of two descriptions, for messages.

use serde_json::Value;

/// Most differences that a message lists.
const MOST: usize = 5;

/// Describes the differences of two canonical descriptions: `count` is 3 there and 5 here.
pub(crate) fn describe_differences(there: &str, here: &str) -> String {
    let parse = |text: &str| serde_json::from_str::<Value>(text);
    let (Ok(there), Ok(here)) = (parse(there), parse(here)) else {
        return "its job.json is damaged".to_owned();
    };
    let mut found = Vec::new();
    collect("", &there, &here, &mut found);
    let more = match found.len().saturating_sub(MOST) {
        0 => String::new(),
        more => format!("; and {more} more"),
    };
    found.truncate(MOST);
    format!("{}{more}", found.join("; "))
}

fn collect(path: &str, there: &Value, here: &Value, found: &mut Vec<String>) {
    if there == here {
        return;
    }
    if let (Value::Object(one), Value::Object(other)) = (there, here) {
        let mut keys: Vec<&String> = one.keys().chain(other.keys()).collect();
        keys.sort_unstable();
        keys.dedup();
        for key in keys {
            let dot = if path.is_empty() { "" } else { "." };
            let path = format!("{path}{dot}{key}");
            collect(&path, &there[key], &here[key], found);
        }
        return;
    }
    found.push(format!(
        "`{path}` is {} there and {} here",
        shorten(there),
        shorten(here)
    ));
}

fn shorten(value: &Value) -> String {
    const CHARACTERS: usize = 40;
    let text = match value {
        Value::Null => "absent".to_owned(),
        value => value.to_string(),
    };
    if text.chars().count() <= CHARACTERS {
        return text;
    }
    let start: String = text.chars().take(CHARACTERS).collect();
    format!("{start}…")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_different_field_is_named_with_both_values() {
        let stored = r#"{"count": 3, "scene": {"seed": 1}, "same": [1]}"#;
        let wanted = r#"{"count": 5, "scene": {"seed": 1, "family": "shaft"}, "same": [1]}"#;
        assert_eq!(
            describe_differences(stored, wanted),
            "`count` is 3 there and 5 here; `scene.family` is absent there and \"shaft\" here"
        );
        assert_eq!(describe_differences("{", wanted), "its job.json is damaged");
    }
}

//! The types that the labels of a description can have.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

/// Type of a label's value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LabelType {
    /// A number.
    Number,
    /// A string.
    Text,
    /// A truth value.
    Bool,
}

impl LabelType {
    /// Its name in lists of columns.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Number => "number",
            Self::Text => "text",
            Self::Bool => "bool",
        }
    }

    /// The column of this type for a label of several types, in a table whose columns have one type each. Numbers have the name of
    /// the label.
    #[must_use]
    pub fn mixed_column(self, label: &str) -> String {
        match self {
            Self::Number => label.to_owned(),
            Self::Text | Self::Bool => format!("{label} ({})", self.name()),
        }
    }

    /// The type of a value.
    #[must_use]
    pub fn of_value(value: &Value) -> Option<Self> {
        match value {
            Value::Number(_) => Some(Self::Number),
            Value::String(_) => Some(Self::Text),
            Value::Bool(_) => Some(Self::Bool),
            _ => None,
        }
    }
}

/// The types of each label of `labels` in a canonical description.
#[must_use]
pub fn label_types(labels: &Value) -> BTreeMap<String, BTreeSet<LabelType>> {
    let labels = labels.as_object().into_iter().flatten();
    labels
        .map(|(name, description)| {
            let mut types = BTreeSet::new();
            collect_types(description, &mut types);
            (name.clone(), types)
        })
        .collect()
}

/// Adds the types of the values that a label's description draws.
pub fn collect_types(description: &Value, types: &mut BTreeSet<LabelType>) {
    match description {
        Value::Array(values) => values.iter().for_each(|value| collect_types(value, types)),
        Value::Object(law) => match law.get("choice").or_else(|| law.get("grid")) {
            Some(values) => collect_types(values, types),
            // All other distributions draw numbers.
            None => {
                types.insert(LabelType::Number);
            }
        },
        value => types.extend(LabelType::of_value(value)),
    }
}

/// The columns of a label in a table whose columns have one type each; [`LabelType::mixed_column`] for a label of several types.
#[must_use]
pub fn label_columns(name: &str, types: &BTreeSet<LabelType>) -> Vec<(String, LabelType)> {
    let column = format!("labels.{name}");
    if types.len() > 1 {
        types
            .iter()
            .map(|label| (label.mixed_column(&column), *label))
            .collect()
    } else {
        let only = types.first().copied().unwrap_or(LabelType::Text);
        vec![(column, only)]
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn types_follow_from_constants_choices_and_distributions() {
        let labels = json!({
            "depth": {"uniform": [1, 120]},
            "site": "dock",
            "day": {"choice": [true, false], "weights": [1, 3]},
            "mix": {"grid": [1, "a", true, {"int": [1, 2]}]},
        });
        let types = label_types(&labels);
        let names = |name: &str| -> Vec<&str> { types[name].iter().map(|kind| kind.name()).collect() };
        assert_eq!(names("depth"), ["number"]);
        assert_eq!(names("site"), ["text"]);
        assert_eq!(names("day"), ["bool"]);
        assert_eq!(names("mix"), ["number", "text", "bool"]);
        let columns: Vec<String> = label_columns("mix", &types["mix"])
            .into_iter()
            .map(|(name, _)| name)
            .collect();
        assert_eq!(columns, ["labels.mix", "labels.mix (text)", "labels.mix (bool)"]);
        let words = BTreeSet::from([LabelType::Text, LabelType::Bool]);
        assert_eq!(label_columns("x", &words)[0].0, "labels.x (text)");
        assert_eq!(label_columns("x", &types["day"])[0].0, "labels.x");
    }
}

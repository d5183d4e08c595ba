//! The JSON of an experiment.

use std::path::Path;

use cli::exit::Failure;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::setup::{Parameter, Setup};
use crate::studio::read_json;

/// Parameters of every experiment on jobs.
pub const PARAMETERS: &[Parameter] = &[
    Parameter::number("count", "", [1.0, 1e6], "frames of each case"),
    Parameter::number("runs", "", [1.0, 1000.0], "runs of a frame"),
];

/// An experiment: each case is rendered in each variant.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Description {
    pub(super) about: String,
    cases: Vec<NamedJob>,
    /// Patches of the jobs of all cases; null removes a field.
    #[serde(default)]
    pub(super) variants: Vec<NamedJob>,
    /// Merged into every job.
    #[serde(default)]
    base: Value,
    pub(super) measure: Vec<Measure>,
    #[serde(default = "single")]
    pub(super) count: u64,
    /// Runs of each frame; the fastest counts.
    #[serde(default = "single")]
    runs: u64,
    /// Stages whose times are summed; without it each stage has a column.
    #[serde(default)]
    stages: Vec<String>,
    pub(super) sheet: Option<Sheet>,
}

fn single() -> u64 {
    1
}

/// A description, a patch of one, or the path of a description.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct NamedJob {
    name: String,
    job: Value,
}

/// A measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Measure {
    /// Milliseconds of the stages.
    Time,
    /// Differences of the codes to the previous and to the last variant.
    Difference,
    /// Error of the exposed light against the f64 reference.
    Reference,
    /// Bias against Monte Carlo.
    Truth,
    /// Lightness, and contrast of structures.
    Look,
    /// Features of photographs.
    Photograph,
    /// Effects that the plan added.
    Effects,
    /// Measured error of the models.
    Model,
    /// The faster variant of IBLA against the exact one.
    Ibla,
}

/// A sheet of pictures.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Sheet {
    pub(super) columns: usize,
    pub(super) tile_px: usize,
    #[serde(default = "rgb")]
    artifacts: Vec<String>,
    /// Frames of each case on the sheet.
    #[serde(default = "single")]
    frames: u64,
}

fn rgb() -> Vec<String> {
    vec!["rgb".to_owned()]
}

/// A frame to render, and its measurements.
pub(super) struct Task {
    pub(super) case: String,
    pub(super) variant: String,
    pub(super) job: Value,
    pub(super) index: u64,
    pub(super) measure: Vec<Measure>,
    pub(super) runs: u64,
    pub(super) stages: Vec<String>,
    /// Artifacts on the sheet.
    pub(super) shown: Vec<String>,
}

/// Checks the JSON of an experiment, but not its jobs.
///
/// # Errors
/// A mistake in the description.
pub fn check(text: &str, name: &str) -> Result<(), Failure> {
    parse(text, name).map(drop)
}

fn parse(text: &str, name: &str) -> Result<Description, Failure> {
    let value: Result<Value, _> = serde_json::from_str(text);
    let description = value.and_then(|value| match value.get("cases") {
        Some(_) => serde_json::from_value(value),
        // A job is an experiment of one case.
        None => serde_json::from_value(json!({
            "about": format!("The job {name}."), "count": value["count"].as_u64().unwrap_or(1),
            "cases": [{"name": name, "job": value}], "measure": ["time", "look", "effects"]
        })),
    });
    description.map_err(|error| Failure::BadInput(format!("{name}: {error}")))
}

impl Description {
    /// Reads the JSON and applies parameters. Jobs of the user replace the cases.
    pub(super) fn parse(text: &str, name: &str, setup: &Setup) -> Result<Self, Failure> {
        let mut description = parse(text, name)?;
        if description.variants.is_empty() {
            let (name, job) = (String::new(), Value::Null);
            description.variants.push(NamedJob { name, job });
        }
        let jobs = setup.inputs.iter().map(|path| NamedJob {
            name: path.display().to_string(),
            job: json!(std::path::absolute(path).unwrap_or_default()),
        });
        if !setup.inputs.is_empty() {
            description.cases = jobs.collect();
        }
        let numbers = [("count", &mut description.count), ("runs", &mut description.runs)];
        for (name, number) in numbers {
            *number = setup.optional_number(name).map_or(*number, |value| value as u64);
        }
        Ok(description)
    }

    /// A task for each frame: case by case, variant by variant.
    pub(super) fn list_tasks(&self, folder: &Path) -> Result<Vec<Task>, Failure> {
        let mut tasks = Vec::new();
        for case in &self.cases {
            let job = match &case.job {
                Value::String(path) => read_json(&folder.join(path))?,
                job => job.clone(),
            };
            for variant in &self.variants {
                let mut job = job.clone();
                merge(&mut job, &self.base);
                merge(&mut job, &variant.job);
                job["count"] = json!(self.count);
                tasks.extend((0..self.count).map(|index| Task {
                    case: case.name.clone(),
                    variant: variant.name.clone(),
                    job: job.clone(),
                    index,
                    measure: self.measure.clone(),
                    runs: self.runs,
                    stages: self.stages.clone(),
                    shown: self.list_shown(index),
                }));
            }
        }
        Ok(tasks)
    }

    /// The artifacts of a frame that are on the sheet.
    fn list_shown(&self, index: u64) -> Vec<String> {
        let sheet = self.sheet.iter().filter(|sheet| index < sheet.frames);
        sheet.flat_map(|sheet| sheet.artifacts.clone()).collect()
    }
}

/// Merges a patch into a description: objects field by field, null removes a field.
fn merge(target: &mut Value, patch: &Value) {
    let Value::Object(fields) = patch else {
        if !patch.is_null() {
            *target = patch.clone();
        }
        return;
    };
    if !target.is_object() {
        *target = json!({});
    }
    for (name, value) in fields {
        match value {
            // Removals do not create objects.
            Value::Object(removed) if target.get(name).is_none() && removed.values().all(Value::is_null) => {}
            Value::Null => drop(target.as_object_mut().and_then(|target| target.remove(name))),
            value => merge(&mut target[name], value),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_merge_and_null_removes() {
        let mut target = json!({"a": {"b": 1, "c": 2}, "d": [1]});
        merge(
            &mut target,
            &json!({"a": {"b": null, "e": 3}, "d": [2], "f": {"g": null}}),
        );
        assert_eq!(target, json!({"a": {"c": 2, "e": 3}, "d": [2]}));
    }

    #[test]
    fn a_wrong_description_is_refused_with_its_name() {
        let wrong = r#"{"about": "", "measure": ["speed"], "cases": []}"#;
        let refused = check(wrong, "mine").unwrap_err().to_string();
        assert!(refused.starts_with("mine: unknown variant `speed`"), "{refused}");
    }
}

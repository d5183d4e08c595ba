//! Experiments on jobs and their variants, described as JSON.

mod column;
mod shot;
mod view;

use std::collections::BTreeMap;
use std::path::Path;

use cli::exit::Failure;
use cli::sheet::{Tile, sheet};
use serde::Deserialize;
use serde_json::{Map, Value, json};

use crate::plot::{Axis, Bar, Bars, Chart, Form, Lines, Series};
use crate::report::Report;
use crate::setup::{Parameter, Setup};
use crate::studio::read_json;
use crate::table::Table;
use column::{Column, summarize};
use shot::{Measure, Shot, Task, compare, take_all};

/// Parameters of every experiment on jobs.
pub const PARAMETERS: &[Parameter] = &[
    Parameter::number("count", "", [1.0, 1e6], "frames of each case"),
    Parameter::number(
        "runs",
        "",
        [1.0, 1000.0],
        "runs of each frame; the fastest counts",
    ),
    Parameter::number("width", "", [16.0, 8192.0], "columns of the frames; rows follow"),
];

/// An experiment: each case is rendered in each variant.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    about: String,
    cases: Vec<Case>,
    #[serde(default)]
    variants: Vec<Variant>,
    /// Merged into every job.
    #[serde(default)]
    base: Value,
    measure: Vec<Measure>,
    #[serde(default = "single")]
    count: u64,
    #[serde(default = "single")]
    runs: u64,
    /// Stages whose times are summed; without it each stage has a column.
    #[serde(default)]
    stages: Vec<String>,
    sheet: Option<Sheet>,
    /// Columns of the table: bars of each, or dots of the second over the first.
    chart: Option<Drawn>,
}

fn single() -> u64 {
    1
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Case {
    name: String,
    /// A description, or the path of one.
    job: Value,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Variant {
    name: String,
    /// Merged into the job of the case; null removes a field.
    job: Value,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Sheet {
    columns: usize,
    tile_px: usize,
    #[serde(default)]
    artifacts: Vec<String>,
    /// Frames of each case on the sheet.
    #[serde(default = "single")]
    frames: u64,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Drawn {
    Bars(Vec<String>),
    Dots(String, String),
}

/// Runs an experiment from its JSON text; `folder` is the base of paths of jobs.
///
/// # Errors
/// A mistake in the description, or a frame that cannot be rendered.
pub fn run(text: &str, folder: &Path, name: &str, setup: &Setup) -> Result<Report, Failure> {
    let mut experiment = parse(text, name)?;
    experiment.count = setup
        .optional_number("count")
        .map_or(experiment.count, |v| v as u64);
    experiment.runs = setup
        .optional_number("runs")
        .map_or(experiment.runs, |v| v as u64);
    let tasks = experiment.tasks(folder, setup)?;
    let is_timed = experiment.measure.contains(&Measure::Time);
    let mut shots = take_all(&tasks, setup, is_timed)?;
    if experiment.measure.contains(&Measure::Difference) {
        compare(&mut shots, experiment.variants.len(), experiment.count as usize);
    }
    Ok(experiment.report(name, &tasks, shots))
}

/// Checks the JSON of an experiment, but not its jobs.
///
/// # Errors
/// A mistake in the description.
pub fn check(text: &str, name: &str) -> Result<(), Failure> {
    parse(text, name).map(drop)
}

fn parse(text: &str, name: &str) -> Result<Description, Failure> {
    let mistake = |error: serde_json::Error| Failure::BadInput(format!("{name}: {error}"));
    let mut value: Value = serde_json::from_str(text).map_err(mistake)?;
    if value.get("cases").is_none() {
        // A job is an experiment of one case.
        value = json!({"about": format!("The job {name}."), "cases": [{"name": name, "job": value}],
                       "measure": ["time", "look", "effects"], "count": value["count"].as_u64().unwrap_or(1)});
    }
    let mut experiment: Description = serde_json::from_value(value).map_err(mistake)?;
    if experiment.variants.is_empty() {
        let (name, job) = (String::new(), Value::Null);
        experiment.variants.push(Variant { name, job });
    }
    Ok(experiment)
}

impl Description {
    /// A task for each frame: case by case, variant by variant.
    fn tasks(&self, folder: &Path, setup: &Setup) -> Result<Vec<Task>, Failure> {
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
                if let Some(width) = setup.optional_number("width") {
                    let camera = &mut job["camera"];
                    let sides = ["height", "width"].map(|side| camera[side].as_f64());
                    let aspect = sides[0].zip(sides[1]).map_or(492.0 / 768.0, |(h, w)| h / w);
                    camera["height"] = json!((width * aspect).round());
                    camera["width"] = json!(width);
                }
                job["count"] = json!(self.count);
                tasks.extend((0..self.count).map(|index| Task {
                    case: case.name.clone(),
                    variant: variant.name.clone(),
                    job: job.clone(),
                    index,
                    measure: self.measure.clone(),
                    runs: self.runs,
                    stages: self.stages.clone(),
                    shown: self.shown(index),
                }));
            }
        }
        Ok(tasks)
    }

    /// The artifacts of a frame that are on the sheet.
    fn shown(&self, index: u64) -> Vec<String> {
        let sheet = self.sheet.iter().filter(|sheet| index < sheet.frames);
        let mut shown: Vec<String> = sheet.flat_map(|sheet| sheet.artifacts.clone()).collect();
        if shown.is_empty() && self.sheet.as_ref().is_some_and(|sheet| index < sheet.frames) {
            shown.push("rgb".to_owned());
        }
        shown
    }

    fn report(&self, name: &str, tasks: &[Task], shots: Vec<Shot>) -> Report {
        let mut groups: Vec<(String, String, Vec<Column>)> = Vec::new();
        let mut tiles = Vec::new();
        for (task, shot) in tasks.iter().zip(shots) {
            let case = shot.site.unwrap_or_else(|| task.case.clone());
            let place = groups
                .iter()
                .position(|(known, variant, _)| (known, variant) == (&case, &task.variant));
            let place = place.unwrap_or_else(|| {
                groups.push((case, task.variant.clone(), Vec::new()));
                groups.len() - 1
            });
            groups[place].2.extend(shot.columns);
            tiles.extend(shot.tiles);
        }
        let summaries: Vec<Map<String, Value>> = groups.iter().map(|(_, _, all)| summarize(all)).collect();
        let mut report = Report::new(self.about.clone(), vec![table(name, &groups, &summaries)]);
        if let Some(chart) = self.chart(name, &groups, &summaries) {
            report.add_chart(name, chart);
        }
        if let Some(Sheet { columns, tile_px, .. }) = self.sheet {
            report
                .pictures
                .push((name.to_owned(), draw_sheet(tiles, columns, tile_px)));
        }
        report
    }

    fn chart(
        &self,
        name: &str,
        groups: &[(String, String, Vec<Column>)],
        summaries: &[Map<String, Value>],
    ) -> Option<Chart> {
        let number = |index: usize, column: &str| summaries[index].get(column).and_then(Value::as_f64);
        match self.chart.as_ref()? {
            Drawn::Dots(x, y) => {
                let mut series: BTreeMap<&str, Vec<(f64, f64)>> = BTreeMap::new();
                for (index, (_, variant, _)) in groups.iter().enumerate() {
                    let point = number(index, x).zip(number(index, y));
                    series.entry(variant).or_default().extend(point);
                }
                let series = series.into_iter();
                Some(Chart::Lines(Lines {
                    title: name.to_owned(),
                    x: Axis::logarithmic(x),
                    y: Axis::logarithmic(y),
                    series: series
                        .map(|(variant, points)| Series::new(variant, points, Form::Dots))
                        .collect(),
                }))
            }
            Drawn::Bars(columns) => {
                let bars = |column: &String| -> Vec<Bar> {
                    let bar = |(index, (case, variant, _)): (usize, &(String, String, _))| Bar {
                        name: if variant.is_empty() { case } else { variant }.clone(),
                        mean: number(index, column).unwrap_or(f64::NAN),
                        sd: 0.0,
                    };
                    groups.iter().enumerate().map(bar).collect()
                };
                Some(Chart::Bars(Bars {
                    title: name.to_owned(),
                    panels: columns
                        .iter()
                        .map(|column| (column.clone(), bars(column)))
                        .collect(),
                }))
            }
        }
    }
}

/// A row for each case and variant.
fn table(name: &str, groups: &[(String, String, Vec<Column>)], summaries: &[Map<String, Value>]) -> Table {
    let has_variants = groups.iter().any(|(_, variant, _)| !variant.is_empty());
    let mut names: Vec<&String> = Vec::new();
    for column in summaries.iter().flat_map(Map::keys) {
        if !names.contains(&column) {
            names.push(column);
        }
    }
    let fixed = if has_variants {
        vec!["case", "variant"]
    } else {
        vec!["case"]
    };
    let header = fixed.iter().map(|&text| text.to_owned());
    let mut table = Table::new(name, header.chain(names.iter().map(|&name| name.clone())));
    for ((case, variant, _), summary) in groups.iter().zip(summaries) {
        let mut row = vec![json!(case)];
        row.extend(has_variants.then(|| json!(variant)));
        row.extend(
            names
                .iter()
                .map(|name| summary.get(*name).cloned().unwrap_or_default()),
        );
        table.push(row);
    }
    table
}

/// A sheet whose captions omit the parts that all tiles share.
fn draw_sheet(tiles: Vec<(Vec<String>, imaging::Rgb8)>, columns: usize, tile_px: usize) -> imaging::Rgb8 {
    let first = tiles
        .first()
        .map(|(caption, _)| caption.clone())
        .unwrap_or_default();
    let varies: Vec<bool> = (0..first.len())
        .map(|line| tiles.iter().any(|(caption, _)| caption[line] != first[line]))
        .collect();
    let tiles: Vec<Tile> = tiles
        .into_iter()
        .map(|(caption, picture)| Tile {
            picture,
            caption: caption
                .into_iter()
                .zip(&varies)
                .filter_map(|(line, varies)| varies.then_some(line))
                .collect(),
        })
        .collect();
    sheet(&tiles, columns, tile_px)
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
        if value.is_null() {
            target.as_object_mut().and_then(|target| target.remove(name));
        } else {
            merge(&mut target[name], value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cli::styles::StyleArguments;

    fn run_text(text: &str) -> Report {
        let styles = StyleArguments {
            styles: None,
            onnxruntime: None,
        };
        let setup = Setup::new(PARAMETERS, &[], Vec::new(), styles).unwrap();
        run(text, Path::new("."), "test", &setup).unwrap()
    }

    #[test]
    fn variants_are_compared_with_their_reference_and_with_each_other() {
        let text = r#"{"about": "Fewer kernels.", "measure": ["reference", "difference", "time"], "stages": ["water"],
            "cases": [{"name": "wall", "job": {"scene": {"kind": "procedural", "family": "structure", "seed": 3},
                       "camera": {"width": 48, "height": 32}, "water": {"optics": "jerlov-1C"}}}],
            "variants": [{"name": "coarse", "job": {"fidelity": {"tolerance": 0.05}}},
                         {"name": "fine", "job": {"fidelity": {"tolerance": 1e-5}}}],
            "sheet": {"columns": 2, "tile_px": 48}, "chart": {"dots": ["ms", "largest error"]}}"#;
        let report = run_text(text);
        let rows = report.tables[0].json();
        let error = |row: usize| rows[row]["largest error"].as_f64().unwrap();
        assert!(error(1) < error(0) && error(1) <= 1e-5, "{rows}");
        assert!(rows[0]["ms"].as_f64().unwrap() > 0.0 && rows[0]["codes to the previous"].is_null());
        assert!(
            rows[1]["codes to the last"] == 0.0 && rows[1]["codes to the previous"].as_f64().unwrap() < 20.0
        );
        assert_eq!(report.pictures[0].1.width(), 8 + 2 * 56);
        assert!(report.charts[0].1.svg().contains("coarse"));
    }

    #[test]
    fn a_plain_job_is_an_experiment_and_patches_merge() {
        let job = r#"{"site": "tank", "count": 2, "camera": {"width": 64, "height": 42}}"#;
        let rows = run_text(job).tables[0].json();
        assert_eq!(
            (rows[0]["case"].as_str(), rows[0]["frames"].as_u64()),
            (Some("tank"), Some(2))
        );
        let mut target = json!({"a": {"b": 1, "c": 2}, "d": [1]});
        merge(&mut target, &json!({"a": {"b": null, "e": 3}, "d": [2]}));
        assert_eq!(target, json!({"a": {"c": 2, "e": 3}, "d": [2]}));
    }
}

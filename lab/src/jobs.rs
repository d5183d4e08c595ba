//! Experiments on jobs and their variants, described as JSON.

mod column;
mod description;
mod shot;

use std::path::Path;

use cli::exit::Failure;
use cli::sheet::{Tile, sheet};
use imaging::Rgb8;
use serde_json::{Value, json};

use crate::parallel::run_all;
use crate::report::Report;
use crate::setup::Setup;
use crate::studio::Studio;
use crate::table::Table;
use cli::plot::{Bar, Bars};
use column::{Column, summarize};
use description::{Description, Measure};
use shot::{Shot, compare};

pub use description::{PARAMETERS, check};

/// The frames of a case in a variant.
struct Group {
    case: String,
    variant: String,
    columns: Vec<Column>,
}

impl Group {
    fn new(case: String, variant: String, columns: Vec<Column>) -> Self {
        Self {
            case,
            variant,
            columns,
        }
    }

    /// A name for a bar.
    fn short_name(&self) -> String {
        let name = if self.variant.is_empty() {
            &self.case
        } else {
            &self.variant
        };
        name.chars().take(5).collect()
    }
}

/// Runs an experiment from its JSON text; `folder` is the base of paths of jobs.
///
/// # Errors
/// A mistake in the description, or a frame that cannot be rendered.
pub fn run(text: &str, folder: &Path, name: &str, setup: &Setup) -> Result<Report, Failure> {
    let experiment = Description::parse(text, name, setup)?;
    let tasks = experiment.list_tasks(folder)?;
    let threads = experiment.measure.contains(&Measure::Time).then_some(1);
    let shots = run_all("frames", threads, &tasks, Option::default, |task, studio| {
        let studio = match studio {
            Some(studio) => studio,
            None => studio.insert(Studio::new(&setup.styles)?),
        };
        shot::take(task, studio)
    });
    let mut shots: Vec<Shot> = shots.into_iter().collect::<Result<_, Failure>>()?;
    if experiment.measure.contains(&Measure::Difference) {
        compare(&mut shots, experiment.variants.len(), experiment.count as usize);
    }
    let mut groups: Vec<Group> = Vec::new();
    let mut tiles = Vec::new();
    for (task, shot) in tasks.iter().zip(shots) {
        // Frames of a mix of sites are grouped by site.
        let case = shot.site.unwrap_or_else(|| task.case.clone());
        let mut known = groups.iter();
        let known = known.position(|group| (&group.case, &group.variant) == (&case, &task.variant));
        let index = known.unwrap_or(groups.len());
        if known.is_none() {
            groups.push(Group::new(case, task.variant.clone(), Vec::new()));
        }
        groups[index].columns.extend(shot.columns);
        tiles.extend(shot.tiles);
    }
    if experiment.variants.len() == 1 && groups.len() > 1 {
        let columns = groups.iter().flat_map(|group| group.columns.clone()).collect();
        groups.push(Group::new("all".to_owned(), String::new(), columns));
    }
    Ok(report(name, &experiment, &groups, tiles))
}

fn report(name: &str, experiment: &Description, groups: &[Group], tiles: Vec<(Vec<String>, Rgb8)>) -> Report {
    let cells: Vec<Vec<(String, Value)>> = groups.iter().map(|group| summarize(&group.columns)).collect();
    let mut columns: Vec<&String> = Vec::new();
    for (column, _) in cells.iter().flatten() {
        if !columns.contains(&column) {
            columns.push(column);
        }
    }
    let header = columns.iter().map(|column| column.as_str());
    let mut table = Table::new(name, ["case", "variant"].into_iter().chain(header));
    let mut panels: Vec<(String, Vec<Bar>)> = Vec::new();
    for column in &columns {
        let bars = groups.iter().zip(&cells).map(|(group, cells)| Bar {
            name: group.short_name(),
            mean: find(cells, column).as_f64().unwrap_or(f64::NAN),
            sd: 0.0,
        });
        panels.push(((*column).clone(), bars.collect()));
    }
    for (group, cells) in groups.iter().zip(&cells) {
        let mut row = vec![json!(group.case), json!(group.variant)];
        row.extend(columns.iter().map(|column| find(cells, column)));
        table.push(row);
    }
    let mut report = Report::new(experiment.about.clone(), vec![table]);
    // Columns of text have no bars, and the number of frames needs none.
    panels.retain(|(column, bars)| column != "frames" && bars.iter().any(|bar| bar.mean.is_finite()));
    if !panels.is_empty() {
        let title = name.to_owned();
        report.add_chart(name, Bars { title, panels }.svg());
    }
    if let Some(layout) = &experiment.sheet {
        let picture = draw_sheet(tiles, layout.columns, layout.tile_px);
        report.pictures.push((name.to_owned(), picture));
    }
    report
}

/// The value of a column; null without one.
fn find(cells: &[(String, Value)], column: &str) -> Value {
    let cell = cells.iter().find(|(name, _)| name == column);
    cell.map(|(_, value)| value.clone()).unwrap_or_default()
}

/// A sheet whose captions omit the parts that all tiles share.
fn draw_sheet(tiles: Vec<(Vec<String>, Rgb8)>, columns: usize, tile_px: usize) -> Rgb8 {
    let captions: Vec<Vec<String>> = tiles.iter().map(|(caption, _)| caption.clone()).collect();
    let tiles = tiles.into_iter().map(|(caption, picture)| {
        let lines = caption.into_iter().enumerate();
        let varying = lines.filter(|(line, text)| captions.iter().any(|other| other[*line] != *text));
        let caption = varying.map(|(_, text)| text).collect();
        Tile { picture, caption }
    });
    sheet(&tiles.collect::<Vec<_>>(), columns, tile_px)
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
        run(text, Path::new("."), "test", &Setup::new(PARAMETERS, styles)).unwrap()
    }

    #[test]
    fn variants_are_compared_with_their_reference_and_with_each_other() {
        let text = r#"{"about": "Fewer kernels.", "measure": ["reference", "difference", "time"], "stages": ["water"],
            "cases": [{"name": "wall", "job": {"scene": {"kind": "procedural", "family": "structure", "seed": 3, "lighting": "in_air"},
                       "camera": {"width": 48, "height": 32}, "water": {"optics": {"preset": "jerlov-1C", "veil_gain": 0.01}}}}],
            "variants": [{"name": "coarse", "job": {"fidelity": {"tolerance": 0.05}}},
                         {"name": "fine", "job": {"fidelity": {"tolerance": 1e-5}}}],
            "sheet": {"columns": 2, "tile_px": 48}}"#;
        let report = run_text(text);
        let rows = report.tables[0].json();
        let error = |row: usize| rows[row]["largest error"].as_f64().unwrap();
        assert!(error(1) < error(0) && error(1) <= 1e-5, "{rows}");
        assert!(rows[0]["ms"].as_f64().unwrap() > 0.0 && rows[0]["codes to the previous"].is_null());
        assert!(
            rows[1]["codes to the last"] == 0.0 && rows[1]["codes to the previous"].as_f64().unwrap() < 20.0
        );
        assert_eq!(report.pictures[0].1.width(), 8 + 2 * 56);
        assert!(report.charts[0].1.contains("coars"));
    }

    #[test]
    fn a_plain_job_is_an_experiment_that_shows_its_effects() {
        let job = r#"{"site": "tank", "count": 2, "camera": {"width": 64, "height": 42}}"#;
        let rows = run_text(job).tables[0].json();
        assert_eq!(
            (rows[0]["case"].as_str(), rows[0]["frames"].as_u64()),
            (Some("tank"), Some(2))
        );
        assert!(rows[0]["median L*"].is_string(), "{rows}");
    }
}

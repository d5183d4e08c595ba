//! The table as data and as text.

use std::fmt::Write;

use super::{CAMERAS_M, CONES_DEG, Cell, LAWS, Law, Place, WALLS_M, WATERS};

/// Every cell, one line each.
#[must_use]
pub fn csv(cells: &[Cell]) -> String {
    let mut text = String::from(
        "phase,water,absorption_per_m,scattering_per_m,lamp,wall_m,what,ring_deg,camera_m,look_deg,truth,standard_error,single,multiple\n",
    );
    for cell in cells {
        let (what, place) = match cell.place {
            Place::Wall {
                ring_deg: [inner, outer],
            } => ("wall", format!("{inner}-{outer},,")),
            Place::Water { camera_m, look_deg } => ("water", format!(",{camera_m},{look_deg}")),
        };
        let [single, multiple] = cell.chain;
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{what},{place},{:.4e},{:.1e},{single:.4e},{multiple:.4e}",
            cell.law.name(),
            cell.water,
            cell.coefficients.absorption,
            cell.coefficients.scattering,
            lamp(cell.is_spot),
            cell.wall_m,
            cell.truth.mean,
            cell.truth.error,
        );
    }
    text
}

fn lamp(is_spot: bool) -> &'static str {
    if is_spot { "spot" } else { "point" }
}

/// The tables of the page: truth over single scattering, and the chain with multiple scattering over the truth.
#[must_use]
pub fn markdown(cells: &[Cell]) -> String {
    let mut text = String::from(INTRODUCTION);
    for law in LAWS {
        for cone in CONES_DEG {
            let is_spot = cone.is_some();
            let kind = if is_spot {
                "spots of 35 degrees"
            } else {
                "point lamps"
            };
            let _ = write!(text, "## {}: {kind}\n\n", law.name());
            tables(&mut text, cells, law, is_spot);
        }
    }
    text.push_str(
        "## All cells\n\n| cells | known | single within 20 % | multiple within 20 % | multiple, least to greatest |\n|---|---|---|---|---|\n",
    );
    for law in LAWS {
        for is_spot in [false, true] {
            for (what, on_wall) in [("on walls", true), ("in the water", false)] {
                let name = format!("{}, {}s {what}", law.name(), lamp(is_spot));
                summary(&mut text, &name, cells, |cell| {
                    cell.law == law && cell.is_spot == is_spot && cell.place.is_wall() == on_wall
                });
            }
        }
        let name = format!("{}, points on walls, b r up to 4", law.name());
        summary(&mut text, &name, cells, |cell| {
            let is_near = cell.coefficients.scattering * cell.wall_m <= 4.0;
            cell.law == law && !cell.is_spot && cell.place.is_wall() && is_near
        });
    }
    text
}

const INTRODUCTION: &str = "Each entry is the truth over the chain with single scattering, and in brackets the chain with multiple scattering \
                            over the truth, least and greatest of several places. The chain scatters as Henyey and Greenstein say; \
                            where the truth does, too, only the chain's orders are wrong.\n\n";

fn tables(text: &mut String, cells: &[Cell], law: Law, is_spot: bool) {
    let of = |water: &str, belongs: &dyn Fn(&Cell) -> bool| -> Vec<Cell> {
        let belongs =
            |cell: &&Cell| cell.law == law && cell.water == water && cell.is_spot == is_spot && belongs(cell);
        cells.iter().filter(belongs).cloned().collect()
    };
    table(
        text,
        "On a wall within 20 degrees of the axis, at",
        &WALLS_M,
        |water, wall| {
            of(water, &|cell| {
                cell.wall_m == wall
                    && matches!(cell.place, Place::Wall { ring_deg: [_, outer] } if outer <= 20.0)
            })
        },
    );
    let title = "In the water before a wall at 4 m, camera beside the lamp at";
    table(text, title, &CAMERAS_M, |water, camera| {
        of(water, &|cell| {
            let looks = matches!(cell.place, Place::Water { camera_m, .. } if camera_m == camera);
            looks && cell.wall_m == 4.0
        })
    });
}

fn table(text: &mut String, title: &str, columns: &[f64], cells: impl Fn(&str, f64) -> Vec<Cell>) {
    let heads: Vec<String> = columns.iter().map(|column| format!("{column} m")).collect();
    let rule = "---|".repeat(columns.len());
    let _ = write!(
        text,
        "{title}\n\n| water (a, b) | {} |\n|---|{rule}\n",
        heads.join(" | ")
    );
    for (name, water) in WATERS {
        let row: Vec<String> = columns
            .iter()
            .map(|&column| entry(&cells(name, column)))
            .collect();
        let _ = writeln!(
            text,
            "| {name} ({}, {}) | {} |",
            water.absorption,
            water.scattering,
            row.join(" | ")
        );
    }
    text.push('\n');
}

/// Least and greatest of both ratios.
fn entry(cells: &[Cell]) -> String {
    let ratios: Vec<[f64; 2]> = cells.iter().filter_map(Cell::ratios).collect();
    if ratios.is_empty() {
        return "not measured".to_owned();
    }
    let ends = |values: &dyn Fn(&[f64; 2]) -> f64| {
        let all = || ratios.iter().map(values);
        let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
        format!("{}-{}", short(low), short(high))
    };
    format!("{} ({})", ends(&|ratio| 1.0 / ratio[0]), ends(&|ratio| ratio[1]))
}

fn short(value: f64) -> String {
    match value {
        v if v >= 100.0 => format!("{v:.0}"),
        v if v >= 10.0 => format!("{v:.1}"),
        v => format!("{v:.2}"),
    }
}

fn summary(text: &mut String, name: &str, cells: &[Cell], belongs: impl Fn(&Cell) -> bool) {
    let chosen: Vec<&Cell> = cells.iter().filter(|cell| belongs(cell)).collect();
    let ratios: Vec<[f64; 2]> = chosen.iter().filter_map(|cell| cell.ratios()).collect();
    let share = |form: usize| {
        let near = ratios
            .iter()
            .filter(|ratio| (ratio[form] - 1.0).abs() <= 0.2)
            .count();
        100.0 * near as f64 / ratios.len().max(1) as f64
    };
    let all = || ratios.iter().map(|ratio| ratio[1]);
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
    let _ = writeln!(
        text,
        "| {name}: {} | {} | {:.0} % | {:.0} % | {}-{} |",
        chosen.len(),
        ratios.len(),
        share(0),
        share(1),
        short(low),
        short(high)
    );
}

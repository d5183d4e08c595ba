//! The table as data and as text.

use std::fmt::Write;

use super::{CAMERAS_M, CONES_DEG, Cell, Place, WALLS_M, WATERS};

/// Every cell, one line each.
#[must_use]
pub fn csv(cells: &[Cell]) -> String {
    let mut text = String::from(
        "water,absorption_per_m,scattering_per_m,lamp,wall_m,what,ring_deg,camera_m,look_deg,truth,standard_error,single,multiple\n",
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
            "{},{},{},{},{},{what},{place},{:.4e},{:.1e},{single:.4e},{multiple:.4e}",
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
    let mut text = String::new();
    for cone in CONES_DEG {
        let is_spot = cone.is_some();
        let _ = write!(
            text,
            "## {}\n\n",
            if is_spot {
                "Spots of 35 degrees"
            } else {
                "Point lamps"
            }
        );
        table(
            &mut text,
            "On a wall within 20 degrees of the axis, at",
            "m",
            &WALLS_M,
            |water, wall| {
                of(cells, water, is_spot, |cell| {
                    cell.wall_m == wall
                        && matches!(cell.place, Place::Wall { ring_deg: [_, outer] } if outer <= 20.0)
                })
            },
        );
        table(
            &mut text,
            "In the water before a wall at 4 m, camera beside the lamp at",
            "m",
            &CAMERAS_M,
            |water, camera| {
                of(cells, water, is_spot, |cell| {
                    let looks = matches!(cell.place, Place::Water { camera_m, .. } if camera_m == camera);
                    looks && cell.wall_m == 4.0
                })
            },
        );
    }
    text.push_str("## All cells\n\n| cells | known | single within 20 % | multiple within 20 % | multiple, least to greatest |\n|---|---|---|---|---|\n");
    for is_spot in [false, true] {
        for (what, on_wall) in [("on walls", true), ("in the water", false)] {
            let name = format!("{}s {what}", lamp(is_spot));
            summary(&mut text, &name, cells, |cell| {
                cell.is_spot == is_spot && matches!(cell.place, Place::Wall { .. }) == on_wall
            });
        }
    }
    summary(&mut text, "points on walls, b r up to 4", cells, |cell| {
        !cell.is_spot
            && matches!(cell.place, Place::Wall { .. })
            && cell.coefficients.scattering * cell.wall_m <= 4.0
    });
    text
}

/// The cells of a water that a table shows in one place.
fn of<'a>(cells: &'a [Cell], water: &str, is_spot: bool, belongs: impl Fn(&Cell) -> bool) -> Vec<&'a Cell> {
    cells
        .iter()
        .filter(|cell| cell.water == water && cell.is_spot == is_spot && belongs(cell))
        .collect()
}

fn table<'a>(
    text: &mut String,
    title: &str,
    unit: &str,
    columns: &[f64],
    cells: impl Fn(&str, f64) -> Vec<&'a Cell>,
) {
    let heads: Vec<String> = columns.iter().map(|column| format!("{column} {unit}")).collect();
    let rule = "---|".repeat(columns.len());
    let _ = write!(
        text,
        "{title}: truth over single scattering, and in brackets the chain with multiple scattering over the truth.\n\n"
    );
    let _ = write!(text, "| water (a, b) | {} |\n|---|{rule}\n", heads.join(" | "));
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
fn entry(cells: &[&Cell]) -> String {
    let ratios: Vec<[f64; 2]> = cells.iter().filter_map(|cell| cell.ratios()).collect();
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

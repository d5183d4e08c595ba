//! The measurements as tables: truth over single scattering, and in brackets the chain with multiple scattering over the truth, least
//! and greatest of several positions. In Fournier-Forand water a second pair in the brackets is the chain with the rising phase function.

use super::cell::{CAMERAS_M, Cell, MULTIPLE, Place, RISING, SINGLE, TruePhase, WALLS_M, WATERS};
use crate::row;
use crate::table::Table;

/// All tables: for each phase function and kind of lamp on walls and in the water, then the shares within 20 %, then every cell.
pub(super) fn tables(cells: &[Cell]) -> Vec<Table> {
    let mut tables = Vec::new();
    for phase in TruePhase::ALL {
        for (is_spot, lamp) in [(false, "point lamps"), (true, "spots of 35 degrees")] {
            let lamps: Vec<&Cell> = cells
                .iter()
                .filter(|cell| cell.lamp.phase == phase && cell.lamp.is_spot == is_spot)
                .collect();
            let name = format!(
                "{}: {lamp} on a wall within 20 degrees of the axis, at",
                phase.name()
            );
            tables.push(table(name, &lamps, &WALLS_M, &[MULTIPLE], |cell, wall_m| {
                cell.wall_m == wall_m && matches!(cell.place, Place::Wall { ring_deg } if ring_deg <= 20.0)
            }));
            let name = format!(
                "{}: {lamp} in the water in front of a wall at 4 m, camera at",
                phase.name()
            );
            let variants = match phase {
                TruePhase::FournierForand => &[MULTIPLE, RISING][..],
                TruePhase::HenyeyGreenstein => &[MULTIPLE],
            };
            tables.push(table(name, &lamps, &CAMERAS_M, variants, |cell, wanted_m| {
                cell.wall_m == 4.0
                    && matches!(cell.place, Place::Water { camera_m, .. } if camera_m == wanted_m)
            }));
        }
    }
    tables.push(summarize(cells));
    tables.push(list(cells));
    tables
}

fn table(
    name: String,
    cells: &[&Cell],
    columns: &[f64],
    variants: &[usize],
    is_inside: impl Fn(&Cell, f64) -> bool,
) -> Table {
    let header = columns.iter().map(|column| format!("{column} m"));
    let mut table = Table::new(name, std::iter::once("water (a, b)".to_owned()).chain(header));
    for (water, (name, coefficients)) in WATERS.iter().enumerate() {
        let mut row = row![format!(
            "{name} ({}, {})",
            coefficients.absorption, coefficients.scattering
        )];
        for &column in columns {
            let own = cells
                .iter()
                .filter(|cell| cell.lamp.water == water && is_inside(cell, column));
            let own: Vec<&Cell> = own.copied().collect();
            row.push(describe(&own, variants).into());
        }
        table.push(row);
    }
    table
}

/// Smallest and largest truth over single scattering, and of each variant over the truth.
fn describe(cells: &[&Cell], variants: &[usize]) -> String {
    let ratios = list_ratios(cells, SINGLE);
    if ratios.is_empty() {
        return "not measured".to_owned();
    }
    let chain: Vec<String> = variants
        .iter()
        .map(|&variant| span(&list_ratios(cells, variant)))
        .collect();
    let inverse: Vec<f64> = ratios.iter().map(|ratio| 1.0 / ratio).collect();
    format!("{} ({})", span(&inverse), chain.join("; "))
}

fn list_ratios(cells: &[&Cell], variant: usize) -> Vec<f64> {
    cells.iter().filter_map(|cell| cell.ratio(variant)).collect()
}

fn span(values: &[f64]) -> String {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(0.0, f64::max);
    format!("{}-{}", format_ratio(low), format_ratio(high))
}

fn format_ratio(value: f64) -> String {
    match value {
        v if v >= 100.0 => format!("{v:.0}"),
        v if v >= 10.0 => format!("{v:.1}"),
        v => format!("{v:.2}"),
    }
}

/// Shares of cells within 20 % of the truth.
fn summarize(cells: &[Cell]) -> Table {
    let columns = [
        "cells",
        "known",
        "single within 20 %",
        "multiple within 20 %",
        "multiple, least to greatest",
        "rising within 20 %",
        "rising, least to greatest",
    ];
    let mut table = Table::new("all cells", columns);
    for phase in TruePhase::ALL {
        type Group = (&'static str, fn(&Cell) -> bool);
        let groups: [Group; 5] = [
            ("points on walls", |cell| !cell.lamp.is_spot && cell.is_on_wall()),
            ("points in the water", |cell| {
                !cell.lamp.is_spot && !cell.is_on_wall()
            }),
            ("spots on walls", |cell| cell.lamp.is_spot && cell.is_on_wall()),
            ("spots in the water", |cell| {
                cell.lamp.is_spot && !cell.is_on_wall()
            }),
            ("points on walls, b r up to 4", |cell| {
                let optical_length = WATERS[cell.lamp.water].1.scattering * cell.wall_m;
                !cell.lamp.is_spot && cell.is_on_wall() && optical_length <= 4.0
            }),
        ];
        for (name, is_inside) in groups {
            let own = cells
                .iter()
                .filter(|cell| cell.lamp.phase == phase && is_inside(cell));
            let own: Vec<&Cell> = own.collect();
            let [single, multiple, rising] =
                [SINGLE, MULTIPLE, RISING].map(|variant| list_ratios(&own, variant));
            table.push(row![
                format!("{}, {name}: {}", phase.name(), own.len()),
                single.len(),
                share_near(&single),
                share_near(&multiple),
                span(&multiple),
                share_near(&rising),
                span(&rising),
            ]);
        }
    }
    table
}

fn share_near(ratios: &[f64]) -> String {
    let near = ratios.iter().filter(|ratio| (*ratio - 1.0).abs() <= 0.2).count();
    format!("{:.0} %", 100.0 * near as f64 / ratios.len().max(1) as f64)
}

/// Every cell.
fn list(cells: &[Cell]) -> Table {
    let columns =
        "phase,water,lamp,wall_m,ring_deg,camera_m,look_deg,truth,standard_error,single,multiple,rising";
    let mut table = Table::new("list", columns.split(','));
    for cell in cells {
        let (ring, camera, look) = match cell.place {
            Place::Wall { ring_deg } => (Some(ring_deg), None, None),
            Place::Water { camera_m, look_deg } => (None, Some(camera_m), Some(look_deg)),
        };
        let [single, multiple, rising] = cell.chain;
        table.push(row![
            cell.lamp.phase.name(),
            WATERS[cell.lamp.water].0,
            if cell.lamp.is_spot { "spot" } else { "point" },
            cell.wall_m,
            ring,
            camera,
            look,
            cell.truth.mean,
            cell.truth.error,
            single,
            multiple,
            rising,
        ]);
    }
    table
}

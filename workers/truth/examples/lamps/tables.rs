//! The measurements as tables.

use std::fmt::Write as _;

use super::cell::{Cell, MULTIPLE, Place, RISING, SINGLE, TruePhase, WATERS};

/// The cells of a row: lamp, whether on walls, and the largest optical length b r.
const GROUPS: [(&str, bool, bool, f64); 5] = [
    ("points on walls", false, true, f64::INFINITY),
    ("points in the water", false, false, f64::INFINITY),
    ("spots on walls", true, true, f64::INFINITY),
    ("spots in the water", true, false, f64::INFINITY),
    ("points on walls, b r up to 4", false, true, 4.0),
];

/// Shares of cells within 20 % of the truth, by single scattering, multiple scattering, and the rising phase function.
pub(super) fn summarize(cells: &[Cell]) -> String {
    let mut text = "| cells | known | single within 20 % | multiple within 20 % | multiple, least to greatest | rising within 20 % | \
                    rising, least to greatest |\n|---|---|---|---|---|---|---|\n"
        .to_owned();
    for phase in TruePhase::ALL {
        for (name, is_spot, is_on_wall, most) in GROUPS {
            let same = cells.iter().filter(|cell| {
                let optical_length = WATERS[cell.lamp.water].1.scattering * cell.wall_m;
                let is_alike = (cell.lamp.phase, cell.lamp.is_spot) == (phase, is_spot);
                is_alike && cell.is_on_wall() == is_on_wall && optical_length <= most
            });
            let ratios = [SINGLE, MULTIPLE, RISING].map(|variant| {
                let ratios = same.clone().filter_map(|cell| cell.ratio(variant));
                ratios.collect::<Vec<f64>>()
            });
            let [single, multiple, rising] = ratios.each_ref().map(|ratios| share_near(ratios));
            let _ = writeln!(
                text,
                "| {}, {name}: {} | {} | {single} | {multiple} | {} | {rising} | {} |",
                phase.name(),
                same.count(),
                ratios[SINGLE].len(),
                describe_span(&ratios[MULTIPLE]),
                describe_span(&ratios[RISING])
            );
        }
    }
    text
}

/// The share of ratios within 20 % of 1.
fn share_near(ratios: &[f64]) -> String {
    let near = ratios.iter().filter(|ratio| (*ratio - 1.0).abs() <= 0.2).count();
    format!("{:.0} %", 100.0 * near as f64 / ratios.len().max(1) as f64)
}

fn describe_span(ratios: &[f64]) -> String {
    let low = ratios.iter().copied().fold(f64::INFINITY, f64::min);
    let high = ratios.iter().copied().fold(0.0, f64::max);
    format!("{low:.2}-{high:.2}")
}

/// Every cell as comma-separated text.
pub(super) fn list(cells: &[Cell]) -> String {
    let mut text =
        "phase,water,lamp,wall_m,ring_deg,camera_m,look_deg,truth,standard_error,single,multiple,rising\n"
            .to_owned();
    for cell in cells {
        let lamp = if cell.lamp.is_spot { "spot" } else { "point" };
        let place = match cell.place {
            Place::Wall { ring_deg } => format!("{ring_deg},,"),
            Place::Water { camera_m, look_deg } => format!(",{camera_m},{look_deg}"),
        };
        let [single, multiple, rising] = cell.chain;
        let _ = writeln!(
            text,
            "{},{},{lamp},{},{place},{:.4e},{:.1e},{single:.4e},{multiple:.4e},{rising:.4e}",
            cell.lamp.phase.name(),
            WATERS[cell.lamp.water].0,
            cell.wall_m,
            cell.truth.mean,
            cell.truth.error
        );
    }
    text
}

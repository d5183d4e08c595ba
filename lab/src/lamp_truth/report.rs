//! The table as CSV and as Markdown.

use std::fmt::Write;

use super::{CAMERAS_M, CONES_DEG, Cell, Form, LAWS, Law, Place, WALLS_M, WATERS};

/// Every cell, one line each.
#[must_use]
pub fn csv(cells: &[Cell]) -> String {
    let mut text = String::from(
        "phase,water,absorption_per_m,scattering_per_m,lamp,wall_m,what,ring_deg,camera_m,look_deg,truth,standard_error,single,multiple,rising\n",
    );
    for cell in cells {
        let (what, place) = match cell.place {
            Place::Wall {
                ring_deg: [inner, outer],
            } => ("wall", format!("{inner}-{outer},,")),
            Place::Water { camera_m, look_deg } => ("water", format!(",{camera_m},{look_deg}")),
        };
        let [single, multiple, rising] = cell.chain;
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{what},{place},{:.4e},{:.1e},{single:.4e},{multiple:.4e},{rising:.4e}",
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
        "## All cells\n\n| cells | known | single within 20 % | multiple within 20 % | multiple, least to greatest | rising within 20 % | rising, least to greatest |\n|---|---|---|---|---|---|---|\n",
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
                            where the truth does, too, only the chain's orders are wrong. Where the truth scatters as Fournier and \
                            Forand say, a second pair in the brackets is the chain with that phase function, which rises toward the back \
                            (`rising` below).\n\n";

fn tables(text: &mut String, cells: &[Cell], law: Law, is_spot: bool) {
    let of = |water: &str, belongs: &dyn Fn(&Cell) -> bool| -> Vec<Cell> {
        let belongs =
            |cell: &&Cell| cell.law == law && cell.water == water && cell.is_spot == is_spot && belongs(cell);
        cells.iter().filter(belongs).cloned().collect()
    };
    table(
        text,
        ("On a wall within 20 degrees of the axis, at", &[Form::Multiple]),
        &WALLS_M,
        |water, wall| {
            of(water, &|cell| {
                cell.wall_m == wall
                    && matches!(cell.place, Place::Wall { ring_deg: [_, outer] } if outer <= 20.0)
            })
        },
    );
    let title = "In the water before a wall at 4 m, camera beside the lamp at";
    let forms: &[Form] = match law {
        Law::FournierForand => &[Form::Multiple, Form::Rising],
        Law::HenyeyGreenstein => &[Form::Multiple],
    };
    table(text, (title, forms), &CAMERAS_M, |water, camera| {
        of(water, &|cell| {
            let looks = matches!(cell.place, Place::Water { camera_m, .. } if camera_m == camera);
            looks && cell.wall_m == 4.0
        })
    });
}

fn table(
    text: &mut String,
    (title, forms): (&str, &[Form]),
    columns: &[f64],
    cells: impl Fn(&str, f64) -> Vec<Cell>,
) {
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
            .map(|&column| entry(&cells(name, column), forms))
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

/// Smallest and largest ratio of each variant.
fn entry(cells: &[Cell], forms: &[Form]) -> String {
    if ratios(cells.iter(), Form::Single).next().is_none() {
        return "not measured".to_owned();
    }
    let span = |form: Form| ends(ratios(cells.iter(), form));
    let chain: Vec<String> = forms.iter().map(|&form| span(form)).collect();
    let truth = ends(ratios(cells.iter(), Form::Single).map(|ratio| 1.0 / ratio));
    format!("{truth} ({})", chain.join("; "))
}

fn ratios<'a>(cells: impl Iterator<Item = &'a Cell>, form: Form) -> impl Iterator<Item = f64> {
    cells.filter_map(move |cell| cell.ratio(form))
}

fn ends(values: impl Iterator<Item = f64>) -> String {
    let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(low, high), v| {
        (low.min(v), high.max(v))
    });
    format!("{}-{}", short(low), short(high))
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
    let of = |form: Form| ratios(chosen.iter().copied(), form);
    let known = of(Form::Single).count();
    let near = |form: Form| {
        let near = of(form).filter(|ratio| (ratio - 1.0).abs() <= 0.2).count();
        100.0 * near as f64 / known.max(1) as f64
    };
    let _ = write!(
        text,
        "| {name}: {} | {known} | {:.0} % |",
        chosen.len(),
        near(Form::Single)
    );
    for form in [Form::Multiple, Form::Rising] {
        let _ = write!(text, " {:.0} % | {} |", near(form), ends(of(form)));
    }
    text.push('\n');
}

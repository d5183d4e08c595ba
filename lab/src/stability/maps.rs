//! Cells as heat maps and as text.

use super::cell::{Cell, METRICS};
use super::degradation::{Degradation, LEVELS};
use cli::plot::HeatMap;

/// Minimum share of worse specimens for a cell in the failure region of a method.
const FAILS: f64 = 0.5;

/// Whether most pictures get worse.
pub(super) fn is_failure(cell: &Cell) -> bool {
    cell.worse[0] > FAILS
}

/// Change of the SSIM to the clean picture by a method. Cells with more than half of the pictures worse are outlined.
pub(super) fn ssim_map(cells: &[Cell]) -> HeatMap {
    HeatMap {
        title: format!(
            "{}: change of SSIM; outlined: most pictures get worse",
            cells[0].method
        ),
        span: 0.3,
        outlined: outline(cells, is_failure),
        ..map(cells, |cell| cell.after[0] - cell.before[0])
    }
}

/// Change of the result for one code of noise. Cells above four codes are outlined.
pub(super) fn gain_map(cells: &[Cell]) -> HeatMap {
    HeatMap {
        title: format!(
            "{}: gain of noise of one code; outlined: more than 4",
            cells[0].method
        ),
        neutral: 1.0,
        span: -6.0,
        outlined: outline(cells, |cell| cell.gain[0] > 4.0),
        ..map(cells, |cell| cell.gain[0])
    }
}

/// Dependence of a metric of the untouched pictures on the degradations, as a multiple of its value at the first level. Outlined:
/// the metric rates the picture better although its SSIM has fallen by a tenth.
pub(super) fn metric_map(cells: &[Cell], metric: usize) -> HeatMap {
    HeatMap {
        title: format!(
            "{}, first level = 1; outlined: better at an SSIM 0.1 lower",
            METRICS[metric]
        ),
        neutral: 1.0,
        outlined: outline(cells, |cell| {
            let loss = first(cells, cell).before[0] - cell.before[0];
            cell.values[metric] / first(cells, cell).values[metric] > 1.02 && loss > 0.1
        }),
        ..map(cells, |cell| {
            cell.values[metric] / first(cells, cell).values[metric]
        })
    }
}

/// The first level of the degradation of a cell.
fn first<'a>(cells: &'a [Cell], cell: &Cell) -> &'a Cell {
    let mut same = cells.iter().filter(|other| other.degradation == cell.degradation);
    same.next().expect("a first level")
}

fn map(cells: &[Cell], value: impl Fn(&Cell) -> f64) -> HeatMap {
    let rows = Degradation::ALL.map(|degradation| {
        let levels = degradation.levels();
        let ends = format!("{} {}..{}", degradation.name(), levels[0], levels[LEVELS - 1]);
        let row = cells.iter().filter(|cell| cell.degradation == degradation);
        (ends, row.map(&value).collect())
    });
    HeatMap {
        title: String::new(),
        rows: rows.into(),
        neutral: 0.0,
        span: 1.0,
        outlined: Vec::new(),
    }
}

fn outline(cells: &[Cell], fails: impl Fn(&Cell) -> bool) -> Vec<(usize, usize)> {
    let failed = cells.iter().filter(|cell| fails(cell));
    failed
        .map(|cell| (cell.level, cell.degradation as usize))
        .collect()
}

/// The levels that make most pictures worse, with their SSIM before and after.
pub(super) fn describe_failures(cells: &[Cell]) -> String {
    let regions = Degradation::ALL.iter().filter_map(|&degradation| {
        let failed = cells.iter().filter(|cell| is_failure(cell));
        let levels = failed.filter(|cell| cell.degradation == degradation).map(|cell| {
            let level = degradation.levels()[cell.level];
            format!("{level} ({:.2} to {:.2})", cell.before[0], cell.after[0])
        });
        let levels: Vec<String> = levels.collect();
        (!levels.is_empty()).then(|| format!("{} {}", degradation.name(), levels.join(", ")))
    });
    regions.collect::<Vec<_>>().join("; ")
}

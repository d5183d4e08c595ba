//! The cells as CSV, maps and Markdown.

use std::fmt::Write;

use super::{Cell, Degradation, LEVELS, METRICS, Summary};
use crate::plot::HeatMap;

/// Minimum share of worse specimens for a cell in the failure region of a method.
const FAILS: f64 = 0.5;

/// One line for each cell.
#[must_use]
pub fn csv(cells: &[Cell]) -> String {
    let mut text = String::from(
        "method,degradation,level,value,ssim_before,ssim_after,repeatability_before,repeatability_after,",
    );
    text.push_str("worse_ssim,worse_repeatability,gain_mean,gain_max,warned,failures");
    METRICS.iter().for_each(|metric| {
        let _ = write!(text, ",{metric}");
    });
    text.push('\n');
    for cell in cells {
        let _ = write!(
            text,
            "{},\"{}\",{},{},{},{},{},{},{},{},{},{},{},{}",
            name(cell),
            cell.degradation.name(),
            cell.level,
            cell.degradation.levels()[cell.level],
            cell.ssim.0.mean,
            cell.ssim.1.mean,
            cell.repeatability.0.mean,
            cell.repeatability.1.mean,
            cell.worse_ssim,
            cell.worse_repeatability,
            cell.gain.mean,
            cell.gain.max,
            cell.warned,
            cell.failures
        );
        for value in &cell.values {
            let _ = write!(text, ",{}", value.mean);
        }
        text.push('\n');
    }
    text
}

fn name(cell: &Cell) -> &'static str {
    cell.method.unwrap_or("none")
}

/// Change of the SSIM to the clean picture by a method. Cells with more than half of the pictures worse are outlined.
#[must_use]
pub fn ssim_map(cells: &[Cell]) -> HeatMap {
    let mut map = map(cells, |cell| cell.ssim.1.mean - cell.ssim.0.mean);
    let method = cells.first().map_or("none", name);
    map.title = format!("{method}: change of SSIM to the clean picture");
    map.foot = "outlined: more than half of the pictures come out with a lower SSIM".to_owned();
    (map.neutral, map.span, map.low_is_bad) = (0.0, 0.3, true);
    map.outlined = outlined(cells, |cell| cell.worse_ssim > FAILS);
    map
}

/// Change of the result for one code of noise. Cells above four codes are outlined.
#[must_use]
pub fn gain_map(cells: &[Cell]) -> HeatMap {
    let mut map = map(cells, |cell| cell.gain.mean);
    let method = cells.first().map_or("none", name);
    map.title = format!("{method}: change of the result for one code of noise");
    map.foot = "1: the noise passes as it is; outlined: more than fourfold".to_owned();
    (map.neutral, map.span, map.low_is_bad) = (1.0, 6.0, false);
    map.outlined = outlined(cells, |cell| cell.gain.mean > 4.0);
    map
}

/// Dependence of a metric of the untouched pictures on the degradations, as a multiple of its value at the first level. Outlined:
/// the metric rates the picture better although its SSIM has fallen by a tenth.
#[must_use]
pub fn metric_map(cells: &[Cell], metric: usize) -> HeatMap {
    let base = |cell: &Cell| {
        let first = cells
            .iter()
            .find(|other| other.degradation == cell.degradation && other.level == 0);
        first.map_or((f64::NAN, f64::NAN), |first| {
            (first.values[metric].mean, first.ssim.0.mean)
        })
    };
    let ratio = |cell: &Cell| cell.values.get(metric).map_or(f64::NAN, |value| value.mean) / base(cell).0;
    let mut map = map(cells, ratio);
    map.title = format!("{} of the degraded picture, first level = 1", METRICS[metric]);
    map.foot = "outlined: calls the picture better although its SSIM fell by 0.1 or more".to_owned();
    (map.neutral, map.span, map.low_is_bad) = (1.0, 1.0, true);
    map.outlined = outlined(cells, |cell| {
        ratio(cell) > 1.02 && cell.ssim.0.mean < base(cell).1 - 0.1
    });
    map
}

fn map(cells: &[Cell], value: impl Fn(&Cell) -> f64) -> HeatMap {
    let row = |degradation: Degradation| {
        let of = |level: usize| {
            cells
                .iter()
                .find(|cell| cell.degradation == degradation && cell.level == level)
        };
        let cells = (0..LEVELS).map(|level| of(level).map_or(f64::NAN, &value));
        let levels = degradation.levels();
        let ends = format!("{} {}..{}", degradation.name(), levels[0], levels[LEVELS - 1]);
        (ends, cells.collect())
    };
    HeatMap {
        title: String::new(),
        columns: (0..LEVELS).map(|level| format!("step {level}")).collect(),
        rows: Degradation::ALL.map(row).into(),
        neutral: 0.0,
        span: 1.0,
        low_is_bad: true,
        outlined: Vec::new(),
        foot: String::new(),
    }
}

fn outlined(cells: &[Cell], fails: impl Fn(&Cell) -> bool) -> Vec<(usize, usize)> {
    let row = |cell: &Cell| Degradation::ALL.iter().position(|d| *d == cell.degradation);
    cells
        .iter()
        .filter(|cell| fails(cell))
        .filter_map(|cell| Some((cell.level, row(cell)?)))
        .collect()
}

/// The failure region of each method as Markdown; `pictures(method)` names the files of its maps.
#[must_use]
pub fn markdown(runs: &[Vec<Cell>], about: &str, pictures: impl Fn(&str) -> String) -> String {
    let mut text = format!("# Where enhancements fail\n\n{about}\n\n{INTRODUCTION}\n");
    for cells in runs {
        let method = cells.first().map_or("none", name);
        let _ = write!(text, "\n## {method}\n\n{}\n\n", pictures(method));
        let fails: Vec<String> = Degradation::ALL
            .iter()
            .filter_map(|d| region(cells, *d))
            .collect();
        let everywhere = cells.iter().filter(|cell| cell.worse_ssim > FAILS).count();
        let failures: usize = cells.iter().map(|cell| cell.failures).sum();
        let gain = cells
            .iter()
            .map(|cell| cell.gain.mean)
            .filter(|v| v.is_finite())
            .fold(0.0, f64::max);
        let _ = writeln!(
            text,
            "{everywhere} of {} cells lower the SSIM of most pictures; largest gain {gain:.1}; failed runs and values \
             that are not finite: {failures}.\n",
            cells.len()
        );
        if !fails.is_empty() {
            let _ = writeln!(text, "Most pictures get worse at: {}.\n", fails.join("; "));
        }
        if let Some((_, why)) = WHY.iter().find(|(known, _)| *known == method) {
            let _ = writeln!(text, "{why}");
        }
    }
    text
}

/// The levels of a degradation that make a method fail.
fn region(cells: &[Cell], degradation: Degradation) -> Option<String> {
    let levels: Vec<String> = cells
        .iter()
        .filter(|cell| cell.degradation == degradation && cell.worse_ssim > FAILS)
        .map(|cell| {
            let (Summary { mean: before, .. }, Summary { mean: after, .. }) = cell.ssim;
            format!("{} ({before:.2} to {after:.2})", degradation.levels()[cell.level])
        })
        .collect();
    (!levels.is_empty()).then(|| format!("{} {}", degradation.name(), levels.join(", ")))
}

const INTRODUCTION: &str = "\
Each scene is put under water, degraded step by step, and handed to every method. The left map shows how the method \
moves the structural similarity to the clean picture (red: away from it), the right one how strongly it amplifies noise \
of one code. A method can look better and be further from the truth; both maps together say where not to use it.";

const WHY: &[(&str, &str)] = &[
    (
        "none",
        "The picture as it is: what every method is compared with.",
    ),
    (
        "hscm",
        "The homomorphic filter works on the logarithm of the luma, whose slope is steepest at black: noise in dark pictures \
         is amplified first, CLAHE then spreads what is left over all codes. With little signal (no transmittance, no \
         light) it draws the noise; color is kept, so a cast stays.",
    ),
    (
        "clahe",
        "Contrast of every tile is stretched up to the clip limit whether it holds scene or noise; color is kept, so a cast \
         stays.",
    ),
    (
        "grey_world",
        "Each channel is scaled to a common mean. Where red is all but gone its noise is scaled with it, and a lamp or a \
         colored object shifts the mean that it rests on.",
    ),
    (
        "ulap",
        "Range is estimated from max(G, B) - R with fixed weights. Where red is missing everywhere, everything counts as far \
         and red is divided by a small transmittance: the result turns red. A lamp counts as near and background at once.",
    ),
    (
        "ibla",
        "The background light is looked for among bright, smooth pixels: with a lamp in view it is the lamp, and what is \
         darker than four fifths of it falls below zero and turns black. Small pictures leave the quadtree no pixels.",
    ),
    (
        "suir",
        "Green and blue are dehazed, then red is balanced by their mean. In the dark the dark channel says nothing, and \
         where red is gone it is made of noise.",
    ),
    (
        "rd",
        "Each half of each histogram is stretched to the full range, so that a narrow histogram (veil, darkness) becomes \
         noise of many codes, and averages of the halves leave plateaus.",
    ),
    (
        "rghs",
        "Channels are equalized by their means and stretched between percentiles that come from a Rayleigh spread: narrow \
         histograms are stretched most, and very small pictures leave the percentiles no pixels.",
    ),
];

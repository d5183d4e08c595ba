//! Points as charts and as text.

use std::fmt::Write;

use super::Point;
use crate::plot::{Axis, Form, Grid, Lines, Mark, Series};

/// Smaller errors are drawn at this value, since a logarithmic axis has no 0.
const FLOOR: f64 = 1e-8;

/// The quantity plotted against time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// The largest error.
    Max,
    /// The root mean square error.
    Rmse,
    /// The largest difference of 8-bit codes.
    Codes,
    /// The mean color difference.
    DeltaE,
}

impl Measure {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Max, Self::Rmse, Self::Codes, Self::DeltaE];

    fn title(self) -> &'static str {
        match self {
            Self::Max => "largest error, linear light",
            Self::Rmse => "root mean square error",
            Self::Codes => "8-bit codes off, most (0 at 0.1)",
            Self::DeltaE => "mean color difference, CIEDE2000",
        }
    }

    /// The value on a logarithmic axis; smaller values are drawn at the floor.
    fn value(self, point: &Point) -> Option<f64> {
        match self {
            Self::Max => point.error_max.map(|e| e.max(FLOOR)),
            Self::Rmse => point.error_rmse.map(|e| e.max(FLOOR)),
            Self::Codes => point.codes_max.map(|codes| f64::from(codes).max(0.1)),
            Self::DeltaE => point.delta_e.map(|e| e.max(1e-5)),
        }
    }
}

/// Error against time for one stage and scene, with the Pareto front and the default variant.
#[must_use]
pub fn error_chart(title: &str, points: &[Point], measure: Measure) -> Lines {
    // Other programs on the machine can only add time, so the fastest run is the least disturbed.
    let mark = |point: &Point, labeled: bool| {
        Some(Mark {
            x: point.ms_min,
            y: measure.value(point)?,
            reach: Some(point.ms_median),
            label: if labeled { label(point) } else { String::new() },
            ringed: point.default,
        })
    };
    let mut names: Vec<&str> = Vec::new();
    for point in points.iter().filter(|p| p.error_max.is_some()) {
        let name = family(point);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let mut front: Vec<&Point> = points.iter().filter(|p| p.pareto).collect();
    front.sort_by(|a, b| a.ms_min.total_cmp(&b.ms_min));
    let mut series: Vec<Series> = names
        .iter()
        .map(|name| {
            let of = points.iter().filter(|p| family(p) == *name).enumerate();
            Series {
                name: (*name).to_owned(),
                marks: of.filter_map(|(index, p)| mark(p, index % 2 == 0)).collect(),
                form: Form::Dots,
            }
        })
        .collect();
    // The other measures join the same points, which shows how the front of the largest error performs there.
    series.push(Series {
        name: "Pareto front".to_owned(),
        marks: front.into_iter().filter_map(|p| mark(p, false)).collect(),
        form: Form::Line,
    });
    let axis = |title: &str| Axis {
        title: title.to_owned(),
        logarithmic: true,
    };
    Lines {
        title: format!("{title}  (ring: default)"),
        x: axis("ms: fastest run, line to the median"),
        y: axis(measure.title()),
        series,
    }
}

/// All measures of one stage and scene on one sheet.
#[must_use]
pub fn error_sheet(title: &str, points: &[Point]) -> Grid {
    Grid {
        panels: Measure::ALL
            .map(|measure| error_chart(title, points, measure))
            .into(),
    }
}

/// The name of a variant without its suffix in brackets, such as a tolerance or a water.
fn family(point: &Point) -> &str {
    point.variant.split(" (").next().unwrap_or(&point.variant)
}

/// The number of terms, or the suffix in brackets.
fn label(point: &Point) -> String {
    let inside = || Some(point.variant.split_once(" (")?.1.trim_end_matches(')').to_owned());
    let terms = point.terms.map(|terms| terms.to_string());
    terms.or_else(inside).unwrap_or_default()
}

/// Time against megapixels, or at one size against kernels and lights.
#[must_use]
pub fn cost_chart(points: &[Point], by_terms: bool) -> Lines {
    const USUAL: (usize, usize) = (768, 492);
    let mut series: Vec<Series> = Vec::new();
    let of_cost = points.iter().filter(|p| p.stage == "cost");
    let fits = |p: &&Point| {
        let swept = (p.width, p.height) == USUAL;
        match (by_terms, p.variant.as_str()) {
            (true, "jaffe" | "haze" | "lamps") => swept,
            (true, _) => false,
            (false, "jaffe") => p.terms == Some(6),
            (false, "haze") => p.terms == Some(4),
            (false, "lamps") => p.terms == Some(2),
            (false, _) => true,
        }
    };
    for point in of_cost.filter(fits) {
        let x = match (by_terms, point.terms) {
            (true, Some(terms)) => terms as f64,
            _ => (point.width * point.height) as f64 / 1e6,
        };
        let mark = Mark {
            x,
            y: point.ms_min,
            reach: None,
            label: String::new(),
            ringed: false,
        };
        match series.iter_mut().find(|s| s.name == point.variant) {
            Some(series) => series.marks.push(mark),
            None => series.push(Series {
                name: point.variant.clone(),
                marks: vec![mark],
                form: Form::Joined,
            }),
        }
    }
    let axis = |title: &str| Axis {
        title: title.to_owned(),
        logarithmic: !by_terms,
    };
    let (title, x) = if by_terms {
        ("Cost at 768x492", "kernels of jaffe, lights of haze, lamps")
    } else {
        (
            "Cost against size: six kernels, four lights, two lamps",
            "megapixels",
        )
    };
    Lines {
        title: title.to_owned(),
        x: axis(x),
        y: axis("ms, fastest run"),
        series,
    }
}

/// All points as comma-separated text.
#[must_use]
pub fn csv(points: &[Point]) -> String {
    let mut text = "stage,variant,terms,scene,width,height,ms_median,ms_min,ms_max,error_max,error_rmse,codes_max,delta_e,default,pareto\n".to_owned();
    for p in points {
        let terms = p.terms.map_or_else(String::new, |v| v.to_string());
        let number = |v: Option<f64>| v.map_or_else(String::new, |v| format!("{v:.4e}"));
        let codes = p.codes_max.map_or_else(String::new, |v| v.to_string());
        let _ = writeln!(
            text,
            "{},{},{terms},{},{},{},{:.3},{:.3},{:.3},{},{},{codes},{},{},{}",
            p.stage,
            p.variant,
            p.scene,
            p.width,
            p.height,
            p.ms_median,
            p.ms_min,
            p.ms_max,
            number(p.error_max),
            number(p.error_rmse),
            number(p.delta_e),
            p.default,
            p.pareto
        );
    }
    text
}

//! Points as charts and as text.

use std::fmt::Write;

use super::Point;
use crate::plot::{Axis, Lines, Mark, Series};

/// Smaller errors are drawn here: on a logarithmic axis there is no 0.
const FLOOR: f64 = 1e-8;

/// Largest error against time, with the front and the default, of one stage and scene.
#[must_use]
pub fn error_chart(title: &str, points: &[Point]) -> Lines {
    let error = |point: &Point| point.error_max.unwrap_or(FLOOR).max(FLOOR);
    let mut names: Vec<&str> = Vec::new();
    for point in points.iter().filter(|p| p.error_max.is_some()) {
        // The frame's variants carry their tolerance behind their name.
        let name = family(point);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    // Other programs on the machine only ever add time: the fastest run disturbs the picture least.
    let mark = |point: &Point, label: bool| Mark {
        x: point.ms_min,
        y: error(point),
        label: point
            .terms
            .filter(|_| label)
            .map_or_else(String::new, |terms| terms.to_string()),
        ringed: point.default,
    };
    let mut series: Vec<Series> = names
        .iter()
        .map(|name| {
            let of = points
                .iter()
                .filter(|p| p.error_max.is_some() && family(p) == *name);
            let marks: Vec<Mark> = of.enumerate().map(|(index, p)| mark(p, index % 2 == 0)).collect();
            Series {
                name: (*name).to_owned(),
                marks,
                joined: false,
            }
        })
        .collect();
    let mut front: Vec<&Point> = points.iter().filter(|p| p.pareto).collect();
    front.sort_by(|a, b| a.ms_min.total_cmp(&b.ms_min));
    series.push(Series {
        name: "Pareto front".to_owned(),
        marks: front
            .into_iter()
            .map(|p| Mark {
                ringed: false,
                ..mark(p, false)
            })
            .collect(),
        joined: true,
    });
    let axis = |title: &str| Axis {
        title: title.to_owned(),
        logarithmic: true,
    };
    Lines {
        title: format!("{title}  (ring: default)"),
        x: axis("ms, fastest run"),
        y: axis("largest error, linear light"),
        series,
    }
}

fn family(point: &Point) -> &str {
    match point.stage {
        "frame" => point.variant.split(' ').next().unwrap_or(&point.variant),
        _ => &point.variant,
    }
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
            (true, "jaffe" | "haze") => swept,
            (true, _) => false,
            (false, "jaffe") => p.terms == Some(6),
            (false, "haze") => p.terms == Some(4),
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
            label: String::new(),
            ringed: false,
        };
        match series.iter_mut().find(|s| s.name == point.variant) {
            Some(series) => series.marks.push(mark),
            None => series.push(Series {
                name: point.variant.clone(),
                marks: vec![mark],
                joined: true,
            }),
        }
    }
    let axis = |title: &str| Axis {
        title: title.to_owned(),
        logarithmic: !by_terms,
    };
    let (title, x) = if by_terms {
        ("Cost at 768x492", "kernels, lights")
    } else {
        ("Cost against size: six kernels, four lights", "megapixels")
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

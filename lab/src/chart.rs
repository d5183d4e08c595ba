//! Error against time: variants of a stage on scenes, each against its f64 reference.

mod cost;
mod difference;
mod draw;
mod forward_scatter;
mod frame;
mod ibla;
mod lamps;
mod overlay;
mod scenes;
mod spatial;
mod stopwatch;
mod summary;
mod weighted;

use serde::Serialize;

pub use cost::cost;
pub use difference::{Difference, difference};
pub use draw::{Measure, cost_chart, csv, error_chart, error_sheet};
pub use forward_scatter::forward_scatter;
pub use frame::whole_frame;
pub use ibla::ibla;
pub use lamps::glow;
pub use overlay::{haze, homomorphic};
pub use scenes::{ChartScene, standard_scenes};
pub use stopwatch::{Times, time, time_once};
pub use summary::summary;

/// The stages that have a chart.
pub const STAGES: [&str; 6] = ["forward_scatter", "haze", "homomorphic", "ibla", "lamps", "frame"];

/// Time and error of one variant on one scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// The stage.
    pub stage: &'static str,
    /// The method.
    pub variant: String,
    /// Number of kernels, layers or lights, if applicable.
    pub terms: Option<usize>,
    /// The scene.
    pub scene: String,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Median run.
    pub ms_median: f64,
    /// The fastest run.
    pub ms_min: f64,
    /// The slowest.
    pub ms_max: f64,
    /// Largest difference to the reference in linear light; `None` if only time was measured.
    pub error_max: Option<f64>,
    /// Root of its mean square.
    pub error_rmse: Option<f64>,
    /// Largest difference of 8-bit codes.
    pub codes_max: Option<u8>,
    /// Mean color difference, CIEDE2000; in the table, not in the JSON.
    #[serde(skip)]
    pub delta_e: Option<f64>,
    /// The default variant of a job.
    pub default: bool,
    /// No other variant on this scene is both faster and more exact.
    pub pareto: bool,
}

impl Point {
    /// Builds a point from its measurements.
    #[must_use]
    pub fn new(
        stage: &'static str,
        (variant, terms): (&str, Option<usize>),
        scene: &str,
        (width, height): (usize, usize),
        times: Times,
        difference: Option<Difference>,
    ) -> Self {
        Self {
            stage,
            variant: variant.to_owned(),
            terms,
            scene: scene.to_owned(),
            width,
            height,
            ms_median: times.median,
            ms_min: times.min,
            ms_max: times.max,
            error_max: difference.map(|d| d.max),
            error_rmse: difference.map(|d| d.rmse),
            codes_max: difference.map(|d| d.codes),
            delta_e: difference.map(|d| d.delta_e),
            default: false,
            pareto: false,
        }
    }
}

/// Marks the points of one stage and scene that no other point beats in both its fastest run and its largest error.
pub fn mark_pareto(points: &mut [Point]) {
    let beats = |a: &Point, b: &Point| {
        let (Some(one), Some(other)) = (a.error_max, b.error_max) else {
            return false;
        };
        (a.ms_min <= b.ms_min && one < other) || (a.ms_min < b.ms_min && one <= other)
    };
    let front: Vec<bool> = points
        .iter()
        .map(|point| {
            let rivals = points
                .iter()
                .filter(|p| (p.stage, &p.scene) == (point.stage, &point.scene));
            point.error_max.is_some() && !rivals.into_iter().any(|rival| beats(rival, point))
        })
        .collect();
    points
        .iter_mut()
        .zip(front)
        .for_each(|(point, pareto)| point.pareto = pareto);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(ms: f64, error: f64) -> Point {
        let times = Times {
            median: ms,
            min: ms,
            max: ms,
        };
        let difference = Difference {
            max: error,
            rmse: error,
            codes: 0,
            delta_e: 0.0,
        };
        Point::new("haze", ("a", None), "wall", (1, 1), times, Some(difference))
    }

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let mut points = vec![
            point(1.0, 0.1),
            point(2.0, 0.2),
            point(2.0, 0.01),
            point(3.0, 0.01),
        ];
        mark_pareto(&mut points);
        let front: Vec<bool> = points.iter().map(|p| p.pareto).collect();
        assert_eq!(front, [true, false, true, false]);
    }

    #[test]
    fn every_stage_measures_its_exact_form_as_exact_and_draws() {
        let scene = &standard_scenes(48, 32)[1];
        let mut points = forward_scatter(scene, 1);
        points.extend(haze(scene, 1));
        points.extend(homomorphic(scene, 1));
        points.extend(ibla(scene, 1));
        points.extend(glow(scene, 1));
        points.extend(whole_frame(scene, 1));
        mark_pareto(&mut points);
        for stage in STAGES {
            let of: Vec<Point> = points.iter().filter(|p| p.stage == stage).cloned().collect();
            assert!(
                of.iter().filter(|p| p.default).count() == 1,
                "{stage} has no default"
            );
            assert!(of.iter().any(|p| p.pareto), "{stage}");
            let least = of
                .iter()
                .filter_map(|p| p.error_max)
                .fold(f64::INFINITY, f64::min);
            // The airlight of a lamp in view reaches 100, which f32 represents to 8e-6.
            let limit = if stage == "lamps" { 2e-5 } else { 3e-6 };
            assert!(least < limit, "{stage}: {least:e}");
            assert!(
                crate::plot::svg(&error_sheet(stage, &of))
                    .unwrap()
                    .contains("</svg>")
            );
        }
        let of = |variant: &str, terms| {
            let point = points.iter().find(|p| p.variant == variant && p.terms == terms);
            point.unwrap().error_max.unwrap()
        };
        assert!(of("chebyshev", Some(12)) < of("chebyshev", Some(4)));
        assert!(of("chebyshev", Some(8)) < of("hard layers", Some(8)));
        assert_eq!(csv(&points).lines().count(), points.len() + 1);
        assert!(summary(&points, scene).contains("| chebyshev | 12 |"));
    }

    #[test]
    fn the_json_of_a_point_has_the_fields_that_are_promised() {
        let json = serde_json::to_value(point(1.0, 0.1)).unwrap();
        let fields: Vec<&str> = json.as_object().unwrap().keys().map(String::as_str).collect();
        let mut promised = [
            "stage",
            "variant",
            "terms",
            "scene",
            "width",
            "height",
            "ms_median",
            "ms_min",
            "ms_max",
            "error_max",
            "error_rmse",
            "codes_max",
            "default",
            "pareto",
        ];
        promised.sort_unstable();
        let mut fields = fields;
        fields.sort_unstable();
        assert_eq!(fields, promised);
    }
}

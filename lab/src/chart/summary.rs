//! The points of one scene as tables.

use std::fmt::Write as _;

use super::{ChartScene, Point};

/// A table for each stage: every variant on one scene, the fastest first, the default and the Pareto front marked.
#[must_use]
pub fn summary(points: &[Point], scene: &ChartScene) -> String {
    let mut stages: Vec<&str> = points.iter().map(|p| p.stage).filter(|s| *s != "cost").collect();
    stages.dedup();
    let mut text = String::new();
    let mut seen: Vec<&str> = Vec::new();
    for stage in stages {
        if seen.contains(&stage) {
            continue;
        }
        seen.push(stage);
        let mut of: Vec<&Point> = points
            .iter()
            .filter(|p| p.stage == stage && p.scene == scene.name)
            .collect();
        of.sort_by(|a, b| a.ms_min.total_cmp(&b.ms_min));
        let _ = write!(
            text,
            "\n## {stage}, {}\n\n| variant | terms | ms median | min | max | error max | RMSE | codes | dE | |\n|{}\n",
            scene.name,
            "---|".repeat(10)
        );
        for p in of {
            let terms = p.terms.map_or_else(String::new, |terms| terms.to_string());
            let error = |e: Option<f64>| e.map_or_else(String::new, |e| format!("{e:.1e}"));
            let codes = p.codes_max.map_or_else(String::new, |codes| codes.to_string());
            let marks = match (p.default, p.pareto) {
                (true, true) => "default, front",
                (true, false) => "default",
                (false, true) => "front",
                _ => "",
            };
            let _ = writeln!(
                text,
                "| {} | {terms} | {:.2} | {:.2} | {:.2} | {} | {} | {codes} | {} | {marks} |",
                p.variant,
                p.ms_median,
                p.ms_min,
                p.ms_max,
                error(p.error_max),
                error(p.error_rmse),
                error(p.delta_e)
            );
        }
    }
    let cost: Vec<&Point> = points.iter().filter(|p| p.stage == "cost").collect();
    if !cost.is_empty() {
        text.push_str("\n## Cost\n\n| what | terms | columns | rows | ms median | min | max |\n|---|---|---|---|---|---|---|\n");
    }
    for p in cost {
        let terms = p.terms.map_or_else(String::new, |terms| terms.to_string());
        let (width, height) = (p.width, p.height);
        let _ = writeln!(
            text,
            "| {} | {terms} | {width} | {height} | {:.2} | {:.2} | {:.2} |",
            p.variant, p.ms_median, p.ms_min, p.ms_max
        );
    }
    text
}

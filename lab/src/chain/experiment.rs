//! All findings as an experiment.

use cli::exit::Failure;

use super::finding::{Finding, Limit};
use super::{geometry, numbers, shapes};
use crate::report::Report;
use crate::row;
use crate::setup::Setup;
use crate::table::{Table, format_number};

/// The name of a test and its measurement.
pub type NamedFinding = (&'static str, fn() -> Finding);

/// The findings by the names of their tests, in the order of the page.
pub const FINDINGS: [NamedFinding; 15] = [
    ("a_step_in_range", geometry::measure_step),
    ("far_light_over_a_near_object", geometry::measure_leak),
    ("a_cone_focuses_light", geometry::measure_cone),
    ("the_border", geometry::measure_border),
    ("tiny_and_huge_spreads", numbers::measure_spreads),
    ("g_close_to_c", numbers::measure_cancellation),
    ("single_pixels_and_lines", shapes::measure_single_pixels),
    ("prime_sizes", shapes::measure_prime_sizes),
    ("holes_of_every_kind", shapes::measure_holes),
    ("radiance_that_is_no_number", shapes::measure_bad_radiance),
    ("bright_lamps", numbers::measure_bright_lamps),
    ("very_short_and_very_long_ranges", numbers::measure_ranges),
    ("f32_against_f64", numbers::measure_rounding),
    ("a_tolerance_below_f32", numbers::measure_tiny_tolerance),
    ("threads", shapes::measure_threads),
];

/// Measures all findings. Each figure beyond its limit is a failure.
///
/// # Errors
/// None.
pub fn run(_: &Setup) -> Result<Report, Failure> {
    let mut table = Table::new("findings", ["finding", "figure", "measured", "limit", "within"]);
    let mut report = Report::default();
    for (name, measure) in FINDINGS {
        let finding = measure();
        for figure in &finding.figures {
            let limit = match figure.limit {
                Limit::AtMost(limit) => format!("≤ {}", format_number(limit)),
                Limit::AtLeast(limit) => format!("≥ {}", format_number(limit)),
            };
            if !figure.is_within() {
                let (what, value) = (figure.what, figure.value);
                report
                    .failures
                    .push(format!("{name}: {what} is {value:e}, limit {limit}"));
            }
            table.push(row![name, figure.what, figure.value, limit, figure.is_within()]);
        }
    }
    report.about = "Hostile frames through the water chain, against the limits of docs/science/stability.md. Errors are the largest \
                    of a frame in linear light. ≤ is a promise, ≥ a known weakness."
        .to_owned();
    report.tables.push(table);
    Ok(report)
}

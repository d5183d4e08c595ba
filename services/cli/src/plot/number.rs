//! Numbers in charts and tables.

/// A number with about three digits.
#[must_use]
pub fn format_number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        v if !(0.1..1e5).contains(&v) => format!("{value:.1e}"),
        v if v < 10.0 => format!("{value:.2}"),
        v if v < 100.0 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}

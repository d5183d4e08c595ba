//! Numbers of things, seconds and bytes in words.

use std::fmt::Display;

/// A number with its noun, such as `1 frame` and `3 frames`.
pub fn count(number: impl Display, noun: &str) -> String {
    let number = number.to_string();
    let ending = if number == "1" { "" } else { "s" };
    format!("{number} {noun}{ending}")
}

/// Such as `3 min 20 s`.
pub fn describe_duration(seconds: f64) -> String {
    let seconds = seconds.ceil() as u64;
    match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
        (0, 0, seconds) => format!("{seconds} s"),
        (0, minutes, seconds) => format!("{minutes} min {seconds} s"),
        (hours, minutes, _) => format!("{hours} h {minutes} min"),
    }
}

/// Such as `16.8 MB`.
pub fn describe_bytes(bytes: f64) -> String {
    let (size, unit) = match bytes {
        ..999.5 => return format!("{bytes:.0} B"),
        ..999.95e3 => (bytes / 1e3, "kB"),
        ..999.95e6 => (bytes / 1e6, "MB"),
        ..999.95e9 => (bytes / 1e9, "GB"),
        _ => (bytes / 1e12, "TB"),
    };
    format!("{size:.1} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_one_thing_has_no_plural() {
        assert_eq!(
            [0, 1, 2, 11].map(|number| count(number, "frame")),
            ["0 frames", "1 frame", "2 frames", "11 frames"]
        );
    }

    #[test]
    fn durations_have_two_units_at_most() {
        assert_eq!(
            [0.2, 61.0, 7260.0].map(describe_duration),
            ["1 s", "1 min 1 s", "2 h 1 min"]
        );
    }

    #[test]
    fn bytes_have_the_largest_unit_in_them() {
        assert_eq!(
            [0.0, 999.0, 1000.0, 16_793_663.0, 999_960_000.0, 5e15].map(describe_bytes),
            ["0 B", "999 B", "1.0 kB", "16.8 MB", "1.0 GB", "5000.0 TB"]
        );
    }
}

//! Checks of query parameters.

use std::time::Duration;

use super::problem::{Problem, Slug};
use crate::limits;

/// Checks the number of rows of a page.
pub(crate) fn check_rows(limit: Option<u32>) -> Result<u32, Problem> {
    match limit {
        None => Ok(limits::DEFAULT_PAGE_ROWS),
        Some(rows @ 1..=limits::MAX_PAGE_ROWS) => Ok(rows),
        Some(rows) => Err(out_of_range(
            "limit",
            rows.into(),
            1,
            limits::MAX_PAGE_ROWS.into(),
        )),
    }
}

/// Checks the time that a client wants to wait.
pub(crate) fn check_wait(seconds: Option<u64>) -> Result<Duration, Problem> {
    let longest = limits::MAX_WAIT.as_secs();
    match seconds.unwrap_or(0) {
        seconds if seconds <= longest => Ok(Duration::from_secs(seconds)),
        seconds => Err(out_of_range("wait", seconds, 0, longest)),
    }
}

/// Checks a filter; an empty one counts as absent.
pub(crate) fn check_filter(filter: Option<String>) -> Result<Option<String>, Problem> {
    match filter {
        Some(text) if text.len() > limits::FILTER_BYTES => {
            let (bytes, limit) = (text.len(), limits::FILTER_BYTES);
            let detail = format!("the filter has {bytes} bytes; must be at most {limit}");
            Err(Problem::new(Slug::InvalidFilter, detail))
        }
        filter => Ok(filter.filter(|text| !text.trim().is_empty())),
    }
}

/// Splits a comma-separated list.
pub(crate) fn split_names(list: &str) -> Vec<String> {
    list.split(',').map(|name| name.trim().to_owned()).collect()
}

pub(crate) fn out_of_range(name: &str, value: u64, least: u64, most: u64) -> Problem {
    let detail = format!("{name} is {value}; must be in {least}..={most}");
    Problem::new(Slug::InvalidQuery, detail)
}

//! Filters of commands: a job may be named by the beginning of its id.

use client::Client;

use crate::exit::Failure;
use crate::known;

/// The filter with whole ids in place of the beginnings that `job` is compared with, such as `job == "job_0198c0ffee00"`.
pub fn expand_jobs(client: &Client, filter: &str) -> Result<String, Failure> {
    let mut expanded = filter.to_owned();
    for text in catalogue::find_texts(filter, "job").into_iter().rev() {
        if text.value.starts_with("job_") && !known::is_job_id(&text.value) {
            let id = known::job(client, &text.value)?.id;
            expanded.replace_range(text.range, &format!("\"{id}\""));
        }
    }
    Ok(expanded)
}

//! Datasets, jobs and scenes by name, with the nearest names where there are none.

use serde_json::Value;

use crate::exit::Failure;
use crate::remote::{Remote, encode, with_query};

/// Names that a message lists at most.
const MOST_LISTED: usize = 8;

/// The job of this id.
pub fn job(remote: &Remote, id: &str) -> Result<Value, Failure> {
    let found = remote.find(&format!("/v1/jobs/{}", encode(id)))?;
    found.map_or_else(|| Err(unknown_job(remote, id)?), Ok)
}

/// The dataset or sealed version of this name, with its columns.
pub fn dataset(remote: &Remote, name: &str) -> Result<Value, Failure> {
    let found = remote.find(&format!("/v1/datasets/{}", encode(name)))?;
    if let (None, Some(Version { dataset, .. })) = (&found, version(name)) {
        return Err(unknown_version(remote, dataset, name)?);
    }
    found.map_or_else(|| Err(unknown_named(remote, "dataset", name)?), Ok)
}

/// The uploaded scene of this id.
pub fn scene(remote: &Remote, id: &str) -> Result<Value, Failure> {
    let found = remote.find(&format!("/v1/scenes/{}", encode(id)))?;
    found.ok_or_else(|| Failure::BadInput(format!("no scene `{id}`; `fathom scenes` lists them")))
}

/// The scenes of the collection of this name, in their order.
pub fn collection(remote: &Remote, name: &str) -> Result<Vec<Value>, Failure> {
    match remote.find(&format!("/v1/collections/{}", encode(name)))? {
        Some(page) => Ok(items(&page).to_vec()),
        None => Err(unknown_named(remote, "collection", name)?),
    }
}

/// A sealed version by its name.
pub struct Version<'a> {
    pub dataset: &'a str,
    pub number: &'a str,
}

/// Reads a name such as `tour@1`; none for that of a dataset, which has no `@`.
pub fn version(name: &str) -> Option<Version<'_>> {
    let (dataset, number) = name.rsplit_once('@')?;
    let is_number = !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then_some(Version { dataset, number })
}

fn unknown_job(remote: &Remote, id: &str) -> Result<Failure, Failure> {
    let limit = MOST_LISTED.to_string();
    let newest = remote.get(&with_query("/v1/jobs", &[("limit", Some(&limit))]))?;
    let newest = items(&newest);
    let text = |job: &Value, name: &str| job[name].as_str().unwrap_or_default().to_owned();
    let ids: Vec<String> = newest.iter().map(|job| text(job, "id")).collect();
    let described = |job: &Value| {
        format!(
            "{} ({}, {})",
            text(job, "id"),
            text(job, "dataset"),
            text(job, "state")
        )
    };
    let listed: Vec<String> = newest.iter().map(described).collect();
    Ok(unknown(
        &Named {
            what: "job",
            kind: "newest jobs",
            name: id,
        },
        &ids,
        &listed,
    ))
}

/// A version that is not there, of a dataset that may be.
fn unknown_version(remote: &Remote, dataset: &str, name: &str) -> Result<Failure, Failure> {
    let Some(page) = remote.find(&format!("/v1/datasets/{}/versions", encode(dataset)))? else {
        return unknown_named(remote, "dataset", dataset);
    };
    let names = items(&page).iter().filter_map(|row| row["name"].as_str());
    let names: Vec<String> = names.map(str::to_owned).collect();
    let wanted = Named {
        what: "sealed version",
        kind: "sealed versions",
        name,
    };
    Ok(unknown(&wanted, &names, &names))
}

/// A dataset or collection that is not there.
fn unknown_named(remote: &Remote, what: &str, name: &str) -> Result<Failure, Failure> {
    let kind = format!("{what}s");
    let all = remote.rows(&format!("/v1/{kind}"), &[], usize::MAX)?;
    let names = all.iter().filter_map(|row| row["name"].as_str());
    let names: Vec<String> = names.map(str::to_owned).collect();
    Ok(unknown(
        &Named {
            what,
            kind: &kind,
            name,
        },
        &names,
        &names,
    ))
}

/// Whether a name has the form of a job's id, `job_` and a UUID.
pub fn is_job_id(name: &str) -> bool {
    is_id("job_", name)
}

/// Whether a name has the form of a scene's id, `scn_` and a UUID.
pub fn is_scene_id(name: &str) -> bool {
    is_id("scn_", name)
}

fn is_id(prefix: &str, name: &str) -> bool {
    let id = name.strip_prefix(prefix);
    id.is_some_and(|id| id.len() == 32 && id.bytes().all(|byte| byte.is_ascii_hexdigit()))
}

/// The rows of a page.
pub fn items(page: &Value) -> &[Value] {
    page["items"].as_array().map(Vec::as_slice).unwrap_or_default()
}

/// What was looked for.
struct Named<'a> {
    what: &'a str,
    /// What the list is of.
    kind: &'a str,
    name: &'a str,
}

fn unknown(wanted: &Named<'_>, names: &[String], listed: &[String]) -> Failure {
    let Named { what, kind, name } = wanted;
    let near = spec::nearest(name, names);
    let near = near.map_or_else(String::new, |near| format!(" (did you mean `{near}`?)"));
    let mut message = format!("no {what} `{name}`{near}");
    if listed.is_empty() {
        message.push_str(&format!("; the service has no {what} at all"));
    } else {
        let shown = &listed[..listed.len().min(MOST_LISTED)];
        let more = listed.len() - shown.len();
        message.push_str(&format!("; the {kind} are {}", shown.join(", ")));
        if more > 0 {
            message.push_str(&format!(" and {more} more"));
        }
    }
    Failure::BadInput(message)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_name_comes_with_the_nearest_one_and_a_short_list() {
        let wanted = Named {
            what: "dataset",
            kind: "datasets",
            name: "tuor",
        };
        let mut names: Vec<String> = (0..10).map(|index| format!("bay-{index}")).collect();
        names[3] = "tour".to_owned();
        let message = unknown(&wanted, &names, &names).to_string();
        assert!(
            message.starts_with("no dataset `tuor` (did you mean `tour`?); the datasets are bay-0, bay-1")
        );
        assert!(message.ends_with("bay-7 and 2 more"), "{message}");
        let message = unknown(&wanted, &[], &[]).to_string();
        assert_eq!(message, "no dataset `tuor`; the service has no dataset at all");
    }
}

//! Datasets, jobs and scenes by name; an unknown name is an error with the nearest known one.

use std::collections::BTreeSet;

use client::{Client, CollectionScene, DatasetDetail, JobRow, SceneView};

use crate::exit::Failure;
use crate::terminal;

/// Names that a message lists at most.
const MOST_LISTED: usize = 8;
/// Jobs among which the beginning of an id is searched, newest first.
const MOST_SEARCHED: usize = 10_000;
/// Least digits of the beginning of an id.
const LEAST_DIGITS: usize = 4;

/// The job of this id, or the only one of the newest whose id begins so.
pub fn job(client: &Client, id: &str) -> Result<JobRow, Failure> {
    if let Some(job) = client.job(id)? {
        return Ok(job);
    }
    let digits = id.strip_prefix("job_").unwrap_or(id);
    if is_job_id(id) || digits.len() < LEAST_DIGITS {
        return Err(unknown_job(client, id)?);
    }
    let mut found = client.jobs(None, None, MOST_SEARCHED)?;
    found.retain(|job| job.id.trim_start_matches("job_").starts_with(digits));
    match found.len() {
        0 => Err(unknown_job(client, id)?),
        1 => Ok(found.remove(0)),
        count => {
            let ids: Vec<&str> = found.iter().map(|job| job.id.as_str()).collect();
            let mut ids = shorten_ids(&ids);
            ids.truncate(MOST_LISTED);
            Err(Failure::BadInput(format!(
                "`{id}` begins the ids of {count} jobs: {}; write more digits",
                ids.join(", ")
            )))
        }
    }
}

/// The shortest distinct beginnings of ids of one length, at least the digits of their time; with `--wide` the ids.
pub fn shorten_ids(ids: &[&str]) -> Vec<String> {
    /// `job_` and the time of a UUID in milliseconds.
    const USUAL: usize = 16;
    let distinct: BTreeSet<&str> = ids.iter().copied().collect();
    let longest = ids.iter().map(|id| id.len()).max().unwrap_or(0);
    let is_unique = |length: &usize| {
        let beginnings: BTreeSet<&str> = distinct.iter().map(|id| begin_id(id, *length)).collect();
        beginnings.len() == distinct.len()
    };
    let length = match terminal::is_wide() {
        true => longest,
        false => (USUAL..longest).find(is_unique).unwrap_or(longest),
    };
    ids.iter().map(|id| begin_id(id, length).to_owned()).collect()
}

/// The beginning that names a job; with `--wide` the whole id.
pub fn shorten_id(id: &str) -> String {
    shorten_ids(&[id]).concat()
}

/// An id from a service may have any characters.
fn begin_id(id: &str, length: usize) -> &str {
    id.get(..length).unwrap_or(id)
}

/// The dataset or sealed version of this name, with its columns.
pub fn dataset(client: &Client, name: &str) -> Result<DatasetDetail, Failure> {
    if let Some(dataset) = client.dataset(name)? {
        return Ok(dataset);
    }
    Err(match version(name) {
        Some(Version { dataset, .. }) => unknown_version(client, dataset, name)?,
        None => unknown_dataset(client, name)?,
    })
}

/// The uploaded scene of this id.
pub fn scene(client: &Client, id: &str) -> Result<SceneView, Failure> {
    client
        .scene(id)?
        .ok_or_else(|| Failure::BadInput(format!("no scene `{id}`; `fathom scenes` lists them")))
}

/// The scenes of the collection of this name, in their order.
pub fn collection(client: &Client, name: &str) -> Result<Vec<CollectionScene>, Failure> {
    if let Some(scenes) = client.collection(name)? {
        return Ok(scenes);
    }
    let names = client
        .collections()?
        .into_iter()
        .map(|collection| collection.name);
    Err(Unknown::new("collection", "collections", name).failure(&names.collect::<Vec<_>>()))
}

/// A sealed version by its name.
pub struct Version<'a> {
    pub dataset: &'a str,
    pub number: &'a str,
}

/// Reads a name such as `tour@1`; `None` for the name of a dataset, which has no `@`.
pub fn version(name: &str) -> Option<Version<'_>> {
    let (dataset, number) = name.rsplit_once('@')?;
    let is_number = !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then_some(Version { dataset, number })
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

fn unknown_job(client: &Client, id: &str) -> Result<Failure, Failure> {
    let newest = client.jobs(None, None, MOST_LISTED)?;
    let ids: Vec<String> = newest.iter().map(|job| job.id.clone()).collect();
    let shortened = shorten_ids(&ids.iter().map(String::as_str).collect::<Vec<_>>());
    let described: Vec<String> = newest
        .iter()
        .zip(shortened)
        .map(|(JobRow { dataset, state, .. }, id)| format!("{id} ({dataset}, {state})"))
        .collect();
    Ok(Unknown::new("job", "newest jobs", id).failure_with(&ids, &described))
}

fn unknown_version(client: &Client, dataset: &str, name: &str) -> Result<Failure, Failure> {
    let Some(versions) = client.versions(dataset)? else {
        return unknown_dataset(client, dataset);
    };
    let names: Vec<String> = versions.into_iter().map(|version| version.name).collect();
    Ok(Unknown::new("sealed version", "sealed versions", name).failure(&names))
}

fn unknown_dataset(client: &Client, name: &str) -> Result<Failure, Failure> {
    let names: Vec<String> = client
        .datasets()?
        .into_iter()
        .map(|dataset| dataset.name)
        .collect();
    Ok(Unknown::new("dataset", "datasets", name).failure(&names))
}

/// A name that the service does not have.
struct Unknown<'a> {
    kind: &'a str,
    plural: &'a str,
    name: &'a str,
}

impl<'a> Unknown<'a> {
    fn new(kind: &'a str, plural: &'a str, name: &'a str) -> Self {
        Self { kind, plural, name }
    }

    fn failure(&self, names: &[String]) -> Failure {
        self.failure_with(names, names)
    }

    /// The error, with the nearest of the known names; `described` is listed in their place.
    fn failure_with(&self, names: &[String], described: &[String]) -> Failure {
        let Self { kind, plural, name } = self;
        let near = spec::nearest(name, names);
        let near = near.map_or_else(String::new, |near| format!(" (did you mean `{near}`?)"));
        let mut message = format!("no {kind} `{name}`{near}");
        if described.is_empty() {
            message.push_str(&format!("; the service has no {kind} at all"));
        } else {
            let shown = &described[..described.len().min(MOST_LISTED)];
            message.push_str(&format!("; the {plural} are {}", shown.join(", ")));
            let more = described.len() - shown.len();
            if more > 0 {
                message.push_str(&format!(" and {more} more"));
            }
        }
        Failure::BadInput(message)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_as_short_as_they_can_be_told_apart() {
        let ids = [
            "job_0123456789abcdef",
            "job_0123456789abcd00",
            "job_9123456789abcd00",
        ];
        assert_eq!(
            shorten_ids(&ids),
            [
                "job_0123456789abcde",
                "job_0123456789abcd0",
                "job_9123456789abcd0"
            ]
        );
        assert_eq!(shorten_ids(&ids[..1]), ["job_0123456789ab"]);
        assert_eq!(shorten_ids(&[ids[0], ids[0]]), ["job_0123456789ab"; 2]);
        assert_eq!(shorten_id("job_äöüäöüäöüäöüäöü"), "job_äöüäöü");
        assert_eq!(
            shorten_id("job_aäöüäöüäöü"),
            "job_aäöüäöüäöü",
            "no whole characters"
        );
        assert!(shorten_ids(&[]).is_empty());
    }

    #[test]
    fn an_unknown_name_comes_with_the_nearest_one_and_a_short_list() {
        let wanted = Unknown::new("dataset", "datasets", "tuor");
        let mut names: Vec<String> = (0..10).map(|index| format!("bay-{index}")).collect();
        names[3] = "tour".to_owned();
        let message = wanted.failure(&names).to_string();
        assert!(
            message.starts_with("no dataset `tuor` (did you mean `tour`?); the datasets are bay-0, bay-1")
        );
        assert!(message.ends_with("bay-7 and 2 more"), "{message}");
        let message = wanted.failure(&[]).to_string();
        assert_eq!(message, "no dataset `tuor`; the service has no dataset at all");
    }
}

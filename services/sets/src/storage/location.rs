//! Locations of sets: a folder or a prefix of a bucket, as a user writes it.

use std::fmt;
use std::path::{Component, PathBuf};

use crate::error::SetError;

/// The location of a set.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Location {
    /// A folder of a file system that all workers share.
    Folder(PathBuf),
    /// A prefix of an S3 bucket.
    S3 {
        /// The bucket.
        bucket: String,
        /// Without slashes at its ends; empty for the whole bucket.
        prefix: String,
    },
}

impl Location {
    /// Reads `s3://bucket/prefix`, `file:///folder` or the path of a folder.
    ///
    /// # Errors
    /// [`SetError::Refused`] for another scheme, a missing bucket, and credentials in the URL, which would end up in logs.
    pub fn parse(text: &str) -> Result<Self, SetError> {
        let Some((scheme, rest)) = text.split_once("://") else {
            return Ok(Self::Folder(PathBuf::from(text)));
        };
        match scheme {
            "file" => Ok(Self::Folder(PathBuf::from(rest))),
            "s3" => Self::bucket(rest),
            other => Err(SetError::Refused(format!(
                "`{other}://` is no store; use s3://BUCKET/PREFIX or a folder"
            ))),
        }
    }

    /// Whether another location is this one or below it; never for a path with `..`.
    #[must_use]
    pub fn contains(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Folder(outer), Self::Folder(inner)) => {
                let climbs = inner.components().any(|part| part == Component::ParentDir);
                inner.starts_with(outer) && !climbs
            }
            (
                Self::S3 { bucket, prefix },
                Self::S3 {
                    bucket: other_bucket,
                    prefix: inner,
                },
            ) => {
                let rest = inner.strip_prefix(prefix.as_str());
                bucket == other_bucket
                    && (prefix.is_empty()
                        || rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/')))
                    && !inner.split('/').any(|part| part == "..")
            }
            _ => false,
        }
    }

    /// A place below this one.
    #[must_use]
    pub fn join(&self, name: &str) -> Self {
        match self {
            Self::Folder(path) => Self::Folder(path.join(name)),
            Self::S3 { bucket, prefix } => Self::S3 {
                bucket: bucket.clone(),
                prefix: format!("{prefix}/{name}").trim_start_matches('/').to_owned(),
            },
        }
    }

    /// The same place from every working folder.
    ///
    /// # Errors
    /// [`SetError::Machine`] if this process has no working folder.
    pub fn absolute(self) -> Result<Self, SetError> {
        match self {
            Self::Folder(path) => std::path::absolute(path)
                .map(Self::Folder)
                .map_err(|error| SetError::Machine(format!("no working folder: {error}"))),
            bucket @ Self::S3 { .. } => Ok(bucket),
        }
    }

    fn bucket(rest: &str) -> Result<Self, SetError> {
        let (bucket, prefix) = rest.split_once('/').unwrap_or((rest, ""));
        if bucket.contains('@') {
            return Err(SetError::Refused(
                "credentials do not belong into the URL; set AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY"
                    .to_owned(),
            ));
        }
        if bucket.is_empty() {
            return Err(SetError::Refused(
                "the URL names no bucket; use s3://BUCKET/PREFIX".to_owned(),
            ));
        }
        Ok(Self::S3 {
            bucket: bucket.to_owned(),
            prefix: prefix.trim_matches('/').to_owned(),
        })
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Folder(path) => path.display().fmt(f),
            Self::S3 { bucket, prefix } => write!(f, "s3://{bucket}/{prefix}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_and_buckets_are_told_apart() {
        let folder = |path: &str| Location::Folder(PathBuf::from(path));
        assert_eq!(Location::parse("sets/a").unwrap(), folder("sets/a"));
        assert_eq!(Location::parse("file:///mnt/a").unwrap(), folder("/mnt/a"));
        let bucket = Location::parse("s3://reef/sets/a/").unwrap();
        assert_eq!(bucket.to_string(), "s3://reef/sets/a");
        assert_eq!(Location::parse("s3://reef").unwrap().to_string(), "s3://reef/");
    }

    #[test]
    fn a_location_contains_what_lies_below_it_and_nothing_else() {
        let contains = |outer: &str, inner: &str| {
            let [outer, inner] = [outer, inner].map(|text| Location::parse(text).unwrap());
            outer.contains(&inner)
        };
        for (outer, inner) in [
            ("/mnt/sets", "/mnt/sets/a"),
            ("/mnt/sets", "file:///mnt/sets"),
            ("s3://reef", "s3://reef/a/b"),
            ("s3://reef/a", "s3://reef/a"),
            ("s3://reef/a", "s3://reef/a/b"),
        ] {
            assert!(contains(outer, inner), "{inner} in {outer}");
        }
        for (outer, inner) in [
            ("/mnt/sets", "/mnt/sets2"),
            ("/mnt/sets", "/mnt/sets/../other"),
            ("/mnt/sets", "s3://mnt/sets"),
            ("s3://reef/a", "s3://reef/ab"),
            ("s3://reef/a", "s3://other/a"),
            ("s3://reef/a", "s3://reef/a/../b"),
        ] {
            assert!(!contains(outer, inner), "{inner} in {outer}");
        }
    }

    #[test]
    fn a_url_that_names_no_store_is_refused_and_a_secret_in_it_is_not_repeated() {
        for text in ["gs://reef/a", "s3:///a", "s3://"] {
            assert!(
                matches!(Location::parse(text), Err(SetError::Refused(_))),
                "{text}"
            );
        }
        let refused = Location::parse("s3://id:hush@reef/a").unwrap_err().to_string();
        assert!(!refused.contains("hush"), "{refused}");
    }
}

//! Jobs of version 0.1 in older data folders and sets. Their images are listed and served, but cannot be rendered.

use serde_json::Value;

use crate::invalid::{FieldError, Invalid};

/// Error text for a job of version 0.1.
pub const EARLIER_VERSION: &str = "the job is of version 0.1, which this version cannot render; its images can be listed and read, or \
                                   rendered by version 0.1";

/// Whether this is the canonical text of a job of version 0.1. Later ones have `daylight`, or several sites with it.
#[must_use]
pub fn is_of_earlier_version(canonical: &str) -> bool {
    serde_json::from_str(canonical).is_ok_and(|job: Value| lacks_daylight(&job))
}

/// Rejects a stored job of version 0.1.
pub(crate) fn refuse_earlier_version(job: &Value) -> Result<(), Invalid> {
    match lacks_daylight(job) {
        true => Err(Invalid(vec![FieldError::new("", EARLIER_VERSION)])),
        false => Ok(()),
    }
}

fn lacks_daylight(job: &Value) -> bool {
    job.as_object().is_some_and(|fields| {
        ["daylight", "site"]
            .iter()
            .all(|later| !fields.contains_key(*later))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Job;
    use crate::vocabulary::Vocabulary;

    #[test]
    fn stored_jobs_of_version_0_1_are_refused_in_one_sentence() {
        let text = br#"{"scene":{"kind":"procedural","family":"shaft"},"metrics":[]}"#;
        let vocabulary = Vocabulary {
            families: vec!["shaft".to_owned()],
            ..Vocabulary::default()
        };
        let job = Job::parse(text, &vocabulary).unwrap();
        assert!(!is_of_earlier_version(job.canonical()));
        assert!(Job::from_canonical(job.canonical()).is_ok());
        let mut earlier: Value = serde_json::from_str(job.canonical()).unwrap();
        earlier.as_object_mut().unwrap().remove("daylight");
        assert!(is_of_earlier_version(&earlier.to_string()));
        let refused = Job::from_canonical(&earlier.to_string()).unwrap_err();
        assert!(refused.to_string().contains("version 0.1"), "{refused}");
    }
}

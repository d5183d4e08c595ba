//! The waters and styles that images show, with their sources and terms.

use std::collections::BTreeSet;

use cli::exit::Failure;
use cli::known::items;
use cli::remote::Remote;
use serde::Serialize;
use serde_json::Value;

/// The names that were met so far.
#[derive(Debug, Default)]
pub(super) struct Met {
    waters: BTreeSet<String>,
    styles: BTreeSet<String>,
}

/// Something that went into the images.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Origin {
    /// Such as `water jerlov-3C/williamson2022`.
    pub(super) name: String,
    pub(super) source: String,
    pub(super) licence: String,
}

impl Met {
    pub(super) fn add(&mut self, row: &Value) {
        let insert = |names: &mut BTreeSet<String>, column: &str| {
            if let Some(name) = row[column].as_str().filter(|name| !names.contains(*name)) {
                names.insert(name.to_owned());
            }
        };
        insert(&mut self.waters, "water.optics");
        insert(&mut self.styles, "water.style");
    }

    /// Asks the service for what is known of them.
    pub(super) fn origins(&self, remote: &Remote) -> Result<Vec<Origin>, Failure> {
        let mut origins = Vec::new();
        for (what, names, path) in [
            ("water", &self.waters, "/v1/waters"),
            ("style", &self.styles, "/v1/styles"),
        ] {
            if names.is_empty() {
                continue;
            }
            let listed = remote.get(path)?;
            origins.extend(names.iter().map(|name| origin(what, name, items(&listed))));
        }
        Ok(origins)
    }
}

fn origin(what: &str, name: &str, listed: &[Value]) -> Origin {
    let found = listed.iter().find(|entry| entry["name"] == *name);
    let text = |member: &str, or: &str| {
        let text = found.and_then(|entry| entry[member].as_str());
        text.filter(|text| !text.is_empty()).unwrap_or(or).to_owned()
    };
    Origin {
        name: format!("{what} {name}"),
        source: text("source", "given by the user in the job"),
        licence: text("licence", "unknown"),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn what_the_service_does_not_list_came_with_the_job() {
        let listed = [json!({"name": "muddy", "source": "a photo", "licence": "CC-BY-4.0"})];
        let known = origin("style", "muddy", &listed);
        assert_eq!(
            (known.source.as_str(), known.licence.as_str()),
            ("a photo", "CC-BY-4.0")
        );
        let own = origin("water", "quay", &listed);
        assert_eq!(
            (own.name.as_str(), own.licence.as_str()),
            ("water quay", "unknown")
        );
        assert!(own.source.contains("in the job"));
    }
}

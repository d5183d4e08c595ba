//! Sites: complete descriptions that a job can start from.

mod expand;
mod merge;

use serde_json::{Map, Value};

pub(crate) use expand::{NamedSite, OF_THE_JOB, Sites, insert_descriptions, split_site, take_names};

/// A built-in site.
#[derive(Debug, Clone, Copy)]
pub struct SitePreset {
    /// Name in jobs.
    pub name: &'static str,
    text: &'static str,
}

/// The built-in sites.
pub const SITES: [SitePreset; 7] = [
    SitePreset::new("harbour-wall", include_str!("../sites/harbour-wall.json")),
    SitePreset::new("lock-chamber", include_str!("../sites/lock-chamber.json")),
    SitePreset::new("pile-in-current", include_str!("../sites/pile-in-current.json")),
    SitePreset::new("pipeline", include_str!("../sites/pipeline.json")),
    SitePreset::new("shaft", include_str!("../sites/shaft.json")),
    SitePreset::new("tank", include_str!("../sites/tank.json")),
    SitePreset::new("paper", include_str!("../sites/paper.json")),
];

/// Keys of a site's file outside its description.
const COMMENTS: [&str; 2] = ["summary", "note"];

impl SitePreset {
    const fn new(name: &'static str, text: &'static str) -> Self {
        Self { name, text }
    }

    /// Returns the site of this name.
    #[must_use]
    pub fn find(name: &str) -> Option<&'static Self> {
        SITES.iter().find(|site| site.name == name)
    }

    /// One-line summary of the site.
    #[must_use]
    pub fn summary(&self) -> String {
        let file = self.file();
        file["summary"].as_str().unwrap_or_default().to_owned()
    }

    /// The description, with distributions.
    #[must_use]
    pub fn description(&self) -> Map<String, Value> {
        let mut fields = self.file();
        fields.retain(|key, _| !COMMENTS.contains(&key.as_str()));
        fields
    }

    fn file(&self) -> Map<String, Value> {
        serde_json::from_str(self.text).expect("the files of sites are JSON objects, a test reads them all")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_site_has_a_summary_a_note_and_no_field_of_the_job_as_a_whole() {
        for site in SITES {
            assert!(
                site.summary()
                    .ends_with(|letter: char| letter.is_ascii_alphanumeric())
            );
            assert!(site.file()["note"].is_string(), "{}", site.name);
            let fields = site.description();
            assert!(fields.contains_key("scene") && fields.contains_key("water"));
            for field in OF_THE_JOB {
                assert!(!fields.contains_key(field), "{}: {field}", site.name);
            }
        }
    }
}

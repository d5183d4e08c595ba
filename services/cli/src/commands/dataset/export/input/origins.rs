//! The waters and styles of the exported images, with their sources and terms.

use std::collections::BTreeSet;

use cli::exit::Failure;
use client::{Client, ImageRow, WaterView};
use serde::Serialize;
use style::ModelCard;

/// The names in the exported rows.
#[derive(Debug, Default)]
pub(crate) struct UsedNames {
    waters: BTreeSet<String>,
    styles: BTreeSet<String>,
}

/// A water or a style.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Origin {
    /// Such as `water jerlov-3C/williamson2022`.
    pub(crate) name: String,
    pub(crate) source: String,
    pub(crate) licence: String,
}

impl UsedNames {
    pub(crate) fn add(&mut self, row: &ImageRow) {
        for (names, column) in [
            (&mut self.waters, "water.optics"),
            (&mut self.styles, "water.style"),
        ] {
            if let Some(name) = row.text(column).filter(|name| !names.contains(*name)) {
                names.insert(name.to_owned());
            }
        }
    }

    /// The sources and terms of the waters and styles, from the lists of the service.
    pub(crate) fn origins(&self, client: &Client) -> Result<Vec<Origin>, Failure> {
        let mut origins = Vec::new();
        if !self.waters.is_empty() {
            let waters: Vec<WaterView> = client.list("/v1/waters")?;
            for name in &self.waters {
                let water = waters.iter().find(|water| water.name == *name);
                let terms = water.map(|water| (water.source.as_str(), water.licence.as_str()));
                origins.push(Origin::new(format!("water {name}"), terms));
            }
        }
        if !self.styles.is_empty() {
            let styles: Vec<ModelCard> = client.list("/v1/styles")?;
            for name in &self.styles {
                let style = styles.iter().find(|style| style.name == *name);
                let terms = style.map(|style| (style.source.as_str(), style.licence.as_str()));
                origins.push(Origin::new(format!("style {name}"), terms));
            }
        }
        Ok(origins)
    }
}

impl Origin {
    /// An origin by its source and licence, which are absent if the service does not list it.
    fn new(name: String, terms: Option<(&str, &str)>) -> Self {
        let (source, licence) = terms.unwrap_or_default();
        Self {
            name,
            source: text_or(source, "given by the user in the job"),
            licence: text_or(licence, "unknown"),
        }
    }
}

fn text_or(text: &str, missing: &str) -> String {
    if text.is_empty() { missing } else { text }.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unlisted_water_is_the_users_own() {
        let listed = Origin::new("style muddy".to_owned(), Some(("a photo", "CC-BY-4.0")));
        assert_eq!(
            (listed.source.as_str(), listed.licence.as_str()),
            ("a photo", "CC-BY-4.0")
        );
        let custom = Origin::new("water quay".to_owned(), None);
        assert_eq!(custom.licence, "unknown");
        assert!(custom.source.contains("in the job"));
    }
}

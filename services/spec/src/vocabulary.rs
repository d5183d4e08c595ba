//! The names that a description may use.

use std::collections::BTreeMap;

use serde_json::{Map, Value};

/// The names that a description may use. They come from the crates and folders that own them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Vocabulary {
    /// Families of procedural scenes.
    pub families: Vec<String>,
    /// Water presets, bare (`jerlov-3C`) or full (`jerlov-3C/williamson2022`) names.
    pub presets: Vec<String>,
    /// Presets that cannot be rendered, and why.
    pub unrenderable_presets: Vec<(String, String)>,
    /// Waters of the users' own: the fields of `water.optics` that stand for each name.
    pub waters: BTreeMap<String, Map<String, Value>>,
    /// Style models.
    pub styles: Vec<String>,
    /// Enhancement methods.
    pub enhancements: Vec<String>,
    /// Metrics, `name` or `name@profile`.
    pub metrics: Vec<String>,
    /// Whether `scene.kind` may be `files`.
    pub local: bool,
}

impl Vocabulary {
    /// The full name of a preset; `None` if it is not listed under its full, its bare or the written name.
    pub(crate) fn preset(&self, written: &str) -> Option<String> {
        let full = full_name(written);
        let listed = |name: &str| self.presets.iter().any(|preset| preset == name);
        (listed(written) || listed(&full) || listed(bare_name(&full)) && full_name(bare_name(&full)) == full)
            .then_some(full)
    }

    /// Why a preset, by its full name, cannot be rendered.
    pub(crate) fn why_unrenderable(&self, full: &str) -> Option<&str> {
        self.unrenderable_presets
            .iter()
            .find(|(name, _)| full_name(name) == full)
            .map(|(_, why)| why.as_str())
    }
}

/// `jerlov-3C` means the default source of that type.
fn full_name(written: &str) -> String {
    optics::preset::find(written).map_or_else(|| written.to_owned(), |preset| preset.name.to_owned())
}

fn bare_name(full: &str) -> &str {
    full.split_once('/').map_or(full, |(bare, _)| bare)
}

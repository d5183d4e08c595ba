//! The built-in entries of each list.

use camera::preset::{ASSUMPTIONS, CAMERAS, SENSORS, SensorPreset};
use catalogue::{JobState, columns_of_every_image};
use enhance::Method;
use quality::{MetricId, MetricInfo, Needs, Profile};
use renderer::vocabulary;
use scenes::SceneFamily;
use scenes::categories::{CATEGORIES, FINDINGS};
use spec::{JERLOV_TYPES, METRIC_NETWORK, SITES, table};
use style::{Library, ModelRole};

use super::entry::Entry;
use crate::http::problem::Slug;

fn entry(name: impl Into<String>, about: impl Into<String>) -> Entry {
    Entry {
        name: name.into(),
        number: None,
        unit: None,
        about: about.into(),
    }
}

pub(super) fn sites(_: &Library) -> Vec<Entry> {
    SITES
        .iter()
        .map(|site| entry(site.name, site.summary()))
        .collect()
}

pub(super) fn artifacts(library: &Library) -> Vec<Entry> {
    let kinds = vocabulary(library, false).artifacts();
    kinds
        .iter()
        .map(|kind| entry(kind.to_string(), kind.about()))
        .collect()
}

pub(super) fn metrics(library: &Library) -> Vec<Entry> {
    let networks = library.of_role(ModelRole::Metric).map(|model| {
        let name = format!("{METRIC_NETWORK}{}", model.name);
        entry(name, format!("network of the user; {}", model.card.source))
    });
    MetricId::all()
        .map(|id| entry(id.to_string(), describe_metric(id.info())))
        .chain(networks)
        .collect()
}

pub(super) fn describe_metric(info: &MetricInfo) -> String {
    let (least, most) = (*info.range.start(), *info.range.end());
    let range = if most.is_finite() {
        format!("; {least}..={most}")
    } else {
        String::new()
    };
    let needs = match info.needs {
        Needs::Nothing => String::new(),
        needs => format!("; needs {needs}"),
    };
    format!("{}{range}{needs}", info.about)
}

pub(super) fn profiles(_: &Library) -> Vec<Entry> {
    Profile::ALL
        .iter()
        .map(|profile| entry(profile.name(), profile.about()))
        .collect()
}

pub(super) fn enhancements(_: &Library) -> Vec<Entry> {
    let methods = enhance::METHODS.iter().filter_map(|name| Method::parse(name));
    methods
        .map(|method| {
            let about = format!("{}; {}", method.about(), method.against_published());
            entry(method.name(), about)
        })
        .collect()
}

pub(super) fn families(_: &Library) -> Vec<Entry> {
    let families = scenes::FAMILIES
        .iter()
        .filter_map(|name| SceneFamily::parse(name));
    families.map(|family| entry(family.name, family.about)).collect()
}

pub(super) fn categories(_: &Library) -> Vec<Entry> {
    CATEGORIES
        .iter()
        .map(|(category, name)| Entry {
            number: Some(*category as u8),
            ..entry(*name, category.about())
        })
        .collect()
}

pub(super) fn findings(_: &Library) -> Vec<Entry> {
    FINDINGS
        .iter()
        .map(|(finding, name)| Entry {
            number: Some(*finding as u8),
            ..entry(*name, finding.about())
        })
        .collect()
}

pub(super) fn fields(_: &Library) -> Vec<Entry> {
    table::rows()
        .into_iter()
        .map(|row| Entry {
            unit: row.unit.map(str::to_owned),
            ..entry(row.path.clone(), row.summary())
        })
        .collect()
}

pub(super) fn columns(library: &Library) -> Vec<Entry> {
    let columns = columns_of_every_image(&vocabulary(library, false).metrics);
    columns
        .into_iter()
        .map(|column| Entry {
            unit: column.unit,
            ..entry(column.name, column.kind)
        })
        .collect()
}

pub(super) fn states(_: &Library) -> Vec<Entry> {
    JobState::ALL
        .iter()
        .map(|(state, name)| entry(*name, state.about()))
        .collect()
}

pub(super) fn jerlov_types(_: &Library) -> Vec<Entry> {
    JERLOV_TYPES
        .iter()
        .map(|name| {
            let is_ocean = name.starts_with('I');
            entry(*name, if is_ocean { "open ocean" } else { "coastal" })
        })
        .collect()
}

pub(super) fn problems(_: &Library) -> Vec<Entry> {
    Slug::ALL
        .iter()
        .map(|slug| entry(slug.name(), slug.meaning()))
        .collect()
}

pub(super) fn cameras(_: &Library) -> Vec<Entry> {
    CAMERAS
        .iter()
        .map(|camera| entry(camera.name, format!("{}; {}", camera.about, camera.source)))
        .collect()
}

pub(super) fn sensors(_: &Library) -> Vec<Entry> {
    SENSORS
        .iter()
        .map(|sensor| entry(sensor.name, describe_sensor(sensor)))
        .collect()
}

pub(super) fn describe_sensor(sensor: &SensorPreset) -> String {
    let assumed = if sensor.is_assumed() {
        format!("; {ASSUMPTIONS}")
    } else {
        String::new()
    };
    format!("{}; {}{assumed}", sensor.about, sensor.source)
}

pub(super) fn waters(_: &Library) -> Vec<Entry> {
    let presets = optics::preset::presets().iter();
    presets
        .map(|preset| entry(preset.name.clone(), preset.source.clone()))
        .collect()
}

pub(super) fn styles(library: &Library) -> Vec<Entry> {
    library
        .models()
        .map(|model| {
            let source = &model.card.source;
            let about = match model.card.role {
                ModelRole::Style => source.clone(),
                role => format!("{}; {source}", role.name()),
            };
            entry(model.name.clone(), about)
        })
        .collect()
}

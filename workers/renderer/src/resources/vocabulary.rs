//! The names allowed in a description, collected from the crates that define them.

use quality::{MetricId, Needs};
use spec::{KnownNetwork, Vocabulary};
use style::{Library, ModelRole};

/// The vocabulary of this build with these style models. `local` allows scenes from local files.
#[must_use]
pub fn vocabulary(library: &Library, local: bool) -> Vocabulary {
    let presets = optics::preset::presets();
    let unrenderable = presets
        .iter()
        .filter_map(|preset| Some((preset.name.clone(), preset.unrenderable()?)));
    Vocabulary {
        families: owned(scenes::FAMILIES),
        presets: presets.iter().map(|preset| preset.name.clone()).collect(),
        unrenderable_presets: unrenderable.collect(),
        waters: Default::default(),
        collections: Default::default(),
        rules: optics::water::RULES,
        cameras: camera::preset::CAMERAS
            .iter()
            .map(|camera| camera.name.to_owned())
            .collect(),
        sensors: camera::preset::SENSORS
            .iter()
            .map(|sensor| sensor.name.to_owned())
            .collect(),
        camera_rules: camera::rules::RULES,
        styles: library
            .of_role(ModelRole::Style)
            .map(|model| model.name.clone())
            .collect(),
        enhancers: list_networks(library, ModelRole::Enhancer),
        metric_networks: list_networks(library, ModelRole::Metric),
        range_styles: library
            .of_role(ModelRole::Style)
            .filter(|model| model.card.takes_range)
            .map(|model| model.name.clone())
            .collect(),
        metrics: MetricId::all().map(|metric| metric.to_string()).collect(),
        path_metrics: MetricId::all()
            .filter(|metric| matches!(metric.info().needs, Needs::PreviousFrames(_)))
            .map(|metric| metric.to_string())
            .collect(),
        local,
    }
}

fn list_networks(library: &Library, role: ModelRole) -> Vec<KnownNetwork> {
    let networks = library.of_role(role).map(|model| KnownNetwork {
        name: model.name.clone(),
        digest: model.card.sha256.clone(),
        size: model.card.picture_input().size.fixed(),
    });
    networks.collect()
}

fn owned(names: &[&str]) -> Vec<String> {
    names.iter().map(ToString::to_string).collect()
}

//! Labels of a procedural frame after the water: boxes, categories, and how well each object can be seen.

use imaging::{Plane, Rgb};
use optics::chain::Layers;
use optics::setting::Setting;
use optics::{Visibility, visibility};
use scenes::labels::Instance;
use spec::{InstanceRecord, SceneRecord};

use super::light::Lit;
use super::scene::Prepared;

/// What the record says about the scene; none of a scene whose camera has no place in a world.
pub(crate) fn describe(
    prepared: &Prepared,
    setting: &Setting,
    lit: &Lit<'_>,
    layers: &Layers,
) -> Option<SceneRecord> {
    let pose = prepared.pose?;
    let camera = prepared.scene.intrinsics?;
    let instances = prepared.labels.as_ref().map(|labels| {
        let most = labels.instances.iter().map(|instance| instance.number).max();
        let ranges = medians(prepared, prepared.scene.range.as_ref(), most);
        let is_patchy = setting.patches.is_some();
        let paths = is_patchy.then(|| medians(prepared, lit.path.as_deref(), most));
        let one = |instance: &Instance| {
            let of = |medians: &[Option<f64>]| medians.get(usize::from(instance.number)).copied().flatten();
            let median_m = of(&ranges);
            let path_m = paths.as_deref().map_or(median_m, of);
            record(prepared, setting, &layers.scattered, instance, (median_m, path_m))
        };
        labels.instances.iter().map(one).collect::<Vec<_>>()
    });
    let scores = || {
        instances
            .iter()
            .flatten()
            .filter_map(|instance| instance.visibility)
    };
    let count = scores().count();
    Some(SceneRecord {
        world_from_camera: pose.world_from_camera(),
        intrinsics: camera,
        visible: instances
            .as_ref()
            .map(|all| all.iter().filter(|instance| instance.visible).count() as u64),
        least_visibility: scores().reduce(f64::min),
        mean_visibility: (count > 0).then(|| scores().sum::<f64>() / count as f64),
        instances,
    })
}

fn record(
    prepared: &Prepared,
    setting: &Setting,
    after: &Rgb<f32>,
    instance: &Instance,
    (median_m, path_m): (Option<f64>, Option<f64>),
) -> InstanceRecord {
    let Instance {
        number,
        category,
        bounds,
        pixels,
    } = *instance;
    let numbers = prepared.scene.instances.as_ref();
    let seen =
        numbers.and_then(|numbers| visibility(&prepared.scene.radiance, after, numbers, number, bounds));
    let attenuation = setting.attenuation();
    InstanceRecord {
        number,
        category: category.name().to_owned(),
        bounds,
        pixels: pixels as u64,
        range_m: median_m,
        transmittance: path_m.map(|metres| attenuation.map(|c| (-c * metres).exp())),
        contrast: seen.map(|seen| seen.after),
        visibility: seen.as_ref().and_then(Visibility::score),
        visible: seen.is_some_and(|seen| seen.is_visible()),
    }
}

/// The median over every instance of metres by pixel, by its number.
fn medians(prepared: &Prepared, metres: Option<&Plane<f32>>, most: Option<u16>) -> Vec<Option<f64>> {
    let (Some(range), Some(numbers), Some(most)) = (metres, &prepared.scene.instances, most) else {
        return Vec::new();
    };
    let mut found = vec![Vec::new(); usize::from(most) + 1];
    for (&metres, &number) in range.data().iter().zip(numbers.data()) {
        if !optics::range::is_hole(metres)
            && let Some(ranges) = found.get_mut(usize::from(number))
        {
            ranges.push(metres);
        }
    }
    let median = |mut ranges: Vec<f32>| {
        let middle = ranges.len() / 2;
        (!ranges.is_empty()).then(|| f64::from(*ranges.select_nth_unstable_by(middle, f32::total_cmp).1))
    };
    found.into_iter().map(median).collect()
}

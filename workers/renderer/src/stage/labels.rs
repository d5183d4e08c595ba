//! Labels of a procedural frame after the water: boxes, categories, and how well each object can be seen.

use imaging::Rgb;
use optics::chain::Layers;
use optics::water::Water;
use optics::{Visibility, visibility};
use scenes::labels::Instance;
use spec::{InstanceRecord, IntrinsicsRecord, SceneRecord};

use super::scene::Prepared;

/// What the record says about the scene; none of a scene whose camera has no place in a world.
pub(crate) fn describe(prepared: &Prepared, water: Option<&Water>, layers: &Layers) -> Option<SceneRecord> {
    let pose = prepared.pose?;
    let camera = prepared.scene.intrinsics?;
    let instances = prepared.labels.as_ref().map(|labels| {
        let ranges = ranges(
            prepared,
            labels.instances.iter().map(|instance| instance.number).max(),
        );
        let one = |instance: &Instance| {
            let median_m = ranges.get(usize::from(instance.number)).copied().flatten();
            record(prepared, water, &layers.scattered, instance, median_m)
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
        intrinsics: IntrinsicsRecord {
            focal_px: camera.focal_px,
            cx: camera.cx,
            cy: camera.cy,
        },
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
    water: Option<&Water>,
    after: &Rgb<f32>,
    instance: &Instance,
    median_m: Option<f64>,
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
    let attenuation = water.map_or([0.0; 3], Water::direct_attenuation);
    InstanceRecord {
        number,
        category: category.name().to_owned(),
        bounds,
        pixels: pixels as u64,
        range_m: median_m,
        transmittance: median_m.map(|metres| attenuation.map(|c| (-c * metres).exp())),
        contrast: seen.map(|seen| seen.after),
        visibility: seen.as_ref().and_then(Visibility::score),
        visible: seen.is_some_and(|seen| seen.is_visible()),
    }
}

/// The median range of every instance by its number.
fn ranges(prepared: &Prepared, most: Option<u16>) -> Vec<Option<f64>> {
    let scene = &prepared.scene;
    let (Some(range), Some(numbers), Some(most)) = (&scene.range, &scene.instances, most) else {
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

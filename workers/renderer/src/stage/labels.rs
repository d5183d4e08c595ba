//! Labels of a frame after the water: boxes, categories, and the visibility of each object.

use imaging::{Plane, Rgb};
use optics::chain::Layers;
use optics::visibility;
use scenes::Labels;
use scenes::categories::{CATEGORIES, Category};
use scenes::classes::UNLABELED;
use scenes::labels::Instance;
use spec::{InstanceRecord, SceneCategory, SceneRecord};

use crate::context::FrameContext;

/// Pixels with a lower transmittance in all channels count as water in `semantics.visible`.
const LEAST_TRANSMITTANCE: f32 = 0.02;

/// The semantic mask with invisible surfaces labeled as water.
pub(crate) fn visible_semantics(semantics: &Plane<u8>, transmittance: &Rgb<f32>) -> Plane<u8> {
    let [red, green, blue] = transmittance.planes().each_ref().map(Plane::data);
    let mut visible = semantics.clone();
    for (pixel, code) in visible.data_mut().iter_mut().enumerate() {
        if red[pixel].max(green[pixel]).max(blue[pixel]) < LEAST_TRANSMITTANCE {
            *code = Category::Background as u8;
        }
    }
    visible
}

/// The record of the scene; `None` if it has neither a camera pose nor labels.
pub(crate) fn describe(context: &FrameContext<'_>, layers: &Layers) -> Option<SceneRecord> {
    let (pose, labels) = (context.prepared.pose, context.labels());
    if pose.is_none() && labels.is_none() {
        return None;
    }
    let instances = labels.map(|labels| {
        let most = labels.instances.iter().map(|instance| instance.number).max();
        let ranges = medians(context, context.range(), most);
        let paths = match (&context.setting.patches, context.path()) {
            (Some(_), Some(path)) => medians(context, Some(&*context.view_labels(path)), most),
            _ => ranges.clone(),
        };
        let (clean, scattered) = (
            context.view(&context.prepared.scene.radiance),
            context.view(&layers.scattered),
        );
        let record = |instance: &Instance| {
            let number = usize::from(instance.number);
            let median = |medians: &[Option<f64>]| medians.get(number).copied().flatten();
            describe_instance(
                context,
                [&*clean, &*scattered],
                instance,
                median(&ranges),
                median(&paths),
            )
        };
        labels.instances.iter().map(record).collect::<Vec<_>>()
    });
    let all = || instances.iter().flatten();
    let scores: Vec<f64> = all().filter_map(|instance| instance.visibility).collect();
    let mean = scores.iter().sum::<f64>() / scores.len() as f64;
    let visible = all().filter(|instance| instance.visible).count() as u64;
    Some(SceneRecord {
        world_from_camera: pose.map(|pose| pose.world_from_camera()),
        intrinsics: context.intrinsics(),
        lens: context.lens(),
        categories: categories(context, labels),
        visible: instances.is_some().then_some(visible),
        least_visibility: scores.iter().copied().reduce(f64::min),
        mean_visibility: (!scores.is_empty()).then_some(mean),
        instances,
    })
}

/// The classes of an uploaded scene, and the class of unlabeled objects if there are any.
fn categories(context: &FrameContext<'_>, labels: Option<&Labels>) -> Option<Vec<SceneCategory>> {
    let (classes, labels) = (context.prepared.classes.as_ref()?, labels?);
    let (id, name) = UNLABELED;
    let unlabeled = labels.instances.iter().any(|instance| instance.class == id);
    let unlabeled = unlabeled.then(|| SceneCategory {
        id,
        name: name.to_owned(),
    });
    Some(classes.categories.iter().cloned().chain(unlabeled).collect())
}

/// Name of a class by its code.
fn class_name<'a>(context: &'a FrameContext<'_>, class: u8) -> &'a str {
    match &context.prepared.classes {
        Some(classes) => classes.name(class).unwrap_or(UNLABELED.1),
        None => CATEGORIES
            .get(usize::from(class))
            .map_or(UNLABELED.1, |(_, name)| name),
    }
}

fn describe_instance(
    context: &FrameContext<'_>,
    [clean, scattered]: [&Rgb<f32>; 2],
    instance: &Instance,
    range_m: Option<f64>,
    path_m: Option<f64>,
) -> InstanceRecord {
    let Instance {
        number,
        class,
        bounds,
        pixels,
        host,
    } = *instance;
    let seen = context
        .instances()
        .and_then(|numbers| visibility(clean, scattered, numbers, number, bounds));
    let attenuation = context.setting.attenuation();
    InstanceRecord {
        number,
        category: class_name(context, class).to_owned(),
        bounds,
        pixels: pixels as u64,
        host,
        range_m,
        transmittance: path_m.map(|meters| attenuation.map(|c| (-c * meters).exp())),
        contrast: seen.as_ref().map(|seen| seen.after),
        visibility: seen.as_ref().and_then(|seen| seen.score()),
        visible: seen.is_some_and(|seen| seen.is_visible()),
    }
}

/// Median of `meters` over the pixels of each instance, indexed by its number.
fn medians(context: &FrameContext<'_>, meters: Option<&Plane<f32>>, most: Option<u16>) -> Vec<Option<f64>> {
    let (Some(meters), Some(numbers), Some(most)) = (meters, context.instances(), most) else {
        return Vec::new();
    };
    let mut found = vec![Vec::new(); usize::from(most) + 1];
    for (&meters, &number) in meters.data().iter().zip(numbers.data()) {
        if !optics::range::is_hole(meters)
            && let Some(group) = found.get_mut(usize::from(number))
        {
            group.push(meters);
        }
    }
    let median = |mut group: Vec<f32>| {
        let middle = group.len() / 2;
        (!group.is_empty()).then(|| f64::from(*group.select_nth_unstable_by(middle, f32::total_cmp).1))
    };
    found.into_iter().map(median).collect()
}

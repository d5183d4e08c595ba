//! From the light of a moment to the exposed picture.

use std::borrow::Cow;

use ::camera::geometry::pupil_error_px;
use ::camera::vignette::FallOff;
use ::camera::{defocus, exposure, vignette};
use imaging::{Plane, Rgb};
use optics::plan::{StageId, Variant};
use optics::range::is_hole;
use serde_json::json;
use spec::{Exposure, Fidelity, FrameRecord, Port};

use super::{haze_before, reference};
use crate::context::FrameContext;
use crate::inputs::camera::Taking;

/// The light of a moment after port and lens: haze in linear light, geometry, defocus and the movement of a picture.
pub(crate) fn gather(context: &FrameContext<'_>, scattered: &Rgb<f32>) -> Rgb<f32> {
    let haze = haze_before(context.frame);
    let light = if haze.is_empty() {
        Cow::Borrowed(scattered)
    } else {
        Cow::Owned(optics::haze(scattered.clone(), &haze))
    };
    let Some(taking) = &context.taking else {
        return light.into_owned();
    };
    let mut picture = match &taking.sampling {
        None => light.into_owned(),
        Some(_) if context.runs_reference(StageId::Geometry) => reference::resample(taking, &light),
        Some(sampling) => sampling.picture(&light),
    };
    if let (Some(focus), Some(range)) = (taking.parts.focus, context.range()) {
        match context.plan.variant(StageId::Defocus) {
            Variant::Skip => {}
            Variant::Reference => picture = reference::blur(&picture, &focus, range),
            _ => picture = defocus::blur(&picture, &focus.radii(range)),
        }
    }
    match taking.shift_px {
        Some(shift) => shifted(&picture, shift),
        None => picture,
    }
}

/// Averages a picture over shifts from −1/2 to +1/2 of the vector, in steps of at most one pixel. Border pixels are repeated.
pub(super) fn shifted(picture: &Rgb<f32>, [across, down]: [f64; 2]) -> Rgb<f32> {
    let steps = across.hypot(down).ceil() as usize + 1;
    if steps == 1 {
        return picture.clone();
    }
    let planes = picture.planes().each_ref().map(|plane| {
        let mut sums = Plane::filled(plane.width(), plane.height(), 0.0f32);
        for step in 0..steps {
            let share = step as f64 / (steps - 1) as f64 - 0.5;
            add_moved(&mut sums, plane, share * across, share * down);
        }
        sums.map(|&sum| sum / steps as f32)
    });
    Rgb::new(planes).expect("three planes of one picture")
}

fn add_moved(sums: &mut Plane<f32>, plane: &Plane<f32>, across: f64, down: f64) {
    let (width, height) = plane.size();
    let inside = |i: f64, side: usize| (i.max(0.0) as usize).min(side - 1);
    let (x, y) = (across.floor(), down.floor());
    let (share_x, share_y) = ((across - x) as f32, (down - y) as f32);
    for j in 0..height {
        imaging::cancel::check();
        let row = |dy: f64| plane.row(inside(j as f64 + y + dy, height));
        let (upper, lower) = (row(0.0), row(1.0));
        for (i, sum) in sums.row_mut(j).iter_mut().enumerate() {
            let (left, right) = (inside(i as f64 + x, width), inside(i as f64 + x + 1.0, width));
            let upper = upper[left] + (upper[right] - upper[left]) * share_x;
            let lower = lower[left] + (lower[right] - lower[left]) * share_x;
            *sum += upper + (lower - upper) * share_y;
        }
    }
}

/// An exposed picture.
pub(crate) struct Exposed {
    pub(crate) picture: Rgb<f32>,
    /// The factor of the exposure.
    pub(crate) gain: f64,
}

/// Applies vignette and exposure and records their numbers. `lagging` is the factor of a sequence whose exposure lags.
pub(crate) fn expose(
    context: &FrameContext<'_>,
    mut picture: Rgb<f32>,
    lagging: Option<f64>,
    record: &mut FrameRecord,
) -> Exposed {
    let Some(taking) = &context.taking else {
        return Exposed { picture, gain: 1.0 };
    };
    let falloff = falloff(context);
    let is_reference = context.frame.fidelity == Fidelity::Reference;
    let gain = match (taking.parts.exposure, lagging) {
        (None, _) => 1.0,
        (Some(Exposure::Fixed(gain)), _) | (Some(Exposure::Auto(_)), Some(gain)) => gain,
        (Some(Exposure::Auto(metering)), None) if is_reference => {
            reference::metered(&picture, falloff, &metering)
        }
        (Some(Exposure::Auto(metering)), None) => exposure::metered(&picture, falloff, &metering),
    };
    describe(context, taking, gain, record);
    if is_reference {
        picture = reference::expose(&picture, falloff, gain);
    } else if falloff.is_some() || gain != 1.0 {
        vignette::expose(&mut picture, falloff, gain);
    }
    Exposed { picture, gain }
}

fn describe(context: &FrameContext<'_>, taking: &Taking, gain: f64, record: &mut FrameRecord) {
    let numbers = record.optics.entry("camera").or_insert_with(|| json!({}));
    numbers["exposure_gain"] = json!(gain);
    if let Some(lens) = context.lens() {
        numbers["lens"] = json!(lens);
    }
    if let Some(error) = port_error(context) {
        numbers["port_error_px"] = json!(error);
    }
    if let Some(focus) = taking.parts.focus {
        let radii = context.range().map(|range| focus.radii(range));
        let most = radii.map_or(0.0, |radii| radii.data().iter().copied().fold(0.0, f64::max));
        numbers["largest_blur_px"] = json!(most as f32);
        if most >= defocus::MOST_PX {
            let warning = format!("circles of confusion are cut at {} px", defocus::MOST_PX);
            record.warnings.push(warning);
        }
    }
}

/// Corner error of a flat port at the median range when its pupil is treated as one viewpoint, px.
fn port_error(context: &FrameContext<'_>) -> Option<f64> {
    let taking = context.taking.as_ref()?;
    let port = ::camera::preset::complete(&context.frame.camera).port?;
    let mut meters: Vec<f32> = context
        .range()?
        .data()
        .iter()
        .copied()
        .filter(|&z| !is_hole(z))
        .collect();
    if meters.is_empty() || !matches!(port, Port::Flat { .. }) {
        return None;
    }
    let middle = meters.len() / 2;
    let median = f64::from(*meters.select_nth_unstable_by(middle, f32::total_cmp).1);
    Some(pupil_error_px(
        &taking.parts.lens,
        &port,
        taking.parts.size,
        median,
    ))
    .filter(|error| *error > 0.0)
}

/// The fall-off, if the plan includes it.
pub(crate) fn falloff<'a>(context: &'a FrameContext<'_>) -> Option<&'a FallOff> {
    let falloff = context.taking.as_ref()?.parts.falloff.as_ref();
    falloff.filter(|_| !context.plan.variant(StageId::Vignette).is_skipped())
}

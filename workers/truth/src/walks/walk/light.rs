//! Light collected by a path.

use std::f64::consts::PI;

use imaging::rays::leaving;
use imaging::vector::DVec3;

use super::lamp_view::LampView;
use super::{ORDERS, Walk};
use crate::lamp::SphereLamp;
use crate::phase::versine;
use crate::scene::{Along, End, SegmentEnd};
use crate::sea::fresnel;

/// `1 − cos` of 2°, by which waves in light wind spread the sun under water. The phase function is averaged over this cone: toward a
/// point its forward peak has no bounded variance.
const SUN_VERSINE: f64 = 6.1e-4;

impl<const N: usize> Walk<'_, N> {
    /// Adds light of a scattering order, per channel, times the weight of the path.
    fn add(&mut self, order: usize, light: [f64; N]) {
        let sums = &mut self.orders[order.min(ORDERS - 1)];
        for i in 0..N {
            sums[i] += self.weight[i] * light[i];
        }
    }

    /// Adds the single scattering of every lamp into a segment, at one point each.
    pub(super) fn lamps_along(&mut self, along: Along, end: &End) {
        if !self.scatters() {
            return;
        }
        let scene = self.scene;
        for lamp in &scene.lamps {
            let unit = self.dice.next();
            let Some(view) = LampView::new(lamp, along, end.distance) else {
                continue;
            };
            if let Some(light) = self.lamp_along(lamp, &view, along, end.distance, unit) {
                self.add(self.order + 1, light);
            }
        }
    }

    fn lamp_along(
        &mut self,
        lamp: &SphereLamp,
        view: &LampView,
        along: Along,
        end: f64,
        unit: f64,
    ) -> Option<[f64; N]> {
        let Along { origin, direction } = along;
        let drawn = self.scene.phase.draw_angle(view.range, unit)?;
        let distance = view.distance(drawn.angle);
        if !(0.0..=end).contains(&distance) {
            return None;
        }
        let place = origin + direction * distance;
        let profile = lamp.profile((place + -lamp.place).normalized());
        if profile <= 0.0 {
            return None;
        }
        let (reach, toward) = self.unblocked(lamp, place, 0.0)?;
        let gap = reach.max(lamp.radius_m);
        let sine = (lamp.radius_m / gap).min(1.0);
        let cone = 1.0 - (1.0 - sine * sine).sqrt();
        let scattered = self.scene.phase.density_toward(versine(toward, direction), cone);
        let turbidity = &self.scene.turbidity;
        let meters = turbidity.meters(origin, direction, distance) + turbidity.meters(place, toward, gap);
        let stretch = view.stretch(distance) / drawn.density;
        let shape = turbidity.factor(place) * scattered * profile * stretch / (gap * gap);
        Some(self.channels.map(|channel| {
            let water = self.scene.water[channel];
            water.scattering * lamp.intensity[channel] * shape * (-water.attenuation() * meters).exp()
        }))
    }

    /// Distance and direction to a lamp if its sampled point is visible.
    fn unblocked(&mut self, lamp: &SphereLamp, place: DVec3, from: f64) -> Option<(f64, DVec3)> {
        let away = lamp.place + -place;
        let reach = away.length();
        if reach <= 0.0 {
            return None;
        }
        let toward = away * (1.0 / reach);
        let shift = if lamp.disc_m > 0.0 {
            sample_disc(toward, lamp.disc_m, self.dice.pair())
        } else {
            DVec3::from([0.0; 3])
        };
        let sought = away + shift;
        let distance = sought.length();
        let blocked = self
            .scene
            .is_blocked(place, sought * (1.0 / distance), from, distance);
        (!blocked).then_some((reach, toward))
    }

    /// Adds the light emitted by the end of a segment; `passes` is its transmittance.
    pub(super) fn add_end(&mut self, along: Along, end: &End, passes: [f64; N]) {
        let light = match &end.met {
            SegmentEnd::Nothing => return,
            SegmentEnd::Sea { cosine } => {
                let through = 1.0 - fresnel(*cosine);
                let sky = self.scene.sea.as_ref().map_or([0.0; 3], |sea| sea.sky);
                self.channels.map(|channel| through * sky[channel])
            }
            SegmentEnd::Surface { hit, material } => {
                let place = along.origin + along.direction * end.distance;
                let mut light = self.channels.map(|channel| material.emitted[channel]);
                if self
                    .channels
                    .iter()
                    .any(|&channel| material.reflectance[channel] > 0.0)
                {
                    let irradiance = self.irradiance(place, hit.normal);
                    for i in 0..N {
                        light[i] += material.reflectance[self.channels[i]] / PI * irradiance[i];
                    }
                }
                light
            }
        };
        let arrives: [f64; N] = std::array::from_fn(|i| light[i] * passes[i]);
        self.add(self.order, arrives);
    }

    /// The irradiance of a surface by lamps and sun.
    fn irradiance(&mut self, place: DVec3, normal: [f64; 3]) -> [f64; N] {
        let start = leaving(place.into(), normal);
        let (origin, normal) = (DVec3::from(start.origin), DVec3::from(normal));
        let mut sum = self
            .sun(origin, start.from)
            .map_or([0.0; N], |(light, direction)| {
                let facing = normal.dot(direction).max(0.0);
                light.map(|light| light * facing)
            });
        let scene = self.scene;
        for lamp in &scene.lamps {
            let Some((reach, toward)) = self.unblocked(lamp, origin, start.from) else {
                continue;
            };
            let gap = reach.max(lamp.radius_m);
            let facing = normal.dot(toward).max(0.0) * lamp.profile(-toward) / (gap * gap);
            let meters = self.scene.turbidity.meters(origin, toward, gap);
            for (sum, &channel) in sum.iter_mut().zip(&self.channels) {
                let passes = (-self.scene.water[channel].attenuation() * meters).exp();
                *sum += lamp.intensity[channel] * facing * passes;
            }
        }
        sum
    }

    /// Adds sunlight scattered by the water at a point towards the previous one.
    pub(super) fn sun_on_water(&mut self, place: DVec3, came: DVec3) {
        if let Some((light, direction)) = self.sun(place, 0.0) {
            let scattered = self
                .scene
                .phase
                .density_toward(versine(direction, came), SUN_VERSINE);
            self.add(self.order, light.map(|light| light * scattered));
        }
    }

    /// Irradiance of the sun perpendicular to its direction at a point, and that direction; `None` in shadow or without
    /// a sun.
    fn sun(&self, place: DVec3, from: f64) -> Option<([f64; N], DVec3)> {
        let sea = self.scene.sea.as_ref()?;
        let sun = sea.sun.as_ref()?;
        let distance = sea.distance(place, sun.direction)?;
        if self.scene.is_blocked(place, sun.direction, from, distance) {
            return None;
        }
        let meters = self.scene.turbidity.meters(place, sun.direction, distance);
        let light = self.channels.map(|channel| {
            sun.irradiance[channel] * (-self.scene.water[channel].attenuation() * meters).exp()
        });
        Some((light, sun.direction))
    }
}

/// A uniformly sampled point of a disc perpendicular to a unit vector.
fn sample_disc(toward: DVec3, radius: f64, [distance, azimuth]: [f64; 2]) -> DVec3 {
    // The axes of Duff et al. 2017.
    let [x, y, z]: [f64; 3] = toward.into();
    let sign = if z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    let first = DVec3::from([1.0 + sign * x * x * a, sign * b, -sign * x]);
    let second = DVec3::from([b, sign + y * y * a, -y]);
    let (sine, cosine) = (2.0 * PI * azimuth).sin_cos();
    (first * cosine + second * sine) * (radius * distance.sqrt())
}

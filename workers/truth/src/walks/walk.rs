//! One path from the camera to the light.

mod aim;
mod lamp_view;
mod light;

use imaging::random::Stream;
use imaging::rays::leaving;
use imaging::vector::DVec3;

use crate::dice::{Address, PathDice};
use crate::phase::{tilt, versine};
use crate::scene::{Along, End, SegmentEnd, TracedScene};
use crate::sea::fresnel;
use crate::water::WaterCoefficients;

/// Light is summed by scattering order: 0, 1, more.
pub const ORDERS: usize = 3;
/// Longer paths are cut and counted.
pub const MOST_SEGMENTS: usize = 2000;
/// Paths of smaller weight times importance undergo Russian roulette.
const LIGHT: f64 = 0.1;

/// Estimate of one path for the radiance of N channels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathTally<const N: usize> {
    /// By order of scattering.
    pub orders: [[f64; N]; ORDERS],
    /// Whether a limit ended it: its light is underestimated.
    pub is_cut: bool,
}

/// A path in progress. It is split at its first segment, whose end then contributes without noise.
/// With several channels, distances are sampled from a leading channel, and weights use the mean density of all (balance
/// heuristic, Veach 1995).
struct Walk<'s, const N: usize> {
    scene: &'s TracedScene<'s>,
    channels: [usize; N],
    /// Index of the channel that samples distances.
    leading: usize,
    /// Light of each channel over the mean density.
    weight: [f64; N],
    /// Density of each channel over the mean.
    density: [f64; N],
    /// Estimated light of the direction over that of one away from all sources. Directions toward a source are frequent because they are
    /// bright, so a small weight does not make them unimportant.
    importance: f64,
    order: usize,
    orders: [[f64; N]; ORDERS],
    dice: PathDice,
}

/// Sampled end of a segment.
enum WalkEvent {
    /// Scattering at this distance.
    Water(f64),
    /// The geometric end.
    End,
}

/// Probabilities of the branches of the first segment of a channel: both 0 without light.
#[derive(Debug, Clone, Copy)]
struct Branch {
    end: f64,
    water: f64,
}

impl Branch {
    /// In proportion to the light that passes and that does not, without branches that send no light on.
    fn new(passes: f64, sent_back: f64, albedo: f64) -> Self {
        let end = if sent_back > 0.0 { passes } else { 0.0 };
        let water = if albedo > 0.0 { 1.0 - passes } else { 0.0 };
        let whole = end + water;
        if whole <= 0.0 {
            return Self { end: 0.0, water: 0.0 };
        }
        Self {
            end: end / whole,
            water: water / whole,
        }
    }
}

impl TracedScene<'_> {
    /// Traces one path of one channel along a ray: an estimate of its radiance by scattering order.
    #[must_use]
    pub fn trace(&self, along: Along, stream: Stream, address: Address) -> PathTally<1> {
        let channel = (address.channel as usize).min(2);
        Walk::new(self, [channel], PathDice::new(stream, address)).run(along)
    }

    /// Traces one path for all channels: colors stay consistent, in a third of the time. For attenuations within a
    /// factor of 3 of each other.
    #[must_use]
    pub fn trace_shared(&self, along: Along, stream: Stream, address: Address) -> PathTally<3> {
        let address = Address {
            channel: 3,
            ..address
        };
        Walk::new(self, [0, 1, 2], PathDice::new(stream, address)).run(along)
    }
}

impl<'s, const N: usize> Walk<'s, N> {
    fn new(scene: &'s TracedScene<'s>, channels: [usize; N], mut dice: PathDice) -> Self {
        let leading = if N == 1 {
            0
        } else {
            (dice.next() * N as f64) as usize
        };
        Self {
            scene,
            channels,
            leading,
            weight: [1.0; N],
            density: [1.0; N],
            importance: 1.0,
            order: 0,
            orders: [[0.0; N]; ORDERS],
            dice,
        }
    }

    fn run(mut self, along: Along) -> PathTally<N> {
        let is_cut = self.follow(along);
        PathTally {
            orders: self.orders,
            is_cut,
        }
    }

    /// Follows the path to its end. Returns whether a limit ended it.
    fn follow(&mut self, mut along: Along) -> bool {
        let mut start = 0.0;
        for segment in 0..MOST_SEGMENTS {
            let end = self.scene.end(along, start);
            self.lamps_along(along, &end);
            let event = if segment == 0 {
                self.split(along, &end)
            } else {
                self.step(along, &end)
            };
            let next = match event {
                None => return false,
                Some(WalkEvent::Water(distance)) => self.scatter(along, distance),
                Some(WalkEvent::End) => self.reflect(along, &end),
            };
            let Some(next) = next.filter(|_| self.survives()) else {
                return false;
            };
            (along, start) = next;
            if self.dice.is_exhausted() {
                return true;
            }
        }
        true
    }

    /// The first segment: the end's emission without noise, then one branch.
    fn split(&mut self, along: Along, end: &End) -> Option<WalkEvent> {
        let passes = self.transmittance(along, end.distance);
        self.add_end(along, end, passes);
        let sent_back = self.sent_back(end);
        if !self.scene.turbidity.is_even() {
            let free = self.free_path(along, end.distance);
            if free < end.distance {
                self.pass(along, free, |_, water| [water.scattering, water.attenuation()]);
                return self.continues(WalkEvent::Water(free));
            }
            self.pass(along, end.distance, |i, _| [sent_back[i], 1.0]);
            return self.continues(WalkEvent::End);
        }
        let branches: [Branch; N] = std::array::from_fn(|i| {
            let water = self.scene.water[self.channels[i]];
            Branch::new(passes[i], sent_back[i], water.albedo())
        });
        let leading = branches[self.leading];
        if self.dice.next() < leading.end {
            self.weigh(|i, _| [sent_back[i] * passes[i], branches[i].end]);
            return self.continues(WalkEvent::End);
        }
        let unit = self.dice.next();
        let attenuation = self.scene.water[self.channels[self.leading]].attenuation();
        if leading.water <= 0.0 || attenuation <= 0.0 {
            return None;
        }
        let free = -(-unit * (1.0 - passes[self.leading])).ln_1p() / attenuation;
        let free = free.min(end.distance);
        self.weigh(|i, water| {
            let density = branches[i].water * water.attenuation() / (1.0 - passes[i]).max(f64::MIN_POSITIVE);
            let passes = (-water.attenuation() * free).exp();
            [water.scattering * passes, density * passes]
        });
        self.continues(WalkEvent::Water(free))
    }

    /// An event, unless no light is left.
    fn continues(&self, event: WalkEvent) -> Option<WalkEvent> {
        self.weight.iter().any(|&weight| weight > 0.0).then_some(event)
    }

    /// A later segment.
    fn step(&mut self, along: Along, end: &End) -> Option<WalkEvent> {
        let free = self.free_path(along, end.distance);
        if free < end.distance {
            self.pass(along, free, |_, water| [water.scattering, water.attenuation()]);
            return Some(WalkEvent::Water(free));
        }
        if matches!(end.met, SegmentEnd::Nothing) {
            return None;
        }
        self.pass(along, end.distance, |_, _| [1.0; 2]);
        self.add_end(along, end, [1.0; N]);
        let sent_back = self.sent_back(end);
        self.weight
            .iter_mut()
            .zip(sent_back)
            .for_each(|(weight, back)| *weight *= back);
        Some(WalkEvent::End)
    }

    /// Weights an event at a distance; `source` returns the factors of light and of density besides the transmittance, which both have.
    fn pass(&mut self, along: Along, distance: f64, source: impl Fn(usize, &WaterCoefficients) -> [f64; 2]) {
        if N == 1 {
            return self.weigh(source);
        }
        let passes = self.transmittance(along, distance);
        self.weigh(|i, water| source(i, water).map(|factor| factor * passes[i]));
    }

    /// Weights an event by the light and the density of each channel.
    fn weigh(&mut self, source: impl Fn(usize, &WaterCoefficients) -> [f64; 2]) {
        for (i, &channel) in self.channels.iter().enumerate() {
            let [light, density] = source(i, &self.scene.water[channel]);
            self.weight[i] *= light;
            self.density[i] *= density;
        }
        let mean = self.density.iter().sum::<f64>() / N as f64;
        let scale = if mean > 0.0 { 1.0 / mean } else { 0.0 };
        self.weight
            .iter_mut()
            .chain(&mut self.density)
            .for_each(|value| *value *= scale);
    }

    /// Transmittance of a part of a segment per channel.
    fn transmittance(&self, along: Along, distance: f64) -> [f64; N] {
        if distance == f64::INFINITY {
            return [0.0; N];
        }
        let meters = self
            .scene
            .turbidity
            .meters(along.origin, along.direction, distance);
        self.channels
            .map(|channel| (-self.scene.water[channel].attenuation() * meters).exp())
    }

    /// Samples the distance to the next event of the leading channel: by delta tracking in non-uniform water (Woodcock
    /// et al. 1965).
    fn free_path(&mut self, along: Along, end: f64) -> f64 {
        let attenuation = self.scene.water[self.channels[self.leading]].attenuation();
        if attenuation <= 0.0 {
            return f64::INFINITY;
        }
        let turbidity = &self.scene.turbidity;
        if turbidity.is_even() {
            return -(-self.dice.next()).ln_1p() / attenuation;
        }
        let most = turbidity.most();
        let mut distance = 0.0;
        while distance < end && !self.dice.is_exhausted() {
            distance -= (-self.dice.next()).ln_1p() / (attenuation * most);
            let place = along.origin + along.direction * distance;
            if distance < end && self.dice.next() * most < turbidity.factor(place) {
                return distance;
            }
        }
        f64::INFINITY
    }

    /// Reflectance at the end of a segment.
    fn sent_back(&self, end: &End) -> [f64; N] {
        match &end.met {
            SegmentEnd::Nothing => [0.0; N],
            SegmentEnd::Surface { material, .. } => {
                self.channels.map(|channel| material.reflectance[channel])
            }
            SegmentEnd::Sea { cosine } => [fresnel(*cosine); N],
        }
    }

    /// Continues after scattering in the water.
    fn scatter(&mut self, along: Along, distance: f64) -> Option<(Along, f64)> {
        self.order += 1;
        let place = along.origin + along.direction * distance;
        self.sun_on_water(place, along.direction);
        let phase = &self.scene.phase;
        let direction = match self.source_to_aim_at(place) {
            Some(toward) => phase.turn(toward, self.dice.pair()),
            None => phase.turn(along.direction, self.dice.pair()),
        };
        let wanted = phase.density(versine(along.direction, direction));
        self.weigh_aim(place, direction, wanted);
        let along = Along {
            origin: place,
            direction,
        };
        Some((along, 0.0))
    }

    /// Continues from the end of a segment.
    fn reflect(&mut self, along: Along, end: &End) -> Option<(Along, f64)> {
        let place = along.origin + along.direction * end.distance;
        match (&end.met, &self.scene.sea) {
            (SegmentEnd::Surface { hit, .. }, _) => {
                let normal = DVec3::from(hit.normal);
                let start = leaving(place.into(), hit.normal);
                let origin = DVec3::from(start.origin);
                let direction = match self.source_to_aim_at(origin) {
                    Some(toward) => self.scene.phase.turn(toward, self.dice.pair()),
                    None => {
                        let [height, azimuth] = self.dice.pair();
                        tilt(normal, 1.0 - (1.0 - height).sqrt(), azimuth)
                    }
                };
                let cosine = normal.dot(direction);
                self.weigh_aim(origin, direction, cosine.max(0.0) / std::f64::consts::PI);
                (cosine > 0.0).then_some((Along { origin, direction }, start.from))
            }
            (SegmentEnd::Sea { cosine }, Some(sea)) => {
                let direction = (along.direction + sea.up * (-2.0 * cosine)).normalized();
                let along = Along {
                    origin: place,
                    direction,
                };
                Some((along, 0.0))
            }
            _ => None,
        }
    }

    /// Roulette by weight and importance.
    fn survives(&mut self) -> bool {
        let most = self.weight.iter().copied().fold(0.0, f64::max) * self.importance;
        if most >= LIGHT {
            return true;
        }
        // A weight that is not a number ends the path, too.
        let lives = self.dice.next() * LIGHT < most;
        if !lives {
            return false;
        }
        self.weight.iter_mut().for_each(|weight| *weight *= LIGHT / most);
        true
    }
}

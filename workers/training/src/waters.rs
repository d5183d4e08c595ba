//! Style photos of our own: a scene under one of three waters, with everything that a camera sees there. No picture of
//! anybody else is needed to make a style.
//!
//! In linear light, for range Z in metres, x right and y down in 0..=1:
//!
//! ```text
//! E = exp(-Kd depth)      light = gain E / max E      veil = veil gain E tint / max (E tint)
//! Z' = Z scale (1 + t n1)      V = veil (1.25 - 0.7 y + 0.08 n2 + 0.5 t n1)      c = Kd ratio
//! I = 0.9 J light exp(-c Z') + V (1 - exp(-c Z'))
//! ```
//!
//! then `0.6 blur(s) + 0.4 blur(4 s)` for forward scatter, particles, encoding, and sensor noise `a sqrt(0.8 I + 0.2)`. J is
//! the scene in air, n1 and n2 are clouds of unit variance. Kd at about 610, 535 and 460 nm: Jerlov, Marine Optics, 2nd
//! ed. 1976, Table XXVII; the other numbers are chosen by eye.

mod particles;

use imaging::geometry::Intrinsics;
use imaging::random::Stream;
use imaging::{Plane, Rgb8, transfer};

use crate::blur::gaussian;
use crate::clouds::clouds;
use crate::loss::normals;
use crate::tensor::Tensor;

const WIDTH: usize = 640;
const HEIGHT: usize = 480;
/// Where nothing is met, in metres.
const FAR_M: f32 = 60.0;

/// A water to photograph.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaterLook {
    /// Its name.
    pub name: &'static str,
    /// Diffuse attenuation, 1/m.
    diffuse_attenuation: [f64; 3],
    /// Depth of the camera, m.
    depth_m: f64,
    /// Beam attenuation over diffuse attenuation.
    ratio: f64,
    tint: [f64; 3],
    veil_gain: f64,
    range_scale: f64,
    light_gain: f64,
    particles_per_mpx: f64,
    particle_colour: [f64; 3],
    turbidity: f64,
    floor: [f64; 3],
    blur_px: f64,
    noise: f64,
}

/// The three waters.
pub const LOOKS: [WaterLook; 3] = [
    WaterLook {
        name: "atlantic",
        // 0.55 II + 0.45 III
        diffuse_attenuation: [0.31465, 0.09875, 0.09245],
        depth_m: 9.0,
        ratio: 2.2,
        tint: [0.50, 0.52, 1.0],
        veil_gain: 0.22,
        range_scale: 3.4,
        light_gain: 1.3,
        particles_per_mpx: 1600.0,
        particle_colour: [0.65, 0.8, 0.95],
        turbidity: 0.12,
        floor: [0.36, 0.34, 0.30],
        blur_px: 1.6,
        noise: 0.0025,
    },
    WaterLook {
        name: "mediterranean",
        // IB
        diffuse_attenuation: [0.280, 0.063, 0.034],
        depth_m: 5.5,
        ratio: 2.0,
        tint: [0.50, 0.80, 1.0],
        veil_gain: 0.42,
        range_scale: 4.3,
        light_gain: 1.5,
        particles_per_mpx: 500.0,
        particle_colour: [0.85, 1.0, 1.0],
        turbidity: 0.05,
        floor: [0.85, 0.80, 0.66],
        blur_px: 1.1,
        noise: 0.0018,
    },
    WaterLook {
        name: "muddy",
        // 0.5 7C + 0.5 9C
        diffuse_attenuation: [0.5675, 0.59, 1.11],
        depth_m: 0.9,
        ratio: 1.15,
        tint: [0.80, 0.82, 1.05],
        veil_gain: 0.27,
        range_scale: 1.2,
        light_gain: 0.8,
        particles_per_mpx: 4200.0,
        particle_colour: [0.75, 0.68, 0.5],
        turbidity: 0.30,
        floor: [0.42, 0.34, 0.22],
        blur_px: 2.4,
        noise: 0.002,
    },
];

impl WaterLook {
    /// The water of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        LOOKS.iter().find(|look| look.name == name)
    }

    /// A photo, 640×480: a pure function of water and seed.
    #[must_use]
    pub fn photograph(&self, seed: u64) -> Rgb8 {
        let (mut light, range) = self.in_air(seed);
        let size = (WIDTH, HEIGHT);
        let mud = clouds(seed, "turbidity", size, 2.0, 4);
        let glow = clouds(seed, "glow", size, 1.0, 2);
        let (lit, veil) = self.lights();
        let mut veiled = light.like();
        for channel in 0..3 {
            let attenuation = (self.diffuse_attenuation[channel] * self.ratio) as f32;
            let turbidity = self.turbidity as f32;
            for at in 0..WIDTH * HEIGHT {
                let down = (at / WIDTH) as f32 / HEIGHT as f32;
                let bright = 1.25 - 0.7 * down + 0.08 * glow[at] + 0.5 * turbidity * mud[at];
                let veil = (veil[channel] as f32 * bright).max(0.0);
                let range = range[at] * self.range_scale as f32 * (1.0 + turbidity * mud[at]).max(0.0);
                let left = libm::expf(-attenuation * range);
                let direct = &mut light.plane_mut(channel)[at];
                *direct = 0.9 * *direct * lit[channel] as f32 * left + veil * (1.0 - left);
                veiled.plane_mut(channel)[at] = veil;
            }
        }
        self.scatter(&mut light);
        self.add_particles(&mut light, &veiled, seed);
        self.developed(&light, seed)
    }

    /// The scene in air, without green or blue paint and on this water's floor, and its range.
    fn in_air(&self, seed: u64) -> (Tensor<f32>, Vec<f32>) {
        let lens = Intrinsics::centered(0.6 * WIDTH as f64, WIDTH, HEIGHT);
        let scene =
            scenes::procedural("structure", seed, WIDTH, HEIGHT, lens).expect("a family that is there");
        let range = scene.range.map(Plane::into_data).unwrap_or_default();
        let far = |range: f32| {
            if range.is_finite() {
                range.min(FAR_M)
            } else {
                FAR_M
            }
        };
        let range: Vec<f32> = range.into_iter().map(far).collect();
        let instances = scene.instances.map(Plane::into_data).unwrap_or_default();
        let mut light = Tensor::zeros(3, HEIGHT, WIDTH);
        for at in 0..WIDTH * HEIGHT {
            let [r, g, b] = scene.radiance.planes().each_ref().map(|plane| plane.data()[at]);
            // Sunlight from above, where the scene has a lamp at the camera.
            let sun = (1.0 + 0.25 * range[at]).min(3.0);
            let mean = (r + g + b) / 3.0;
            let pixel = if instances.get(at) == Some(&1) {
                self.floor.map(|albedo| albedo as f32 / 0.33 * mean)
            } else {
                let cold = ((g.max(b) - r).max(0.0) / (mean + 0.02) * 3.0).min(1.0);
                let grey = [1.05 * mean, mean, 0.93 * mean];
                [0, 1, 2].map(|channel| [r, g, b][channel] * (1.0 - cold) + grey[channel] * cold)
            };
            for (channel, value) in pixel.into_iter().enumerate() {
                light.plane_mut(channel)[at] = (value * sun).min(1.2);
            }
        }
        (light, range)
    }

    /// Light on the scene, and light of the veil.
    fn lights(&self) -> ([f64; 3], [f64; 3]) {
        let left = self.diffuse_attenuation.map(|kd| libm::exp(-kd * self.depth_m));
        let veil = [0, 1, 2].map(|channel| left[channel] * self.tint[channel]);
        let scaled = |values: [f64; 3], gain: f64| {
            let largest = values.into_iter().fold(0.0, f64::max);
            values.map(|value| gain * value / largest)
        };
        (scaled(left, self.light_gain), scaled(veil, self.veil_gain))
    }

    fn scatter(&self, light: &mut Tensor<f32>) {
        let mut wide = light.clone();
        gaussian(light, self.blur_px);
        gaussian(&mut wide, 4.0 * self.blur_px);
        for (near, wide) in light.data.iter_mut().zip(&wide.data) {
            *near = 0.6 * *near + 0.4 * wide;
        }
    }

    fn add_particles(&self, light: &mut Tensor<f32>, veiled: &Tensor<f32>, seed: u64) {
        let count = self.particles_per_mpx * (WIDTH * HEIGHT) as f64 / 1e6;
        let snow = particles::draw(seed, count as u64, (WIDTH, HEIGHT));
        let brightest = veiled.data.iter().copied().fold(1e-6, f32::max);
        for channel in 0..3 {
            let gain = (self.particle_colour[channel] * self.veil_gain.max(0.35)) as f32;
            let veiled = veiled.plane(channel).iter().zip(&snow);
            for (light, (veil, snow)) in light.plane_mut(channel).iter_mut().zip(veiled) {
                *light += snow * gain * (0.35 + 0.65 * veil / brightest);
            }
        }
    }

    fn developed(&self, light: &Tensor<f32>, seed: u64) -> Rgb8 {
        let stream = Stream::stage(seed, "sensor");
        let mut noise = normals(&stream, 0);
        Rgb8::from_fn(WIDTH, HEIGHT, |x, y| {
            [0, 1, 2].map(|channel| {
                let linear = f64::from(light.row(channel, y)[x]).clamp(0.0, 1.0);
                let grain = self.noise * (0.8 * linear + 0.2).sqrt() * noise.next().unwrap_or_default();
                (255.0 * (transfer::encode(linear) + grain))
                    .round()
                    .clamp(0.0, 255.0) as u8
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(photo: &Rgb8) -> [f64; 3] {
        let count = (WIDTH * HEIGHT) as f64;
        [0, 1, 2].map(|channel| photo.pixels().map(|pixel| f64::from(pixel[channel])).sum::<f64>() / count)
    }

    #[test]
    fn the_waters_have_their_colours_and_the_seed_changes_the_photo() {
        let [atlantic, mediterranean, muddy] = LOOKS.map(|look| mean(&look.photograph(1)));
        assert!(atlantic[2] > atlantic[0] + 40.0, "blue: {atlantic:?}");
        assert!(
            mediterranean[1] > mediterranean[0] + 30.0,
            "cyan: {mediterranean:?}"
        );
        assert!(
            mediterranean[1] > atlantic[1] + 20.0,
            "brighter: {mediterranean:?}"
        );
        assert!(muddy[0] > muddy[2] - 5.0, "brown: {muddy:?}");
        let look = WaterLook::named("muddy").unwrap();
        assert_eq!(look.photograph(1), look.photograph(1));
        assert!(look.photograph(1) != look.photograph(2));
    }
}

//! Contributions of photons to cameras and walls.

use std::f64::consts::PI;

use super::bench::{AirlightLevels, Bench, Photon, Shone};
use super::disc::LookDisc;
use crate::estimate::{Level, level};

/// Sums of one batch.
#[derive(Debug, Clone)]
pub(super) struct PhotonTally {
    /// By look, wall and camera: single scattering, and all.
    airlight: Vec<[f64; 2]>,
    /// By wall and ring.
    walls: Vec<f64>,
}

impl PhotonTally {
    pub(super) fn new(bench: &Bench) -> Self {
        let (walls, cameras) = (bench.walls_m.len(), bench.cameras_m.len());
        Self {
            airlight: vec![[0.0; 2]; bench.looks_deg.len() * walls * cameras],
            walls: vec![0.0; walls * bench.rings_deg.len()],
        }
    }

    /// Adds a scattered photon to the walls that its next free path is the first to cross.
    pub(super) fn cross(&mut self, bench: &Bench, photon: &Photon, free: f64) {
        let end = photon.place.z + photon.direction.z * free;
        if photon.order == 0 || end <= photon.deepest {
            return;
        }
        for (number, &wall) in bench.walls_m.iter().enumerate() {
            if wall <= photon.deepest || wall > end {
                continue;
            }
            let distance = (wall - photon.place.z) / photon.direction.z;
            let position = photon.place + photon.direction * distance;
            let angle = position.x.hypot(position.y).atan2(wall).to_degrees();
            let ring = bench.rings_deg.partition_point(|&edge| edge <= angle);
            if let Some(sum) = self.walls.get_mut(number * bench.rings_deg.len() + ring)
                && ring < bench.rings_deg.len()
            {
                *sum += photon.weight * (-bench.water.absorption * distance).exp();
            }
        }
    }

    /// Adds the contribution of an event to the cameras.
    pub(super) fn join(&mut self, bench: &Bench, disc: &LookDisc, photon: &Photon) {
        let depth = photon.place.z;
        let radius = photon.place.x.hypot(photon.place.y);
        if depth <= 0.0 || radius <= 0.0 {
            return;
        }
        let outward = (photon.direction.x * photon.place.x + photon.direction.y * photon.place.y) / radius;
        for (number, look) in bench.looks_deg.iter().enumerate() {
            let (sin, cos) = look.to_radians().sin_cos();
            // The event on either side of the axis.
            for side in [1.0, -1.0] {
                let camera = side * radius - depth * sin / cos;
                if camera > 0.0 {
                    let cosine = -(side * outward * sin + photon.direction.z * cos);
                    let meters = depth / cos;
                    let light = photon.weight * (-bench.water.attenuation() * meters).exp()
                        / (2.0 * PI * radius * cos);
                    self.see(bench, number, camera, photon, light, || disc.mean(cosine));
                }
            }
        }
    }

    fn see(
        &mut self,
        bench: &Bench,
        look: usize,
        camera: f64,
        photon: &Photon,
        light: f64,
        phase: impl FnOnce() -> f64,
    ) {
        let cameras = bench.cameras_m.iter().enumerate();
        let Some((bin, [near, far])) = cameras
            .into_iter()
            .find(|(_, [near, far])| (*near..*far).contains(&camera))
        else {
            return;
        };
        let light = light * phase() / (far - near);
        for (wall, _) in bench
            .walls_m
            .iter()
            .enumerate()
            .filter(|(_, wall)| **wall > photon.deepest)
        {
            let place = (look * bench.walls_m.len() + wall) * bench.cameras_m.len() + bin;
            let [single, all] = &mut self.airlight[place];
            *all += light;
            if photon.order == 1 {
                *single += light;
            }
        }
    }

    /// Means over batches; `scale` converts the sum of a batch to light.
    pub(super) fn levels(bench: &Bench, batches: &[Self], scale: f64, photons: u64) -> Shone {
        let (walls, cameras, rings) = (bench.walls_m.len(), bench.cameras_m.len(), bench.rings_deg.len());
        let airlight = (0..bench.looks_deg.len() * walls * cameras).map(|place| {
            let [single, all] =
                [0, 1].map(|order: usize| batch_level(batches, |batch| scale * batch.airlight[place][order]));
            AirlightLevels { single, all }
        });
        let airlight: Vec<AirlightLevels> = airlight.collect();
        let scattered = (0..walls).map(|wall| {
            let rings = (0..rings).map(|ring| {
                let area = bench.ring_area(wall, ring);
                batch_level(batches, |batch| scale * (batch.walls[wall * rings + ring] / area))
            });
            rings.collect()
        });
        Shone {
            airlight: (0..bench.looks_deg.len())
                .map(|look| {
                    let rows = airlight[look * walls * cameras..].chunks(cameras.max(1));
                    rows.take(walls).map(<[AirlightLevels]>::to_vec).collect()
                })
                .collect(),
            scattered: scattered.collect(),
            photons,
        }
    }
}

impl Bench {
    /// Inner and outer radius of a ring on a wall, m.
    #[must_use]
    pub fn ring_m(&self, wall: usize, ring: usize) -> [f64; 2] {
        let [inner, outer] = [ring.saturating_sub(1), ring]
            .map(|ring| self.walls_m[wall] * self.rings_deg[ring].to_radians().tan());
        [if ring == 0 { 0.0 } else { inner }, outer]
    }

    fn ring_area(&self, wall: usize, ring: usize) -> f64 {
        let [inner, outer] = self.ring_m(wall, ring);
        PI * (outer * outer - inner * inner)
    }
}

fn batch_level(batches: &[PhotonTally], sum: impl Fn(&PhotonTally) -> f64) -> Level {
    let values: Vec<f64> = batches.iter().map(sum).collect();
    level(&values)
}

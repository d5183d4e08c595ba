//! The family `structure`: piles, braced legs, pipelines, plates and beams on a rippled seabed, as an inspection robot
//! meets them under a jetty or beside a platform.
//!
//! World: metres, z up, the seabed at z = 0. Surfaces are met exactly: range is the distance to the solid itself. Relief
//! (ripples, rust, pores, growth) turns normals and colours only and never moves a surface, as in a normal map. The picture
//! is in air, lit by a lamp at the camera and a soft light from above; it is linear and may exceed 1 close to the lamp.
//!
//! Instances: 0 where nothing is met, 1 the seabed, from 2 on the objects that are in view, numbered without gaps.

mod camera;
mod chance;
mod finish;
mod lanes;
mod layout;
mod noise;
mod shade;
mod solid;
mod vector;

use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb};

use crate::Scene;
use layout::Site;
use shade::Shader;
use solid::{Nearest, Rays};

/// The seabed ends here: beyond it nothing comes back to a lamp at the camera.
const FAR_M: f32 = 60.0;
/// Owner of rays that meet nothing, and of rays that meet the seabed.
const NOTHING: u16 = u16::MAX;
const SEABED: u16 = u16::MAX - 1;

/// Renders the scene of a seed: a pure function of its arguments.
#[must_use]
pub fn render(seed: u64, width: usize, height: usize, intrinsics: Intrinsics) -> Scene {
    let site = Site::of(seed, (width, height), &intrinsics);
    let shader = Shader::new(&site);
    let mut bands = [const { Vec::new() }; 3];
    let mut range = Vec::with_capacity(width * height);
    let mut instances = Vec::with_capacity(width * height);
    let (mut parameter, mut owner) = (vec![0.0f32; width], vec![NOTHING; width]);
    for y in 0..height {
        trace(&site, shader.frames(), y, &mut parameter, &mut owner);
        shader.row(y, &parameter, &owner, &mut bands);
        for x in 0..width {
            let length = site.camera.ray(x as f32, y as f32).length();
            range.push(parameter[x] * length);
            instances.push(match owner[x] {
                NOTHING => 0,
                SEABED => 1,
                solid => 2 + site.solids[usize::from(solid)].object,
            });
        }
    }
    renumber(&mut instances);
    let plane = |data| Plane::new(width, height, data).expect("one sample for each pixel");
    Scene {
        radiance: Rgb::new(bands.map(plane)).expect("three planes of one frame"),
        range: Some(plane(range)),
        instances: Some(Plane::new(width, height, instances).expect("one instance for each pixel")),
        intrinsics: Some(intrinsics),
    }
}

/// The nearest surface for every ray of a row: its parameter along the ray (infinite: none) and whose it is.
fn trace(site: &Site, frames: &[shade::Frame], y: usize, parameter: &mut [f32], owner: &mut [u16]) {
    let camera = &site.camera;
    for (x, (parameter, owner)) in parameter.iter_mut().zip(&mut *owner).enumerate() {
        let ray = camera.ray(x as f32, y as f32);
        let ground = -camera.eye.z / ray.z;
        let met = ray.z < 0.0 && ground * ray.length() < FAR_M;
        (*parameter, *owner) = if met {
            (ground, SEABED)
        } else {
            (f32::INFINITY, NOTHING)
        };
    }
    for (index, (solid, frame)) in site.solids.iter().zip(frames).enumerate() {
        let Some(columns) = frame.columns(y) else { continue };
        let rays = Rays {
            eye: camera.eye,
            first: camera.ray(columns.start as f32, y as f32),
            step: camera.across(),
        };
        let nearest = Nearest {
            parameter: &mut parameter[columns.clone()],
            owner: &mut owner[columns],
        };
        solid.meet(&rays, nearest, index as u16);
    }
}

/// Numbers the objects in view without gaps, in the order of their own numbers.
fn renumber(instances: &mut [u16]) {
    let mut seen: Vec<u16> = instances.iter().copied().filter(|&id| id > 1).collect();
    seen.sort_unstable();
    seen.dedup();
    for id in instances.iter_mut().filter(|id| **id > 1) {
        *id = 2 + seen.binary_search(id).unwrap_or(0) as u16;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(seed: u64, width: usize, height: usize) -> Scene {
        render(
            seed,
            width,
            height,
            Intrinsics::centred(0.6 * width as f64, width, height),
        )
    }

    #[test]
    fn every_size_gives_finite_light_that_is_never_negative() {
        for (width, height) in [(1, 1), (3, 2), (97, 61)] {
            for seed in 0..24 {
                let scene = scene(seed, width, height);
                assert_eq!(scene.radiance.size(), (width, height));
                assert!(
                    scene
                        .radiance
                        .planes()
                        .iter()
                        .flat_map(|p| p.data())
                        .all(|v| v.is_finite() && *v >= 0.0)
                );
            }
        }
    }

    #[test]
    fn the_same_seed_is_the_same_scene_and_another_one_is_not() {
        assert_eq!(scene(5, 64, 41), scene(5, 64, 41));
        assert_ne!(scene(5, 64, 41).radiance, scene(6, 64, 41).radiance);
    }

    #[test]
    fn instances_have_no_gaps_and_nothing_is_where_there_is_no_range() {
        for seed in 0..24 {
            let scene = scene(seed, 96, 62);
            let (instances, range) = (scene.instances.unwrap(), scene.range.unwrap());
            let most = *instances.data().iter().max().unwrap();
            assert!(most >= 2, "seed {seed} shows no structure");
            assert!((2..=most).all(|id| instances.data().contains(&id)), "seed {seed}");
            let agree = instances
                .data()
                .iter()
                .zip(range.data())
                .all(|(&id, z)| (id == 0) == z.is_infinite());
            assert!(agree, "seed {seed}");
        }
    }

    #[test]
    fn the_seabed_is_where_the_ray_crosses_it() {
        let intrinsics = Intrinsics::centred(40.0, 64, 48);
        let scene = render(3, 64, 48, intrinsics);
        let site = Site::of(3, (64, 48), &intrinsics);
        let (instances, range) = (scene.instances.unwrap(), scene.range.unwrap());
        let mut seen = 0;
        for y in 0..48 {
            for x in (0..64).filter(|&x| instances.at(x, y) == 1) {
                let ray = site.camera.ray(x as f32, y as f32);
                let point = site.camera.eye + ray.unit() * range.at(x, y);
                assert!(
                    point.z.abs() < 1e-3 * range.at(x, y),
                    "({x}, {y}): z = {}",
                    point.z
                );
                seen += 1;
            }
        }
        assert!(seen > 50);
    }
}

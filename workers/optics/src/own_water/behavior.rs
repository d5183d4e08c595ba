//! Requirements for pictures in any water, tested with every preset: independent channels, one meaning of a missing range, the two
//! ends of the range, and a seed of 0 that counts as a seed.

use crate::medium::Medium;
use imaging::random::Stream;
use imaging::{Plane, Rgb};
use spec::{ForwardScatter, Optics, ScatterModel};

use crate::chain;
use crate::preset::{Preset, all_known};
use crate::water::Water;

/// The tested function, replaceable by a broken one in a test.
#[derive(Clone, Copy)]
pub(super) struct Machine {
    /// The color of one pixel: request, radiance, range in meters.
    pub(super) pixel: fn(&Medium, [f64; 3], f64) -> Option<[f64; 3]>,
    /// A random value of a seed.
    pub(super) draw: fn(u64) -> u64,
}

/// The chain's reference and the stream of the stages.
pub(super) const OURS: Machine = Machine { pixel, draw };

const SCENE: [f64; 3] = [0.9, 0.4, 0.1];
/// Beyond the visibility range of any water: c of 0.01/m attenuates to e^-1000.
const FAR_M: f64 = 1e5;
const NEAR_M: f64 = 1e-3;
const RANGES_M: [f64; 7] = [NEAR_M, 0.1, 1.0, 3.0, 10.0, 100.0, FAR_M];
const SLACK: f64 = 1e-12;

fn pixel(request: &Medium, radiance: [f64; 3], range_m: f64) -> Option<[f64; 3]> {
    let water = Water::resolve(request, 1.0).ok()?;
    let scene = Rgb::from_fn(1, 1, |_, _| radiance);
    let layers = chain::water_reference(&scene, &Plane::from_fn(1, 1, |_, _| range_m), &water).ok()?;
    Some([0, 1, 2].map(|c| layers.scattered.planes()[c].data()[0]))
}

fn draw(seed: u64) -> u64 {
    Stream::stage(seed, "waters").bits(0, 0)
}

/// Defects of a picture with this preset; empty for a preset that cannot be rendered.
pub(super) fn test(preset: &Preset, machine: Machine) -> Vec<String> {
    let mut defects = Vec::new();
    let zero = (machine.draw)(0);
    if (machine.draw)(0) != zero || [1, 42, u64::MAX].iter().any(|&seed| (machine.draw)(seed) == zero) {
        defects.push("a seed of 0 is not a seed of its own".to_owned());
    }
    let Some(c) = all_known(preset.beam_attenuation) else {
        return defects;
    };
    let veil = preset.veiling_light.unwrap_or([0.05, 0.2, 0.3]);
    let see = |c: [f64; 3], veil: [f64; 3], range_m: f64| (machine.pixel)(&request(c, veil), SCENE, range_m);
    let Some(seen) = see(c, veil, 2.0) else {
        defects.push("no picture can be made with it".to_owned());
        return defects;
    };
    for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
        let mut other = c;
        other[channel] = 1.5 * other[channel] + 0.1;
        let moved = see(other, veil, 2.0).unwrap_or(seen);
        if (0..3).any(|i| (moved[i] != seen[i]) != (i == channel)) {
            defects.push(format!("another {name} attenuation does not change {name} alone"));
        }
    }
    let hole = see(c, veil, f64::NAN);
    if [0.0, -1.0, f64::INFINITY, 0.5 * NEAR_M]
        .iter()
        .any(|&range_m| see(c, veil, range_m) != hole)
    {
        defects.push("ranges that are none do not mean the same".to_owned());
    }
    let near = |a: Option<[f64; 3]>, b: [f64; 3], slack: f64| {
        a.is_some_and(|a| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= slack))
    };
    if c.iter().all(|&c| c > 1e-3) && !near(see(c, veil, FAR_M), veil, SLACK) {
        defects.push("far away it is not the veil".to_owned());
    }
    let thickest = c.iter().fold(0.0, |a, &b| f64::max(a, b));
    if !near(see(c, veil, NEAR_M), SCENE, 2.0 * thickest * NEAR_M + SLACK) {
        defects.push("close by it is not the scene".to_owned());
    }
    let black = |range_m| (machine.pixel)(&request(c, [0.0; 3]), [0.0, 0.0, 1.0], range_m);
    if RANGES_M
        .iter()
        .any(|&range_m| black(range_m).is_none_or(|seen| seen.iter().any(|&v| v < 0.0)))
    {
        defects.push("a picture falls below black".to_owned());
    }
    defects
}

fn request(c: [f64; 3], veil: [f64; 3]) -> Medium {
    Medium::from(Optics {
        beam_attenuation_per_m: Some(c),
        veiling_light: Some(veil),
        forward_scatter: Some(ForwardScatter::from(ScatterModel::None)),
        ..Optics::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset::presets;

    /// Every preset finds this fault of a machine, if it can be rendered.
    fn all_find(machine: Machine, words: &str) {
        for preset in presets()
            .iter()
            .filter(|p| all_known(p.beam_attenuation).is_some())
        {
            let found = test(preset, machine);
            assert!(
                found.iter().any(|what| what.contains(words)),
                "{}: {found:?}",
                preset.name
            );
        }
    }

    #[test]
    fn our_own_chain_has_no_defect_in_any_water() {
        for preset in presets() {
            assert_eq!(test(preset, OURS), [""; 0], "{}", preset.name);
        }
    }

    #[test]
    fn a_swap_of_red_and_blue_is_found() {
        let pixel: fn(&Medium, [f64; 3], f64) -> Option<[f64; 3]> = |request, radiance, range_m| {
            let mut swapped = request.clone();
            let beam = swapped.optics.beam_attenuation_per_m.as_mut();
            beam.expect("it is given").reverse();
            super::pixel(&swapped, radiance, range_m)
        };
        all_find(Machine { pixel, ..OURS }, "does not change red alone");
    }

    #[test]
    fn a_zero_that_means_near_is_found() {
        let pixel: fn(&Medium, [f64; 3], f64) -> Option<[f64; 3]> = |request, radiance, range_m| {
            if range_m == 0.0 {
                Some(radiance)
            } else {
                super::pixel(request, radiance, range_m)
            }
        };
        all_find(Machine { pixel, ..OURS }, "do not mean the same");
    }

    #[test]
    fn an_infinity_that_is_a_distance_of_its_own_is_found() {
        let pixel: fn(&Medium, [f64; 3], f64) -> Option<[f64; 3]> = |request, radiance, range_m| {
            super::pixel(request, radiance, if range_m.is_nan() { 2.0 } else { range_m })
        };
        all_find(Machine { pixel, ..OURS }, "do not mean the same");
    }

    #[test]
    fn a_veil_that_is_missing_and_a_scene_that_is_dimmed_are_found() {
        let dark: fn(&Medium, [f64; 3], f64) -> Option<[f64; 3]> = |request, radiance, range_m| {
            super::pixel(request, radiance, range_m.min(50.0)).map(|v| v.map(|v| 0.8 * v))
        };
        all_find(Machine { pixel: dark, ..OURS }, "close by it is not the scene");
        let blind: fn(&Medium, [f64; 3], f64) -> Option<[f64; 3]> = |request, radiance, range_m| {
            super::pixel(request, radiance, range_m).map(|v| v.map(|v| v + 1e-6 * range_m.clamp(0.0, 1e6)))
        };
        all_find(Machine { pixel: blind, ..OURS }, "far away it is not the veil");
    }

    #[test]
    fn light_below_black_is_found() {
        let pixel: fn(&Medium, [f64; 3], f64) -> Option<[f64; 3]> = |request, radiance, range_m| {
            super::pixel(request, radiance, range_m).map(|v| v.map(|v| v - 1e-9))
        };
        all_find(Machine { pixel, ..OURS }, "below black");
    }

    #[test]
    fn a_seed_of_zero_that_is_taken_for_none_is_found() {
        let machine = Machine {
            draw: |seed| super::draw(if seed == 0 { 42 } else { seed }),
            ..OURS
        };
        for preset in presets() {
            assert_eq!(
                test(preset, machine),
                ["a seed of 0 is not a seed of its own"],
                "{}",
                preset.name
            );
        }
    }
}

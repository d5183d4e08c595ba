//! Lower bounds on the time of a frame from the bytes it must move and the memory speed of this machine, and how often frames share
//! kernels.

use std::hint::black_box;

use imaging::Plane;
use imaging::random::Stream;
use optics::chain;
use optics::forward_scatter::KernelCache;
use optics::kernel::Transfer;
use optics::medium::Medium;
use optics::plan::{Plan, SceneBounds};
use optics::preset::presets;
use optics::water::Water;
use spec::{Fidelity, Optics};

use crate::chart::{standard_scenes, time, time_once};

/// Copies planes of this many samples on each of several threads, rotating through a dozen planes like a frame. Returns the mean
/// rate of a thread in GB/s, read and written.
#[must_use]
pub fn copy_gb_per_s(samples: usize, threads: usize) -> f64 {
    const PLANES: usize = 12;
    const ROUNDS: usize = 40;
    let work = || {
        let mut planes = vec![vec![1.0f32; samples]; PLANES];
        let mut round = || {
            for plane in 0..PLANES / 2 {
                let (from, to) = planes.split_at_mut(PLANES / 2);
                to[plane].copy_from_slice(&from[plane]);
            }
            black_box(&planes);
        };
        round();
        let ms = time_once(|| (0..ROUNDS).for_each(|_| round()));
        (ROUNDS * PLANES * samples * size_of::<f32>()) as f64 / ms / 1e6
    };
    let rates: Vec<f64> = std::thread::scope(|scope| {
        let handles: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        handles
            .into_iter()
            .filter_map(|handle| handle.join().ok())
            .collect()
    });
    rates.iter().sum::<f64>() / rates.len().max(1) as f64
}

/// Planes of f32 that a stage reads and writes at least. Each pass counts, assuming that the planes of a frame do not fit into the
/// cache of a core.
pub mod traffic {
    /// Radiance and range, read.
    pub const PLAN: f64 = 4.0;
    /// Radiance and range read, direct light, veil, spread light and image written, for each of three channels.
    pub const ATTENUATION: f64 = 18.0;
    /// Three planes read, three of bytes written.
    pub const ENCODE: f64 = 3.75;
    /// Three planes of bytes read.
    pub const METRICS: f64 = 0.75;
    /// Three planes of bytes read and about as many written.
    pub const FILES: f64 = 1.5;

    /// Forward scatter of a channel with `kernels` kernels, two in a complex plane: light and place read, the plane written, read
    /// and written by rows and by columns, then read with both transfer functions and added to the sum. The inverse transform runs
    /// once. Before the first transform, light and place are reordered.
    #[must_use]
    pub fn forward_scatter(kernels: usize) -> f64 {
        const PAIR: f64 = 2.0 + 2.0 + 8.0 + 2.0 + 2.0 + 2.0;
        const BACK: f64 = 3.0 + 8.0 + 3.0;
        const BEFORE: f64 = 6.0;
        if kernels == 0 {
            return 0.0;
        }
        PAIR * kernels.div_ceil(2) as f64 + BACK + BEFORE
    }
}

/// Usage of the kernel cache by a job.
#[derive(Debug, Clone, PartialEq)]
pub struct CacheUse {
    /// Name of the job.
    pub job: &'static str,
    /// Its frames.
    pub frames: usize,
    /// Transfer functions found in the cache.
    pub hits: u64,
    /// Transfer functions missing from the cache.
    pub misses: u64,
    /// Peak memory of the cache, bytes.
    pub bytes: usize,
    /// Median time of the water in a frame, ms.
    pub ms: f64,
}

/// Runs jobs of many frames through one cache: one water, random waters, and random waters and distances.
#[must_use]
pub fn cache_use((width, height): (usize, usize), frames: usize) -> Vec<CacheUse> {
    let jobs = ["one water", "random water", "random water and range"];
    let renderable = presets().iter().filter(|preset| preset.unrenderable().is_none());
    let names: Vec<&str> = renderable.map(|preset| preset.name.as_str()).collect();
    let run = |(number, job): (usize, &'static str)| {
        let scene = &standard_scenes(width, height)[1];
        let stream = Stream::stage(2, "speed/cache");
        let mut cache = KernelCache::new();
        let (mut times, mut bytes) = (Vec::new(), 0);
        for frame in 0..frames {
            let unit = |what| stream.unit(frame as u64, what);
            let preset = match number {
                0 => "jerlov-1C",
                _ => names[((unit(0) * names.len() as f64) as usize).min(names.len() - 1)],
            };
            let scale = if number < 2 {
                1.0
            } else {
                0.2 * 10f64.powf(unit(1))
            };
            let Some(water) = at_scale(preset, scale, width) else {
                continue;
            };
            let range = &scene.range;
            let stats = SceneBounds::measure(&scene.radiance, range, &water);
            let plan = Plan::for_water(&stats, &water, Fidelity::Tolerance(3e-4));
            times.push(time_once(|| {
                render(&scene.radiance, range, &water, &plan, &mut cache)
            }));
            bytes = bytes.max(cache.bytes());
        }
        times.sort_by(f64::total_cmp);
        let (hits, misses) = cache.hits_and_misses();
        let ms = times.get(times.len() / 2).copied().unwrap_or(f64::NAN);
        CacheUse {
            job,
            frames,
            hits,
            misses,
            bytes,
            ms,
        }
    };
    jobs.into_iter().enumerate().map(run).collect()
}

fn render(
    radiance: &imaging::Rgb<f32>,
    range: &Plane<f32>,
    water: &Water,
    plan: &Plan,
    cache: &mut KernelCache,
) {
    if let Ok(layers) = chain::water(radiance, range, water, plan, cache) {
        cache.recycle(layers);
    }
}

fn at_scale(preset: &str, range_scale: f64, width: usize) -> Option<Water> {
    let request = Medium {
        range_scale,
        ..Optics {
            preset: Some(preset.to_owned()),
            ..Optics::default()
        }
        .into()
    };
    let focal_px = width as f64 / (2.0 * 40f64.to_radians().tan());
    Water::resolve(&request, focal_px).ok()
}

/// Milliseconds of a kernel missing from the cache, fastest of `runs`: narrow, middle and wide.
#[must_use]
pub fn miss_ms((width, height): (usize, usize), runs: usize) -> Vec<(f64, f64)> {
    let one = |gamma| {
        (
            gamma,
            time(runs, || Transfer::new(gamma).grid_f32(width, height)).0.min,
        )
    };
    [0.1, 1.0, 10.0].map(one).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_water_finds_its_kernels_and_random_ones_stay_within_the_memory() {
        let uses = cache_use((64, 40), 12);
        let rate = |u: &CacheUse| u.hits as f64 / (u.hits + u.misses) as f64;
        assert!(rate(&uses[0]) > 0.9, "{uses:?}");
        assert!(
            rate(&uses[0]) >= rate(&uses[2]) && uses.iter().all(|u| u.bytes > 0),
            "{uses:?}"
        );
    }

    #[test]
    fn more_kernels_move_more_and_a_copy_takes_time() {
        assert!(traffic::forward_scatter(0) == 0.0);
        assert!(traffic::forward_scatter(9) > traffic::forward_scatter(8));
        assert!(copy_gb_per_s(1 << 12, 2).is_finite());
    }
}

//! How often frames of a job share kernels, and the time of a kernel missing from the cache.

use imaging::random::Stream;
use optics::chain;
use optics::forward_scatter::KernelCache;
use optics::kernel::Transfer;
use optics::medium::Medium;
use optics::plan::{Plan, SceneBounds};
use optics::preset::presets;
use optics::water::Water;
use spec::{Fidelity, Optics};

use crate::chart::standard_scenes;
use crate::measurement::{time, time_once};
use crate::row;
use crate::statistics::median;
use crate::table::Table;

const SIZE: (usize, usize) = (768, 492);

/// Jobs of many frames of a slope from 1 to 15 m through one cache: one water, random waters, and random waters and distances.
pub(super) fn measure(frames: usize) -> [Table; 2] {
    let columns = [
        "job",
        "hits",
        "misses",
        "hit rate, %",
        "peak memory, MB",
        "water, ms",
    ];
    let mut table = Table::new("kernel cache", columns);
    for job in 0..3 {
        table.push(measure_job(job, frames, SIZE.0));
    }
    let mut misses = Table::new("misses", ["kernel scale, px", "ms"]);
    for gamma in [0.1, 1.0, 10.0] {
        let times = time(15, || Transfer::new(gamma).grid_f32(SIZE.0, SIZE.1)).0;
        misses.push(row![gamma, times.min]);
    }
    [table, misses]
}

fn measure_job(job: usize, frames: usize, width: usize) -> Vec<serde_json::Value> {
    let scene = &standard_scenes(width)[1];
    let focal_px = width as f64 / (2.0 * 40f64.to_radians().tan());
    let renderable = presets().iter().filter(|preset| preset.unrenderable().is_none());
    let names: Vec<&str> = renderable.map(|preset| preset.name.as_str()).collect();
    let stream = Stream::stage(2, "speed/cache");
    let mut cache = KernelCache::new();
    let (mut times, mut bytes) = (Vec::new(), 0);
    for frame in 0..frames as u64 {
        let preset = match job {
            0 => "jerlov-1C",
            _ => names[((stream.unit(frame, 0) * names.len() as f64) as usize).min(names.len() - 1)],
        };
        let range_scale = if job < 2 {
            1.0
        } else {
            0.2 * 10f64.powf(stream.unit(frame, 1))
        };
        let optics = Optics {
            preset: Some(preset.to_owned()),
            ..Optics::default()
        };
        let request = Medium {
            range_scale,
            ..optics.into()
        };
        let Ok(water) = Water::resolve(&request, focal_px) else {
            continue;
        };
        let stats = SceneBounds::measure(&scene.radiance, &scene.range, &water);
        let plan = Plan::for_water(&stats, &water, Fidelity::Tolerance(3e-4));
        times.push(time_once(|| {
            if let Ok(layers) = chain::water(&scene.radiance, &scene.range, &water, &plan, &mut cache) {
                cache.recycle(layers);
            }
        }));
        bytes = bytes.max(cache.bytes());
    }
    let (hits, misses) = cache.hits_and_misses();
    let rate = 100.0 * hits as f64 / (hits + misses).max(1) as f64;
    let name = ["one water", "random water", "random water and range"][job];
    row![name, hits, misses, rate, bytes as f64 / 1e6, median(times)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_water_finds_its_kernels_and_random_ones_stay_within_the_memory() {
        let [one, random] = [0, 2].map(|job| measure_job(job, 12, 64));
        let rate = |row: &[serde_json::Value]| row[3].as_f64().unwrap();
        assert!(
            rate(&one) > 90.0 && rate(&one) >= rate(&random),
            "{one:?} {random:?}"
        );
        assert!(random[4].as_f64().unwrap() > 0.0);
    }
}

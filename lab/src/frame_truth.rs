//! One round of a frame's truth on all cores. The result does not depend on how the pixels are divided among threads.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use truth::{PathBatch, PixelSums, TracedScene};

/// Pixels that a thread claims at a time.
const PIXELS: usize = 16;

/// Traces `samples` of the first `count` pixels on `threads` threads. `watch` receives the number of finished pixels.
///
/// # Panics
/// A path panics.
pub fn round(
    (shutter, scene): (&PathBatch, &TracedScene<'_>),
    count: usize,
    samples: &Range<u64>,
    threads: usize,
    watch: &mut dyn FnMut(usize),
) -> Vec<PixelSums> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let first = next.fetch_add(PIXELS, Ordering::Relaxed);
            if first >= count {
                return done;
            }
            let pixels = first..(first + PIXELS).min(count);
            done.push((first, shutter.trace(scene, pixels, samples)));
        }
    };
    let mut parts: Vec<(usize, Vec<PixelSums>)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.max(1)).map(|_| scope.spawn(work)).collect();
        while workers.iter().any(|worker| !worker.is_finished()) {
            std::thread::sleep(std::time::Duration::from_millis(20));
            watch(next.load(Ordering::Relaxed).min(count));
        }
        let finished = workers
            .into_iter()
            .map(|worker| worker.join().expect("a path does not panic"));
        finished.flatten().collect()
    });
    parts.sort_by_key(|(first, _)| *first);
    parts.into_iter().flat_map(|(_, pixels)| pixels).collect()
}

//! The truth of one frame of a job, on all cores: the pixels are divided among threads, and no bit depends on how.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use imaging::Rgb;
use renderer::WaterLight;
use spec::Frame;
use truth::{
    ChainLight, Goal, NoTruth, Phase, Pixel, Report, Scene, Screen, Shutter, Subject, Truth, converge,
};

/// Pixels that a thread takes at a time.
const PIXELS: usize = 16;

/// What is asked for.
#[derive(Debug, Clone, Copy)]
pub struct Asked {
    /// How well the frame must be known.
    pub goal: Goal,
    /// Seed of the paths.
    pub seed: u64,
    /// Whether a path serves all channels.
    pub is_shared: bool,
    /// Threads.
    pub threads: usize,
}

/// A frame's truth, and the chain held against it.
pub struct Found {
    /// The truth.
    pub truth: Truth,
    /// What it says of the chain.
    pub report: Report,
}

/// Why there is none.
#[derive(Debug, thiserror::Error)]
pub enum Without {
    /// The scene has no range, so nothing is at any distance.
    #[error("scene: it has no range, without which there is no water before it")]
    NoRange,
    /// The water is not known well enough.
    #[error(transparent)]
    Water(#[from] NoTruth),
    /// It was ended before the first paths.
    #[error("--budget-s: it is spent before the first paths")]
    Budget,
}

/// Traces a frame. `watch` hears what happens; a round begins only if it returns true.
///
/// # Errors
/// [`Without`].
pub fn trace(
    frame: &Frame,
    chain: &WaterLight,
    phase: Phase,
    asked: &Asked,
    watch: &mut dyn FnMut(Moment<'_>) -> bool,
) -> Result<Found, Without> {
    let range = chain.scene.range.as_ref().ok_or(Without::NoRange)?;
    let screen = Screen::new(range, chain.setting.eye.camera);
    let subject = Subject {
        frame,
        setting: &chain.setting,
        radiance: &chain.scene.radiance,
        range,
    };
    let scene = Scene::of_frame(&subject, &screen, phase)?;
    let size = chain.setting.size;
    let shutter = Shutter {
        camera: chain.setting.eye.camera,
        width: size.0,
        frame: frame.index,
        stream: truth::stream(asked.seed),
        is_shared: asked.is_shared,
    };
    let truth = converge(size, &asked.goal, |samples| {
        let begins = watch(Moment::Round(&samples));
        begins.then(|| round(&shutter, &scene, size.0 * size.1, &samples, asked.threads, watch))
    });
    let truth = truth.ok_or(Without::Budget)?;
    let scattered = match &chain.glow {
        None => chain.forward_scatter.clone(),
        Some(glow) => sum(&chain.forward_scatter, glow),
    };
    let light = ChainLight {
        direct: &chain.direct,
        scattered: &scattered,
    };
    let report = Report::new(&truth, &asked.goal, &light, Some(range));
    Ok(Found { truth, report })
}

/// What happens while a frame is traced.
pub enum Moment<'a> {
    /// A round of these samples of every pixel is about to begin.
    Round(&'a Range<u64>),
    /// As many pixels of the round are done.
    Done(usize),
}

/// One round: some samples of every pixel.
fn round(
    shutter: &Shutter,
    scene: &Scene<'_>,
    count: usize,
    samples: &Range<u64>,
    threads: usize,
    watch: &mut dyn FnMut(Moment<'_>) -> bool,
) -> Vec<Pixel> {
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
    let mut parts: Vec<(usize, Vec<Pixel>)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.max(1)).map(|_| scope.spawn(work)).collect();
        while workers.iter().any(|worker| !worker.is_finished()) {
            std::thread::sleep(std::time::Duration::from_millis(20));
            watch(Moment::Done(next.load(Ordering::Relaxed).min(count)));
        }
        let finished = workers
            .into_iter()
            .map(|worker| worker.join().expect("a path does not panic"));
        finished.flatten().collect()
    });
    parts.sort_by_key(|(first, _)| *first);
    parts.into_iter().flat_map(|(_, pixels)| pixels).collect()
}

fn sum(a: &Rgb<f32>, b: &Rgb<f32>) -> Rgb<f32> {
    Rgb::from_fn(a.width(), a.height(), |x, y| {
        [0, 1, 2].map(|i| a.planes()[i].pixel(x, y) + b.planes()[i].pixel(x, y))
    })
}

//! Time of a style network, and throughput of concurrent sessions.

use std::time::{Duration, Instant};

use imaging::Rgb;
use style::{ModelInputs, Session, StyleError};

use crate::measurement::time;

/// Measured frame sizes.
pub(super) const SIZES: [(usize, usize); 3] = [(640, 480), (869, 565), (1920, 1080)];
/// Concurrent sessions.
const SESSIONS: usize = 4;
/// How long the concurrent sessions run.
const SPAN: Duration = Duration::from_secs(3);

/// The speed of one network.
pub(super) struct Speed {
    /// Fastest run at each of [`SIZES`].
    pub(super) ms: [f64; 3],
    /// Frames of [`SESSIONS`] sessions at 640×480.
    pub(super) frames_per_s: f64,
}

impl Speed {
    /// Measures a network; `None` if it has no session.
    pub(super) fn measure(
        open: &dyn Fn() -> Option<Session>,
        runs: usize,
    ) -> Result<Option<Self>, StyleError> {
        let Some(mut session) = open() else {
            return Ok(None);
        };
        let mut ms = [0.0; 3];
        for (ms, size) in ms.iter_mut().zip(SIZES) {
            let frame = pattern(size);
            let (times, styled) = time(runs, || session.apply(&frame, ModelInputs::default()));
            styled?;
            *ms = times.min;
        }
        let sessions: Vec<Session> = (0..SESSIONS).filter_map(|_| open()).collect();
        let frames_per_s = run_together(sessions)?;
        Ok(Some(Self { ms, frames_per_s }))
    }
}

fn pattern((width, height): (usize, usize)) -> Rgb<f32> {
    Rgb::from_fn(width, height, |x, y| {
        let share = (x * y % 97) as f32 / 97.0;
        [x as f32 / width as f32, y as f32 / height as f32, share]
    })
}

/// Frames per second of concurrent sessions, each on a separate thread.
fn run_together(sessions: Vec<Session>) -> Result<f64, StyleError> {
    let (frame, start) = (pattern(SIZES[0]), Instant::now());
    let rates: Vec<Result<f64, StyleError>> = std::thread::scope(|scope| {
        let threads = sessions.into_iter().map(|mut session| {
            let frame = &frame;
            scope.spawn(move || {
                let mut frames = 0u32;
                while start.elapsed() < SPAN {
                    session.apply(frame, ModelInputs::default())?;
                    frames += 1;
                }
                Ok(f64::from(frames) / start.elapsed().as_secs_f64())
            })
        });
        let threads: Vec<_> = threads.collect();
        let threads = threads.into_iter();
        threads
            .map(|thread| thread.join().expect("a session does not panic"))
            .collect()
    });
    rates.into_iter().sum()
}

//! A preview of the style during training.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use anyhow::Context;
use cli::exit::Failure;
use cli::files;
use imaging::codec;
use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb, transfer};
use style::net::layer::Weights;
use style::net::{Network, Scratch};

/// Shortest time between two pictures; drawing one takes a few percent of it.
const INTERVAL: Duration = Duration::from_secs(2);
/// The scene, not used in training.
const SEED: u64 = 3;
const WIDTH: usize = 320;
const HEIGHT: usize = 240;

pub(super) struct Preview {
    file: PathBuf,
    /// In linear light.
    scene: Rgb<f32>,
    /// As networks that take the range have it.
    range: Option<Plane<f32>>,
    drawn: Instant,
}

impl Preview {
    pub(super) fn new(file: PathBuf) -> Result<Self, Failure> {
        let lens = Intrinsics::centered(0.6 * WIDTH as f64, WIDTH, HEIGHT);
        let scene =
            scenes::procedural("structure", SEED, WIDTH, HEIGHT, lens).context("cannot render a scene")?;
        Ok(Self {
            file,
            scene: scene.radiance,
            range: (scene.range).map(|range| optics::attenuation::faded(&range, style::RANGE_SCALE_M)),
            drawn: Instant::now(),
        })
    }

    /// Draws if the last picture is old enough. The training is not affected.
    pub(super) fn draw_at_times(&mut self, weights: &Weights) -> Result<(), Failure> {
        if self.drawn.elapsed() < INTERVAL {
            return Ok(());
        }
        self.draw(weights)
    }

    pub(super) fn draw(&mut self, weights: &Weights) -> Result<(), Failure> {
        let encoded = transfer::encode_unit(&self.scene);
        let styled = Network::new(weights).apply(&encoded, self.range.as_ref(), &mut Scratch::default());
        let (picture, _) = transfer::encode_rgb8(&optics::style_blend(&self.scene, &styled, 1.0));
        let bytes = codec::encode_png(&picture.into()).context("cannot encode the preview")?;
        files::write(&self.file, &bytes)?;
        self.drawn = Instant::now();
        Ok(())
    }
}

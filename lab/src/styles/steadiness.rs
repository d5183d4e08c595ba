//! Stability of one style network.

use imaging::Rgb;
use imaging::random::Stream;
use style::{ModelInputs, Session, StyleError};

use crate::statistics::{largest, mean};

/// Frame sizes that a model must accept, smallest to largest.
const SIZES: [(usize, usize); 8] = [
    (1, 1),
    (2, 3),
    (8, 8),
    (37, 3),
    (127, 131),
    (640, 480),
    (869, 565),
    (1920, 1080),
];
/// Noise on flat frames, in units of 1/255.
pub(super) const LEVELS: [f64; 6] = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0];
/// The level of the table.
const USUAL_LEVEL: usize = 2;
/// Moves of a frame, in pixels.
pub(super) const MOVES: [usize; 6] = [1, 2, 3, 5, 8, 13];
/// Side of the patch in a frame of [`AROUND`] for computing the Jacobian.
const PATCH: usize = 10;
const AROUND: usize = 40;
const STEP: f32 = 0.01;
const ITERATIONS: usize = 30;
/// Limits for our network: the gain, and the change of a pixel when the scene moves by one pixel, of 255.
pub(super) const GAIN_LIMIT: f64 = 0.6;
pub(super) const FLICKER_LIMIT: f64 = 0.5;
/// Border pixels excluded from the comparison, since shifted and cropped frames have other surroundings there.
const MARGIN: usize = 24;

/// Measurements of a model.
pub(super) struct Steadiness {
    pub(super) name: String,
    /// Root mean square change of the output over that of the input, by the noise on flat frames in units of 1/255.
    pub(super) gains: Vec<(f64, f64)>,
    /// Largest singular value of the Jacobian for moves within a patch.
    pub(super) singular: f64,
    /// Change of a pixel, of 255, by the move of the frame in pixels. The largest is another crop.
    pub(super) moves: Vec<(f64, f64)>,
    /// The outputs for black and for white.
    pub(super) black: [f32; 3],
    pub(super) white: [f32; 3],
    /// Frame sizes that make the model fail.
    pub(super) failed: Vec<(usize, usize)>,
}

/// A model that is run on single frames.
struct Network(Session);

impl Network {
    fn run(&mut self, frame: &Rgb<f32>) -> Result<Rgb<f32>, StyleError> {
        self.0.apply(frame, ModelInputs::default())
    }
}

impl Steadiness {
    /// Measures a model.
    pub(super) fn measure(name: &str, session: Session) -> Result<Self, StyleError> {
        let mut network = Network(session);
        let scenes = training::new_scenes();
        let lively: Vec<&Rgb<f32>> = scenes
            .iter()
            .filter(|scene| spread(scene) > 0.05)
            .take(6)
            .collect();
        let mut ends = [[0.0; 3]; 2];
        for (end, light) in ends.iter_mut().zip([0.0, 1.0]) {
            *end = network.run(&flat(light))?.pixel(32, 32);
        }
        let failed = SIZES.into_iter().filter(|&(width, height)| {
            let frame = Rgb::from_fn(width, height, |x, y| {
                [x as f32 / width as f32, y as f32 / height as f32, 0.5]
            });
            network
                .run(&frame)
                .map_or(true, |styled| styled.size() != (width, height))
        });
        let failed = failed.collect();
        Ok(Self {
            name: name.to_owned(),
            gains: measure_gains(&mut network)?,
            singular: measure_singular_value(&mut network, &crop(lively[0], 0, AROUND))?,
            moves: measure_moves(&mut network, &lively)?,
            black: ends[0],
            white: ends[1],
            failed,
        })
    }

    /// The gain at the usual level of noise.
    pub(super) fn gain(&self) -> f64 {
        self.gains[USUAL_LEVEL].1
    }
}

fn flat(light: f32) -> Rgb<f32> {
    Rgb::from_fn(64, 64, |_, _| [light; 3])
}

/// The worst gain of three flat frames at each level of noise.
fn measure_gains(network: &mut Network) -> Result<Vec<(f64, f64)>, StyleError> {
    let stream = Stream::stage(1, "stability noise");
    let mut gains = Vec::new();
    for level in LEVELS {
        let mut all = [0.0; 3];
        for (gain, light) in all.iter_mut().zip([0.2, 0.4, 0.6]) {
            let frame = flat(light);
            let noisy = Rgb::from_fn(64, 64, |x, y| {
                [0, 1, 2].map(|channel| {
                    // Uniform noise with this standard deviation.
                    let unit = stream.unit((y * 64 + x) as u64, channel) - 0.5;
                    light + (unit * level / 255.0 * 12.0f64.sqrt()) as f32
                })
            });
            *gain = distance(&network.run(&noisy)?, &network.run(&frame)?) / distance(&noisy, &frame);
        }
        gains.push((level, largest(all)));
    }
    Ok(gains)
}

fn measure_moves(network: &mut Network, scenes: &[&Rgb<f32>]) -> Result<Vec<(f64, f64)>, StyleError> {
    let mut squares = vec![Vec::new(); MOVES.len()];
    for scene in scenes {
        let side = scene.width() - 16;
        let inner = side - 2 * MARGIN;
        let base = crop(&network.run(&crop(scene, 0, side))?, MARGIN, inner);
        for (offset, squares) in MOVES.into_iter().zip(&mut squares) {
            let moved = network.run(&crop(scene, offset, side))?;
            squares.push(distance(&crop(&moved, MARGIN - offset, inner), &base).powi(2));
        }
    }
    let moves = MOVES.iter().zip(squares);
    Ok(moves
        .map(|(&offset, squares)| (offset as f64, 255.0 * mean(&squares).sqrt()))
        .collect())
}

/// Largest singular value of the map from the samples of a patch to the frame, by finite differences and power iteration: a lower
/// bound on that of the whole frame.
fn measure_singular_value(network: &mut Network, frame: &Rgb<f32>) -> Result<f64, StyleError> {
    let before = network.run(frame)?;
    let corner = (AROUND - PATCH) / 2;
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for index in 0..3 * PATCH * PATCH {
        let (channel, index) = (index / (PATCH * PATCH), index % (PATCH * PATCH));
        let mut moved = frame.clone();
        let place = (corner + index / PATCH) * AROUND + corner + index % PATCH;
        // Avoids black and white, where the network clamps.
        let sample = &mut moved.planes_mut()[channel][place];
        let step = if *sample > 0.5 { -STEP } else { STEP };
        *sample += step;
        let after = network.run(&moved)?;
        let pairs = pairs(&after, &before);
        columns.push(
            pairs
                .map(|(after, before)| f64::from((after - before) / step))
                .collect(),
        );
    }
    let mut input = vec![1.0 / (columns.len() as f64).sqrt(); columns.len()];
    let mut value = 0.0;
    for _ in 0..ITERATIONS {
        let mut output = vec![0.0; columns[0].len()];
        for (column, share) in columns.iter().zip(&input) {
            for (sum, entry) in output.iter_mut().zip(column) {
                *sum += entry * share;
            }
        }
        for (share, column) in input.iter_mut().zip(&columns) {
            *share = column.iter().zip(&output).map(|(a, b)| a * b).sum();
        }
        let length = input.iter().map(|v| v * v).sum::<f64>().sqrt().max(1e-300);
        input.iter_mut().for_each(|v| *v /= length);
        value = length.sqrt();
    }
    Ok(value)
}

/// A square from this offset in both directions.
fn crop(frame: &Rgb<f32>, offset: usize, side: usize) -> Rgb<f32> {
    Rgb::from_fn(side, side, |x, y| frame.pixel(offset + x, offset + y))
}

fn pairs<'a>(one: &'a Rgb<f32>, other: &'a Rgb<f32>) -> impl Iterator<Item = (f32, f32)> + 'a {
    let planes = one.planes().iter().zip(other.planes());
    planes.flat_map(|(one, other)| one.data().iter().copied().zip(other.data().iter().copied()))
}

/// Root mean square difference.
fn distance(one: &Rgb<f32>, other: &Rgb<f32>) -> f64 {
    let squares: f64 = pairs(one, other)
        .map(|(a, b)| f64::from(a - b) * f64::from(a - b))
        .sum();
    (squares / (3 * one.width() * one.height()) as f64).sqrt()
}

/// Standard deviation of green.
fn spread(frame: &Rgb<f32>) -> f64 {
    let data = frame.planes()[1].data();
    let mean = data.iter().sum::<f32>() / data.len() as f32;
    let squares: f64 = data
        .iter()
        .map(|v| f64::from(v - mean) * f64::from(v - mean))
        .sum();
    (squares / data.len() as f64).sqrt()
}

//! Stability of style models under noise, shifts, other crops and extreme sizes.

use std::fmt::Write as _;

use imaging::Rgb;
use imaging::random::Stream;
use lab::plot::{Axis, Form, Lines, Mark, Series};
use style::{Library, Runtime, Session, StyleError};

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
/// Standard deviation of the noise on flat frames in the table, in units of 1/255.
const NOISE: f64 = 1.0;
/// Noise on flat frames in the chart of the gain, in units of 1/255.
const LEVELS: [f64; 6] = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0];
/// Moves in the chart of the change of a pixel, in pixels.
const MOVES: [usize; 6] = [1, 2, 3, 5, 8, 13];
/// Side of the patch in a frame of [`AROUND`] for computing the Jacobian.
const PATCH: usize = 10;
const AROUND: usize = 40;
const MOVE: f32 = 0.01;
const ITERATIONS: usize = 30;
/// Limits for our network: the gain, and the change of a pixel when the scene moves by one pixel, of 255.
const GAIN_LIMIT: f64 = 0.6;
const FLICKER_LIMIT: f64 = 0.5;
/// Border pixels excluded from the comparison, since shifted and cropped frames have other surroundings there.
const MARGIN: usize = 24;

/// Measurements of a model.
pub(super) struct Steadiness {
    pub(super) name: String,
    /// Root mean square change of the output over that of the input, for noise on flat frames.
    pub(super) gain: f64,
    /// Largest singular value of the Jacobian for moves within a patch.
    pub(super) singular: f64,
    /// Change of a pixel when the scene moves by one pixel, of 255.
    pub(super) flicker_255: f64,
    /// Change of a pixel between two crops, of 255.
    pub(super) crop_255: f64,
    /// The gain over the noise, in units of 1/255.
    pub(super) gains: Vec<(f64, f64)>,
    /// The change of a pixel over the move, in pixels, of 255.
    pub(super) moves: Vec<(f64, f64)>,
    /// The outputs for black and for white.
    pub(super) black: [f32; 3],
    pub(super) white: [f32; 3],
    /// Frame sizes that make the model fail.
    pub(super) failed: Vec<(usize, usize)>,
}

/// Measures every model of a library and the control.
pub(super) fn measure(
    library: &Library,
    control: &style::StyleModel,
    runtime: &Runtime,
) -> Result<Vec<Steadiness>, StyleError> {
    let names = library.names();
    let models = names.iter().filter_map(|name| library.get(name));
    // The frames are pictures without a range.
    let models = models.filter(|model| !model.card.takes_range).chain([control]);
    models
        .map(|model| {
            let session = Session::native(model);
            let session = session.map_or_else(|| runtime.session(model), Ok)?;
            steadiness(&model.name, session)
        })
        .collect()
}

fn steadiness(name: &str, mut session: Session) -> Result<Steadiness, StyleError> {
    let mut run = |frame: &Rgb<f32>| session.apply(frame, style::ModelInputs::default());
    let scenes = training::new_scenes();
    let lively: Vec<&Rgb<f32>> = scenes
        .iter()
        .filter(|scene| spread(scene) > 0.05)
        .take(6)
        .collect();
    let flat = |light: f32| Rgb::from_fn(64, 64, |_, _| [light; 3]);
    let mut gains = Vec::new();
    for level in LEVELS {
        let mut gain = 0.0f64;
        for light in [0.2, 0.4, 0.6] {
            let frame = flat(light);
            let stream = Stream::stage(1, "stability noise");
            let noisy = Rgb::from_fn(64, 64, |x, y| {
                [0, 1, 2].map(|channel| {
                    // Uniform noise with this standard deviation.
                    let unit = stream.unit((y * 64 + x) as u64, channel) - 0.5;
                    light + (unit * level / 255.0 * 12.0f64.sqrt()) as f32
                })
            });
            gain = gain.max(distance(&run(&noisy)?, &run(&frame)?) / distance(&noisy, &frame));
        }
        gains.push((level, gain));
    }
    let mut changes = MOVES.map(|_| 0.0);
    for scene in &lively {
        let side = scene.width() - 16;
        let inner = side - 2 * MARGIN;
        let base = part(&run(&part(scene, (0, 0), side))?, (MARGIN, MARGIN), inner);
        for (at, sum) in MOVES.into_iter().zip(&mut changes) {
            let moved = run(&part(scene, (at, at), side))?;
            let same = part(&moved, (MARGIN - at, MARGIN - at), inner);
            let change = distance(&same, &base);
            *sum += change * change / lively.len() as f64;
        }
    }
    let singular = singular_value(&mut run, &part(lively[0], (0, 0), AROUND))?;
    let color = |frame: &Rgb<f32>| frame.pixel(32, 32);
    let (black, white) = (color(&run(&flat(0.0))?), color(&run(&flat(1.0))?));
    let mut fails = |&(width, height): &(usize, usize)| {
        let frame = Rgb::from_fn(width, height, |x, y| {
            [x as f32 / width as f32, y as f32 / height as f32, 0.5]
        });
        run(&frame).map_or(true, |styled| styled.size() != (width, height))
    };
    Ok(Steadiness {
        name: name.to_owned(),
        gain: gains
            .iter()
            .find(|(level, _)| *level == NOISE)
            .map_or(f64::NAN, |found| found.1),
        singular,
        flicker_255: 255.0 * changes[0].sqrt(),
        crop_255: 255.0 * changes[MOVES.len() - 1].sqrt(),
        gains,
        moves: MOVES
            .iter()
            .zip(changes)
            .map(|(&at, sum)| (at as f64, 255.0 * sum.sqrt()))
            .collect(),
        black,
        white,
        failed: SIZES.iter().copied().filter(|size| fails(size)).collect(),
    })
}

/// Largest singular value of the map from the samples of a patch to the frame, by finite differences and power iteration: a lower
/// bound on that of the whole frame.
fn singular_value(
    run: &mut impl FnMut(&Rgb<f32>) -> Result<Rgb<f32>, StyleError>,
    frame: &Rgb<f32>,
) -> Result<f64, StyleError> {
    let before = run(frame)?;
    let corner = (AROUND - PATCH) / 2;
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for channel in 0..3 {
        for at in 0..PATCH * PATCH {
            let mut moved = frame.clone();
            let place = (corner + at / PATCH) * AROUND + corner + at % PATCH;
            // Avoids black and white, where the network clamps.
            let sample = &mut moved.planes_mut()[channel][place];
            let step = if *sample > 0.5 { -MOVE } else { MOVE };
            *sample += step;
            let after = run(&moved)?;
            let pairs = after.planes().iter().zip(before.planes());
            let pairs = pairs.flat_map(|(after, before)| after.data().iter().zip(before.data()));
            columns.push(
                pairs
                    .map(|(after, before)| f64::from((after - before) / step))
                    .collect(),
            );
        }
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
        let back = columns
            .iter()
            .map(|column| column.iter().zip(&output).map(|(a, b)| a * b).sum::<f64>());
        input = back.collect();
        let length = input.iter().map(|v| v * v).sum::<f64>().sqrt().max(1e-300);
        input.iter_mut().for_each(|v| *v /= length);
        value = length.sqrt();
    }
    Ok(value)
}

fn part(frame: &Rgb<f32>, (left, top): (usize, usize), side: usize) -> Rgb<f32> {
    Rgb::from_fn(side, side, |x, y| frame.pixel(left + x, top + y))
}

/// Root mean square difference.
fn distance(one: &Rgb<f32>, other: &Rgb<f32>) -> f64 {
    let planes = one.planes().iter().zip(other.planes());
    let pairs = planes.flat_map(|(one, other)| one.data().iter().zip(other.data()));
    let squares: f64 = pairs.map(|(a, b)| f64::from(a - b) * f64::from(a - b)).sum();
    (squares / (3 * one.width() * one.height()) as f64).sqrt()
}

fn spread(frame: &Rgb<f32>) -> f64 {
    let data = frame.planes()[1].data();
    let mean = data.iter().sum::<f32>() / data.len() as f32;
    let squares: f64 = data
        .iter()
        .map(|v| f64::from(v - mean) * f64::from(v - mean))
        .sum();
    (squares / data.len() as f64).sqrt()
}

/// The gain over the noise, and the change of a pixel over the move, with the limits for our network.
pub(super) fn curves(found: &[Steadiness]) -> [(&'static str, Lines); 2] {
    let axis = |title: &str| Axis {
        title: title.to_owned(),
        logarithmic: true,
    };
    let series = |name: &str, points: &[(f64, f64)]| {
        // A logarithmic axis cannot show zero.
        let points = points.iter().filter(|(_, y)| *y > 0.0);
        let mark = |&(x, y): &(f64, f64)| Mark {
            x,
            y,
            label: String::new(),
            ringed: false,
            reach: None,
        };
        Series {
            name: name.to_owned(),
            marks: points.map(mark).collect(),
            form: if name == "limit" { Form::Line } else { Form::Joined },
        }
    };
    let ends = |xs: [f64; 2], limit: f64| xs.map(|x| (x, limit));
    let limit = |points: [(f64, f64); 2]| series("limit", &points);
    let mut gains: Vec<_> = found
        .iter()
        .map(|model| series(&model.name, &model.gains))
        .collect();
    gains.push(limit(ends([LEVELS[0], LEVELS[LEVELS.len() - 1]], GAIN_LIMIT)));
    let mut moves: Vec<_> = found
        .iter()
        .map(|model| series(&model.name, &model.moves))
        .collect();
    moves.push(limit(ends([1.0, 2.0], FLICKER_LIMIT)));
    [
        (
            "style-gain",
            Lines {
                title: "What becomes of noise on flat frames".to_owned(),
                x: axis("noise, 1/255"),
                y: axis("gain"),
                series: gains,
            },
        ),
        (
            "style-flicker",
            Lines {
                title: "Change of the same pixel when the frame moves".to_owned(),
                x: axis("move, pixels"),
                y: axis("root mean square change, of 255"),
                series: moves,
            },
        ),
    ]
}

/// The table of the documentation.
pub(super) fn markdown(found: &[Steadiness]) -> String {
    let mut text = String::from(
        "# Stability of the style models\n\nGain: root mean square change of the output over that of the input, for noise of 1/255 on flat \
         frames (the worst of three). Singular value: the largest of the Jacobian for moves within a patch of 10×10 pixels. Flicker: change \
         of a pixel when the scene moves by one pixel. Crop: change of the same pixel in another crop. Both are root mean \
         squares over six scenes, of 255, away from the border. `johnson` is the network of fast neural style with instance \
         normalization and random weights: a control for what its form does.\n\n\
         | model | gain | singular value | flicker | crop | black becomes | white becomes | fails at |\n|---|---|---|---|---|---|---|---|\n",
    );
    for model in found {
        let color = |[r, g, b]: [f32; 3]| format!("{r:.2} {g:.2} {b:.2}");
        let failed: Vec<String> = model.failed.iter().map(|(w, h)| format!("{w}×{h}")).collect();
        let failed = if failed.is_empty() {
            "none".to_owned()
        } else {
            failed.join(", ")
        };
        let (name, black, white) = (&model.name, color(model.black), color(model.white));
        let (gain, singular) = (model.gain, model.singular);
        let (flicker, crop) = (model.flicker_255, model.crop_255);
        let _ = writeln!(
            text,
            "| {name} | {gain:.2} | {singular:.2} | {flicker:.2} | {crop:.2} | {black} | {white} | {failed} |"
        );
    }
    text
}

//! The fast network, its f64 reference and ONNX Runtime on the exported file agree: weights × picture × size.

use imaging::random::Stream;
use imaging::{Plane, Rgb};
use style::net::layer::{COLOR, OUTPUT, RANGE_COLOR, Weights};
use style::net::{Network, Scratch, apply_reference, onnx};
use style::{Library, ModelInputs, Session};

use crate::{model_of, runtime};

/// A single pixel, single lines, sides below the reach of the filters, primes, odd and even sides.
const SIZES: [(usize, usize); 14] = [
    (1, 1),
    (2, 3),
    (1, 9),
    (9, 1),
    (4, 4),
    (5, 8),
    (8, 8),
    (13, 17),
    (16, 9),
    (31, 37),
    (65, 33),
    (97, 61),
    (127, 64),
    (129, 131),
];
/// Whole frames, which are too slow for the reference in every combination.
const FRAMES: [(usize, usize); 2] = [(640, 480), (768, 492)];

/// Rounding of f32: sums of up to 144 products of order 1, ten layers deep.
const FLOAT: f64 = 1e-5;

fn shipped() -> Vec<(String, Weights)> {
    let library = Library::embedded().unwrap();
    let weights = |name: &str| onnx::read(&library.get(name).unwrap().onnx).unwrap();
    let names = library.names().into_iter();
    names.map(|name| (name.to_owned(), weights(name))).collect()
}

/// The shipped networks and two random ones; the last has a range.
fn networks() -> Vec<(String, Weights)> {
    let mut networks = shipped();
    networks.push(("random".to_owned(), random(false)));
    networks.push(("random with range".to_owned(), random(true)));
    networks
}

/// A random network whose layers preserve the magnitude of the values.
fn random(takes_range: bool) -> Weights {
    let stream = Stream::stage(5, "agreement");
    let mut random = Weights::zeros(takes_range);
    for (index, &layer) in random.clone().layers().iter().enumerate() {
        let scale = 0.7 / (layer.fan_in() as f64).sqrt();
        let (weight, bias) = random.layer_mut(layer);
        // Biases keep every channel alive and the result between black and white.
        bias.fill(if layer == OUTPUT { 0.5 } else { 1.0 });
        let scale = if layer == OUTPUT { 0.1 * scale } else { scale };
        for (at, value) in weight.iter_mut().enumerate() {
            *value = ((stream.unit(index as u64, at as u64) - 0.5) * 2.0 * scale) as f32;
        }
    }
    for layer in [COLOR, RANGE_COLOR]
        .into_iter()
        .filter(|layer| takes_range || *layer == COLOR)
    {
        let (weight, bias) = random.layer_mut(layer);
        weight.iter_mut().chain(bias).for_each(|value| *value *= 0.1);
    }
    random
}

/// Ranges of a picture: from the camera to far away, with steps.
fn range(width: usize, height: usize) -> Plane<f32> {
    let stream = Stream::stage(7, "agreement");
    Plane::from_fn(width, height, |x, y| {
        stream.unit((y / 3) as u64, (x / 5) as u64) as f32
    })
}

/// A ramp, and noise as rough as possible.
fn pictures(width: usize, height: usize) -> [(&'static str, Rgb<f32>); 2] {
    let stream = Stream::stage(6, "agreement");
    let ramp = Rgb::from_fn(width, height, |x, y| {
        let (u, v) = (x as f32 / width as f32, y as f32 / height as f32);
        [u, 0.2 + 0.7 * v, 0.5 * (u + v)]
    });
    let noise = Rgb::from_fn(width, height, |x, y| {
        [0, 1, 2].map(|channel| stream.unit((y * width + x) as u64, channel) as f32)
    });
    [("ramp", ramp), ("noise", noise)]
}

fn largest_error<A: Copy + Into<f64>, B: Copy + Into<f64>>(one: &Rgb<A>, other: &Rgb<B>) -> f64 {
    assert_eq!(one.size(), other.size());
    let planes = one.planes().iter().zip(other.planes());
    let samples = planes.flat_map(|(one, other)| one.data().iter().zip(other.data()));
    let errors = samples.map(|(&a, &b)| (a.into() - b.into()).abs());
    errors.fold(0.0, |worst, error| if error <= worst { worst } else { error })
}

fn judge(weights: &Weights) -> Session {
    let model = model_of(&onnx::write(weights, &[]));
    runtime().session(&model).unwrap()
}

fn with_range(range: &Plane<f32>) -> ModelInputs<'_> {
    ModelInputs {
        noise: None,
        range: Some(range),
    }
}

#[test]
fn fast_reference_and_onnx_runtime_agree_at_every_size() {
    let mut failures = Vec::new();
    for (name, weights) in networks() {
        let (network, exact, mut judge) = (
            Network::new(&weights),
            weights.map(|&v| f64::from(v)),
            judge(&weights),
        );
        let mut scratch = Scratch::default();
        for (width, height) in SIZES {
            for (picture, frame) in pictures(width, height) {
                let range = range(width, height);
                let fast = network.apply(&frame, Some(&range), &mut scratch);
                let doubled = (frame.map(|&v| f64::from(v)), range.map(|&v| f64::from(v)));
                let reference = apply_reference(&exact, &doubled.0, Some(&doubled.1));
                let judged = judge.apply(&frame, with_range(&range)).unwrap();
                let errors = [
                    ("fast and reference", largest_error(&fast, &reference)),
                    ("fast and ONNX Runtime", largest_error(&fast, &judged)),
                    ("reference and ONNX Runtime", largest_error(&reference, &judged)),
                ];
                for (pair, error) in errors {
                    if error.is_nan() || error > FLOAT {
                        failures.push(format!(
                            "{name}, {picture}, {width}×{height}, {pair}: {error:.1e}"
                        ));
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn whole_frames_agree_with_onnx_runtime_and_one_with_the_reference() {
    for (name, weights) in networks() {
        let (network, mut judge) = (Network::new(&weights), judge(&weights));
        let mut scratch = Scratch::default();
        for (width, height) in FRAMES {
            for (picture, frame) in pictures(width, height) {
                let range = range(width, height);
                let fast = network.apply(&frame, Some(&range), &mut scratch);
                let error = largest_error(&fast, &judge.apply(&frame, with_range(&range)).unwrap());
                assert!(error <= FLOAT, "{name}, {picture}, {width}×{height}: {error:.1e}");
            }
        }
    }
    let (name, weights) = networks().pop().unwrap();
    let [_, (_, frame)] = pictures(640, 480);
    let range = range(640, 480);
    let fast = Network::new(&weights).apply(&frame, Some(&range), &mut Scratch::default());
    let doubled = (frame.map(|&v| f64::from(v)), range.map(|&v| f64::from(v)));
    let exact = apply_reference(&weights.map(|&v| f64::from(v)), &doubled.0, Some(&doubled.1));
    let error = largest_error(&fast, &exact);
    assert!(error <= FLOAT, "{name}: {error:.1e}");
}

#[test]
fn what_was_computed_before_changes_no_bit() {
    let (_, weights) = networks().pop().unwrap();
    let network = Network::new(&weights);
    let mut used = Scratch::default();
    for (width, height) in [(97, 61), (13, 17), (127, 64), (1, 1), (97, 61)] {
        let [_, (_, frame)] = pictures(width, height);
        let range = range(width, height);
        let first = network.apply(&frame, Some(&range), &mut Scratch::default());
        assert_eq!(
            network.apply(&frame, Some(&range), &mut used),
            first,
            "{width}×{height}"
        );
        let near = network.apply(&frame, None, &mut used);
        let zeros = Plane::filled(width, height, 0.0);
        assert_eq!(
            near,
            network.apply(&frame, Some(&zeros), &mut used),
            "{width}×{height}"
        );
    }
    let empty = Rgb::from_fn(0, 5, |_, _| [0.0f32; 3]);
    assert_eq!(network.apply(&empty, None, &mut used), empty);
}

/// A layer without effect could be wrong unnoticed. A few channels are dead behind their ReLU, as in any network.
#[test]
fn the_numbers_of_every_layer_count() {
    let (_, weights) = networks().pop().unwrap();
    let weights = weights.map(|&v| f64::from(v));
    let [_, (_, frame)] = pictures(24, 16);
    let frame = frame.map(|&v| f64::from(v));
    let range = range(24, 16).map(|&v| f64::from(v));
    let before = apply_reference(&weights, &frame, Some(&range));
    for &layer in weights.layers() {
        let length = layer.weights() + layer.outputs;
        let alive = (0..length).filter(|&at| {
            let mut changed = weights.clone();
            let (weight, bias) = changed.layer_mut(layer);
            *weight.iter_mut().chain(bias).nth(at).unwrap() += 0.1;
            largest_error(&before, &apply_reference(&changed, &frame, Some(&range))) > 0.0
        });
        let (alive, name) = (alive.count(), layer.name);
        assert!(4 * alive >= 3 * length, "{name}: {alive} of {length}");
    }
}

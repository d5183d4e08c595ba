//! A network with an input for noise gets standard normal samples of the job's seed and the frame.

use std::sync::Arc;

use imaging::codec::decode_picture;
use renderer::{Engine, SceneSource, Slot};
use serde_json::json;
use spec::Job;
use style::Library;

use crate::common::{Files, HEIGHT, WIDTH, file, installed_runtime};
use crate::onnx::{FLOAT, Graph};

/// Share of the picture in the output of the network; the rest is noise.
const EIGHT_NINTHS: f32 = 8.0 / 9.0;

/// `noisy`: eight parts picture and one part noise; `plain`: the picture. Both need ONNX Runtime.
fn library() -> Library {
    let graph = |inputs: &[(&str, u64, u64)], operands: &[usize]| {
        Graph {
            operator: "Mean",
            attribute: None,
            inputs,
            operands,
            output: "styled",
        }
        .bytes()
    };
    let (image, noise) = (("image", FLOAT, 3), ("noise", FLOAT, 1));
    let noisy = graph(&[image, noise], &[0, 0, 0, 0, 0, 0, 0, 0, 1]);
    let embedded = Library::embedded().unwrap();
    let library = embedded.with_model("noisy", noisy, None).unwrap();
    library.with_model("plain", graph(&[image], &[0]), None).unwrap()
}

/// A new engine, as another worker has.
fn engine() -> Arc<Engine> {
    Arc::new(Engine::new(library(), installed_runtime().as_deref()))
}

fn job(files: &Files, style: &str, seed: u64) -> Job {
    let fields = json!({"water": {"style": style}, "seed": seed, "count": 9});
    let vocabulary = renderer::vocabulary(&library(), true);
    Job::parse(files.description(&fields).to_string().as_bytes(), &vocabulary).unwrap()
}

/// The stored picture of a frame, and the names of its inputs.
fn rendered(engine: &Arc<Engine>, job: &Job, index: u64) -> (Vec<u8>, Vec<String>) {
    let frame = job.resolve(index).unwrap();
    let rendered = Slot::new(engine).render(&frame, &SceneSource::Local).unwrap();
    let inputs = rendered.record.provenance.inputs.keys().cloned().collect();
    (file(&rendered, "rgb").to_vec(), inputs)
}

#[test]
fn the_same_frame_has_the_same_noise_in_any_worker_and_another_seed_or_frame_has_another() {
    let (files, engines) = (Files::new(), [engine(), engine()]);
    let job = |seed| job(&files, "noisy", seed);
    let (base, inputs) = rendered(&engines[0], &job(4), 2);
    assert!(inputs.contains(&"style.noisy.noise".to_owned()), "{inputs:?}");
    // On another thread, after other frames.
    let again = std::thread::scope(|scope| {
        let work = scope.spawn(|| [5, 2].map(|index| rendered(&engines[1], &job(4), index).0));
        work.join().unwrap()
    });
    assert_eq!(again[1], base);
    assert!(again[0] != base && rendered(&engines[0], &job(5), 2).0 != base);
}

#[test]
fn a_network_without_the_input_is_fed_none() {
    let (files, engine) = (Files::new(), engine());
    for style in ["plain", "muddy"] {
        let (base, inputs) = rendered(&engine, &job(&files, style, 4), 2);
        assert!(inputs.contains(&format!("style.{style}")), "{inputs:?}");
        for (seed, index) in [(4, 3), (5, 2)] {
            assert_eq!(
                rendered(&engine, &job(&files, style, seed), index).0,
                base,
                "{style}"
            );
        }
    }
}

/// The noise recovered from the pictures equals `style::noise` of seed and frame, and is distributed as N(0, 1).
#[test]
fn the_noise_that_is_fed_is_standard_normal() {
    let (files, engine) = (Files::new(), engine());
    let (noisy, plain) = (job(&files, "noisy", 4), job(&files, "plain", 4));
    let blue = |job: &Job, index| -> Vec<f32> {
        let picture = decode_picture(&rendered(&engine, job, index).0)
            .unwrap()
            .to_rgb8();
        picture
            .pixels()
            .map(|[.., blue]| f32::from(blue) / 255.0)
            .collect()
    };
    // Both pictures are rounded to codes.
    let rounding = (0.5 + 0.5 * EIGHT_NINTHS) / 255.0 / (1.0 - EIGHT_NINTHS) + 1e-3;
    let mut samples = Vec::new();
    for index in 0..9 {
        let expected = style::noise(4, index, (WIDTH, HEIGHT));
        let pairs = blue(&noisy, index).into_iter().zip(blue(&plain, index));
        for ((noisy, plain), &expected) in pairs.zip(expected.data()) {
            let found = (noisy - EIGHT_NINTHS * plain) / (1.0 - EIGHT_NINTHS);
            assert!(
                noisy == 0.0 || (found - expected).abs() < rounding,
                "{found} {expected}"
            );
            samples.push(f64::from(found));
        }
    }
    let count = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / count;
    let spread = (samples.iter().map(|sample| (sample - mean).powi(2)).sum::<f64>() / count).sqrt();
    // Five standard errors of 13 824 samples, plus the loss by clipping to black below -2.8.
    assert!(
        mean.abs() < 0.045 && (spread - 1.0).abs() < 0.04,
        "{mean} {spread}"
    );
}

//! What a training promises: it learns, and its numbers depend on photo, seed and steps alone.

#![allow(clippy::unwrap_used)]

use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb, transfer};
use optics::chain;
use optics::water::Water;
use spec::{ForwardScatter, Optics, ScatterModel};
use style::net::{Network, Scratch};
use training::network::forward;
use training::tensor::Tensor;
use training::{Photo, Trainer, score};

/// A scene in murky water, softened by forward scatter as the photos of the waters are.
fn photo() -> Photo {
    let (width, height) = (240, 180);
    let lens = Intrinsics::centered(150.0, width, height);
    let scene = scenes::procedural("structure", 5, width, height, lens).unwrap();
    let optics = Optics {
        beam_attenuation_per_m: Some([0.8, 0.8, 1.5]),
        veiling_light: Some([0.25, 0.25, 0.2]),
        forward_scatter: Some(ForwardScatter {
            spread_px_per_m: Some([0.0; 3]),
            spread_offset_px: Some([2.4; 3]),
            ..ScatterModel::Simplified.into()
        }),
        ..Optics::default()
    };
    let water = Water::resolve(&optics.into(), 150.0).unwrap();
    let radiance = scene.radiance.map(|&light| f64::from(light));
    let range = scene.range.unwrap().map(|&range| f64::from(range));
    let layers = chain::water_reference(&radiance, &range, &water).unwrap();
    Photo::new(&transfer::encode_rgb8(&layers.scattered.map(|&light| light as f32)).0).unwrap()
}

fn trained(threads: usize, steps: usize) -> Vec<f32> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    pool.install(|| {
        let mut trainer = Trainer::new(&[photo()], 5, steps);
        while !trainer.is_done() {
            trainer.step();
        }
        trainer.best().weights.values().to_vec()
    })
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let alone = trained(1, 3);
    assert_eq!(trained(3, 3), alone);
    assert_eq!(trained(4, 3), alone);
}

#[test]
fn training_beats_the_color_transfer_it_starts_from() {
    let mut trainer = Trainer::new(&[photo()], 1, 60);
    let start = score(trainer.color_transfer(), &[photo()]);
    assert_eq!(start.branch, 0.0);
    while !trainer.is_done() {
        trainer.step();
    }
    let end = score(&trainer.best().weights, &[photo()]);
    assert!(
        end.losses.texture < 0.75 * start.losses.texture,
        "{start:?} {end:?}"
    );
    assert!(end.losses.total() < start.losses.total(), "{start:?} {end:?}");
    assert!(end.branch > 1.0, "{end:?}");
}

/// Training and rendering run the network by different code.
#[test]
fn training_sees_the_network_that_renders() {
    let mut trainer = Trainer::new(&[photo()], 2, 4);
    (0..4).for_each(|_| {
        trainer.step();
    });
    let weights = trainer.best().weights;
    let picture = Rgb::from_fn(53, 41, |x, y| [x as f32 / 53.0, y as f32 / 41.0, 0.3f32]);
    let mut image = Tensor::zeros(3, 41, 53);
    for (channel, plane) in picture.planes().iter().enumerate() {
        image.plane_mut(channel).copy_from_slice(plane.data());
    }
    let styled = forward(&weights, &image).styled;
    let rendered = Network::new(&weights).apply(&picture, &mut Scratch::default());
    let samples = rendered.planes().iter().flat_map(Plane::data);
    for (a, b) in styled.data.iter().zip(samples) {
        assert!((a.clamp(0.0, 1.0) - b).abs() < 1e-5, "{a} {b}");
    }
}

//! Twenty-four seeds yield twenty-four different scenes.

use imaging::geometry::Intrinsics;
use imaging::random::Stream;
use imaging::{Rgb8, transfer};
use quality::MetricId;
use scenes::{FAMILIES, procedural};

/// Frames with a higher similarity, apart from open water, would look like one scene from two positions.
const MOST_ALIKE: f64 = 0.65;

#[test]
fn no_two_of_twenty_four_seeds_look_alike() {
    let (width, height) = (192, 123);
    let lens = Intrinsics::centered(114.5, width, height);
    let ssim = MetricId::parse("ssim").unwrap();
    for family in FAMILIES {
        // Open water is the same in all scenes: replace it by a pattern per scene.
        let frame = |seed: u64| {
            let mut scene = procedural(family, seed, width, height, lens).unwrap();
            let instances = scene.instances.as_ref().unwrap().data().to_vec();
            let pattern = Stream::stage(seed, "variety");
            for (pixel, _) in instances.iter().enumerate().filter(|(_, number)| **number == 0) {
                let light = pattern.unit(pixel as u64, 0) as f32;
                scene
                    .radiance
                    .planes_mut()
                    .iter_mut()
                    .for_each(|plane| plane[pixel] = light);
            }
            transfer::encode_rgb8(&scene.radiance).0
        };
        let frames: Vec<Rgb8> = (0..24).map(frame).collect();
        let mut most = (0.0, 0, 0);
        for (a, one) in frames.iter().enumerate() {
            for (b, other) in frames.iter().enumerate().skip(a + 1) {
                let likeness = quality::measure(one, Some(other), &[ssim]).unwrap()[0].1;
                if likeness > most.0 {
                    most = (likeness, a, b);
                }
            }
        }
        println!("{family}, most alike: {most:?}");
        assert!(
            most.0 < MOST_ALIKE,
            "{family}: seeds {} and {} have an SSIM of {:.3}",
            most.1,
            most.2,
            most.0
        );
    }
}

#[test]
fn an_unknown_family_is_named() {
    let lens = Intrinsics::centered(10.0, 4, 4);
    let error = procedural("castle", 1, 4, 4, lens).unwrap_err();
    assert!(
        error.to_string().contains("castle") && error.to_string().contains("structure"),
        "{error}"
    );
}

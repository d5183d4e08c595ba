//! Properties of every method of the registry on every decodable picture.

#![allow(clippy::unwrap_used)]

use enhance::{EnhanceError, METHODS, Method, run};
use imaging::random::Stream;
use imaging::{Channels, Raster, Samples};
use proptest::prelude::*;

fn methods() -> impl Iterator<Item = Method> {
    METHODS.iter().map(|name| Method::parse(name).unwrap())
}

/// Kinds of picture content.
const KINDS: usize = 7;

/// Any decodable picture: gray or color, 8 or 16 bit, with or without alpha, with different content.
fn picture(
    width: usize,
    height: usize,
    kind: usize,
    color: bool,
    wide: bool,
    alpha: bool,
    seed: u64,
) -> Raster {
    let stream = Stream::stage(seed, "picture");
    let channels = if color { Channels::Rgb } else { Channels::Gray };
    let count = channels.count();
    let code = |i: usize| {
        let (pixel, channel) = (i / count, i % count);
        let (x, y) = (pixel % width, pixel / width);
        let any = (stream.bits(pixel as u64, channel as u64) >> 48) as u16;
        let ends = if any & 1 == 0 { 0 } else { u16::MAX };
        match kind {
            0 => any,
            1 => ends,
            2 => (stream.bits(0, channel as u64) >> 48) as u16,
            3 if channel == (seed % 3) as usize => any,
            3 => 0,
            4 if pixel == width * height / 2 => u16::MAX,
            4 => 0,
            5 => (x * 65535 / width) as u16 / (channel as u16 + 1) + (y as u16),
            _ => 30000 + any % 600,
        }
    };
    let length = width * height * count;
    let samples = |length: usize| match wide {
        true => Samples::U16((0..length).map(code).collect()),
        false => Samples::U8((0..length).map(|i| (code(i) >> 8) as u8).collect()),
    };
    let alpha = alpha.then(|| Samples::U8((0..width * height).map(|i| i as u8).collect()));
    Raster::new(width, height, channels, samples(length), alpha).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn every_method_takes_every_picture_and_keeps_its_size_and_alpha(
        width in 1usize..70, height in 1usize..70, kind in 0..KINDS, color in any::<bool>(),
        wide in any::<bool>(), alpha in any::<bool>(), seed in any::<u64>(),
    ) {
        let picture = picture(width, height, kind, color, wide, alpha, seed);
        for method in methods() {
            let enhanced = run(&method, &picture).unwrap();
            let result = &enhanced.picture;
            prop_assert_eq!((result.width(), result.height()), (width, height), "{}", method.name());
            prop_assert!(matches!(result.samples(), Samples::U8(_)), "{}", method.name());
            prop_assert_eq!(result.alpha(), picture.alpha(), "{}", method.name());
        }
    }
}

#[test]
fn every_method_takes_the_smallest_pictures_of_every_nature() {
    for (width, height) in [(1, 1), (1, 2), (2, 1), (1, 300), (300, 1), (3, 3)] {
        for kind in 0..KINDS {
            for color in [false, true] {
                let picture = picture(width, height, kind, color, false, false, 5);
                for method in methods() {
                    assert!(
                        run(&method, &picture).is_ok(),
                        "{} {width}×{height}",
                        method.name()
                    );
                }
            }
        }
    }
}

#[test]
fn every_method_refuses_a_picture_without_pixels() {
    let empty = Raster::new(3, 0, Channels::Rgb, Samples::U8(Vec::new()), None).unwrap();
    for method in methods() {
        let error = run(&method, &empty).unwrap_err();
        assert_eq!(
            error,
            EnhanceError::Empty { width: 3, height: 0 },
            "{}",
            method.name()
        );
    }
}

#[test]
fn methods_with_a_limit_refuse_a_larger_picture_and_name_the_limit() {
    let (width, height) = (4001, 4000);
    let large = Raster::new(
        width,
        height,
        Channels::Gray,
        Samples::U8(vec![9; width * height]),
        None,
    )
    .unwrap();
    let limited = ["ulap", "suir", "ibla", "dcp", "udcp", "fusion", "mlle"];
    for method in limited.map(|name| Method::parse(name).unwrap()) {
        let text = run(&method, &large).unwrap_err().to_string();
        let name = method.name();
        let expected = format!("picture is 4001×4000 = 16004000 pixels but the limit of {name} is 16000000");
        assert_eq!(text, expected);
    }
}

//! Compression against encoded and decoded files.
#![allow(clippy::unwrap_used)]

use camera::jpeg;
use imaging::Rgb8;
use imaging::codec::{Radiance, decode_radiance, encode_jpeg};
use spec::{Chroma, Jpeg};

fn law(quality: u8, chroma: Chroma) -> Jpeg {
    Jpeg { quality, chroma }
}

fn photo(width: usize, height: usize) -> Rgb8 {
    Rgb8::from_fn(width, height, |x, y| {
        let wave = |a: f64, b: f64| 127.0 + 90.0 * (a * x as f64).sin() * (b * y as f64).cos();
        [wave(0.1, 0.07), wave(0.05, 0.11), 80.0 + 0.5 * wave(0.3, 0.2)].map(|v| v as u8)
    })
}

#[test]
fn compression_is_what_a_jpeg_file_leaves() {
    for (width, height) in [(1, 1), (7, 9), (64, 48), (131, 37)] {
        for quality in [1, 30, 50, 75, 95, 100] {
            let picture = photo(width, height);
            let ours = jpeg::compressed(&picture, law(quality, Chroma::Full));
            let file = encode_jpeg(&picture, quality).unwrap();
            let Ok(Radiance::Encoded(theirs)) = decode_radiance(&file) else {
                panic!("a JPEG file")
            };
            let theirs = theirs.to_rgb8();
            let apart: Vec<i32> = ours
                .data()
                .iter()
                .zip(theirs.data())
                .map(|(&a, &b)| (i32::from(a) - i32::from(b)).abs())
                .collect();
            // A coefficient on the edge between two steps may fall to either side in integer arithmetic.
            let mean = apart.iter().sum::<i32>() as f64 / apart.len() as f64;
            let allowed = if ours.data().len() < 1000 { 2.5 } else { 1.0 };
            assert!(mean < allowed, "{width}×{height} at {quality}: {mean}");
        }
    }
}

#[test]
fn worse_quality_and_half_the_color_lose_more() {
    let picture = photo(96, 64);
    let error = |law: Jpeg| {
        let left = jpeg::compressed(&picture, law);
        let squares = left.data().iter().zip(picture.data()).map(|(&a, &b)| {
            let d = f64::from(a) - f64::from(b);
            d * d
        });
        squares.sum::<f64>()
    };
    let errors = [95, 75, 40, 10].map(|quality| error(law(quality, Chroma::Full)));
    assert!(errors.windows(2).all(|pair| pair[0] < pair[1]), "{errors:?}");
    assert!(error(law(95, Chroma::Half)) > errors[0]);
    let gray = Rgb8::from_fn(33, 21, |x, y| [(3 * x + y) as u8; 3]);
    assert_eq!(
        jpeg::compressed(&gray, law(100, Chroma::Half)),
        jpeg::compressed(&gray, law(100, Chroma::Full))
    );
}

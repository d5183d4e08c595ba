//! Complete methods.

use enhance::{METHODS, Method, Variant, run_variant};
use imaging::Raster;

use crate::{SIZES, pictures};

/// Share of the codes that may differ by one: values within the blocks' tolerance of a tie.
const SHARE: f64 = 0.01;

#[test]
fn every_method_agrees_with_its_reference() {
    for name in METHODS.iter().filter(|name| **name != "hscm") {
        let method = Method::parse(name).expect("a name of the registry");
        // The references of guided filters are slow: only the blocks use the largest size.
        for (width, height) in SIZES
            .into_iter()
            .filter(|(width, height)| width * height < 50_000)
        {
            for (content, picture) in pictures(width, height) {
                let picture = Raster::from(picture);
                let [fast, exact] = [Variant::Fast, Variant::Reference].map(|variant| {
                    let enhanced = run_variant(&method, &picture, variant).expect("a picture with pixels");
                    enhanced.picture.to_rgb8()
                });
                let off: Vec<u8> = fast
                    .data()
                    .iter()
                    .zip(exact.data())
                    .map(|(a, b)| a.abs_diff(*b))
                    .collect();
                let worst = off.iter().max().copied().unwrap_or(0);
                let changed = off.iter().filter(|&&off| off > 0).count();
                let allowed = (SHARE * off.len() as f64).ceil() as usize;
                assert!(
                    worst <= 1 && changed <= allowed,
                    "{name} {width}×{height} {content}: {changed} of {} codes differ, by up to {worst}",
                    off.len()
                );
            }
        }
    }
}

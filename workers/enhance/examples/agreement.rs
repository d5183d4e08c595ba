//! Prints the difference between the fast variant of every method and its reference as Markdown, for the pictures and
//! sizes of the `agreement` tests, which define the limits. `cargo run --release -p fathom-enhance --example agreement`

#[path = "../tests/agreement/content.rs"]
mod content;

use std::error::Error;

use content::{SIZES, pictures};
use enhance::hscm::Luma;
use enhance::hscm::homomorphic::{self, Filter};
use enhance::{METHODS, Method, Variant, run_variant};
use imaging::Raster;

/// The references of guided filters are slow.
const MOST_PIXELS: usize = 50_000;

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "| method | pictures | largest difference, codes | most codes that differ in a picture | where |"
    );
    println!("|---|---|---|---|---|");
    for name in METHODS {
        let method = Method::parse(name).ok_or("a name of the registry")?;
        let (mut count, mut largest, mut share, mut place) = (0, 0, 0.0f64, "–".to_owned());
        for (width, height) in sizes() {
            for (content, picture) in pictures(width, height) {
                let picture = Raster::from(picture);
                let fast = run_variant(&method, &picture, Variant::Fast)?.picture.to_rgb8();
                let exact = run_variant(&method, &picture, Variant::Reference)?
                    .picture
                    .to_rgb8();
                let off: Vec<u8> = fast
                    .data()
                    .iter()
                    .zip(exact.data())
                    .map(|(a, b)| a.abs_diff(*b))
                    .collect();
                largest = off.iter().copied().fold(largest, u8::max);
                let differ = off.iter().filter(|&&off| off > 0).count() as f64 / off.len() as f64;
                if differ > share {
                    (share, place) = (differ, format!("{content}, {width}×{height}"));
                }
                count += 1;
            }
        }
        println!(
            "| {name} | {count} | {largest} | {:.3} % | {place} |",
            100.0 * share
        );
    }
    let (logs, codes) = homomorphic_filter();
    println!(
        "\nHSCM's filtered logarithm differs by at most {logs:.1e}, its codes before the equalization by at most {codes}. On a \
         picture of nearly one gray value the equalization makes several codes of one."
    );
    Ok(())
}

fn sizes() -> impl Iterator<Item = (usize, usize)> {
    SIZES
        .into_iter()
        .filter(|(width, height)| width * height < MOST_PIXELS)
}

/// Largest differences of the filtered logarithm and of its codes.
fn homomorphic_filter() -> (f32, u8) {
    let (mut logs, mut codes) = (0.0f32, 0u8);
    for (width, height) in sizes() {
        for (_, picture) in pictures(width, height) {
            let luma = Luma::new(&Raster::from(picture));
            let filter = Filter::new(&spec::Hscm::default(), width);
            let variants = [Variant::Fast, Variant::Reference];
            let [fast, exact] = variants.map(|variant| homomorphic::filtered_log(&luma, &filter, variant));
            let off = fast.data().iter().zip(exact.data()).map(|(a, b)| (a - b).abs());
            logs = off.fold(logs, f32::max);
            let [fast, exact] = variants.map(|variant| homomorphic::homomorphic(&luma, &filter, variant));
            let off = fast.data().iter().zip(exact.data()).map(|(a, b)| a.abs_diff(*b));
            codes = off.fold(codes, u8::max);
        }
    }
    (logs, codes)
}

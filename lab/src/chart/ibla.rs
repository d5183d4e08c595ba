//! The variants of IBLA.

use enhance::{Method, Variant, run_variant};
use imaging::{Raster, transfer};
use spec::IblaRefinement;

use super::bench::Bench;
use super::scenes::ChartScene;
use crate::measurement::{Measurement, time};

/// The variants of IBLA on the scene's picture, against matting in f64. The guided one may estimate another background light; its
/// error then covers the picture as a whole.
pub(super) fn measure(scene: &ChartScene, runs: usize) -> Vec<Measurement> {
    let picture = Raster::from(transfer::encode_rgb8(&scene.radiance).0);
    let mut bench = Bench::new("ibla", scene, runs);
    let mut exact = None;
    for (variant, refine, form) in [
        ("matting in f64", IblaRefinement::Matting, Variant::Reference),
        ("matting", IblaRefinement::Matting, Variant::Fast),
        ("guided", IblaRefinement::Guided, Variant::Fast),
    ] {
        let method = Method::ibla(refine);
        let runs = if form == Variant::Reference { 1 } else { runs };
        let (times, enhanced) = time(runs, || run_variant(&method, &picture, form));
        let codes = enhanced.expect("a picture with pixels").picture.to_rgb8();
        let light = transfer::decode_rgb8(&codes);
        let reference = exact.get_or_insert_with(|| light.clone());
        bench.push(variant, None, times, &light, reference);
    }
    bench.finish("matting")
}

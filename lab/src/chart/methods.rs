//! Enhancements: the homomorphic filter of HSCM, and the variants of IBLA.

use enhance::hscm::homomorphic::homomorphic;
use enhance::hscm::{CUTOFF, Luma};
use enhance::{Method, Variant, run_variant};
use imaging::{Plane, Raster, Rgb, transfer};

use super::bench::Bench;
use super::scenes::ChartScene;
use crate::measurement::{Measurement, time};

/// The homomorphic filter: the fast variant and the transform in f64, for narrow and wide cut-offs.
pub(super) fn measure_homomorphic(scene: &ChartScene, runs: usize) -> Vec<Measurement> {
    let luma = Luma::new(&Raster::from(transfer::encode_rgb8(&scene.radiance).0));
    let mut bench = Bench::new("homomorphic", scene, runs);
    for cutoff in [8.0, 32.0, 96.0] {
        let [slow, fast] = [Variant::Reference, Variant::Fast].map(|variant| {
            let (times, codes) = time(runs, || homomorphic(&luma, cutoff, variant));
            (times, gray_light(&codes))
        });
        let terms = Some(cutoff as usize);
        bench.push("separable", terms, fast.0, &fast.1, &slow.1);
        bench.push("transform in f64", terms, slow.0, &slow.1, &slow.1);
    }
    bench.finish("separable", Some(CUTOFF as usize))
}

fn gray_light(codes: &Plane<u8>) -> Rgb<f32> {
    let plane = codes.map(|&code| transfer::decode_u8(code));
    Rgb::new([plane.clone(), plane.clone(), plane]).expect("planes of one size")
}

/// The variants of IBLA on the scene's picture, against matting in f64. `ibla_guided` may estimate another background light; its
/// error then covers the picture as a whole.
pub(super) fn measure_ibla(scene: &ChartScene, runs: usize) -> Vec<Measurement> {
    let picture = Raster::from(transfer::encode_rgb8(&scene.radiance).0);
    let mut bench = Bench::new("ibla", scene, runs);
    let mut exact = None;
    for (variant, name, form) in [
        ("matting in f64", "ibla", Variant::Reference),
        ("matting", "ibla", Variant::Fast),
        ("guided", "ibla_guided", Variant::Fast),
    ] {
        let method = Method::parse(name).expect("a name of the registry");
        let runs = if form == Variant::Reference { 1 } else { runs };
        let (times, enhanced) = time(runs, || run_variant(&method, &picture, form));
        let codes = enhanced.expect("a picture with pixels").picture.to_rgb8();
        let light = transfer::decode_rgb8(&codes);
        let reference = exact.get_or_insert_with(|| light.clone());
        bench.push(variant, None, times, &light, reference);
    }
    bench.finish("matting", None)
}

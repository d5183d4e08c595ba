//! IBLA with matting, with the guided filter, and with matting in f64.

use enhance::{Method, Variant, run_variant};
use imaging::{Raster, Rgb8, transfer};

use super::difference::difference;
use super::stopwatch::time;
use super::{ChartScene, Point};

/// The variants of IBLA on the scene's picture, against matting in f64. `ibla_guided` may estimate another background light; its
/// error then covers the picture as a whole.
#[must_use]
pub fn ibla(scene: &ChartScene, runs: usize) -> Vec<Point> {
    let picture = Raster::from(transfer::encode_rgb8(&scene.radiance).0);
    let forms = [
        ("matting in f64", "ibla", Variant::Reference),
        ("matting", "ibla", Variant::Fast),
        ("guided", "ibla_guided", Variant::Fast),
    ];
    let measured = forms.map(|(variant, name, form)| {
        let method = Method::parse(name).expect("a name of the registry");
        let enhanced = || -> Rgb8 {
            let enhanced = run_variant(&method, &picture, form).expect("a picture with pixels");
            enhanced.picture.to_rgb8()
        };
        let runs = if form == Variant::Reference { 1 } else { runs };
        let (times, codes) = time(runs, enhanced);
        (variant, times, transfer::decode_rgb8(&codes))
    });
    let exact = &measured[0].2;
    let points = measured.iter().map(|(variant, times, picture)| {
        let difference = Some(difference(picture, exact));
        let size = scene.range.size();
        let mut point = Point::new("ibla", (variant, None), &scene.name, size, *times, difference);
        point.default = *variant == "matting";
        point
    });
    points.collect()
}

//! Every enhancement and every metric on any small picture: a result without NaN, or an error that names its reason.
#![no_main]

use imaging::{Raster, Rgb8};
use libfuzzer_sys::fuzz_target;
use quality::{MetricId, Needs};

fuzz_target!(|bytes: &[u8]| {
    let [method, width, height, samples @ ..] = bytes else {
        return;
    };
    // Mostly smaller than the windows of the methods, since that is where they are fragile and fast.
    let side = |byte: u8| 1 + usize::from(if byte < 192 { byte % 16 } else { byte - 192 });
    let (width, height) = (side(*width), side(*height));
    // What is missing repeats what is there.
    let sample = |i: usize| samples.get(i % samples.len().max(1)).copied().unwrap_or(0);
    let data: Vec<u8> = (0..3 * width * height).map(sample).collect();
    let picture = Rgb8::new(width, height, data).expect("as many samples as the size says");
    let name = enhance::METHODS[usize::from(*method) % enhance::METHODS.len()];
    let method = enhance::Method::parse(name).expect("a name of the list");
    let enhanced = match enhance::run(&method, &Raster::from(picture.clone())) {
        Ok(enhanced) => enhanced.picture.to_rgb8(),
        Err(error) => panic!("{name} on {width}x{height}: {error}"),
    };
    assert_eq!((enhanced.width(), enhanced.height()), (width, height));
    let of_pictures = [Needs::Nothing, Needs::PictureInAir];
    let metrics: Vec<MetricId> = MetricId::all()
        .filter(|metric| of_pictures.contains(&metric.info().needs))
        .collect();
    let values = quality::measure(&enhanced, Some(&picture), &metrics).expect("pictures of one size");
    for (metric, value) in values {
        assert!(
            value.is_finite(),
            "{metric} of {name} on {width}x{height} is {value}"
        );
    }
});

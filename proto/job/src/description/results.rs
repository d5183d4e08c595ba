//! Queryable results of frames, except metrics.

use crate::schema::{Names, Range, Shape};

/// A queryable result.
pub(crate) struct ResultField {
    /// Name in queries.
    pub(crate) name: &'static str,
    /// JSON pointer in a record.
    pub(crate) pointer: &'static str,
    pub(crate) shape: Shape,
    pub(crate) unit: Option<&'static str>,
    /// Meaning.
    pub(crate) doc: &'static str,
}

/// Declares results: name, JSON pointer, shape, unit (empty: none) and meaning.
macro_rules! results {
    ($($name:literal $pointer:literal $shape:ident $unit:literal $doc:literal;)*) => {
        &[$(ResultField {
            name: $name,
            pointer: $pointer,
            shape: $shape,
            unit: if $unit.is_empty() { None } else { Some($unit) },
            doc: $doc,
        }),*]
    };
}

/// Results of a frame, except metrics: numbers of the water stage, counters, provenance.
pub(crate) const RESULTS: &[ResultField] = results! {
    // The name of the water; for a user-defined water the record contains its numbers.
    "water.optics" "/parameters/water/optics/preset" TEXT "" "the water by name";
    "absorption_per_m" "/optics/absorption_per_m" RGB "1/m" "a, absorption of the water";
    "scattering_per_m" "/optics/scattering_per_m" RGB "1/m" "b, scattering of the water";
    "beam_attenuation_per_m" "/optics/beam_attenuation_per_m" RGB "1/m" "c = a + b, attenuation of light along the ray";
    "backscatter_attenuation_per_m" "/optics/backscatter_attenuation_per_m" RGB "1/m" "attenuation of the veiling light";
    "diffuse_attenuation_per_m" "/optics/diffuse_attenuation_per_m" RGB "1/m" "K_d, decay of daylight with depth";
    "veiling_light" "/optics/veiling_light" RGB "" "backscatter radiance at infinite range, linear";
    "radiance_gain" "/optics/radiance_gain" RGB "" "what the scene's radiance was multiplied by";
    "g_per_m" "/optics/g_per_m" RGB "1/m" "G, attenuation of light that is scattered forward";
    "spread_px_per_m" "/optics/spread_px_per_m" RGB "px/m" "growth of the forward-scatter kernel with range";
    "spread_offset_px" "/optics/spread_offset_px" RGB "px" "width of the forward-scatter kernel at range 0";
    "backscatter_fraction" "/optics/backscatter_fraction" NUMBER "" "share of the scattering that goes back, b_b/b";
    "snow.particles" "/optics/snow/particles" WHOLE "" "particles of marine snow in view";
    "snow.cover" "/optics/snow/cover" NUMBER "" "share of the picture that marine snow covers";
    "turbidity.mean" "/optics/turbidity/mean" NUMBER "" "what multiplies the water's coefficients along the rays, mean over the picture";
    "turbidity.least" "/optics/turbidity/least" NUMBER "" "the same, least of all rays";
    "turbidity.most" "/optics/turbidity/most" NUMBER "" "the same, greatest of all rays";
    "daylight.shallowest_m" "/optics/daylight/shallowest_m" NUMBER "m" "least depth of the surfaces that light from above falls on";
    "daylight.deepest_m" "/optics/daylight/deepest_m" NUMBER "m" "the same, greatest depth";
    "daylight.caustics_peak" "/optics/daylight/caustics_peak" NUMBER "" "brightest place of the caustics over their mean";
    "model.covered" "/optics/model/covered" NUMBER "" "share of the light whose model error was measured under such conditions";
    "model.bias" "/optics/model/bias" NUMBER "" "mean model error of that light, over the light of the truth";
    "model.rms" "/optics/model/rms" NUMBER "" "root mean square of the same over blocks of the picture";
    "instances" "/scene/instances" LIST "" "objects in view";
    "instances.visible" "/scene/visible" WHOLE "" "objects whose contrast can be seen";
    "instances.least_visibility" "/scene/least_visibility" NUMBER "" "least visibility of an object in view";
    "instances.mean_visibility" "/scene/mean_visibility" NUMBER "" "mean visibility of the objects in view";
    "holes" "/counts/holes" WHOLE "" "pixels without a valid range";
    "negative_radiance" "/counts/negative_radiance" WHOLE "" "samples of negative radiance that were set to 0";
    "clamped" "/counts/clamped" WHOLE "" "samples of the result outside 0..=1 that were clamped";
    "range_saturated" "/counts/range_saturated" WHOLE "" "pixels whose range is beyond what the range file holds";
    "total_ms" "/timings_ms/total" NUMBER "ms" "time of rendering";
    "code_version" "/provenance/code_version" TEXT "" "version of the program that rendered it";
    "onnx_runtime" "/provenance/onnx_runtime" TEXT "" "version of ONNX Runtime, if a network ran on it";
    "cpu_features" "/provenance/cpu_features" TEXT "" "CPU features that choose code paths";
};

const NUMBER: Shape = Shape::Number(Range::FINITE);
const WHOLE: Shape = Shape::Integer(0, 1 << 53);
const TEXT: Shape = Shape::Text(Names::Words);
const RGB: Shape = Shape::Rgb(Range::FINITE);
/// Its elements are objects, available through the record.
const LIST: Shape = Shape::List {
    element: &Shape::Scalar,
    max: usize::MAX,
    distinct: false,
};

//! The accepted fields, in one place: name, shape, limits, default, whether a law may stand there, meaning.
//!
//! Parsing, the field table of the documentation and the service's OpenAPI text all read this.
//! One row is one line, so the formatter leaves this file alone.

use crate::schema::Names::{
    Artifact, Dataset, Enhancement, Family, Fixed, Metric, Path, Preset as PresetName, SceneId, Style,
    WaterName, Words,
};
use crate::schema::Presence::{Default, Optional, Required};
use crate::schema::Shape::{Either, Integer, Labels, List, Number, Object, OneOf, Rgb, Short, Tagged, Text, Vector};
use crate::schema::{Field, Presence, Range, Shape, Variant};

/// Most frames of a job, and the greatest `count`.
pub const MAX_FRAMES: u64 = 100_000_000;

/// Most pixels of a frame: what the decoders accept too.
pub const MAX_PIXELS: u64 = 64_000_000;

/// Beyond this, doubles skip whole numbers.
pub(crate) const EXACT: i128 = 1 << 53;

const PER_METRE: Shape = Rgb(Range::within(0.0, 1000.0));
const PIXELS: Shape = Rgb(Range::within(0.0, 100_000.0));
const RADIANCE: Shape = Rgb(Range::within(0.0, 1000.0));
const METRICS: &str = r#"["entropy", "uicm", "uism", "uiconm", "uiqm", "uciqe"]"#;

/// The whole description.
pub static DOCUMENT: Shape = Object(&[
    fixed("dataset", Text(Dataset), Default("\"default\""), "the collection the images join"),
    fixed("count", Integer(1, MAX_FRAMES as i128), Default("1"), "frames of each grid cell"),
    fixed("seed", Integer(0, u64::MAX as i128), Default("0"), "seed of all laws and of stage randomness"),
    field("scene", SCENE, Required, "what the camera would see in air"),
    field("camera", Object(CAMERA), Default("{}"), "pinhole camera, principal point in the middle"),
    field("water", Object(WATER), Default("{}"), "the water and its style"),
    field("alpha", Number(Range::within(0.0, 1.0)), Default("1"), "share of the styled image"),
    field("lights", LIGHTS, Default("[]"), "lamps in the water, and haze in drawing order"),
    field("enhance", names(&Text(Enhancement)), Default("[]"), "enhancement methods to run on the result"),
    field("metrics", names(&Text(Metric)), Default(METRICS), "metrics to measure"),
    field("fidelity", OneOf(FIDELITY), Default("{\"tolerance\": 3e-4}"), "how exact the water must be"),
    field("artifacts", names(&Text(Artifact)), Default("[\"rgb\"]"), "what to store"),
    field("encode", ENCODE, Default("{}"), "file format of RGB-like artifacts"),
    fixed("labels", Labels, Default("{}"), "the user's own scalars, queryable as `labels.<name>`"),
]);

/// A water of a user's own.
pub static OWN_WATER: Shape = Object(&[
    fixed("name", Text(WaterName), Required, "what jobs call it"),
    fixed("source", Text(Words), Required, "where the numbers come from"),
    fixed("licence", Text(Words), Default("\"unknown\""), "under what terms they may be used"),
    fixed("caveats", List { element: &Text(Words), max: 16, distinct: true }, Default("[]"), "what others should know"),
    fixed("jerlov_type", Text(Fixed(&crate::JERLOV_TYPES)), Optional, "its type, held against its neighbours of the same source"),
    fixed("wavelength_nm", Rgb(Range::within(300.0, 1000.0)), Required, "what stands for red, green and blue, falling"),
    fixed("absorption_per_m", PER_METRE, Optional, "a"),
    fixed("scattering_per_m", PER_METRE, Optional, "b"),
    fixed("beam_attenuation_per_m", PER_METRE, Optional, "c; absent: a + b"),
    fixed("diffuse_attenuation_per_m", PER_METRE, Optional, "K_d, the decay of daylight with depth"),
    fixed("backscatter_fraction", Number(Range::within(0.002, 0.5)), Optional, "b_b/b, for the glow of lamps"),
    fixed("veiling_light", RADIANCE, Optional, "backscatter radiance at infinite range, linear; absent: derived from K_d"),
]);

const SCENE: Shape = Tagged {
    tag: "kind",
    presence: Required,
    options: &[
        Variant { name: "procedural", fields: &[
            field("family", Text(Family), Required, "family of scenes"),
            field("seed", Integer(0, EXACT), Default("0"), "seed of the scene, apart from the job's seed"),
        ] },
        Variant { name: "uploaded", fields: &[
            field("id", Text(SceneId), Required, "an uploaded scene, which brings its own size"),
        ] },
        Variant { name: "files", fields: &[
            field("rgb", Text(Path), Required, "PNG, JPEG, WebP or NPY picture"),
            field("range", Text(Path), Optional, "distances along the line of sight"),
            field("z_depth", Text(Path), Optional, "distances along the optical axis, instead of `range`"),
            field("unit_m", Number(Range::above(0.0, 1e6)), Optional, "metres of one unit of that file"),
            field("invalid_code", Integer(0, 65_535), Optional, "code that means no return in that file"),
        ] },
    ],
};

const CAMERA: &[Field] = &[
    field("width", Integer(1, 16_384), Default("768"), "columns; at most 64 000 000 pixels in all"),
    field("height", Integer(1, 16_384), Default("492"), "rows"),
    field("hfov_deg", Number(Range::within(1.0, 170.0)), Default("80"), "horizontal field of view"),
    field("path", Object(PATH), Optional, "a way past a procedural scene; absent: its usual place"),
];

const PATH: &[Field] = &[
    fixed("frames", Integer(1, 1_000_000), Required, "frames from start to end"),
    fixed("frame", Integer(0, 999_999), Optional, "place on the path; absent: each frame of the job in turn"),
    field("start", Object(WAYPOINT), Optional, "where it begins; with `end`; absent: the family's own path"),
    field("end", Object(WAYPOINT), Optional, "where it ends"),
    field("sway_m", Number(Range::within(0.0, 1.0)), Default("0"), "amplitude of the vehicle's sway"),
    field("sway_deg", Number(Range::within(0.0, 28.0)), Default("0"), "amplitude of its turns"),
    field("sway_frames", Number(Range::within(2.0, 1e6)), Default("40"), "period of both, in frames"),
];

const WAYPOINT: &[Field] = &[
    field("position_m", Vector(Range::within(-1000.0, 1000.0)), Required, "in the world: x, y, and z upwards"),
    field("target_m", Vector(Range::within(-1000.0, 1000.0)), Required, "what the camera looks at"),
];

const WATER: &[Field] = &[
    field("optics", Short("preset", OPTICS), Optional, "a preset or coefficients; absent: no water"),
    field("range_scale", Number(Range::above(0.0, 1000.0)), Default("1"), "multiplies every per-metre quantity"),
    field("depth_m", Number(Range::within(0.0, 12_000.0)), Optional, "depth of the camera below the surface"),
    field("ambient", AMBIENT, Default("\"none\""), "what daylight's decay with depth does to the scene"),
    field("holes", HOLES, Default("\"background\""), "what a pixel without a valid range means"),
    field("style", Text(Style), Optional, "style model"),
    field("snow", Object(SNOW), Optional, "marine snow; absent: none"),
    field("turbidity", Object(TURBIDITY), Optional, "patches of murkier water that multiply every coefficient; absent: even water"),
    field("style_tier", Text(Fixed(&["net", "lut", "auto"])), Optional, "network, colour table, or what the tolerance allows; absent: `net`"),
];

const SNOW: &[Field] = &[
    field("density_per_m3", Number(Range::within(0.0, 1e6)), Required, "particles per cubic metre; at most 400 000 in view"),
    field("radius_m", Number(Range::within(1e-5, 0.02)), Default("0.001"), "median radius"),
    field("radius_spread", Number(Range::within(0.0, 1.0)), Default("0.5"), "standard deviation of its logarithm"),
    field("near_m", Number(Range::within(0.05, 100.0)), Default("0.2"), "depth of the nearest along the optical axis"),
    field("far_m", Number(Range::within(0.05, 100.0)), Default("3"), "depth of the farthest"),
    field("albedo", Rgb(Range::within(0.0, 1.0)), Default("[0.5, 0.5, 0.5]"), "share of the light that a particle sends back"),
];

const TURBIDITY: &[Field] = &[
    field("contrast", Number(Range::within(0.0, 0.95)), Required, "how far the clearest water is below the mean, as a share of it"),
    field("scale_m", Number(Range::within(0.05, 1000.0)), Default("2"), "distance at which two places have little in common"),
];

const AMBIENT: Shape = Text(Fixed(&["none", "absolute", "exposed"]));

const HOLES: Shape = Either(Fixed(&["background", "reject"]), &OneOf(&[
    field("range_m", Number(Range::within(0.001, 100_000.0)), Required, "range that takes the place of a hole's"),
]));

const OPTICS: &[Field] = &[
    field("preset", Text(PresetName), Optional, "the preset whose fields the others replace"),
    fixed("name", Text(WaterName), Optional, "what these coefficients are called; a water of the user's own brings its name"),
    field("beam_attenuation_per_m", PER_METRE, Optional, "c = a + b"),
    field("absorption_per_m", PER_METRE, Optional, "a"),
    field("scattering_per_m", PER_METRE, Optional, "b"),
    field("backscatter_attenuation_per_m", PER_METRE, Optional, "of the revised model; absent: as c"),
    field("diffuse_attenuation_per_m", PER_METRE, Optional, "K_d, the decay of daylight with depth"),
    field("veiling_light", RADIANCE, Optional, "backscatter radiance at infinite range, linear"),
    field("veil_gain", Number(Range::within(0.0, 1000.0)), Optional, "brightness of a derived veiling light"),
    field("backscatter_fraction", Number(Range::within(0.002, 0.5)), Optional, "b_b/b, for the glow of lamps; absent: 0.0183"),
    field("forward_scatter", Object(SCATTER), Optional, "absent: `jaffe` if a and b are known, else none"),
];

const SCATTER: &[Field] = &[
    field("model", Text(Fixed(&["jaffe", "simplified", "none"])), Default("\"jaffe\""), "the form"),
    field("g_per_m", PER_METRE, Optional, "G, at most c; absent: derived"),
    field("spread_px_per_m", PIXELS, Optional, "growth of the kernel with range; absent: derived"),
    field("spread_offset_px", PIXELS, Optional, "kernel at range 0; absent: 0, or derived with the growth"),
    field("source", Text(Fixed(&["radiance", "direct"])), Default("\"radiance\""), "the light `jaffe` spreads"),
];

const LIGHTS: Shape = List { element: &LIGHT, max: 64, distinct: false };

const LIGHT: Shape = Tagged {
    tag: "kind",
    presence: Required,
    options: &[Variant { name: "haze", fields: &[
        field("x", Number(Range::within(-100.0, 100.0)), Required, "position in image widths"),
        field("y", Number(Range::within(-100.0, 100.0)), Required, "position in image heights"),
        field("size", Number(Range::FINITE), Default("0.2"), "sigma in image heights; 0 or less: skipped"),
        field("intensity", Number(Range::within(0.0, 1.0)), Default("1"), "weight at the centre"),
        field("color", RADIANCE, Default("[1, 1, 1]"), "colour in the space of the haze"),
        field("blend", Text(Fixed(&["over", "add"])), Default("\"over\""), "how it is laid over the picture"),
        fixed("space", Text(Fixed(&["linear", "display"])), Default("\"linear\""), "the same for all haze"),
    ] }, Variant { name: "point", fields: &[
        field("position_m", PLACE, Required, "metres right, down and ahead of the camera"),
        field("intensity", INTENSITY, Required, "linear radiance times m², per steradian"),
    ] }, Variant { name: "spot", fields: &[
        field("position_m", PLACE, Required, "metres right, down and ahead of the camera"),
        field("intensity", INTENSITY, Required, "along the axis: linear radiance times m², per steradian"),
        field("direction", Vector(Range::within(-1000.0, 1000.0)), Default("[0, 0, 1]"), "axis, of any length but 0"),
        field("cone_deg", Number(Range::within(0.5, 90.0)), Default("30"), "angle from the axis at which no light is left"),
    ] }],
};

const PLACE: Shape = Vector(Range::within(-1000.0, 1000.0));
const INTENSITY: Shape = Rgb(Range::within(0.0, 1e6));

const FIDELITY: &[Field] = &[
    field("tolerance", Number(Range::within(1e-7, 1.0)), Required, "largest error in linear light"),
    field("terms", Integer(1, 64), Required, "kernels of the fast forward scatter"),
    fixed("variant", Text(Fixed(&["reference", "display"])), Required, "`reference`, the slow f64 form, or `display`, within one code of the 8-bit picture"),
];

const ENCODE: Shape = Tagged {
    tag: "format",
    presence: Default("\"png\""),
    options: &[
        Variant { name: "png", fields: &[] },
        Variant { name: "webp", fields: &[] },
        Variant { name: "jpeg", fields: &[
            field("quality", Integer(1, 100), Default("95"), "JPEG quality"),
        ] },
    ],
};

const fn names(element: &'static Shape) -> Shape {
    List { element, max: 64, distinct: true }
}

const fn field(name: &'static str, shape: Shape, presence: Presence, doc: &'static str) -> Field {
    Field { name, shape, presence, laws: true, doc }
}

const fn fixed(name: &'static str, shape: Shape, presence: Presence, doc: &'static str) -> Field {
    Field { name, shape, presence, laws: false, doc }
}

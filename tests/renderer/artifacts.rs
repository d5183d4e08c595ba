//! Every artifact can be decoded and matches its kind.

use imaging::codec::{FilePlane, Radiance, decode_picture, decode_plane, decode_radiance};
use imaging::{Channels, Rgb, Samples};
use serde_json::json;
use spec::sha256;

use crate::common::{Files, HEIGHT, WIDTH, file, parse, pixels, render};

const EVERYTHING: [&str; 13] = [
    "rgb",
    "clean",
    "direct",
    "forward_scatter",
    "backscatter",
    "scattered",
    "styled",
    "hazed",
    "range",
    "transmittance",
    "enhanced.hscm",
    "enhanced.hscm.mask",
    "preview",
];

fn linear(bytes: &[u8]) -> Rgb<f32> {
    match decode_radiance(bytes).unwrap() {
        Radiance::Linear(layer) => layer,
        Radiance::Encoded(_) => panic!("a picture where a linear layer is expected"),
    }
}

#[test]
fn every_kind_decodes_at_its_size_with_the_digest_of_the_record() {
    let files = Files::new();
    let job =
        files.job(&json!({"water": {"optics": "jerlov-3C"}, "enhance": ["hscm"], "artifacts": EVERYTHING}));
    let rendered = render(&job);
    let kinds: Vec<&str> = rendered.files.iter().map(|file| file.kind.as_str()).collect();
    assert_eq!(kinds, EVERYTHING);
    for (file, entry) in rendered.files.iter().zip(&rendered.record.artifacts) {
        assert_eq!((&file.kind, file.bytes.len() as u64), (&entry.kind, entry.bytes));
        assert_eq!(sha256(&file.bytes), entry.digest);
        if file.media_type == "application/x-npy" {
            assert_eq!(linear(&file.bytes).size(), (WIDTH, HEIGHT), "{}", file.kind);
        } else {
            let picture = decode_picture(&file.bytes).unwrap();
            assert_eq!(
                (picture.width(), picture.height()),
                (WIDTH, HEIGHT),
                "{}",
                file.kind
            );
            let gray = ["range", "enhanced.hscm.mask"].contains(&file.kind.as_str());
            assert_eq!(picture.channels() == Channels::Gray, gray, "{}", file.kind);
        }
    }
    assert_eq!(pixels(&rendered, "rgb"), pixels(&rendered, "hazed"));
    assert_ne!(pixels(&rendered, "rgb"), pixels(&rendered, "clean"));
}

#[test]
fn the_layers_add_up_to_the_picture_after_the_water() {
    let files = Files::new();
    let artifacts = [
        "direct",
        "forward_scatter",
        "backscatter",
        "transmittance",
        "clean",
        "scattered",
    ];
    let rendered = render(&files.job(&json!({"water": {"optics": "jerlov-3C"}, "artifacts": artifacts})));
    let layer = |kind| linear(file(&rendered, kind));
    let (direct, forward, veil) = (layer("direct"), layer("forward_scatter"), layer("backscatter"));
    let sum = Rgb::from_fn(WIDTH, HEIGHT, |x, y| {
        [0, 1, 2].map(|c| direct.pixel(x, y)[c] + forward.pixel(x, y)[c] + veil.pixel(x, y)[c])
    });
    let expected = imaging::transfer::encode_rgb8(&sum).0;
    let actual = decode_picture(file(&rendered, "scattered")).unwrap().to_rgb8();
    let largest = expected
        .data()
        .iter()
        .zip(actual.data())
        .map(|(a, b)| a.abs_diff(*b))
        .max()
        .unwrap();
    assert!(
        largest <= 1,
        "{largest} codes: the sum is rounded once more than the picture"
    );
    let clean = imaging::transfer::decode_rgb8(&decode_picture(file(&rendered, "clean")).unwrap().to_rgb8());
    let (x, y) = (30, 10);
    let arriving = clean.pixel(x, y)[1] * layer("transmittance").pixel(x, y)[1];
    assert!((arriving - direct.pixel(x, y)[1]).abs() < 1e-5);
}

#[test]
fn range_is_stored_in_millimeters_with_holes_as_zero() {
    let files = Files::new();
    let rendered = render(&files.job(&json!({"artifacts": ["range"]})));
    let FilePlane::Codes(codes) = decode_plane(file(&rendered, "range")).unwrap() else {
        panic!("not integers")
    };
    assert_eq!(
        (codes.pixel(0, 0), codes.pixel(0, 1), codes.pixel(WIDTH - 1, 3)),
        (0, 1000, 5000)
    );
    assert_eq!(
        (
            rendered.record.counts.holes,
            rendered.record.counts.range_saturated
        ),
        (1, 0)
    );
}

#[test]
fn pictures_follow_the_format_and_codes_stay_png() {
    let files = Files::new();
    for (format, media_type) in [
        ("png", "image/png"),
        ("webp", "image/webp"),
        ("jpeg", "image/jpeg"),
    ] {
        let fields = json!({"artifacts": ["rgb", "range", "preview"], "encode": {"format": format}});
        let rendered = render(&files.job(&fields));
        let types: Vec<&str> = rendered.files.iter().map(|file| file.media_type).collect();
        assert_eq!(types, [media_type, "image/png", media_type]);
        decode_picture(file(&rendered, "rgb")).unwrap();
    }
}

#[test]
fn a_procedural_scene_has_range_instances_and_a_small_preview() {
    let job = parse(&json!({
        "scene": {"kind": "procedural", "family": "structure", "seed": 3},
        "camera": {"width": 400, "height": 300, "hfov_deg": 80}, "metrics": [],
        "artifacts": ["instances", "range", "preview"]}));
    let rendered = render(&job);
    let instances = decode_picture(file(&rendered, "instances")).unwrap();
    assert!(matches!(instances.samples(), Samples::U16(_)));
    let preview = decode_picture(file(&rendered, "preview")).unwrap();
    assert_eq!((preview.width(), preview.height()), (256, 192));
    assert!(
        rendered.record.warnings.is_empty(),
        "{:?}",
        rendered.record.warnings
    );
}

#[test]
fn what_the_scene_does_not_have_is_left_out_with_a_warning() {
    let files = Files::new();
    let fields = json!({"scene": files.scene_without_range(), "artifacts": ["rgb", "range", "instances"]});
    let rendered = render(&files.stored_job(&fields));
    assert_eq!(rendered.files.len(), 1);
    assert_eq!(
        rendered.record.warnings,
        [
            "there is no artifact `range`: the scene has no range",
            "there is no artifact `instances`: the scene has no instance mask"
        ]
    );
}

//! From an upload to an image with the real worker.

use crate::common::bytes::{png, range_npy};
use crate::common::start;
use crate::common::worker::Real;
use imaging::Rgb8;
use imaging::codec::decode_picture;
use serde_json::{Value, json};

/// A job over an uploaded scene without the tint of daylight; one frame in clear air and one in water.
fn job_over(scene: &Value) -> Value {
    json!({
        "dataset": "uploads", "seed": 7, "daylight": "none",
        "scene": {"kind": "uploaded", "id": scene["id"]},
        "water": {"optics": "jerlov-5C", "range_scale": {"grid": [0.000_001, 1.0]}},
        "artifacts": ["rgb", "range"], "metrics": ["uiqm", "uciqe"]
    })
}

#[test]
fn an_uploaded_scene_becomes_an_image_in_water() {
    let service = start();
    let picture = png(40, 30);
    let range = range_npy(40, 30, |x, _| if x < 3 { f32::NAN } else { 6.0 });
    let scene = service.upload(&[("rgb", &picture), ("range", &range), ("hfov_deg", b"80")]);
    assert_eq!(scene.status, 201, "{}", scene.text());
    let id = service.submit(&job_over(&scene.json()));
    let _worker = Real::start(&service);
    let ended = service.get(&format!("/v1/jobs/{id}?wait=60")).json();
    assert_eq!(
        (&ended["state"], &ended["done"]),
        (&json!("done"), &json!(2)),
        "{ended}"
    );

    let rgb = |frame: u64| {
        let bytes = service.get(&format!("/v1/images/{id}/{frame}/artifacts/rgb"));
        assert_eq!(bytes.status, 200, "{}", bytes.text());
        decode_picture(&bytes.body).unwrap().to_rgb8()
    };
    let original = decode_picture(&picture).unwrap().to_rgb8();
    let (clear, murky) = (rgb(0), rgb(1));
    // Columns 0 to 2 have no range: the appearance of a hole is up to the renderer.
    let difference = |picture: &Rgb8| {
        let places = (0..30).flat_map(|y| (3..40).map(move |x| (x, y)));
        let differences =
            places.map(|(x, y)| u32::from(picture.pixel(x, y)[0].abs_diff(original.pixel(x, y)[0])));
        f64::from(differences.sum::<u32>()) / (37.0 * 30.0)
    };
    let (clear, murky) = (difference(&clear), difference(&murky));
    assert!(
        clear < 1.0,
        "{clear}: a millionth of the water changes nothing that one can see"
    );
    assert!(murky > 5.0, "{murky}: six meters of coastal water do");
    let record = service.get(&format!("/v1/images/{id}/1")).json();
    assert_eq!(record["counts"]["holes"], 90, "{record}");
    let rows = service
        .get("/v1/images?dataset=uploads&filter=uciqe%20%3E%200&fields=frame")
        .json();
    assert!(!rows["items"].as_array().unwrap().is_empty(), "{rows}");
}

#[test]
fn a_scene_without_one_valid_range_is_rendered_with_a_warning() {
    let service = start();
    let range = range_npy(16, 12, |_, _| f32::NAN);
    let scene = service.upload(&[("rgb", &png(16, 12)), ("range", &range), ("hfov_deg", b"80")]);
    assert_eq!(scene.status, 201, "{}", scene.text());
    let id = service.submit(&job_over(&scene.json()));
    let _worker = Real::start(&service);
    let ended = service.get(&format!("/v1/jobs/{id}?wait=60")).json();
    assert_eq!(ended["state"], "done", "{ended}");
    let record = service.get(&format!("/v1/images/{id}/1")).json();
    assert!(
        record["warnings"]
            .to_string()
            .contains("no pixel has a valid range"),
        "{record}"
    );
}

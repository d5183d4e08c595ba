//! Snow and turbidity, requested and resulting, can be queried.

use serde_json::json;

use crate::common::worker::Real;
use crate::common::{job, start};

#[test]
fn snow_and_turbidity_are_columns_and_the_mask_is_stored() {
    let service = start();
    let _worker = Real::start(&service);
    let mut murky = job();
    murky["water"] = json!({
        "optics": "jerlov-1C",
        "snow": {"density_per_m3": {"grid": [0, 500]}, "radius_m": 0.003, "albedo": [0.5, 0.6, 0.7]},
        "turbidity": {"contrast": {"choice": [0.5]}, "scale_m": 1.5},
    });
    murky["count"] = json!(2);
    murky["artifacts"] = json!(["rgb", "snow_mask"]);
    let id = service.submit(&murky);
    let ended = service.get(&format!("/v1/jobs/{id}?wait=60")).json();
    assert_eq!(ended["state"], "done", "{ended}");
    let found = |filter: &str| {
        let filter = filter.replace(' ', "%20").replace('<', "%3C").replace('>', "%3E");
        let page = service
            .get(&format!("/v1/images?dataset=tests&filter={filter}"))
            .json();
        let items = page["items"].as_array();
        items.unwrap_or_else(|| panic!("{filter}: {page}")).len()
    };
    for whole in [
        "snow.radius_m = 0.003 and water.snow.spectrum = 4 and snow.near_m = 0.2 and snow.far_m = 3",
        "snow.albedo.r = 0.5 and snow.albedo.g = 0.6 and snow.albedo.b = 0.7",
        "turbidity.contrast = 0.5 and turbidity.scale_m = 1.5",
        "turbidity.least > 0.4 and turbidity.most < 3.1 and turbidity.mean > 0.4",
        "timings.snow >= 0 and timings.turbidity > 0",
    ] {
        assert_eq!(found(whole), 4, "{whole}");
    }
    assert_eq!(found("snow.density_per_m3 = 500"), 2);
    assert_eq!(found("snow.particles > 0 and snow.cover > 0"), 2);
    assert_eq!(found("snow.particles = 0 and snow.cover = 0"), 2);
    let mask = service.get(&format!("/v1/images/{id}/1/artifacts/snow_mask"));
    assert_eq!(mask.header("content-type"), "image/png");
}

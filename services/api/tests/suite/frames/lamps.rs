//! Every number of a lamp can be queried.

use serde_json::{Value, json};

use crate::common::worker::Real;
use crate::common::{job, start};

#[test]
fn pose_intensity_and_cone_of_every_lamp_are_columns() {
    let service = start();
    let _worker = Real::start(&service);
    let mut lit = job();
    lit["water"]["optics"] = json!("jerlov-1C");
    lit["count"] = json!(3);
    lit["lights"] = json!([
        {"kind": "haze", "x": 0.25, "y": 0.5, "intensity": 0.5},
        {"kind": "spot", "position_m": [{"grid": [-0.5, 0.5]}, 0.25, 0.0], "intensity": [4.0, 5.0, 6.0],
         "direction": [0.0, 0.5, 1.0], "cone_deg": 40}
    ]);
    let id = service.submit(&lit);
    let ended = service.get(&format!("/v1/jobs/{id}?wait=60")).json();
    assert_eq!(ended["state"], "done", "{ended}");
    let found = |filter: &str| {
        let filter = filter
            .replace(' ', "%20")
            .replace('<', "%3C")
            .replace('>', "%3E")
            .replace('"', "%22");
        let page = service
            .get(&format!("/v1/images?dataset=tests&filter={filter}"))
            .json();
        page["items"]
            .as_array()
            .unwrap_or_else(|| panic!("{filter}: {page}"))
            .len()
    };
    let all = found("lights.count = 2");
    assert_eq!(all, 6);
    assert_eq!(found("lights.1.position_m.x < 0"), 3);
    assert_eq!(
        found("lights.1.position_m.x = 0.5 and lights.1.position_m.y = 0.25"),
        3
    );
    for whole in [
        "lights.1.intensity.r = 4 and lights.1.intensity.b = 6",
        "lights.1.direction.y = 0.5 and lights.1.direction.z = 1",
        "lights.1.cone_deg between 39 and 41",
        "lights.1.kind = \"spot\" and lights.0.kind = \"haze\"",
        "lights.0.intensity = 0.5 and lights.0.color.g = 1",
        "backscatter_fraction > 0.018 and backscatter_fraction < 0.0185",
    ] {
        assert_eq!(found(whole), all, "{whole}");
    }
    assert_eq!(
        found("lights.1.intensity > 0"),
        0,
        "of a lamp it is a list, no number"
    );
    assert_eq!(found("lights.0.cone_deg > 0"), 0, "haze has none");
    let fields = "fields=frame,lights.1.position_m.x,lights.1.intensity.g&limit=1";
    let row: Value = service.get(&format!("/v1/images?dataset=tests&{fields}")).json()["items"][0].clone();
    assert_eq!(row["lights.1.intensity.g"], 5.0, "{row}");
    let wrong = service.get("/v1/images?dataset=tests&filter=lights.0.position_m.w%20%3E%200");
    wrong.problem(400, "invalid-filter");
}

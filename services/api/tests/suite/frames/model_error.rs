//! The measured error of the models can be queried.

use serde_json::json;

use crate::common::worker::Real;
use crate::common::{job, start};

/// Failures: the error of a water without a measurement counts as known, or the columns cannot be found.
#[test]
fn the_model_error_of_frames_is_a_column() {
    let service = start();
    let _worker = Real::start(&service);
    let mut waters = job();
    let unknown = json!({"beam_attenuation_per_m": [0.4, 0.2, 0.3], "veiling_light": [0.1, 0.2, 0.2]});
    waters["water"]["optics"] = json!({"grid": ["jerlov-II", unknown]});
    waters["count"] = json!(2);
    let id = service.submit(&waters);
    let ended = service.get(&format!("/v1/jobs/{id}?wait=60")).json();
    assert_eq!(ended["state"], "done", "{ended}");
    let found = |filter: &str| {
        let filter = filter.replace(' ', "%20").replace('<', "%3C").replace('>', "%3E");
        let page = service
            .get(&format!(
                "/v1/images?dataset=tests&filter={filter}&fields=model.covered,model.bias,model.rms"
            ))
            .json();
        let items = page["items"].as_array();
        items.unwrap_or_else(|| panic!("{filter}: {page}")).clone()
    };
    let known = found("model.covered >= 0.9 and model.rms < 0.3 and model.bias is not null");
    assert_eq!(known.len(), 2, "{known:?}");
    let none = found("model.covered = 0 and model.bias is null and model.rms is null");
    assert_eq!(none.len(), 2, "{none:?}");
    let record = service.get(&format!("/v1/images/{id}/0")).json();
    assert_eq!(
        record["optics"]["model"]["covered"], known[0]["model.covered"],
        "{record}"
    );
}

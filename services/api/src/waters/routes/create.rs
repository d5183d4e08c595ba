//! `POST /v1/waters`.

use axum::http::StatusCode;
use utoipa::ToSchema;

use crate::http::located::{Located, located};
use crate::http::{JsonBytes, Problem, State, Topic};
use crate::waters::Waters;
use crate::waters::view::WaterView;

/// A water of your own. Arrays are R, G, B; what is absent is unknown.
#[derive(ToSchema)]
#[schema(example = json!({
    "name": "quay-7", "source": "our transmissometer, May", "licence": "CC-BY-4.0", "wavelength_nm": [650, 532, 450],
    "absorption_per_m": [0.42, 0.2, 0.5], "scattering_per_m": [1.0, 1.1, 1.3], "diffuse_attenuation_per_m": [0.6, 0.4, 0.8]
}))]
#[expect(dead_code, reason = "describes the body; `spec` reads it")]
pub(crate) struct NewWater {
    /// What jobs call it: 1 to 64 of A-Z a-z 0-9 . _ -, the first a letter or digit.
    name: String,
    /// Where the numbers come from.
    source: String,
    /// Under what terms they may be used; absent: `unknown`.
    licence: Option<String>,
    /// What others should know; at most 16.
    caveats: Option<Vec<String>>,
    /// Jerlov's type (I to III, 1C to 9C, 1 to 9): it is held against its neighbours of the same source.
    jerlov_type: Option<String>,
    /// What stands for red, green and blue, nm, falling.
    wavelength_nm: [f64; 3],
    /// a, 1/m; with b, or c instead.
    absorption_per_m: Option<[f64; 3]>,
    /// b, 1/m.
    scattering_per_m: Option<[f64; 3]>,
    /// c, 1/m; absent: a + b.
    beam_attenuation_per_m: Option<[f64; 3]>,
    /// K_d, 1/m: gives the veiling light its colour.
    diffuse_attenuation_per_m: Option<[f64; 3]>,
    /// b_b/b.
    backscatter_fraction: Option<f64>,
    /// Backscatter radiance at infinite range, linear; absent: derived from K_d.
    veiling_light: Option<[f64; 3]>,
}

/// Add a water of your own, for jobs to use by name at once.
///
/// It passes the same self-tests as the shipped waters, or all that is wrong with it is listed. A job takes its numbers when
/// it is accepted, so frames stay what they are when the water is deleted.
#[utoipa::path(post, path = "/v1/waters", tag = "waters", request_body = NewWater,
    responses((status = 201, description = "Stored; `warnings` says what is odd about it.", body = WaterView),
              (status = 409, description = "The name is taken.", body = crate::openapi::Problem,
               content_type = "application/problem+json")))]
pub(crate) async fn create(
    State(waters): Topic<Waters>,
    JsonBytes(body): JsonBytes,
) -> Result<Located<WaterView>, Problem> {
    let water = waters.create(body.to_vec()).await?;
    let location = format!("/v1/waters/{}", water.name);
    Ok(located(StatusCode::CREATED, location, water))
}

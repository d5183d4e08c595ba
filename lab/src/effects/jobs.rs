//! The frames that effects are measured in.

use serde_json::{Value, json};

/// An effect: a frame without it and the same with it.
pub struct Effect {
    /// What it is called.
    pub name: &'static str,
    /// The job without it.
    without: Value,
    /// The job with it.
    with: Value,
}

impl Effect {
    fn new(name: &'static str, base: &Value, without: &Value, with: &Value) -> Self {
        let over = |fields: &Value| {
            let mut job = base.clone();
            merge(&mut job, fields);
            job
        };
        Self {
            name,
            without: over(without),
            with: over(with),
        }
    }

    /// The job without or with it, in a picture of this size.
    #[must_use]
    pub fn job(&self, with: bool, (width, height): (usize, usize)) -> Value {
        let mut job = if with { &self.with } else { &self.without }.clone();
        let size = json!({"camera": {"width": width, "height": height, "hfov_deg": 70}, "metrics": [], "artifacts": ["rgb"]});
        merge(&mut job, &size);
        job
    }
}

/// Replaces what both have, object by object; lists as a whole.
fn merge(into: &mut Value, fields: &Value) {
    match (into, fields) {
        (Value::Object(into), Value::Object(fields)) => {
            for (name, value) in fields {
                merge(into.entry(name.clone()).or_insert(Value::Null), value);
            }
        }
        (into, fields) => *into = fields.clone(),
    }
}

/// Every effect whose truth is traced.
#[must_use]
pub fn effects() -> Vec<Effect> {
    let mut all = lamps();
    all.push(forward_scatter());
    all.extend(daylight());
    all
}

/// Coastal water, b_b/b 0.0183.
fn water() -> Value {
    json!({"optics": {"absorption_per_m": [0.35, 0.18, 0.2], "scattering_per_m": [0.22, 0.22, 0.22],
                      "backscatter_fraction": 0.0183}})
}

/// A spot 0.6 m beside the camera, and nothing else that shines.
fn lamps() -> Vec<Effect> {
    let mut base = json!({
        "scene": {"kind": "procedural", "family": "structure", "seed": 5, "light": "albedo"},
        "water": water()
    });
    merge(
        &mut base,
        &json!({"water": {"optics": {"veiling_light": [0, 0, 0]}}}),
    );
    let lit = |beside: Value, multiple: &str| {
        let mut lamp = json!({"kind": "spot", "position_m": [0.6, -0.4, 0], "intensity": [40, 40, 40],
                              "direction": [-0.2, 0.12, 1], "cone_deg": 45});
        merge(&mut lamp, &beside);
        json!({"lights": [lamp], "water": {"multiple": multiple}})
    };
    let hard = || json!({"shadow": "hard", "glow_shadow": true});
    let soft = json!({"shadow": "soft", "radius_m": 0.15, "glow_shadow": true});
    vec![
        Effect::new(
            "multiple scattering of lamps",
            &base,
            &lit(hard(), "none"),
            &lit(hard(), "quasi_single"),
        ),
        Effect::new(
            "hard shadows of lamps",
            &base,
            &lit(json!({}), "quasi_single"),
            &lit(hard(), "quasi_single"),
        ),
        Effect::new(
            "soft shadows of lamps",
            &base,
            &lit(json!({}), "quasi_single"),
            &lit(soft, "quasi_single"),
        ),
    ]
}

/// A structure that is lit already, in water that scatters more.
fn forward_scatter() -> Effect {
    let mut base = json!({
        "scene": {"kind": "procedural", "family": "structure", "seed": 5},
        "water": water()
    });
    let murky =
        json!({"water": {"optics": {"scattering_per_m": [0.6, 0.6, 0.6], "veiling_light": [0, 0, 0]}}});
    merge(&mut base, &murky);
    let scatter = |law: Value| json!({"water": {"optics": {"forward_scatter": law}}});
    Effect::new(
        "two kernels and gates",
        &base,
        &scatter(json!({"model": "jaffe"})),
        &scatter(json!({"model": "jaffe", "spread": "two", "occlusion": "gated"})),
    )
}

/// A structure 6 m deep under a sky and a sun.
fn daylight() -> Vec<Effect> {
    let mut base = json!({
        "scene": {"kind": "procedural", "family": "structure", "seed": 5, "light": "albedo"},
        "water": water()
    });
    merge(&mut base, &json!({"water": {"depth_m": 6}}));
    let above = |above: Value| json!({"water": {"from_above": above}});
    let sun = |shadow: &str, veil: &str, rays: u64| {
        above(
            json!({"surfaces": "normal", "veil": veil, "sun_share": 0.6, "ambient_rays": rays,
                     "sun": {"elevation_deg": 55, "azimuth_deg": 200, "shadow": shadow}}),
        )
    };
    let baked = json!({"scene": {"light": "baked"},
                       "water": {"ambient": "exposed", "from_above": {"veil": "physical"}}});
    vec![
        Effect::new(
            "veil by direction",
            &base,
            &sun("hard", "constant", 32),
            &sun("hard", "physical", 32),
        ),
        Effect::new(
            "daylight by slope and depth",
            &base,
            &baked,
            &sun("hard", "physical", 32),
        ),
        Effect::new(
            "shadows of daylight",
            &base,
            &sun("none", "physical", 0),
            &sun("hard", "physical", 32),
        ),
    ]
}

//! Random waters: presets and free coefficients, with either form of forward scatter.

use optics::preset::presets;
use optics::water::Water;
use spec::{ForwardScatter, HoleRule, Optics, ScatterModel, ScatterSource};

/// A water that can be rendered.
pub(super) struct RandomWater {
    /// Form and preset.
    pub(super) name: String,
    /// Its description.
    pub(super) request: spec::Water,
    /// Focal length of the camera, pixels.
    pub(super) focal_px: f64,
    /// What the description resolves to.
    pub(super) water: Water,
}

impl RandomWater {
    /// Draws until a water can be rendered.
    pub(super) fn draw(unit: &impl Fn(u64) -> f64) -> Self {
        let attempt = |attempt: u64| Self::attempt(&|what| unit(100 + 40 * attempt + what));
        (0..).find_map(attempt).expect("some water can be rendered")
    }

    fn attempt(unit: &impl Fn(u64) -> f64) -> Option<Self> {
        let gathers = unit(0) < 0.5;
        let model = if gathers {
            ScatterModel::Simplified
        } else {
            ScatterModel::Jaffe
        };
        let source = if unit(1) < 0.2 {
            ScatterSource::Direct
        } else {
            ScatterSource::Radiance
        };
        let three =
            |least: f64, ratio: f64, first: u64| Some([0, 1, 2].map(|c| least * ratio.powf(unit(first + c))));
        let free_spread = unit(2) < 0.6;
        let scatter = ForwardScatter {
            spread_px_per_m: if free_spread { three(0.01, 300.0, 3) } else { None },
            spread_offset_px: if free_spread && unit(6) < 0.5 {
                three(0.02, 100.0, 7)
            } else {
                None
            },
            source,
            ..model.into()
        };
        let holes = if unit(10) < 0.3 {
            HoleRule::RangeM(1.0 + 30.0 * unit(11))
        } else {
            HoleRule::Background
        };
        let preset = presets().get((unit(12) * presets().len() as f64) as usize);
        let free = unit(13) < 0.4;
        let request = spec::Water {
            range_scale: 0.1 * 30f64.powf(unit(23)),
            holes,
            ..Optics {
                preset: preset.filter(|_| !free).map(|preset| preset.name.to_owned()),
                absorption_per_m: if free { three(0.01, 100.0, 14) } else { None },
                scattering_per_m: if free { three(0.01, 200.0, 17) } else { None },
                veiling_light: if free { three(0.02, 20.0, 20) } else { None },
                forward_scatter: Some(scatter),
                ..Optics::default()
            }
            .into()
        };
        let focal_px = 60.0 * 15f64.powf(unit(24));
        let water = Water::resolve(&request, focal_px).ok()?;
        let form = if gathers { "simplified" } else { "jaffe" };
        let preset = water.preset().filter(|_| !free).unwrap_or("free");
        Some(Self {
            name: format!("{form}, {preset}"),
            request,
            focal_px,
            water,
        })
    }
}

//! A thinned frame with and without the occlusion of scattered light.

use imaging::Rgb;
use optics::chain;
use optics::forward_scatter::KernelCache;
use optics::plan::{Plan, SceneBounds};
use optics::water::Water;
use spec::Fidelity;

use super::{Light, Preview};

/// Kernels of each layer of a thinned picture, whose scattered light spreads by a few pixels.
const TERMS: usize = 4;

impl Preview<'_> {
    /// `None` without layers.
    pub(super) fn with_occlusion(&self) -> Option<[Rgb<f32>; 2]> {
        let water = self.context.setting.around.as_ref()?;
        self.layering.as_ref()?;
        let surfaces = self.light_surfaces(Light::default());
        Some([
            self.scatter(&surfaces, water)?,
            self.scatter(&surfaces, &water.without_layers())?,
        ])
    }

    /// The picture with forward scatter. `None` if the frame cannot be rendered.
    fn scatter(&self, surfaces: &Rgb<f32>, water: &Water) -> Option<Rgb<f32>> {
        let range = self.context.prepared.scene.range.as_ref()?;
        let mut bounds = SceneBounds::measure(surfaces, range, water);
        bounds.layering = bounds.layering.and(self.layering.clone());
        let plan = Plan::for_water(&bounds, water, Fidelity::Terms(TERMS));
        let layers = chain::water(surfaces, range, water, &plan, &mut KernelCache::new());
        layers.ok().map(|layers| layers.scattered)
    }
}

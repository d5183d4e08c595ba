//! Directions drawn toward lamps and the sun.

use imaging::vector::DVec3;

use super::Walk;
use crate::phase::versine;

/// Highest scattering order with aimed directions. Each of their draws can double the weight of a path, and a few paths would
/// have all the light after many.
const MOST_AIMED: usize = 8;
/// Phase function of wide scattering, 1/sr: the unit of the light expected toward a source.
const WIDE: f64 = 0.01;
/// Share of aimed directions within the beams of all lamps.
const AIMED: f64 = 0.5;
/// Factor on the share of a lamp outside its beam.
const OUTSIDE: f64 = 0.2;

impl<const N: usize> Walk<'_, N> {
    /// Chooses a lamp or the sun at random and returns its direction; `None` for an unaimed draw. Without aimed draws few paths hit the
    /// forward peak of the phase function toward a source, and the estimate is usually too low.
    pub(super) fn source_to_aim_at(&mut self, place: DVec3) -> Option<DVec3> {
        if !self.aims() {
            return None;
        }
        let mut unit = self.dice.next();
        for source in 0..self.sources() {
            let share = self.aim_share(source, place);
            if unit < share {
                return self.toward_source(source, place);
            }
            unit -= share;
        }
        None
    }

    /// Share of a source among the directions from a place.
    fn aim_share(&self, source: usize, place: DVec3) -> f64 {
        let most = AIMED / self.sources() as f64;
        match self.scene.lamps.get(source) {
            Some(lamp) if lamp.profile((place + -lamp.place).normalized()) <= 0.0 => OUTSIDE * most,
            _ => most,
        }
    }

    /// The direction to a source; `None` at its center.
    fn toward_source(&self, source: usize, place: DVec3) -> Option<DVec3> {
        match self.scene.lamps.get(source) {
            Some(lamp) => {
                let away = lamp.place + -place;
                (away.length() > 0.0).then(|| away.normalized())
            }
            None => self.sun_direction(),
        }
    }

    fn sun_direction(&self) -> Option<DVec3> {
        Some(self.scene.sea?.sun?.direction)
    }

    fn sources(&self) -> usize {
        self.scene.lamps.len() + usize::from(self.sun_direction().is_some())
    }

    fn aims(&self) -> bool {
        self.order <= MOST_AIMED && self.sources() > 0 && self.scatters()
    }

    pub(super) fn scatters(&self) -> bool {
        let water = &self.scene.water;
        self.channels
            .iter()
            .any(|&channel| water[channel].scattering > 0.0)
    }

    /// Weights a direction drawn from both densities; `wanted` is the one of the light.
    pub(super) fn weigh_aim(&mut self, place: DVec3, direction: DVec3, wanted: f64) {
        if !self.aims() {
            self.importance = 1.0;
            return;
        }
        let (mut density, mut rest) = (0.0, 1.0);
        for source in 0..self.sources() {
            let share = self.aim_share(source, place);
            if let Some(toward) = self.toward_source(source, place) {
                density += share * self.scene.phase.density(versine(toward, direction));
                rest -= share;
            }
        }
        let factor = wanted / (rest * wanted + density);
        self.weight.iter_mut().for_each(|weight| *weight *= factor);
        self.importance = 1.0 + density / WIDE;
    }
}

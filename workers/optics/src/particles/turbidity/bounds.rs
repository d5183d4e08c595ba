//! Bounds of the mean factor over many stretches of rays.

use imaging::vector::dot;

use super::Field;

/// Rays about a central one, and intervals of the ranges between which each is averaged.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stretch {
    /// Unit vector along the central ray.
    pub(crate) ray: [f64; 3],
    /// Longest difference of any of the unit vectors from the central one.
    pub(crate) turned: f64,
    /// Least and greatest begin and end, m.
    pub(crate) from_m: [f64; 2],
    pub(crate) to_m: [f64; 2],
}

impl Field {
    /// The contrast of the field, within 0..=1.
    pub(crate) fn contrast(&self) -> f64 {
        self.turbidity.contrast
    }

    /// Least and greatest mean of m over any of these stretches.
    ///
    /// Each cosine is averaged over the central stretch; on another one its phase differs by at most the wave vector times the
    /// distance, and an end that moves changes a mean by `min(|q|, 2/length)` per meter at most.
    pub(crate) fn bound_mean(&self, stretch: &Stretch) -> [f64; 2] {
        let (least, most) = self.extremes();
        let Stretch {
            ray,
            turned,
            from_m,
            to_m,
        } = *stretch;
        if !to_m[1].is_finite() {
            return [least, most];
        }
        let middle = |ends: [f64; 2]| 0.5 * (ends[0] + ends[1]);
        let (center, half) = (
            0.5 * (middle(from_m) + middle(to_m)),
            0.5 * (middle(to_m) - middle(from_m)),
        );
        let moved = 0.5 * (from_m[1] - from_m[0] + to_m[1] - to_m[0]);
        let steepest = 2.0 / (to_m[0] - from_m[1]).max(1e-9);
        let (mut low, mut high) = (0.0, 0.0);
        for wave in &self.pairs {
            let along = dot(wave.vector, ray);
            let length = dot(wave.vector, wave.vector).sqrt();
            let phase = along * half;
            let share = if phase.abs() < 1e-8 {
                1.0
            } else {
                phase.sin() / phase
            };
            let mean = (wave.phase + along * center).cos() * share;
            let apart = length * turned * to_m[1] + length.min(steepest) * moved + 1e-9;
            low += (mean - apart).max(-1.0);
            high += (mean + apart).min(1.0);
        }
        [
            (1.0 + self.gain * low).max(least),
            (1.0 + self.gain * high).min(most),
        ]
    }
}

#[cfg(test)]
mod tests {
    use imaging::random::Stream;
    use spec::Turbidity;

    use super::*;
    use crate::snow::World;

    #[test]
    fn no_mean_is_beyond_its_bounds() {
        let mut widths = 0.0;
        for seed in 0..400 {
            let stream = Stream::stage(seed, "stretches");
            let unit = |what: u64| stream.unit(0, what);
            let turbidity = Turbidity {
                contrast: unit(0),
                scale_m: 0.1 * 50f64.powf(unit(1)),
            };
            let field = Field::new(&turbidity, World { seed, index: 0 });
            let ray = [unit(2) - 0.5, unit(3) - 0.5, 1.0];
            let length = dot(ray, ray).sqrt();
            let ray = ray.map(|v| v / length);
            let (turned, from, to) = (0.1 * unit(4), 2.0 * unit(5), 3.0 + 3.0 * unit(6));
            let widest = 0.3 * unit(7);
            let stretch = Stretch {
                ray,
                turned,
                from_m: [from, from + widest],
                to_m: [to, to + widest],
            };
            let [least, most] = field.bound_mean(&stretch);
            widths += (most - least) / 400.0;
            for trial in 0..50 {
                let draw = |what: u64| stream.unit(1 + trial, what);
                let aside = [0, 1, 2].map(|i| ray[i] + turned / 1.8 * (draw(i as u64) - 0.5));
                let length = dot(aside, aside).sqrt();
                let aside = aside.map(|v| v / length);
                let (begin, end) = (from + widest * draw(3), to + widest * draw(4));
                let mean = (field.path_m(aside, end) - field.path_m(aside, begin)) / (end - begin);
                assert!(least <= mean + 1e-9 && mean <= most + 1e-9, "{seed}: {mean}");
            }
        }
        assert!(widths < 1.6, "{widths}");
    }
}

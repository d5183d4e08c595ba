//! Water coefficients and their variation over space.

use imaging::vector::DVec3;
use optics::turbidity::Field;

/// WaterCoefficients of one channel, 1/m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WaterCoefficients {
    /// a, at least 0.
    pub absorption: f64,
    /// b, at least 0.
    pub scattering: f64,
}

impl WaterCoefficients {
    /// c = a + b.
    #[must_use]
    pub fn attenuation(&self) -> f64 {
        self.absorption + self.scattering
    }

    /// b/c; 0 without either.
    #[must_use]
    pub fn albedo(&self) -> f64 {
        if self.scattering > 0.0 {
            self.scattering / self.attenuation()
        } else {
            0.0
        }
    }
}

/// The turbidity factor m of all coefficients.
#[derive(Debug, Clone, PartialEq)]
pub enum TurbidityField {
    /// 1 everywhere.
    Even,
    /// The patches of a frame, in the axes of its camera.
    Patches(Box<Field>),
    /// Horizontal layers.
    Layers(WaterLayers),
}

/// Horizontal layers of water with a factor each.
#[derive(Debug, Clone, PartialEq)]
pub struct WaterLayers {
    /// Unit vector against gravity, camera axes.
    pub up: DVec3,
    /// Depth of the origin below the surface, m.
    pub depth_m: f64,
    /// Depths of the boundaries between layers, ascending, m.
    pub edges_m: Vec<f64>,
    /// Factor of each layer from the surface down: one more than edges.
    pub factors: Vec<f64>,
}

impl WaterLayers {
    fn depth(&self, point: DVec3) -> f64 {
        self.depth_m - self.up.dot(point)
    }

    fn factor(&self, depth: f64) -> f64 {
        self.factors[self.edges_m.partition_point(|&edge| edge <= depth)]
    }

    /// ∫ m from the first edge to a depth.
    fn sum(&self, depth: f64) -> f64 {
        let Some(&first) = self.edges_m.first() else {
            return self.factors[0] * depth;
        };
        if depth <= first {
            return self.factors[0] * (depth - first);
        }
        let mut sum = 0.0;
        for (k, &edge) in self.edges_m.iter().enumerate() {
            let end = self.edges_m.get(k + 1).copied().unwrap_or(f64::INFINITY);
            sum += self.factors[k + 1] * (depth.min(end) - edge).max(0.0);
        }
        sum
    }

    fn meters(&self, origin: DVec3, direction: DVec3, distance: f64) -> f64 {
        let (from, fall) = (self.depth(origin), -self.up.dot(direction));
        if (fall * distance).abs() < 1e-9 || !distance.is_finite() {
            // Horizontal or unbounded: only the final layer counts.
            let depth = if distance.is_finite() || fall == 0.0 {
                from
            } else {
                fall.signum() * f64::INFINITY
            };
            return self.factor(depth) * distance;
        }
        (self.sum(from + fall * distance) - self.sum(from)) / fall
    }
}

impl TurbidityField {
    /// m at a point.
    #[must_use]
    pub fn factor(&self, point: DVec3) -> f64 {
        match self {
            Self::Even => 1.0,
            Self::Patches(field) => field.factor_at(point.into()).max(0.0),
            Self::Layers(layers) => layers.factor(layers.depth(point)),
        }
    }

    /// Upper bound of m.
    #[must_use]
    pub fn most(&self) -> f64 {
        match self {
            Self::Even => 1.0,
            Self::Patches(field) => field.extremes().1,
            Self::Layers(layers) => layers.factors.iter().copied().fold(0.0, f64::max),
        }
    }

    /// ∫ m along a ray: its equivalent length in water of the mean, m.
    #[must_use]
    pub fn meters(&self, origin: DVec3, direction: DVec3, distance: f64) -> f64 {
        match self {
            Self::Even => distance,
            Self::Patches(_) if !distance.is_finite() => distance,
            Self::Patches(field) => field.path_from(origin.into(), direction.into(), distance),
            Self::Layers(layers) => layers.meters(origin, direction, distance),
        }
    }

    pub(crate) fn is_even(&self) -> bool {
        matches!(self, Self::Even)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use imaging::vector::vec3;

    #[test]
    fn a_path_through_layers_is_the_sum_of_its_parts() {
        let turbidity = TurbidityField::Layers(WaterLayers {
            up: vec3(0.0, -1.0, 0.0),
            depth_m: 5.0,
            edges_m: vec![4.0, 6.0],
            factors: vec![0.5, 1.0, 3.0],
        });
        let down = vec3(0.0, 1.0, 0.0);
        let origin = vec3(0.0, -2.0, 0.0);
        // From 3 m to 8 m: 1 m of 0.5, 2 m of 1, 2 m of 3.
        assert!((turbidity.meters(origin, down, 5.0) - 8.5).abs() < 1e-12);
        assert!((turbidity.meters(vec3(0.0, 3.0, 0.0), -down, 5.0) - 8.5).abs() < 1e-12);
        assert_eq!(turbidity.meters(origin, vec3(1.0, 0.0, 0.0), 4.0), 2.0);
        assert_eq!((turbidity.factor(origin), turbidity.most()), (0.5, 3.0));
        assert_eq!(turbidity.meters(origin, down, f64::INFINITY), f64::INFINITY);
    }
}

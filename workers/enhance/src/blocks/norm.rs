//! Stretching a plane to 0..=1.

use imaging::Plane;

/// A plane with a smaller span is flat.
pub const FLAT: f64 = 1e-6;

/// The least and the greatest of some values.
#[must_use]
pub fn range(values: &[f64]) -> (f64, f64) {
    // Independent lanes let the loop vectorize; the order of minima does not matter.
    const LANES: usize = 8;
    let first = values[0];
    let (mut low, mut high) = ([first; LANES], [first; LANES]);
    let (whole, rest) = values.as_chunks::<LANES>();
    for chunk in whole {
        for i in 0..LANES {
            low[i] = if chunk[i] < low[i] { chunk[i] } else { low[i] };
            high[i] = if chunk[i] > high[i] { chunk[i] } else { high[i] };
        }
    }
    let all =
        |lanes: [f64; LANES], pick: fn(f64, f64) -> f64| lanes.iter().chain(rest).copied().fold(first, pick);
    (all(low, f64::min), all(high, f64::max))
}

/// `(z - min) / (max - min)`, or 0 everywhere if `max - min` is at most [`FLAT`]. The plane must not be empty.
#[must_use]
pub fn normalized(mut plane: Plane<f64>) -> Plane<f64> {
    let (low, high) = range(plane.data());
    let scale = if high - low > FLAT {
        1.0 / (high - low)
    } else {
        0.0
    };
    for value in plane.data_mut() {
        *value = (*value - low) * scale;
    }
    plane
}

/// `reach (norm(d) + d0)` of a relative distance d: the distance in units of attenuation.
#[must_use]
pub(crate) fn distance_of(relative: Plane<f64>, nearest: f64, reach: f64) -> Plane<f64> {
    let mut distance = normalized(relative);
    for value in distance.data_mut() {
        *value = reach * (*value + nearest);
    }
    distance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_become_zero_and_one() {
        let plane = Plane::from_fn(5, 3, |x, y| (3 * x + y) as f64 - 4.0);
        assert_eq!(range(plane.data()), (-4.0, 10.0));
        let normalized = normalized(plane);
        assert_eq!((normalized.pixel(0, 0), normalized.pixel(4, 2)), (0.0, 1.0));
    }

    #[test]
    fn a_flat_plane_becomes_zero() {
        let plane = Plane::new(2, 1, vec![0.3, 0.3 + 1e-7]).unwrap();
        assert_eq!(normalized(plane).data(), &[0.0, 0.0]);
    }
}

//! Schema of a type, and its numbers outside their limits.

use crate::schema::{Field, Shape};

/// A type of the description.
pub trait Described {
    /// Schema of a value of this type.
    const SHAPE: Shape;

    /// Name of the type, such as `Camera`.
    const NAME: &'static str;

    /// Calls `found` with each present numeric field; nested objects are skipped.
    fn numbers(&self, found: &mut dyn FnMut(&'static Field, &[f64])) {
        let _ = found;
    }
}

/// A number outside the limits of its field.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{field} is {value}{}; must be {limit}", .part.map(|part| format!(" in {part}")).unwrap_or_default())]
pub struct Beyond {
    /// The field.
    pub field: &'static str,
    /// Component of three numbers: R, G, B or x, y, z.
    pub part: Option<char>,
    /// The number.
    pub value: f64,
    /// The limits, such as `0..=1`.
    pub limit: String,
}

/// Returns every number of this value outside the limits of its field; nested objects are skipped.
#[must_use]
pub fn beyond(value: &impl Described) -> Vec<Beyond> {
    let mut all = Vec::new();
    value.numbers(&mut |field, numbers| {
        let (range, parts) = match field.shape {
            Shape::Number(range) => (range, None),
            Shape::Rgb(range) => (range, Some(['R', 'G', 'B'])),
            Shape::Vector(range) => (range, Some(['x', 'y', 'z'])),
            _ => return,
        };
        let wrong = numbers
            .iter()
            .enumerate()
            .filter(|(_, number)| !range.holds(**number));
        all.extend(wrong.map(|(position, number)| Beyond {
            field: field.name,
            part: parts.map(|parts| parts[position]),
            value: *number,
            limit: range.to_string(),
        }));
    });
    all
}

/// The numbers of a field: one, three, or an empty slice if absent.
pub(crate) trait Floats {
    fn floats(&self) -> &[f64];
}

impl Floats for f64 {
    fn floats(&self) -> &[f64] {
        std::slice::from_ref(self)
    }
}

impl Floats for [f64; 3] {
    fn floats(&self) -> &[f64] {
        self
    }
}

impl<T: Floats> Floats for Option<T> {
    fn floats(&self) -> &[f64] {
        self.as_ref().map_or(&[], T::floats)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::suspended::Turbidity;
    use crate::water::{HoleRule, Optics};

    #[test]
    fn every_number_beyond_its_limits_is_named_with_its_value() {
        let wrong = Turbidity {
            contrast: f64::NAN,
            scale_m: 0.0,
        };
        let texts: Vec<_> = beyond(&wrong).iter().map(ToString::to_string).collect();
        let expected = [
            "contrast is NaN; must be 0..=0.95",
            "scale_m is 0; must be 0.05..=1000",
        ];
        assert_eq!(texts, expected);
        let optics = Optics {
            scattering_per_m: Some([0.1, 0.2, 5000.0]),
            ..Optics::default()
        };
        assert_eq!(
            beyond(&optics)[0].to_string(),
            "scattering_per_m is 5000 in B; must be 0..=1000"
        );
        assert_eq!(beyond(&HoleRule::RangeM(1e6))[0].field, "range_m");
        assert_eq!(beyond(&HoleRule::Reject), []);
    }
}

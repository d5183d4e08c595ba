//! Vectors of three components in f32 or f64. The order of operations is fixed, since frames are compared byte by byte:
//! a dot product is `x x' + y y' + z z'` from left to right, a unit vector a product with the reciprocal of the length.

use std::ops::{Add, Mul, Neg, Sub};

/// A point or a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vector<T> {
    /// First component.
    pub x: T,
    /// Second component.
    pub y: T,
    /// Third component.
    pub z: T,
}

/// A vector in single precision.
pub type Vec3 = Vector<f32>;
/// A vector in double precision.
pub type DVec3 = Vector<f64>;

/// Shorthand for a [`Vector`].
#[inline(always)]
pub const fn vec3<T: Copy>(x: T, y: T, z: T) -> Vector<T> {
    Vector { x, y, z }
}

impl<T: Copy> Vector<T> {
    /// Applies a function to each component.
    #[must_use]
    #[inline(always)]
    pub fn map<U>(self, change: impl Fn(T) -> U) -> Vector<U> {
        let Self { x, y, z } = self;
        [change(x), change(y), change(z)].into()
    }

    /// Combines each pair of components by a function.
    #[must_use]
    #[inline(always)]
    pub fn zip(self, other: Self, join: impl Fn(T, T) -> T) -> Self {
        [
            join(self.x, other.x),
            join(self.y, other.y),
            join(self.z, other.z),
        ]
        .into()
    }
}

/// The dot product of two arrays, in the order of [`Vector::dot`].
#[must_use]
#[inline(always)]
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    Vector::from(a).dot(b.into())
}

impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T>> Vector<T> {
    /// `x x' + y y' + z z'`.
    #[must_use]
    #[inline(always)]
    pub fn dot(self, other: Self) -> T {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The cross product of a right-handed frame.
    #[must_use]
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        vec3(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }
}

macro_rules! lengths {
    ($real:ty) => {
        impl Vector<$real> {
            /// `sqrt(v·v)`.
            #[must_use]
            #[inline(always)]
            pub fn length(self) -> $real {
                self.dot(self).sqrt()
            }

            /// `v (1 / |v|)`: the direction of a nonzero vector.
            #[must_use]
            #[inline(always)]
            pub fn normalized(self) -> Self {
                self * (1.0 / self.length())
            }
        }
    };
}

lengths!(f32);
lengths!(f64);

impl DVec3 {
    /// The nearest vector in single precision.
    #[must_use]
    pub fn as_f32(self) -> Vec3 {
        vec3(self.x as f32, self.y as f32, self.z as f32)
    }
}

impl Vec3 {
    /// The same vector in double precision.
    #[must_use]
    pub fn as_f64(self) -> DVec3 {
        vec3(self.x.into(), self.y.into(), self.z.into())
    }
}

impl<T> From<[T; 3]> for Vector<T> {
    #[inline(always)]
    fn from([x, y, z]: [T; 3]) -> Self {
        Self { x, y, z }
    }
}

impl<T> From<Vector<T>> for [T; 3] {
    #[inline(always)]
    fn from(v: Vector<T>) -> Self {
        [v.x, v.y, v.z]
    }
}

impl<T: Add<Output = T>> Add for Vector<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        [self.x + other.x, self.y + other.y, self.z + other.z].into()
    }
}

impl<T: Sub<Output = T>> Sub for Vector<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        [self.x - other.x, self.y - other.y, self.z - other.z].into()
    }
}

impl<T: Copy + Mul<Output = T>> Mul<T> for Vector<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        [self.x * factor, self.y * factor, self.z * factor].into()
    }
}

impl<T: Neg<Output = T>> Neg for Vector<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        [-self.x, -self.y, -self.z].into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cross_product_is_at_right_angles_to_both_and_right_handed() {
        let (a, b) = (vec3(1.0, 2.0, -3.0), vec3(0.5, -4.0, 2.0));
        let across = a.cross(b);
        assert_eq!((across.dot(a), across.dot(b)), (0.0, 0.0));
        assert_eq!(
            vec3(1.0, 0.0, 0.0).cross(vec3(0.0, 1.0, 0.0)),
            vec3(0.0, 0.0, 1.0)
        );
    }

    #[test]
    fn a_normalized_vector_has_the_same_direction_and_length_one() {
        let v = vec3(2.0f64, -3.0, 6.0);
        assert_eq!(v.length(), 7.0);
        assert!((v.normalized() * 7.0 - v).length() < 1e-15);
        assert_eq!((-v.as_f32()).as_f64(), v * -1.0);
    }
}

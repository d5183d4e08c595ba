//! Normals of surfaces from their range.

use imaging::Plane;
use imaging::geometry::Intrinsics;
use imaging::vectorized;

use crate::attenuation::masked;

/// Two differences that are farther apart than this share of the range belong to different surfaces.
const JUMP: f32 = 0.02;

/// Unit normals in camera axes (right, down, ahead) that face the camera, from range in meters along the ray. The slope of the
/// range is the mean of the differences to both neighbors; at an edge the smaller of the two; 0 if neither neighbor has a range or
/// the frame is one pixel wide. A hole faces the camera. With `Z` the range, `v` the ray of length 1 along the optical axis and `R
/// = Z/|v|`, the surface is `R(x, y) v(x, y)` and its normal is across both of its slopes.
#[must_use]
pub fn normals_of(range: &Plane<f32>, camera: &Intrinsics) -> [Plane<f32>; 3] {
    let (width, height) = range.size();
    let mut normals = [(); 3].map(|()| Plane::filled(width, height, 0.0f32));
    // One hole before and one behind each row.
    let padded = |y: Option<usize>| {
        let mut row = vec![f32::NAN; width + 2];
        if let Some(y) = y.filter(|&y| y < height) {
            row[1..=width].copy_from_slice(range.row(y));
        }
        row
    };
    let lens = [1.0 / camera.focal_px as f32, camera.cx as f32, camera.cy as f32];
    for y in 0..height {
        let [above, row, below] = [padded(y.checked_sub(1)), padded(Some(y)), padded(Some(y + 1))];
        let [nx, ny, nz] = normals.each_mut().map(|plane| plane.row_mut(y));
        let rows = Rows {
            above: &above,
            row: &row,
            below: &below,
        };
        vectorized!(row_normals(rows, lens, y as f32, nx, ny, nz));
    }
    normals
}

/// A row with its neighbors, each with one sample more on both sides.
#[derive(Clone, Copy)]
struct Rows<'a> {
    above: &'a [f32],
    row: &'a [f32],
    below: &'a [f32],
}

#[inline(always)]
fn row_normals(
    Rows { above, row, below }: Rows<'_>,
    [inverse_focal, cx, cy]: [f32; 3],
    y: f32,
    nx: &mut [f32],
    ny: &mut [f32],
    nz: &mut [f32],
) {
    let width = nx.len();
    let (left, middle, right) = (&row[..width], &row[1..=width], &row[2..width + 2]);
    let (above, below) = (&above[1..=width], &below[1..=width]);
    let focal = 1.0 / inverse_focal;
    let v = (y - cy) * inverse_focal;
    for i in 0..width {
        let u = (i as f32 - cx) * inverse_focal;
        let inverse = 1.0 / u.mul_add(u, v.mul_add(v, 1.0)).sqrt();
        let (valid, z) = masked(middle[i]);
        let [west, east] = [slope(left[i], z, -1.0), slope(right[i], z, 1.0)];
        let [north, south] = [slope(above[i], z, -1.0), slope(below[i], z, 1.0)];
        let across = joined(west, east, z);
        let down = joined(north, south, z);
        // R = Z/|v|; its slopes, times f, follow from those of Z and of |v|.
        let planar = z * inverse;
        let shift = planar * inverse;
        let a = across.mul_add(focal, -(shift * u)) * inverse;
        let b = down.mul_add(focal, -(shift * v)) * inverse;
        // (∂/∂x) × (∂/∂y) of R (u, v, 1), divided by R/f², turned to the camera.
        let (x, y, z) = (-a, -b, a.mul_add(u, b.mul_add(v, planar)));
        // It faces the camera where its product with the ray is below 0; that product is R for (x, y, z). A selection before the
        // division: two divisions to choose from would become a branch, and the loop scalar.
        let x = if valid { x } else { u };
        let y = if valid { y } else { v };
        let z = if valid { z } else { 1.0 };
        let scale = -1.0 / x.mul_add(x, y.mul_add(y, z * z)).sqrt();
        (nx[i], ny[i], nz[i]) = (x * scale, y * scale, z * scale);
    }
}

/// The difference to a neighbor per pixel, and whether it has a range.
#[inline(always)]
fn slope(neighbor: f32, z: f32, step: f32) -> (bool, f32) {
    let (valid, neighbor) = masked(neighbor);
    (valid, (neighbor - z) * step)
}

#[inline(always)]
fn joined((one, a): (bool, f32), (other, b): (bool, f32), z: f32) -> f32 {
    let jump = (a - b).abs() > JUMP * z;
    let smaller = if a.abs() < b.abs() { a } else { b };
    let both = if jump { smaller } else { 0.5 * (a + b) };
    let first = if one { a } else { 0.0 };
    let alone = if other { b } else { first };
    if one & other { both } else { alone }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Range to a plane through (0, 0, 3) with this normal.
    fn wall(normal: [f64; 3], camera: &Intrinsics) -> Plane<f32> {
        Plane::from_fn(33, 21, |x, y| {
            let ray = [
                (x as f64 - camera.cx) / camera.focal_px,
                (y as f64 - camera.cy) / camera.focal_px,
                1.0,
            ];
            let along: f64 = ray.iter().zip(normal).map(|(r, n)| r * n).sum();
            (3.0 * normal[2] / along * ray.iter().map(|r| r * r).sum::<f64>().sqrt()) as f32
        })
    }

    #[test]
    fn the_normals_of_a_slanted_wall_are_its_own() {
        let camera = Intrinsics::centered(40.0, 33, 21);
        let normal = [0.48, -0.36, -0.8];
        let normals = normals_of(&wall(normal, &camera), &camera);
        for (plane, expected) in normals.iter().zip(normal) {
            // Inside; a border has one neighbor, and the slope of a wall in perspective is not constant.
            for y in 1..20 {
                for x in 1..32 {
                    assert!(
                        (f64::from(plane.pixel(x, y)) - expected).abs() < 2e-3,
                        "({x}, {y})"
                    );
                }
            }
        }
    }

    #[test]
    fn an_edge_takes_the_surface_that_the_pixel_is_on_and_a_hole_faces_the_camera() {
        let camera = Intrinsics::centered(40.0, 33, 21);
        let flat = wall([0.0, 0.0, -1.0], &camera);
        let step = Plane::from_fn(33, 21, |x, y| {
            if x < 16 {
                flat.pixel(x, y)
            } else {
                flat.pixel(x, y) + 4.0
            }
        });
        let normals = normals_of(&step, &camera);
        assert!((normals[2].pixel(15, 10) + 1.0).abs() < 2e-3 && normals[0].pixel(15, 10).abs() < 2e-2);
        for hole in [f32::NAN, 0.0, f32::INFINITY] {
            let holes = normals_of(&Plane::filled(33, 21, hole), &camera);
            assert_eq!([0, 1, 2].map(|i| holes[i].pixel(16, 10)), [0.0, 0.0, -1.0]);
            assert!(
                holes
                    .iter()
                    .all(|plane| plane.data().iter().all(|v| v.is_finite()))
            );
        }
        let alone = normals_of(&Plane::filled(1, 1, 2.0), &Intrinsics::centered(1.0, 1, 1));
        assert_eq!([0, 1, 2].map(|i| alone[i].pixel(0, 0)), [0.0, 0.0, -1.0]);
    }
}

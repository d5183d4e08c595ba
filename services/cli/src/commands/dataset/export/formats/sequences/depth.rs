//! z-depth of a range picture.

use camera::geometry::{Lens, PortRefraction};
use imaging::Plane;
use imaging::codec::{decode_mask, encode_png};

use crate::commands::dataset::export::formats::view::View;

/// Meters of a code of the artifact `range`.
const RANGE_UNIT_M: f64 = 0.001;

/// Distances along the optical axis, meters, from a stored range along the ray; NaN without a return. The rays are those of the
/// exported camera, with its distortion.
pub(crate) fn read_z_depth(range: &[u8], view: &View) -> Result<Plane<f32>, String> {
    let codes = decode_mask(range).map_err(|error| error.to_string())?;
    let (width, height) = codes.size();
    if (width as u64, height as u64) != (view.width, view.height) {
        return Err(format!(
            "it is {width}×{height}, the picture {}×{}",
            view.width, view.height
        ));
    }
    let lens = Lens {
        camera: view.intrinsics,
        distortion: view.distortion.unwrap_or_default(),
        refraction: PortRefraction::None,
    };
    let depth = Plane::from_fn(width, height, |x, y| match codes.pixel(x, y) {
        0 => f32::NAN,
        code => (f64::from(code) * RANGE_UNIT_M / ray_length(&lens, x, y)) as f32,
    });
    Ok(depth)
}

/// Length of the ray of a pixel up to z = 1; NaN for a pixel that no direction falls on.
fn ray_length(lens: &Lens, x: usize, y: usize) -> f64 {
    let ray = lens.camera.ray(x as f64, y as f64);
    let ideal = lens.undistorted(ray.x, ray.y);
    ideal.map_or(f64::NAN, |(x, y)| (1.0 + x * x + y * y).sqrt())
}

/// z-depth as a picture of 16 bits.
pub(crate) struct DepthPicture {
    pub(crate) png: Vec<u8>,
    /// Pixels beyond the largest code, which are 0.
    pub(crate) far_pixels: u64,
}

impl DepthPicture {
    /// Encodes distances with this many codes per meter; 0 without a return.
    pub(crate) fn encode(z_depth: &Plane<f32>, codes_per_m: f64) -> Result<Self, String> {
        let mut far_pixels = 0;
        let codes = z_depth.data().iter().map(|&depth| {
            let code = (f64::from(depth) * codes_per_m).round();
            let is_far = code > f64::from(u16::MAX);
            far_pixels += u64::from(is_far);
            // NaN becomes 0.
            if is_far { 0 } else { code as u16 }
        });
        let codes: Vec<u16> = codes.collect();
        let plane =
            Plane::new(z_depth.width(), z_depth.height(), codes).map_err(|error| error.to_string())?;
        let png = encode_png(&plane.into()).map_err(|error| error.to_string())?;
        Ok(Self { png, far_pixels })
    }
}

#[cfg(test)]
mod tests {
    use spec::{Distortion, Intrinsics};

    use super::*;

    fn view(distortion: Option<Distortion>) -> View {
        View {
            width: 5,
            height: 3,
            intrinsics: Intrinsics::centered(4.0, 5, 3),
            distortion,
            world_from_camera: [[0.0; 4]; 4],
            baseline_m: None,
        }
    }

    #[test]
    fn a_wall_across_the_axis_has_one_z_depth_through_any_lens() {
        let barrel = Distortion {
            k1: -0.2,
            p1: 0.01,
            ..Distortion::default()
        };
        for distortion in [None, Some(barrel)] {
            let view = view(distortion);
            let lens = Lens {
                camera: view.intrinsics,
                distortion: distortion.unwrap_or_default(),
                refraction: PortRefraction::None,
            };
            let range = Plane::from_fn(5, 3, |x, y| (20_000.0 * ray_length(&lens, x, y)).round() as u16);
            let range = encode_png(&range.into()).unwrap();
            let depth = read_z_depth(&range, &view).unwrap();
            for z in depth.data() {
                assert!((z - 20.0).abs() < 1e-3, "{z}");
            }
        }
        let small = encode_png(&Plane::filled(2, 2, 7u16).into()).unwrap();
        assert!(read_z_depth(&small, &view(None)).is_err_and(|message| message.contains("2×2")));
    }

    #[test]
    fn holes_and_far_pixels_are_zero_and_far_ones_are_counted() {
        let depth = Plane::new(4, 1, vec![f32::NAN, 2.0, 13.107, 13.2]).unwrap();
        let picture = DepthPicture::encode(&depth, 5000.0).unwrap();
        let codes = decode_mask(&picture.png).unwrap();
        assert_eq!(
            (codes.data(), picture.far_pixels),
            (&[0, 10_000, 65_535, 0][..], 1)
        );
    }
}

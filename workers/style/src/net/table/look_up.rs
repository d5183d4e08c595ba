//! Applies a table to a frame row by row: positions and weights in vectors, then the table's nodes pixel by pixel.

use imaging::vectorized;
use imaging::{Plane, Rgb};

use super::{ColorTable, NODES, STEPS};

/// Buffers for a row, reused between frames; their contents do not affect results.
#[derive(Debug, Default)]
pub struct TableScratch {
    places: [Vec<u32>; 4],
    shares: [Vec<f32>; 4],
}

impl ColorTable {
    /// Repaints a frame of sRGB-encoded samples in 0..=1 and returns the same encoding.
    #[must_use]
    pub fn apply(&self, encoded: &Rgb<f32>, scratch: &mut TableScratch) -> Rgb<f32> {
        let (width, height) = encoded.size();
        for (places, shares) in scratch.places.iter_mut().zip(&mut scratch.shares) {
            places.resize(width, 0);
            shares.resize(width, 0.0);
        }
        let mut out = [(); 3].map(|()| vec![0.0f32; width * height]);
        let planes = encoded.planes();
        for y in 0..height {
            let rows = planes.each_ref().map(|plane| plane.row(y));
            let styled = out.each_mut().map(|plane| &mut plane[y * width..(y + 1) * width]);
            let (places, shares) = (&mut scratch.places, &mut scratch.shares);
            vectorized!(locate(rows, places, shares));
            self.mix(places, shares, styled);
        }
        let planes = out.map(|plane| Plane::new(width, height, plane).expect("as many samples as the frame"));
        Rgb::new(planes).expect("three planes of one frame")
    }

    fn mix(&self, places: &[Vec<u32>; 4], shares: &[Vec<f32>; 4], styled: [&mut [f32]; 3]) {
        let [r, g, b] = styled;
        let width = r.len();
        let (g, b) = (&mut g[..width], &mut b[..width]);
        let places = places.each_ref().map(|row| &row[..width]);
        let shares = shares.each_ref().map(|row| &row[..width]);
        for x in 0..width {
            let mut sum = [0.0f32; 4];
            for corner in 0..4 {
                let (node, share) = (&self.nodes[places[corner][x] as usize], shares[corner][x]);
                for channel in 0..4 {
                    sum[channel] += node[channel] * share;
                }
            }
            (r[x], g[x], b[x]) = (sum[0], sum[1], sum[2]);
        }
    }
}

/// Corners and weights of the colors of a row, branch-free. Integers are stored as floats until the end: below 2²³ they
/// are exact, and adding 2²³ leaves them in the low bits.
#[inline(always)]
fn locate(rows: [&[f32]; 3], places: &mut [Vec<u32>; 4], shares: &mut [Vec<f32>; 4]) {
    const LAST: f32 = (NODES - 1) as f32;
    /// Adding and subtracting it rounds to an integer.
    const ROUND: f32 = 12_582_912.0;
    const WHOLE: f32 = 8_388_608.0;
    let [red, green, blue] = rows;
    let width = red.len();
    let (green, blue) = (&green[..width], &blue[..width]);
    let [p0, p1, p2, p3] = places.each_mut().map(|row| &mut row[..width]);
    let [s0, s1, s2, s3] = shares.each_mut().map(|row| &mut row[..width]);
    let [red_step, green_step, blue_step] = STEPS.map(|step| step as f32);
    let all = red_step + green_step + blue_step;
    let index = |value: f32| (value + WHOLE).to_bits() & 0x007f_ffff;
    for x in 0..width {
        let place = |value: f32| value.max(0.0).min(1.0) * LAST;
        // For an integral position between two cells either is correct: the color is the same.
        let cell = |place: f32| ((place - 0.5 + ROUND) - ROUND).min(LAST - 1.0);
        let (r, g, b) = (place(red[x]), place(green[x]), place(blue[x]));
        let (cell_r, cell_g, cell_b) = (cell(r), cell(g), cell(b));
        let base = cell_r * red_step + cell_g * green_step + cell_b * blue_step;
        let (r, g, b) = (r - cell_r, g - cell_g, b - cell_b);
        let most = if r >= g && r >= b {
            red_step
        } else if g >= b {
            green_step
        } else {
            blue_step
        };
        let least = if b <= r && b <= g {
            blue_step
        } else if g <= r {
            green_step
        } else {
            red_step
        };
        let (high, low) = (r.max(g).max(b), r.min(g).min(b));
        let middle = r.min(g).max(r.max(g).min(b));
        (p0[x], p1[x]) = (index(base), index(base + most));
        (p2[x], p3[x]) = (index(base + all - least), index(base + all));
        (s0[x], s1[x], s2[x], s3[x]) = (1.0 - high, high - middle, middle - low, low);
    }
}

#[cfg(test)]
mod tests {
    use imaging::random::Stream;

    use super::*;

    /// A few roundings of numbers up to 16.
    const FLOAT: f32 = 4e-6;

    #[test]
    fn a_frame_is_looked_up_like_its_pixels() {
        let stream = Stream::stage(1, "table");
        let nodes = (0..(NODES * NODES * NODES) as u64)
            .map(|node| [0, 1, 2, 3].map(|channel| stream.unit(node, channel) as f32))
            .collect();
        let table = ColorTable { nodes };
        let mut scratch = TableScratch::default();
        for (width, height) in [(1, 1), (7, 3), (640, 2), (53, 31), (0, 4)] {
            // Ties and integral positions are as common as the others.
            let frame = Rgb::from_fn(width, height, |x, y| {
                let position = (y * width + x) as u64;
                let value = |channel| match stream.bits(9000 + position, channel) % 4 {
                    0 => (stream.bits(position, 7) % 17) as f32 / 16.0,
                    1 => stream.unit(position, 8) as f32,
                    2 => stream.unit(position, channel) as f32 * 1.2 - 0.1,
                    _ => stream.unit(position, channel) as f32,
                };
                [value(0), value(1), value(2)]
            });
            let styled = table.apply(&frame, &mut scratch);
            assert_eq!(styled.size(), (width, height));
            for y in 0..height {
                for x in 0..width {
                    for (found, expected) in styled
                        .pixel(x, y)
                        .into_iter()
                        .zip(table.look_up(frame.pixel(x, y)))
                    {
                        assert!(
                            (found - expected).abs() < FLOAT,
                            "({x}, {y}): {found} is not {expected}"
                        );
                    }
                }
            }
        }
    }
}

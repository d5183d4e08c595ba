//! Pictures as tensors: scale, layout and padding.

use imaging::Rgb8;

use crate::role::{Layout, PictureInput};

/// The output tensor of a network.
#[derive(Clone, Copy)]
pub(super) struct Output<'a> {
    pub(super) shape: &'a [i64],
    pub(super) values: &'a [f32],
}

/// Writes a picture into the input of a network, reflected beyond its right and lower edges.
pub(super) fn fill(
    samples: &mut Vec<f32>,
    picture: &Rgb8,
    (columns, rows): (usize, usize),
    input: PictureInput,
) {
    samples.clear();
    samples.reserve(3 * columns * rows);
    let across: Vec<usize> = (0..columns).map(|x| reflect(x, picture.width())).collect();
    let down: Vec<usize> = (0..rows).map(|y| reflect(y, picture.height())).collect();
    let planes: &[&[usize]] = match input.layout {
        Layout::ChannelsFirst => &[&[0], &[1], &[2]],
        Layout::ChannelsLast => &[&[0, 1, 2]],
    };
    for channels in planes {
        for &y in &down {
            for &x in &across {
                let pixel = picture.pixel(x, y);
                samples.extend(channels.iter().map(|&channel| input.scale.value(pixel[channel])));
            }
        }
    }
}

/// The position of a pixel beyond the edge, without repeating the edge.
fn reflect(position: usize, side: usize) -> usize {
    let period = 2 * (side - 1);
    if period == 0 {
        return 0;
    }
    let position = position % period;
    position.min(period - position)
}

/// The values of a network's picture in 0 to 1, three for each pixel of the cropped picture. `padded` is the size that the network
/// got.
pub(super) fn read(
    Output { shape, values }: Output<'_>,
    padded: (usize, usize),
    (width, height): (usize, usize),
    input: PictureInput,
) -> Result<Vec<f32>, String> {
    let (columns, rows) = padded;
    let expected = input.layout.shape(columns, rows);
    let is_expected = shape.len() == 4 && shape.iter().zip(expected).all(|(&side, own)| side == own as i64);
    if !is_expected {
        return Err(format!(
            "a tensor of shape {shape:?}; must have the shape {expected:?} of its input"
        ));
    }
    let mut units = Vec::with_capacity(3 * width * height);
    for y in 0..height {
        for x in 0..width {
            let pixel = y * columns + x;
            for channel in 0..3 {
                let position = match input.layout {
                    Layout::ChannelsFirst => channel * columns * rows + pixel,
                    Layout::ChannelsLast => 3 * pixel + channel,
                };
                let value = values[position];
                if !value.is_finite() {
                    return Err(format!("a sample of {value} at pixel ({x}, {y})"));
                }
                units.push(input.scale.to_unit(value));
            }
        }
    }
    Ok(units)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::role::{InputScale, SizeRule};

    fn picture() -> Rgb8 {
        Rgb8::from_fn(3, 2, |x, y| [(10 * x) as u8, (10 * y) as u8, 255])
    }

    #[test]
    fn a_padded_picture_is_reflected_and_comes_back_cropped() {
        for layout in Layout::ALL {
            let input = PictureInput {
                scale: InputScale::Codes,
                layout,
                size: SizeRule::MultipleOf(8),
            };
            let mut samples = vec![9.0; 5];
            fill(&mut samples, &picture(), (8, 8), input);
            assert_eq!(samples.len(), 3 * 64);
            let red: Vec<f32> = match layout {
                Layout::ChannelsFirst => samples[..8].to_vec(),
                Layout::ChannelsLast => samples[..24].iter().copied().step_by(3).collect(),
            };
            assert_eq!(red, [0.0, 10.0, 20.0, 10.0, 0.0, 10.0, 20.0, 10.0]);
            let shape = layout.shape(8, 8).map(|side| side as i64);
            let output = Output {
                shape: &shape,
                values: &samples,
            };
            let units = read(output, (8, 8), (3, 2), input).unwrap();
            let codes: Vec<u8> = units.iter().map(|unit| (unit * 255.0).round() as u8).collect();
            assert_eq!(codes, picture().data());
        }
    }

    #[test]
    fn one_pixel_fills_any_size() {
        let one = Rgb8::from_fn(1, 1, |_, _| [51, 102, 204]);
        let input = PictureInput::default();
        let mut samples = Vec::new();
        fill(&mut samples, &one, (4, 4), input);
        assert!(samples[..16].iter().all(|&sample| (sample - 0.2).abs() < 1e-6));
    }

    #[test]
    fn an_output_of_another_size_or_with_a_hole_is_refused() {
        let input = PictureInput::default();
        let refuse = |shape: &[i64], values: &[f32]| {
            read(Output { shape, values }, (2, 1), (2, 1), input).unwrap_err()
        };
        assert!(refuse(&[1, 3, 1, 1], &[0.5; 3]).contains("must have the shape [1, 3, 1, 2]"));
        assert!(refuse(&[1, 1, 2, 3], &[0.5; 6]).contains("[1, 1, 2, 3]"));
        let holed = [0.5, 0.5, 0.5, f32::NAN, 0.5, 0.5];
        assert!(refuse(&[1, 3, 1, 2], &holed).contains("NaN at pixel (1, 0)"));
    }
}

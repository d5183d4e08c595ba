//! Differences of the waters, measured on their pictures of the same scenes.

use std::fmt::Write as _;

use imaging::Rgb;
use style::{Library, Session};

use cli::exit::Failure;

/// Color statistics of the pictures of a water, in 8-bit codes.
struct Look {
    name: String,
    mean: [f64; 3],
    /// Standard deviation of the brightness of all pixels.
    contrast: f64,
    /// Mean difference of the brightness of neighboring pixels, at full size and at an eighth of it.
    fine: f64,
    coarse: f64,
}

/// Adds a table of the waters, and one of the distances between them.
pub(super) fn compare(text: &mut String, library: &Library) -> Result<(), Failure> {
    let mut looks = Vec::new();
    for model in library.names().into_iter().filter_map(|name| library.get(name)) {
        // The scenes are pictures without a range.
        if let Some(session) = Session::native(model).filter(|session| !session.takes_range()) {
            looks.push(Look::measure(&model.name, session)?);
        }
    }
    text.push_str(
        "\n## The waters\n\nOver 16 new scenes at alpha 1, of 255. Contrast: standard deviation of the brightness over all pixels. \
         Texture: mean difference of the brightness of neighboring pixels, at full size and after a mean over 8×8.\n\n\
         | water | mean red | green | blue | contrast | texture | texture at 1/8 |\n|---|---|---|---|---|---|---|\n",
    );
    for look in &looks {
        let [r, g, b] = look.mean;
        let _ = writeln!(
            text,
            "| {} | {r:.0} | {g:.0} | {b:.0} | {:.1} | {:.2} | {:.2} |",
            look.name, look.contrast, look.fine, look.coarse
        );
    }
    text.push_str(
        "\n| between | mean colors apart | contrast, ratio | texture, ratio | texture at 1/8, ratio |\n|---|---|---|---|---|\n",
    );
    for (index, one) in looks.iter().enumerate() {
        for other in &looks[index + 1..] {
            let squares = one.mean.iter().zip(other.mean).map(|(a, b)| (a - b) * (a - b));
            let apart = squares.sum::<f64>().sqrt();
            let ratio = |a: f64, b: f64| a.max(b) / a.min(b).max(1e-9);
            let _ = writeln!(
                text,
                "| {} and {} | {apart:.0} | {:.2} | {:.2} | {:.2} |",
                one.name,
                other.name,
                ratio(one.contrast, other.contrast),
                ratio(one.fine, other.fine),
                ratio(one.coarse, other.coarse)
            );
        }
    }
    Ok(())
}

impl Look {
    fn measure(name: &str, mut session: Session) -> Result<Self, Failure> {
        let scenes = training::new_scenes();
        let (mut count, mut sums) = (0.0, [0.0; 3]);
        let (mut light, mut squares, mut fine, mut coarse) = (0.0, 0.0, 0.0, 0.0);
        for scene in &scenes {
            let styled = session
                .apply(scene, style::ModelInputs::default())
                .map_err(|error| Failure::Other(error.into()))?;
            for (sum, plane) in sums.iter_mut().zip(styled.planes()) {
                *sum += 255.0 * plane.data().iter().map(|&v| f64::from(v)).sum::<f64>();
            }
            let gray = brightness(&styled);
            count += (gray.len() * gray[0].len()) as f64;
            light += gray.iter().flatten().sum::<f64>();
            squares += gray.iter().flatten().map(|v| v * v).sum::<f64>();
            fine += roughness(&gray) / scenes.len() as f64;
            coarse += roughness(&eighth(&gray)) / scenes.len() as f64;
        }
        let mean = light / count;
        Ok(Self {
            name: name.to_owned(),
            mean: sums.map(|sum| sum / count),
            contrast: (squares / count - mean * mean).max(0.0).sqrt(),
            fine,
            coarse,
        })
    }
}

fn brightness(picture: &Rgb<f32>) -> Vec<Vec<f64>> {
    let pixel = |x, y| {
        let [r, g, b] = picture.pixel(x, y).map(f64::from);
        255.0 * (0.299 * r + 0.587 * g + 0.114 * b)
    };
    let row = |y| (0..picture.width()).map(|x| pixel(x, y)).collect();
    (0..picture.height()).map(row).collect()
}

fn eighth(gray: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let cell = |rows: &[Vec<f64>], column: usize| {
        rows.iter()
            .flat_map(|row| &row[8 * column..8 * column + 8])
            .sum::<f64>()
            / 64.0
    };
    let row = |rows: &[Vec<f64>]| (0..rows[0].len() / 8).map(|column| cell(rows, column)).collect();
    gray.chunks_exact(8).map(row).collect()
}

fn roughness(gray: &[Vec<f64>]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (y, row) in gray.iter().enumerate() {
        for (x, value) in row.iter().enumerate() {
            let right = row.get(x + 1);
            let below = gray.get(y + 1).map(|row| &row[x]);
            for neighbor in right.into_iter().chain(below) {
                sum += (value - neighbor).abs();
                count += 1.0;
            }
        }
    }
    sum / f64::max(count, 1.0)
}

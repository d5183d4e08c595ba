//! The faster variant of IBLA against the exact one: agreement of the candidates for background light, and difference of the results.

use enhance::ibla::candidates;
use enhance::{EnhanceError, Method, Variant, run};
use imaging::{Raster, Rgb8, transfer};
use spec::IblaRefinement;

use crate::measurement::{difference, time_once};

/// Maximum difference of a channel for candidates to count as equal, in 0..=1.
const SAME: f64 = 0.01;

/// The guided variant on one picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// Whether its candidates equal those of the exact variant.
    pub is_kept: bool,
    /// Root mean square difference of the results in linear light, 0..=1.
    pub distance: f64,
    /// Milliseconds of the exact and of the guided variant.
    pub ms: [f64; 2],
}

/// Runs both variants on a picture.
///
/// # Errors
/// As [`run`].
pub fn compare(picture: &Rgb8) -> Result<Comparison, EnhanceError> {
    let source = Raster::from(picture.clone());
    let forms = [IblaRefinement::Matting, IblaRefinement::Guided];
    let (mut light, mut ms) = (Vec::new(), [0.0; 2]);
    for (form, ms) in forms.iter().zip(&mut ms) {
        let mut enhanced = None;
        *ms = time_once(|| enhanced = Some(run(&Method::ibla(*form), &source)));
        let codes = enhanced.expect("it was run")?.picture.to_rgb8();
        light.push(transfer::decode_rgb8(&codes));
    }
    let found = forms.map(|form| candidates(picture, form, Variant::Fast));
    Ok(Comparison {
        is_kept: is_same(&found[0], &found[1]),
        distance: difference(&light[1], &light[0]).rmse,
        ms,
    })
}

fn is_same(one: &[[f64; 3]; 3], other: &[[f64; 3]; 3]) -> bool {
    let mut pairs = one.as_flattened().iter().zip(other.as_flattened());
    pairs.all(|(a, b)| (a - b).abs() <= SAME)
}

#[cfg(test)]
mod tests;

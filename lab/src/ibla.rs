//! The faster variants of IBLA against the exact one, picture by picture: agreement of the candidates for background light, and
//! difference of the results.

use std::fmt::Write;

use enhance::ibla::{IblaRefinement, candidates};
use enhance::{EnhanceError, Variant, run};
use imaging::{Raster, Rgb8, transfer};

use crate::chart::{difference, time_once};

/// Maximum difference of a channel for candidates to count as equal, in 0..=1.
const SAME: f64 = 0.01;

/// One variant on one picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// The variant.
    pub form: IblaRefinement,
    /// Largest difference of a candidate's channel from the exact variant, 0..=1.
    pub apart: f64,
    /// Root mean square difference of the results in linear light, 0..=1.
    pub distance: f64,
    /// Milliseconds of the method.
    pub ms: f64,
}

impl Outcome {
    /// Whether the candidates equal those of the exact variant.
    #[must_use]
    pub fn is_kept(&self) -> bool {
        self.apart <= SAME
    }
}

/// Runs all variants on a picture, the exact one first.
///
/// # Errors
/// As [`run`].
pub fn compare(picture: &Rgb8) -> Result<[Outcome; 2], EnhanceError> {
    let raster = Raster::from(picture.clone());
    let mut results = Vec::new();
    for form in IblaRefinement::ALL {
        let method = form.method();
        let mut enhanced = None;
        let ms = time_once(|| enhanced = Some(run(&method, &raster)));
        let codes = enhanced.expect("it was run")?.picture.to_rgb8();
        results.push((ms, transfer::decode_rgb8(&codes)));
    }
    let found = IblaRefinement::ALL.map(|form| candidates(picture, form, Variant::Fast));
    Ok(std::array::from_fn(|n| {
        let form = IblaRefinement::ALL[n];
        let (ms, result) = &results[n];
        Outcome {
            form,
            apart: apart(&found[n], &found[0]),
            distance: difference(result, &results[0].1).rmse,
            ms: *ms,
        }
    }))
}

fn apart(got: &[[f64; 3]; 3], expected: &[[f64; 3]; 3]) -> f64 {
    let pairs = got.as_flattened().iter().zip(expected.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Share of the pictures whose candidates a variant keeps; `None` without pictures.
#[must_use]
pub fn share_kept(outcomes: &[Outcome], form: IblaRefinement) -> Option<f64> {
    let of: Vec<&Outcome> = outcomes.iter().filter(|outcome| outcome.form == form).collect();
    let kept = of.iter().filter(|outcome| outcome.is_kept()).count();
    (!of.is_empty()).then(|| kept as f64 / of.len() as f64)
}

/// A table with one row per variant.
#[must_use]
pub fn markdown(outcomes: &[Outcome]) -> String {
    let mut text = String::from(
        "| form | pictures | same candidates | distance: median | 95th percentile | largest | ms: least | median |\n|---|---|---|---|---|---|---|---|\n",
    );
    for form in IblaRefinement::ALL {
        let Some(share) = share_kept(outcomes, form) else {
            continue;
        };
        let of = || outcomes.iter().filter(move |outcome| outcome.form == form);
        let (distances, times) = (sorted(of().map(|o| o.distance)), sorted(of().map(|o| o.ms)));
        let _ = writeln!(
            text,
            "| {} | {} | {:.1} % | {:.1e} | {:.1e} | {:.1e} | {:.0} | {:.0} |",
            form.name(),
            distances.len(),
            100.0 * share,
            at(&distances, 0.5),
            at(&distances, 0.95),
            at(&distances, 1.0),
            at(&times, 0.0),
            at(&times, 0.5)
        );
    }
    text
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The smallest of the sorted values that is an upper bound for this share of them.
fn at(sorted: &[f64], share: f64) -> f64 {
    let place = (share * sorted.len() as f64).ceil() as usize;
    sorted[place.saturating_sub(1)]
}

#[cfg(test)]
mod tests;

//! An enhancement: its steps one after another, then its mask.

use imaging::{Plane, Raster, Samples};
use spec::{Enhancement, HSCM_STEPS, MASK_STEP, Step};

use crate::mask::{black_out, kept};
use crate::methods::{Method, hscm, run};
use crate::network::{RunNetwork, run_network};
use crate::result::{EnhanceError, Enhanced, raster};
use crate::warning::Warning;

/// The result of an enhancement.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The result, 8 bit, black outside the mask.
    pub picture: Raster,
    /// The result before the mask, for metrics.
    pub unmasked: Raster,
    /// 255 for kept and 0 for other pixels; `None` if all are kept. Feature extractors need this plane, since the edge in
    /// the masked picture creates key points.
    pub mask: Option<Plane<u8>>,
    /// The requested intermediate results by name.
    pub steps: Vec<(String, Raster)>,
    /// Known failures detected on the way, each once.
    pub warnings: Vec<Warning>,
}

/// Runs an enhancement by the fast variants; `wanted` names the intermediate results to return. `network` runs the networks of the
/// user; callers without any pass [`refuse_network`](crate::refuse_network).
///
/// # Errors
/// As [`run`] for any of the steps, and as [`kept`]; [`EnhanceError::Network`] if `network` fails.
pub fn enhance(
    enhancement: &Enhancement,
    picture: &Raster,
    wanted: &[&str],
    network: RunNetwork<'_>,
) -> Result<Outcome, EnhanceError> {
    let mut steps = Vec::new();
    let mut warnings = Vec::new();
    let mut current = picture.clone();
    let last = enhancement.steps.len();
    for (position, step) in enhancement.steps.iter().enumerate() {
        let Enhanced {
            picture: result,
            warnings: found,
        } = match step {
            Step::Onnx(parameters) => run_network(parameters, &current, network)?,
            step => run(&Method(step.clone()), &current)?,
        };
        for warning in found {
            if !warnings.contains(&warning) {
                warnings.push(warning);
            }
        }
        current = result;
        let name = (position + 1).to_string();
        if position + 1 < last && wanted.contains(&name.as_str()) {
            steps.push((name, current.clone()));
        }
    }
    if let [Step::Hscm(parameters)] = enhancement.steps.as_slice()
        && HSCM_STEPS.iter().any(|name| wanted.contains(name))
    {
        let stages = HSCM_STEPS.into_iter().zip(hscm::stages(picture, parameters));
        let asked = stages.filter(|(name, _)| wanted.contains(name));
        steps.extend(asked.map(|(name, luma)| (name.to_owned(), luma.into())));
    }
    let mask = kept(picture, &enhancement.mask)?;
    if wanted.contains(&MASK_STEP) {
        let whole = || Plane::filled(picture.width(), picture.height(), u8::MAX);
        let plane = mask.clone().unwrap_or_else(whole);
        steps.push((MASK_STEP.to_owned(), plane.into()));
    }
    Ok(Outcome {
        picture: match &mask {
            Some(mask) => masked(&current, mask),
            None => current.clone(),
        },
        unmasked: current,
        mask,
        steps,
        warnings,
    })
}

fn masked(picture: &Raster, mask: &Plane<u8>) -> Raster {
    let mut codes = match picture.samples() {
        Samples::U8(codes) => codes.clone(),
        Samples::U16(_) => unreachable!("a result has 8 bit"),
    };
    black_out(&mut codes, picture.channels().count(), mask);
    raster(picture, picture.channels(), codes)
}

#[cfg(test)]
mod tests {
    use imaging::Rgb8;
    use spec::{Clahe, EnhancerNetwork, GrayWorld, Hscm, Mask};

    use super::*;
    use crate::network::refuse_network;

    fn picture() -> Raster {
        Rgb8::from_fn(64, 48, |x, y| {
            [(x * 2) as u8, (y * 4 + 20) as u8, ((x * y) % 200) as u8]
        })
        .into()
    }

    #[test]
    fn steps_run_on_each_others_results() {
        let (gray_world, clahe) = (Step::GrayWorld(GrayWorld {}), Step::Clahe(Clahe::default()));
        let chain = Enhancement {
            name: "mine".to_owned(),
            steps: vec![gray_world.clone(), clahe.clone()],
            ..Enhancement::from(gray_world.clone())
        };
        let outcome = enhance(&chain, &picture(), &["1"], &mut refuse_network).unwrap();
        let first = run(&Method(gray_world), &picture()).unwrap().picture;
        let second = run(&Method(clahe), &first).unwrap().picture;
        assert_eq!(outcome.steps, [("1".to_owned(), first)]);
        assert_eq!(outcome.picture, second);
        assert_eq!((outcome.mask, outcome.unmasked), (None, second));
    }

    #[test]
    fn a_mask_blackens_the_result_and_nothing_else() {
        let alone = Enhancement::of_method("hscm").unwrap();
        let masked = Enhancement {
            mask: Mask::Paper,
            ..alone.clone()
        };
        let [alone, masked] =
            [alone, masked].map(|one| enhance(&one, &picture(), &["mask"], &mut refuse_network).unwrap());
        assert_eq!(alone.picture, masked.unmasked);
        let mask = masked.mask.unwrap();
        assert_eq!(masked.steps, [("mask".to_owned(), mask.clone().into())]);
        assert_eq!(alone.steps[0].1, Plane::filled(64, 48, 255u8).into());
        let pixels = masked.picture.to_rgb8();
        let whole = alone.picture.to_rgb8();
        for ((pixel, before), kept) in pixels.pixels().zip(whole.pixels()).zip(mask.data()) {
            assert_eq!(pixel, if *kept == 0 { [0; 3] } else { before });
        }
    }

    #[test]
    fn the_last_stage_of_hscm_is_the_luma_of_its_gray_result() {
        let hscm = Hscm {
            color: spec::ResultColor::Gray,
            ..Hscm::default()
        };
        let outcome = enhance(
            &Step::Hscm(hscm).into(),
            &picture(),
            &HSCM_STEPS,
            &mut refuse_network,
        )
        .unwrap();
        let names: Vec<_> = outcome.steps.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, HSCM_STEPS);
        assert_eq!(outcome.steps[2].1, outcome.picture);
        assert_ne!(outcome.steps[0].1, outcome.steps[1].1);
    }

    #[test]
    fn a_network_is_a_step_like_any_other() {
        let network = EnhancerNetwork {
            model: "invert".to_owned(),
        };
        let gray_world = Step::GrayWorld(GrayWorld {});
        let chain = Enhancement {
            steps: vec![gray_world.clone(), Step::Onnx(network)],
            mask: Mask::Paper,
            ..Enhancement::from(gray_world.clone())
        };
        let first = run(&Method(gray_world), &picture()).unwrap().picture;
        let mut seen = Vec::new();
        let outcome = enhance(&chain, &picture(), &["1"], &mut |network, colors| {
            seen.push((network.model.clone(), colors.clone()));
            Ok(invert(colors))
        });
        let outcome = outcome.unwrap();
        assert_eq!(outcome.steps[0].1, first);
        assert_eq!(outcome.unmasked.to_rgb8(), invert(&first.to_rgb8()));
        assert_eq!(seen, [("invert".to_owned(), first.to_rgb8())]);
        let mask = outcome.mask.unwrap();
        let outside = mask.data().iter().position(|&kept| kept == 0).unwrap();
        assert_eq!(outcome.picture.to_rgb8().pixels().nth(outside), Some([0; 3]));
    }

    fn invert(colors: &Rgb8) -> Rgb8 {
        let codes = colors.data().iter().map(|code| 255 - code);
        Rgb8::new(colors.width(), colors.height(), codes.collect()).unwrap()
    }

    #[test]
    fn a_network_that_fails_or_changes_the_size_is_an_error_with_its_name() {
        let network = Step::Onnx(EnhancerNetwork {
            model: "mine".to_owned(),
        });
        let enhancement = Enhancement::from(network);
        let error = enhance(&enhancement, &picture(), &[], &mut refuse_network).unwrap_err();
        assert!(
            error.to_string().contains("`mine`") && error.to_string().contains("jobs"),
            "{error}"
        );
        let smaller = |_: &EnhancerNetwork, _: &Rgb8| Ok(Rgb8::from_fn(3, 2, |_, _| [9; 3]));
        let error = enhance(&enhancement, &picture(), &[], &mut { smaller }).unwrap_err();
        assert!(
            error.to_string().contains("3×2") && error.to_string().contains("64×48"),
            "{error}"
        );
        let empty = Raster::from(Rgb8::new(0, 0, Vec::new()).unwrap());
        let error = enhance(&enhancement, &empty, &[], &mut refuse_network).unwrap_err();
        assert!(error.to_string().contains("at least 1×1"), "{error}");
    }
}

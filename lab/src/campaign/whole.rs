//! Whole frames, rendered as those of any job, against the bounds of all their stages together.

use std::sync::Arc;

use renderer::{Engine, LinearPicture, SceneSource, Slot};
use serde_json::json;
use spec::{Fidelity, Frame, Job};
use style::Library;

use super::mixture::Mixture;
use super::{Outcome, codes_of, errors_of};

/// Renders whole frames of the campaign.
pub struct Studio {
    slot: Slot,
    /// A frame of an uploaded scene, to which each mixture brings its own water and lamps.
    plain: Frame,
}

impl Studio {
    /// A studio without style models of the user.
    ///
    /// # Panics
    /// When the embedded style models are damaged.
    #[must_use]
    pub fn new() -> Self {
        let library = Library::embedded().expect("the embedded style models");
        let vocabulary = renderer::vocabulary(&library, true);
        let scene = json!({"kind": "uploaded", "id": "scn_00000000-0000-0000-0000-000000000000"});
        let job = Job::parse(
            json!({"scene": scene, "metrics": [], "artifacts": []})
                .to_string()
                .as_bytes(),
            &vocabulary,
        );
        let plain = job.and_then(|job| job.resolve(0)).expect("a valid description");
        Self {
            slot: Slot::new(&Arc::new(Engine::new(library, None))),
            plain,
        }
    }

    /// Runs the mixture of a seed: an outcome for each channel, none where the frame cannot be rendered.
    pub(super) fn run(&mut self, seed: u64) -> Vec<Outcome> {
        let mixture = Mixture::draw(seed);
        let source = SceneSource::Uploaded(Arc::new(mixture.scene));
        let mut frame = Frame {
            seed,
            water: mixture.water,
            lights: mixture.lights,
            ..self.plain.clone()
        };
        let mut render = |fidelity: Fidelity| -> Option<LinearPicture> {
            frame.fidelity = fidelity;
            self.slot.linear(&frame, &source).ok()
        };
        let Some(exact) = render(Fidelity::REFERENCE) else {
            return Vec::new();
        };
        let exact = exact.radiance.map(|&light| f64::from(light));
        let (Some(fast), Some(shown)) = (
            render(Fidelity::Tolerance(mixture.tolerance)),
            render(Fidelity::DISPLAY),
        ) else {
            return Vec::new();
        };
        let errors = errors_of(&fast.radiance, &exact);
        let codes = codes_of(&shown.radiance, &exact);
        let bounds = fast.plan.bounds().unwrap_or([f64::NAN; 3]);
        let outcome = |channel: usize| Outcome {
            seed,
            channel,
            about: mixture.about.clone(),
            tolerance: mixture.tolerance,
            bound: bounds[channel],
            error: errors[channel],
            display_codes: shown.plan.exceeds.is_none().then_some(codes[channel]),
            exceeds: fast.plan.exceeds.is_some(),
            cost: None,
        };
        [0, 1, 2].map(outcome).into()
    }
}

impl Default for Studio {
    fn default() -> Self {
        Self::new()
    }
}

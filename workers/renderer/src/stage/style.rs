//! The style stage: the network restyles the picture after the water, and alpha blends both.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use imaging::{Rgb, transfer};
use optics::plan::{ErrorBound, Stage, StageId, Variant};
use spec::FrameRecord;
use style::{ModelInputs, ModelRole, RANGE_SCALE_M, Session, StyleError, StyleModel};

use crate::assessment::Assessment;
use crate::context::FrameContext;
use crate::engine::Engine;
use crate::error::RenderError;

/// Slope of the sRGB decoding at white, its maximum; converts differences of encoded values to linear light.
const STEEPEST: f64 = 2.4 / 1.055;
/// Variants of a style: its network and its color table.
const NETWORK: &str = "network";
const TABLE: &str = "table";
/// Costs in ns per pixel: of the network, and the extra cost of a range input.
const NETWORK_NS: f64 = 10.8;
const RANGE_NS: f64 = 4.2;
const TABLE_NS: f64 = 4.2;
/// Maximum prepared networks of a slot: each needs a few megabytes, with ONNX Runtime some hundred.
const MAX_SESSIONS: usize = 8;

/// The networks of a slot.
pub(crate) struct Networks {
    pub(crate) engine: Arc<Engine>,
    /// Keyed by name and by whether it is the color table. A session is prepared on first use.
    sessions: BTreeMap<(String, bool), Session>,
}

impl Networks {
    /// Creates the cache without any prepared network.
    pub(crate) fn new(engine: &Arc<Engine>) -> Self {
        Self {
            engine: Arc::clone(engine),
            sessions: BTreeMap::new(),
        }
    }

    /// Styles a picture as planned: linear light after the blend. A style that needs a range leaves a scene without one unchanged,
    /// with a warning. The record names the model used, with the suffix `.lut` for the color table and
    /// `.noise` for a network fed noise of (job seed, frame).
    pub(crate) fn run<'a>(
        &mut self,
        context: &FrameContext<'_>,
        scattered: &'a Rgb<f32>,
        record: &mut FrameRecord,
    ) -> Result<Cow<'a, Rgb<f32>>, RenderError> {
        let (frame, variant) = (context.frame, context.plan.variant(StageId::Style));
        let Some(name) = frame.water.style.as_ref().filter(|_| !variant.is_skipped()) else {
            return Ok(Cow::Borrowed(scattered));
        };
        let model = find(name, &self.engine)?;
        let is_table = *variant == Variant::Fast(TABLE);
        let range = context.range();
        if model.card.takes_range && range.is_none() {
            let skipped = format!("the scene has no range: the style \"{name}\" is skipped");
            record.warnings.push(skipped);
            return Ok(Cow::Borrowed(scattered));
        }
        let session = self.session(&model, is_table)?;
        let range = range
            .filter(|_| session.takes_range())
            .map(|range| optics::attenuation::faded(range, RANGE_SCALE_M));
        let noise = session
            .takes_noise()
            .then(|| style::noise(frame.seed, frame.index, scattered.size()));
        let beside = ModelInputs {
            noise: noise.as_ref(),
            range: range.as_ref(),
        };
        let repainted = session.repaint(&transfer::encode_unit(scattered), beside)?;
        let uses_runtime = session.uses_runtime();
        let variant = match (is_table, noise) {
            (true, _) => ".lut",
            (false, Some(_)) => ".noise",
            (false, None) => "",
        };
        let digest = model.card.sha256.clone();
        let provenance = &mut record.provenance;
        provenance.inputs.insert(format!("style.{name}{variant}"), digest);
        let runtime = self.engine.runtime().ok().filter(|_| uses_runtime);
        provenance.onnx_runtime = runtime.map(|runtime| runtime.version().to_owned());
        record.counts.clamped += repainted.clamped;
        let blended = optics::style_blend(scattered, &repainted.picture, frame.alpha);
        Ok(Cow::Owned(blended))
    }

    fn session(&mut self, model: &StyleModel, is_table: bool) -> Result<&mut Session, RenderError> {
        let key = (model.name.clone(), is_table);
        if !self.sessions.contains_key(&key) {
            let session = prepare(model, is_table, &self.engine)?;
            if self.sessions.len() == MAX_SESSIONS {
                self.sessions.clear();
            }
            self.sessions.insert(key.clone(), session);
        }
        let session = self.sessions.get_mut(&key);
        Ok(session.expect("it was there or has been inserted"))
    }
}

/// Plans the network of a style, or its color table if that is within the tolerance of the network.
pub(crate) fn assess(assessment: &Assessment<'_>, engine: &Engine) -> Result<Stage, RenderError> {
    let frame = assessment.context.frame;
    let Some(name) = frame.water.style.as_ref().filter(|_| frame.alpha > 0.0) else {
        return Ok(Stage::skipped(StageId::Style));
    };
    let card = &find(name, engine)?.card;
    let distance = card
        .table
        .map(|table| frame.alpha * (STEEPEST * table.max_255 / 255.0));
    let share = assessment.tolerance.map(|tolerance| tolerance.absolute);
    let is_near = distance
        .zip(share)
        .is_some_and(|(distance, share)| distance <= share);
    let stage = if is_near {
        Stage {
            share,
            bound: distance.map(ErrorBound::absolute),
            note: Some("bound: its distance from the network on the same input".to_owned()),
            ..Stage::new(StageId::Style, Variant::Fast(TABLE))
        }
    } else {
        Stage {
            bound: None,
            note: Some("its gain is not known: the bounds hold up to its input".to_owned()),
            ..Stage::new(StageId::Style, Variant::Fast(NETWORK))
        }
    };
    let ns = match (is_near, card.takes_range) {
        (true, _) => TABLE_NS,
        (false, true) => NETWORK_NS + RANGE_NS,
        (false, false) => NETWORK_NS,
    };
    Ok(stage.costing(ns, assessment.pixels()))
}

fn find(name: &str, engine: &Engine) -> Result<Arc<StyleModel>, RenderError> {
    let library = engine.library();
    let known = library
        .shared(name)
        .filter(|model| model.card.role == ModelRole::Style);
    known.ok_or_else(|| {
        let names = library.of_role(ModelRole::Style).map(|model| model.name.as_str());
        RenderError::UnknownStyle {
            name: name.to_owned(),
            known: names.collect::<Vec<_>>().join(", "),
        }
    })
}

fn prepare(model: &StyleModel, is_table: bool, engine: &Engine) -> Result<Session, RenderError> {
    if is_table {
        let reason = "it has no color table: only waters that `fathom train` makes without a range have one";
        return Session::table(model).ok_or_else(|| {
            RenderError::Style(StyleError::Model {
                name: model.name.clone(),
                reason: reason.to_owned(),
            })
        });
    }
    if let Some(session) = Session::native(model) {
        return Ok(session);
    }
    let runtime = engine
        .runtime()
        .map_err(|missing| RenderError::RuntimeMissing(missing.to_string()))?;
    Ok(runtime.session(model)?)
}

//! The style stage: the network repaints the picture after the water, and alpha weighs both.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use imaging::{Rgb, transfer};
use optics::plan::{StyleStep, StyleTraits};
use spec::{Frame, FrameRecord};
use style::{Beside, RANGE_SCALE_M, Session, StyleError, StyleModel};

use super::Shot;
use crate::engine::Engine;
use crate::error::RenderError;

/// Most prepared networks of a slot: each holds a few megabytes, on ONNX Runtime some hundred.
const MAX_SESSIONS: usize = 8;

/// The networks of a slot.
pub(crate) struct Networks {
    pub(crate) engine: Arc<Engine>,
    /// By name, the color tables apart; prepared when they are first asked for.
    sessions: BTreeMap<(String, bool), Session>,
}

impl Networks {
    /// None is prepared yet.
    pub(crate) fn new(engine: &Arc<Engine>) -> Self {
        Self {
            engine: Arc::clone(engine),
            sessions: BTreeMap::new(),
        }
    }

    /// Styles a picture as planned: linear light after the blend. A style that takes a range leaves a scene without one as it
    /// is: jobs that can only have such frames were refused. The record names the model that ran: its name ends in
    /// `.lut` for the color table, in `.noise` for a network that was fed noise of (job seed, frame).
    pub(crate) fn run<'a>(
        &mut self,
        shot: &Shot<'_>,
        scattered: &'a Rgb<f32>,
        record: &mut FrameRecord,
    ) -> Result<Cow<'a, Rgb<f32>>, RenderError> {
        let (frame, step) = (shot.frame, shot.plan.style.form);
        let Some(name) = frame.water.style.as_ref().filter(|_| step != StyleStep::Skip) else {
            return Ok(Cow::Borrowed(scattered));
        };
        let model = find(name, &self.engine)?;
        let is_table = step == StyleStep::Table;
        let range = shot.range();
        if model.card.takes_range && range.is_none() {
            return Ok(Cow::Borrowed(scattered));
        }
        let session = self.session(&model, is_table)?;
        let range = range
            .filter(|_| session.takes_range())
            .map(|range| optics::attenuation::faded(range, RANGE_SCALE_M));
        let noise = session
            .takes_noise()
            .then(|| style::noise(frame.seed, frame.index, scattered.size()));
        let beside = Beside {
            noise: noise.as_ref(),
            range: range.as_ref(),
        };
        let repainted = session.apply(&transfer::encode_unit(scattered), beside)?;
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
        let blended = optics::style_blend(scattered, &repainted, frame.alpha);
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

/// What the plan has to know of a frame's style.
pub(crate) fn traits(frame: &Frame, engine: &Engine) -> Result<StyleTraits, RenderError> {
    let Some(name) = frame.water.style.as_ref().filter(|_| frame.alpha > 0.0) else {
        return Ok(StyleTraits::default());
    };
    let model = find(name, engine)?;
    Ok(StyleTraits {
        table_max_255: model.card.table.map(|table| table.max_255),
        takes_range: model.card.takes_range,
    })
}

fn find(name: &str, engine: &Engine) -> Result<Arc<StyleModel>, RenderError> {
    let library = engine.library();
    library.shared(name).ok_or_else(|| RenderError::UnknownStyle {
        name: name.to_owned(),
        known: library.names().join(", "),
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

//! The style stage: the network repaints the picture after the water, and alpha weighs both.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use imaging::{Rgb, transfer};
use optics::plan::StyleStep;
use spec::Frame;
use style::{Session, StyleError, StyleModel};

use crate::engine::Engine;
use crate::error::RenderError;

/// Most prepared networks of a slot: each holds a few megabytes, on ONNX Runtime some hundred.
const MAX_SESSIONS: usize = 8;

/// The networks of a slot, prepared when they are first asked for.
#[derive(Default)]
pub(crate) struct Sessions(BTreeMap<(String, bool), Session>);

/// What the style stage made.
pub(crate) struct Styled<'a> {
    /// Linear light after the blend.
    pub(crate) picture: Cow<'a, Rgb<f32>>,
    /// Name and SHA-256 of the model that ran; the name ends in `.lut` if it was the colour table, in
    /// `.noise` if the network was fed noise of (job seed, frame).
    pub(crate) model: Option<(String, String)>,
    /// Version of ONNX Runtime, if it ran there.
    pub(crate) runtime: Option<String>,
}

/// Styles a picture as planned.
pub(crate) fn run<'a>(
    frame: &Frame,
    step: StyleStep,
    scattered: &'a Rgb<f32>,
    engine: &Engine,
    sessions: &mut Sessions,
) -> Result<Styled<'a>, RenderError> {
    let Some(name) = frame.water.style.as_ref().filter(|_| step != StyleStep::Skip) else {
        return Ok(Styled {
            picture: Cow::Borrowed(scattered),
            model: None,
            runtime: None,
        });
    };
    let model = &known(name, engine)?;
    let table = step == StyleStep::Table;
    let session = sessions.of(model, table, engine)?;
    let noise = session
        .takes_noise()
        .then(|| style::noise(frame.seed, frame.index, scattered.size()));
    let repainted = session.apply(&transfer::encode_unit(scattered), noise.as_ref())?;
    let runtime = engine.runtime().ok().filter(|_| session.uses_runtime());
    let picture = Cow::Owned(optics::style_blend(scattered, &repainted, frame.alpha));
    let how = match (table, noise) {
        (true, _) => ".lut",
        (false, Some(_)) => ".noise",
        (false, None) => "",
    };
    Ok(Styled {
        picture,
        model: Some((format!("{name}{how}"), model.card.sha256.clone())),
        runtime: runtime.map(|runtime| runtime.version().to_owned()),
    })
}

/// Largest distance of the color table of a frame's style from its network, 8-bit codes; none without style or table.
pub(crate) fn table_max_255(frame: &Frame, engine: &Engine) -> Result<Option<f64>, RenderError> {
    let Some(name) = frame.water.style.as_ref().filter(|_| frame.alpha > 0.0) else {
        return Ok(None);
    };
    Ok(known(name, engine)?.card.table.map(|table| table.max_255))
}

impl Sessions {
    fn of(&mut self, model: &StyleModel, table: bool, engine: &Engine) -> Result<&mut Session, RenderError> {
        let key = (model.name.clone(), table);
        if !self.0.contains_key(&key) {
            let session = prepare(model, table, engine)?;
            if self.0.len() == MAX_SESSIONS {
                self.0.clear();
            }
            self.0.insert(key.clone(), session);
        }
        Ok(self.0.get_mut(&key).expect("it was there or has been inserted"))
    }
}

fn known(name: &str, engine: &Engine) -> Result<Arc<StyleModel>, RenderError> {
    let library = engine.library();
    library.shared(name).ok_or_else(|| RenderError::UnknownStyle {
        name: name.to_owned(),
        known: library.names().iter().map(ToString::to_string).collect(),
    })
}

fn prepare(model: &StyleModel, table: bool, engine: &Engine) -> Result<Session, RenderError> {
    if table {
        return Session::table(model).ok_or_else(|| {
            let name = model.name.clone();
            let reason = "it has no colour table: only the shipped waters and those that `fathom train` makes have one";
            RenderError::Style(StyleError::Model {
                name,
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

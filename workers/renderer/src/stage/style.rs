//! The style stage: the network repaints the picture after the water, and alpha weighs both.

use std::borrow::Cow;
use std::collections::BTreeMap;

use imaging::{Rgb, transfer};
use spec::Frame;
use style::Session;

use crate::engine::Engine;
use crate::error::RenderError;

/// Most prepared networks of a slot: each holds a few megabytes, on ONNX Runtime some hundred.
const MAX_SESSIONS: usize = 8;

/// The networks of a slot, prepared when they are first asked for.
#[derive(Default)]
pub(crate) struct Sessions(BTreeMap<String, Session>);

/// What the style stage made.
pub(crate) struct Styled<'a> {
    /// Linear light after the blend.
    pub(crate) picture: Cow<'a, Rgb<f32>>,
    /// Name and SHA-256 of the model that ran.
    pub(crate) model: Option<(String, String)>,
    /// Whether it ran on ONNX Runtime.
    pub(crate) on_runtime: bool,
}

/// Styles a picture. Without a style, or with alpha 0, it passes through and no network runs.
pub(crate) fn run<'a>(
    frame: &Frame,
    scattered: &'a Rgb<f32>,
    engine: &Engine,
    sessions: &mut Sessions,
) -> Result<Styled<'a>, RenderError> {
    let Some(name) = frame.water.style.as_ref().filter(|_| frame.alpha > 0.0) else {
        return Ok(Styled {
            picture: Cow::Borrowed(scattered),
            model: None,
            on_runtime: false,
        });
    };
    let session = sessions.of(name, engine)?;
    let repainted = session.apply(&transfer::encode_unit(scattered), None)?;
    let on_runtime = session.uses_runtime();
    let picture = Cow::Owned(optics::style_blend(scattered, &repainted, frame.alpha));
    let digest = engine.library().get(name).map(|model| model.card.sha256.clone());
    Ok(Styled {
        picture,
        model: digest.map(|digest| (name.clone(), digest)),
        on_runtime,
    })
}

impl Sessions {
    fn of(&mut self, name: &str, engine: &Engine) -> Result<&mut Session, RenderError> {
        if !self.0.contains_key(name) {
            let session = prepare(name, engine)?;
            if self.0.len() == MAX_SESSIONS {
                self.0.clear();
            }
            self.0.insert(name.to_owned(), session);
        }
        Ok(self.0.get_mut(name).expect("it was there or has been inserted"))
    }
}

fn prepare(name: &str, engine: &Engine) -> Result<Session, RenderError> {
    let library = engine.library();
    let model = library.get(name).ok_or_else(|| RenderError::UnknownStyle {
        name: name.to_owned(),
        known: library.names().iter().map(ToString::to_string).collect(),
    })?;
    if let Some(session) = Session::native(model) {
        return Ok(session);
    }
    let runtime = engine
        .runtime()
        .map_err(|missing| RenderError::RuntimeMissing(missing.to_string()))?;
    Ok(runtime.session(model)?)
}

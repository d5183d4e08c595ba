//! Enhancers and metrics of the user on ONNX Runtime.

use std::collections::BTreeMap;
use std::sync::Arc;

use enhance::Outcome;
use imaging::{Raster, Rgb8};
use spec::{Enhancement, EnhancerNetwork, Frame, FrameRecord, METRIC_NETWORK, Step};
use style::{ModelRole, PictureNetwork};

use crate::engine::Engine;
use crate::error::RenderError;

/// Maximum prepared networks: each may need some hundred megabytes.
const MAX_SESSIONS: usize = 8;

/// The enhancers and metrics of a thread. A network is prepared on first use.
pub struct PictureNetworks {
    engine: Arc<Engine>,
    sessions: BTreeMap<String, PictureNetwork>,
}

impl PictureNetworks {
    /// Creates the cache without any prepared network.
    #[must_use]
    pub fn new(engine: &Arc<Engine>) -> Self {
        Self {
            engine: Arc::clone(engine),
            sessions: BTreeMap::new(),
        }
    }

    /// Runs an enhancement with its networks, see [`enhance::enhance`].
    ///
    /// # Errors
    /// [`RenderError`]: an unknown network, a missing runtime, a failure of a method or a network.
    pub fn enhance(
        &mut self,
        enhancement: &Enhancement,
        picture: &Raster,
        wanted: &[&str],
    ) -> Result<Outcome, RenderError> {
        let mut failure = None;
        let outcome = enhance::enhance(enhancement, picture, wanted, &mut |network, colors| {
            self.run_enhancer(network, colors).map_err(|error| {
                let reason = error.to_string();
                failure = Some(error);
                reason
            })
        });
        match failure {
            Some(error) => Err(error),
            None => Ok(outcome?),
        }
    }

    fn run_enhancer(&mut self, network: &EnhancerNetwork, colors: &Rgb8) -> Result<Rgb8, RenderError> {
        Ok(self
            .prepare(&network.model, ModelRole::Enhancer)?
            .enhance(colors)?)
    }

    /// The value of a metric network.
    ///
    /// # Errors
    /// [`RenderError`]: an unknown network, a missing runtime, a failure of the network.
    pub fn measure(&mut self, name: &str, picture: &Rgb8) -> Result<f64, RenderError> {
        Ok(self.prepare(name, ModelRole::Metric)?.measure(picture)?)
    }

    /// Adds the digests of the networks of a frame, as `enhancer.NAME` and `metric.NAME`, and the version of their runtime.
    pub(crate) fn record(&self, frame: &Frame, record: &mut FrameRecord) {
        let steps = frame.enhance.iter().flat_map(|enhancement| &enhancement.steps);
        let enhancers = steps.filter_map(|step| match step {
            Step::Onnx(network) => Some((ModelRole::Enhancer, network.model.as_str())),
            _ => None,
        });
        let (_, metrics) = split_networks(&frame.metrics);
        let metrics = metrics.into_iter().map(|name| (ModelRole::Metric, name));
        let library = self.engine.library();
        for (role, name) in enhancers.chain(metrics) {
            let Some(model) = library.get(name) else { continue };
            let provenance = &mut record.provenance;
            let key = format!("{}.{name}", role.name());
            provenance.inputs.insert(key, model.card.sha256.clone());
            let runtime = self.engine.runtime().ok();
            provenance.onnx_runtime = runtime.map(|runtime| runtime.version().to_owned());
        }
    }

    fn prepare(&mut self, name: &str, role: ModelRole) -> Result<&mut PictureNetwork, RenderError> {
        let library = self.engine.library();
        let known = library.shared(name).filter(|model| model.card.role == role);
        let model = known.ok_or_else(|| {
            let names: Vec<_> = library.of_role(role).map(|model| model.name.as_str()).collect();
            RenderError::UnknownNetwork {
                role: role.name(),
                name: name.to_owned(),
                known: names.join(", "),
            }
        })?;
        if !self.sessions.contains_key(name) {
            let runtime = self
                .engine
                .runtime()
                .map_err(|missing| RenderError::RuntimeMissing(missing.to_string()))?;
            let session = runtime.picture_network(&model)?;
            if self.sessions.len() == MAX_SESSIONS {
                self.sessions.pop_first();
            }
            self.sessions.insert(name.to_owned(), session);
        }
        let session = self.sessions.get_mut(name);
        Ok(session.expect("it was there or has been inserted"))
    }
}

/// The metrics of the registry, and the names of metric networks without `net.`.
pub(crate) fn split_networks(metrics: &[String]) -> (Vec<&str>, Vec<&str>) {
    let (mut registered, mut networks) = (Vec::new(), Vec::new());
    for metric in metrics {
        match metric.strip_prefix(METRIC_NETWORK) {
            Some(name) => networks.push(name),
            None => registered.push(metric.as_str()),
        }
    }
    (registered, networks)
}

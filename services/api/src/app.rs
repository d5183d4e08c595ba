//! What every handler can reach.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use catalogue::Catalogue;
use metrics_exporter_prometheus::PrometheusHandle;
use spec::Vocabulary;
use store::Store;
use tokio::sync::{Mutex, Notify};
use tokio_util::sync::CancellationToken;

use crate::bytes::naming::Naming;
use crate::bytes::space::Space;
use crate::clock::Clock;
use crate::leases::changes::Watch;
use crate::leases::costs::Experience;
use crate::leases::dispatch::Dispatch;
use crate::processes::child::Children;
use crate::processes::compute::Compute;
use crate::styles::Styles;
use crate::styles::trainings::Trainings;
use crate::waters::Waters;

/// The parts of a running service.
pub(crate) struct App {
    /// The service's folder.
    pub(crate) data: PathBuf,
    pub(crate) catalogue: Catalogue,
    pub(crate) store: Store,
    pub(crate) dispatch: Dispatch,
    pub(crate) watch: Watch,
    pub(crate) experience: Experience,
    pub(crate) compute: Compute,
    /// The same for whole pictures of a user, which take much more memory.
    pub(crate) pictures: Compute,
    pub(crate) children: Children,
    pub(crate) styles: Styles,
    pub(crate) trainings: Trainings,
    /// How long a network that a user adds may take to be tried.
    pub(crate) style_trial: Duration,
    pub(crate) waters: Waters,
    /// Version of the ONNX Runtime that this machine's workers find, or why there is none.
    pub(crate) style_runtime: Result<String, String>,
    /// Held while a job is paused, cancelled, deleted and so on.
    pub(crate) turn: Mutex<()>,
    /// Held while rows and bytes of deleted jobs are taken away, and while everything is copied.
    pub(crate) upkeep: Mutex<()>,
    pub(crate) naming: Naming,
    pub(crate) space: Arc<Space>,
    /// Rung when something was deleted.
    pub(crate) reclaim: Notify,
    pub(crate) clock: Clock,
    pub(crate) telemetry: &'static PrometheusHandle,
    /// Cancelled when the service stops: waiting requests then answer what they have.
    pub(crate) stop: CancellationToken,
}

/// The state as handlers get it.
pub(crate) type Shared = Arc<App>;

impl App {
    /// The words that jobs may use now.
    pub(crate) fn vocabulary(&self) -> Vocabulary {
        Vocabulary {
            waters: self.waters.words(),
            ..self.styles.known().vocabulary.clone()
        }
    }
}

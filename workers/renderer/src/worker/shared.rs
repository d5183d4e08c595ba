//! State shared by the threads of a worker.

use std::sync::{Arc, Mutex};

use super::client::Client;
use super::held::Held;
use crate::engine::Engine;

use super::membership::Membership;

use super::running::{Limits, Running};
use super::stop::Stop;
use crate::source::SceneBytes;
use spec::RecentJobs;
use std::collections::BTreeMap;

/// State shared by the threads of a worker.
pub(super) struct Shared {
    pub(super) engine: Arc<Engine>,
    pub(super) client: Client,
    pub(super) membership: Membership,
    pub(super) held: Held,
    pub(super) jobs: Jobs,
    pub(super) scenes: Scenes,
    pub(super) stop: Stop,
    pub(super) running: Running,
    pub(super) limits: Limits,
}

/// Cache of recently used jobs.
#[derive(Default)]
pub(crate) struct Jobs(pub(super) Mutex<RecentJobs>);

/// Cached scenes by id. An uploaded scene never changes.
#[derive(Default)]
pub(crate) struct Scenes(pub(super) Mutex<BTreeMap<String, Arc<SceneBytes>>>);

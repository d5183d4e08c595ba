//! The workers registered with a broker.

use std::sync::Arc;
use std::time::{Duration, SystemTime};

use api::Worker;
use async_nats::jetstream::Context;
use async_nats::jetstream::kv::{Config, Store};
use async_nats::jetstream::stream::StorageType;
use futures::StreamExt;
use serde::{Deserialize, Serialize};
use tokio::runtime::Runtime;

use super::error::BrokerError;

const BUCKET: &str = "fathom_workers";

/// A worker.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Member {
    /// Its name.
    pub(crate) name: String,
    /// Frames rendered concurrently.
    pub(crate) slots: u64,
    /// Frames of its current shard.
    #[serde(default)]
    pub(crate) frames: u64,
    /// Version of its code.
    #[serde(default)]
    pub(crate) code_version: String,
    /// Version of its ONNX Runtime, if it has one.
    #[serde(default)]
    pub(crate) onnx_runtime: Option<String>,
    /// CPU features that choose its code paths.
    #[serde(default)]
    pub(crate) cpu_features: String,
}

/// The list of workers; entries expire unless they are renewed.
#[derive(Clone)]
pub(crate) struct Fleet {
    runtime: Arc<Runtime>,
    context: Context,
    expiry: Duration,
    replicas: usize,
}

impl Fleet {
    pub(super) fn new(runtime: Arc<Runtime>, context: Context, expiry: Duration, replicas: usize) -> Self {
        Self {
            runtime,
            context,
            expiry,
            replicas,
        }
    }

    /// Adds or renews the entry of a worker.
    pub(crate) fn enter(&self, member: &Member) -> Result<(), BrokerError> {
        let value = serde_json::to_vec(member).map_err(BrokerError::new)?;
        self.runtime.block_on(async {
            let store = self.store().await?;
            let put = store.put(key(&member.name), value.into()).await;
            put.map(drop).map_err(BrokerError::new)
        })
    }

    /// Removes the entry of a worker.
    pub(crate) fn leave(&self, name: &str) -> Result<(), BrokerError> {
        self.runtime.block_on(async {
            let removed = self.store().await?.purge(key(name)).await;
            removed.map_err(BrokerError::new)
        })
    }

    /// The current workers.
    pub(crate) fn members(&self) -> Result<Vec<Member>, BrokerError> {
        let entries = self.entries()?;
        Ok(entries.into_iter().map(|(member, _)| member).collect())
    }

    /// The current workers, in the service's format.
    pub(crate) fn workers(&self) -> Result<Vec<Worker>, BrokerError> {
        let worker = |(member, since): (Member, SystemTime)| Worker {
            id: member.name.clone(),
            name: member.name,
            slots: u32::try_from(member.slots).unwrap_or(u32::MAX),
            leased_frames: member.frames,
            // Measured by the broker's clock.
            silent_ms: since.elapsed().map_or(0, |silent| silent.as_millis() as u64),
            code_version: member.code_version,
            onnx_runtime: member.onnx_runtime,
            cpu_features: member.cpu_features,
        };
        Ok(self.entries()?.into_iter().map(worker).collect())
    }

    /// The workers with the time of their last renewal.
    fn entries(&self) -> Result<Vec<(Member, SystemTime)>, BrokerError> {
        self.runtime.block_on(async {
            let store = self.store().await?;
            let mut keys = store.keys().await.map_err(BrokerError::new)?;
            let mut members = Vec::new();
            while let Some(key) = keys.next().await {
                let entry = store.entry(key.map_err(BrokerError::new)?).await;
                let Some(entry) = entry.map_err(BrokerError::new)? else {
                    continue;
                };
                let member = serde_json::from_slice::<Member>(&entry.value).ok();
                members.extend(member.map(|member| (member, SystemTime::from(entry.created))));
            }
            members.sort_by(|(a, _), (b, _)| a.name.cmp(&b.name));
            Ok(members)
        })
    }

    async fn store(&self) -> Result<Store, BrokerError> {
        match self.context.get_key_value(BUCKET).await {
            Ok(store) => Ok(store),
            Err(_) => {
                let config = Config {
                    bucket: BUCKET.to_owned(),
                    history: 1,
                    max_age: self.expiry,
                    storage: StorageType::Memory,
                    num_replicas: self.replicas,
                    ..Config::default()
                };
                let store = self.context.create_key_value(config).await;
                store.map_err(BrokerError::new)
            }
        }
    }
}

/// A key of the list: any name, encoded in the letters that keys allow.
fn key(name: &str) -> String {
    spec::sha256(name.as_bytes())
}

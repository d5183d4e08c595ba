//! The workers that are there, as they say themselves.

use std::sync::Arc;
use std::time::Duration;

use async_nats::jetstream::Context;
use async_nats::jetstream::kv::{Config, Store};
use async_nats::jetstream::stream::StorageType;
use futures::StreamExt;
use serde::{Deserialize, Serialize};
use tokio::runtime::Runtime;

use super::broker::BrokerError;

const BUCKET: &str = "fathom_workers";

/// A worker.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Member {
    /// Its name.
    pub(crate) name: String,
    /// Frames that it renders side by side.
    pub(crate) slots: u64,
}

/// The list of workers, of which each expires unless it is renewed.
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

    /// Enters a worker, or renews it.
    pub(crate) fn enter(&self, member: &Member) -> Result<(), BrokerError> {
        let value = serde_json::to_vec(member).map_err(BrokerError::new)?;
        self.runtime.block_on(async {
            let store = self.store().await?;
            let put = store.put(key(&member.name), value.into()).await;
            put.map(drop).map_err(BrokerError::new)
        })
    }

    /// Removes a worker that ends.
    pub(crate) fn leave(&self, name: &str) -> Result<(), BrokerError> {
        self.runtime.block_on(async {
            let removed = self.store().await?.purge(key(name)).await;
            removed.map_err(BrokerError::new)
        })
    }

    /// The workers that are there.
    pub(crate) fn members(&self) -> Result<Vec<Member>, BrokerError> {
        self.runtime.block_on(async {
            let store = self.store().await?;
            let mut keys = store.keys().await.map_err(BrokerError::new)?;
            let mut members = Vec::new();
            while let Some(key) = keys.next().await {
                let value = store.get(key.map_err(BrokerError::new)?).await;
                let Some(value) = value.map_err(BrokerError::new)? else {
                    continue;
                };
                members.extend(serde_json::from_slice::<Member>(&value).ok());
            }
            members.sort_by(|a, b| a.name.cmp(&b.name));
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

/// A key of the list: any name, in the letters that keys may have.
fn key(name: &str) -> String {
    spec::sha256(name.as_bytes())
}

//! The stream of shards that wait for a worker.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use async_nats::ConnectOptions;
use async_nats::jetstream::consumer::{AckPolicy, PullConsumer, pull};
use async_nats::jetstream::context::PublishErrorKind;
use async_nats::jetstream::stream::{self, DiscardPolicy, RetentionPolicy, StorageType, Stream};
use async_nats::jetstream::{self, Context, Message};
use cli::engine::EngineArguments;
use cli::exit::Failure;
use futures::StreamExt;
use tokio::runtime::{Builder, Runtime};

use super::delivery::Delivery;
use super::error::BrokerError;
use super::fleet::Fleet;
use super::task::Task;

const STREAM: &str = "FATHOM";
const CONSUMER: &str = "workers";
const RESPONSE_LIMIT: Duration = Duration::from_secs(5);
/// Maximum shards with workers at the same time, over the whole fleet.
const MOST_IN_FLIGHT: i64 = 1_000_000;

/// A connection, which reconnects automatically.
pub(crate) struct Broker {
    runtime: Arc<Runtime>,
    context: Context,
    /// The source of messages; `None` before the first one and after a failure, since the broker may have lost it.
    consumer: Mutex<Option<PullConsumer>>,
    /// Time without a sign of life before a worker loses its shard.
    ack_wait: Duration,
    replicas: usize,
}

impl Broker {
    /// Connects.
    ///
    /// # Errors
    /// [`Failure::Later`] if no broker responds, [`Failure::BadInput`] if the address is none.
    pub(crate) fn connect(arguments: &EngineArguments, url: &str) -> Result<Self, Failure> {
        let runtime = Builder::new_multi_thread().worker_threads(1).enable_all().build();
        let runtime = runtime.map_err(anyhow::Error::from)?;
        let mut options = ConnectOptions::new()
            .name("fathom")
            .connection_timeout(RESPONSE_LIMIT)
            .request_timeout(Some(RESPONSE_LIMIT));
        if let Some(token) = &arguments.engine_token {
            options = options.token(token.clone());
        }
        let addresses: Vec<async_nats::ServerAddr> = url
            .split(',')
            .map(str::parse)
            .collect::<Result<_, _>>()
            .map_err(|error| Failure::BadInput(format!("`--engine {}`: {error}", without_secret(url))))?;
        let client = runtime.block_on(options.connect(addresses));
        let client = client.map_err(|error| {
            Failure::Later(format!("no broker responds at {}: {error}", without_secret(url)))
        })?;
        let context = {
            // The client spawns a task.
            let _entered = runtime.enter();
            jetstream::new(client)
        };
        Ok(Self {
            context,
            consumer: Mutex::default(),
            runtime: Arc::new(runtime),
            ack_wait: Duration::from_secs_f64(arguments.lease_s),
            replicas: usize::from(arguments.replicas),
        })
    }

    /// Time without a sign of life before a worker loses its shard.
    pub(crate) fn lease(&self) -> Duration {
        self.ack_wait
    }

    /// Publishes a task; returns `false` if it was already waiting. Call [`Broker::waiting`] first, which creates the stream.
    pub(crate) fn publish(&self, task: &Task) -> Result<bool, BrokerError> {
        let payload = serde_json::to_vec(task).map_err(BrokerError::new)?;
        self.runtime.block_on(async {
            let sent = self.context.publish(task.subject(), payload.into()).await;
            match sent.map_err(BrokerError::new)?.await {
                Ok(_) => Ok(true),
                // The stream keeps one message of a subject and refuses the second.
                Err(error) if error.kind() == PublishErrorKind::Other && is_refused(&error) => Ok(false),
                Err(error) => Err(BrokerError::new(error)),
            }
        })
    }

    /// Number of shards that wait or are with a worker.
    pub(crate) fn waiting(&self) -> Result<u64, BrokerError> {
        self.runtime.block_on(async {
            let mut stream = self.stream().await?;
            let info = stream.info().await.map_err(BrokerError::new)?;
            Ok(info.state.messages)
        })
    }

    /// Withdraws every waiting task of a set.
    pub(crate) fn withdraw(&self, set: &str) -> Result<(), BrokerError> {
        self.runtime.block_on(async {
            let stream = self.stream().await?;
            let purged = stream.purge().filter(Task::subjects_of(set)).await;
            purged.map(drop).map_err(BrokerError::new)
        })
    }

    /// The next task, if one arrives within this time.
    pub(crate) fn next(&self, patience: Duration) -> Result<Option<Delivery>, BrokerError> {
        // The broker may vanish during the request.
        let limit = patience + 2 * RESPONSE_LIMIT;
        let fetched = self.runtime.block_on(async {
            let fetched = tokio::time::timeout(limit, self.fetch(patience)).await;
            fetched.map_err(BrokerError::new).flatten()
        });
        if fetched.is_err() {
            *self.consumer.lock().unwrap_or_else(PoisonError::into_inner) = None;
        }
        Ok(fetched?.map(|message| Delivery::new(Arc::clone(&self.runtime), message, self.ack_wait)))
    }

    async fn fetch(&self, patience: Duration) -> Result<Option<Message>, BrokerError> {
        let known = self
            .consumer
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone();
        let consumer = match known {
            Some(consumer) => consumer,
            None => self.consumer().await?,
        };
        let batch = consumer.fetch().max_messages(1).expires(patience).messages();
        let message = batch.await.map_err(BrokerError::new)?.next().await;
        *self.consumer.lock().unwrap_or_else(PoisonError::into_inner) = Some(consumer);
        message.transpose().map_err(BrokerError::new)
    }

    /// The list of workers.
    pub(crate) fn fleet(&self) -> Fleet {
        Fleet::new(
            Arc::clone(&self.runtime),
            self.context.clone(),
            self.ack_wait,
            self.replicas,
        )
    }

    /// The stream, recreated if the broker has lost it.
    async fn stream(&self) -> Result<Stream, BrokerError> {
        let config = stream::Config {
            name: STREAM.to_owned(),
            subjects: vec![Task::subjects()],
            retention: RetentionPolicy::WorkQueue,
            storage: StorageType::File,
            discard: DiscardPolicy::New,
            discard_new_per_subject: true,
            max_messages_per_subject: 1,
            num_replicas: self.replicas,
            ..stream::Config::default()
        };
        let stream = self.context.get_or_create_stream(config).await;
        stream.map_err(BrokerError::new)
    }

    async fn consumer(&self) -> Result<PullConsumer, BrokerError> {
        let config = pull::Config {
            durable_name: Some(CONSUMER.to_owned()),
            ack_policy: AckPolicy::Explicit,
            ack_wait: self.ack_wait,
            max_ack_pending: MOST_IN_FLIGHT,
            ..pull::Config::default()
        };
        let stream = self.stream().await?;
        let consumer = stream.get_or_create_consumer(CONSUMER, config).await;
        consumer.map_err(BrokerError::new)
    }
}

fn is_refused(error: &(dyn std::error::Error + 'static)) -> bool {
    let source = error.source().map(ToString::to_string).unwrap_or_default();
    format!("{error} {source}").contains("maximum messages per subject exceeded")
}

/// An address without its credentials.
pub(crate) fn without_secret(url: &str) -> String {
    let shown = |address: &str| match address.split_once("://") {
        Some((scheme, rest)) => match rest.rsplit_once('@') {
            Some((_, host)) => format!("{scheme}://{host}"),
            None => address.to_owned(),
        },
        None => address
            .rsplit_once('@')
            .map_or(address, |(_, host)| host)
            .to_owned(),
    };
    url.split(',').map(shown).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::without_secret;

    #[test]
    fn addresses_are_printed_without_their_secrets() {
        assert_eq!(without_secret("nats://me:hush@a:4222,b"), "nats://a:4222,b");
        assert_eq!(without_secret("hush@a:4222"), "a:4222");
        assert_eq!(without_secret("nats://a"), "nats://a");
    }
}

//! The one task that writes. Changes that arrive within a few milliseconds share a transaction and a flush to the disk.

use std::path::{Path, PathBuf};
use std::pin::Pin;
use std::sync::LazyLock;
use std::time::Duration;

use prometheus::{Histogram, register_histogram};
use sqlx::sqlite::SqliteConnection;
use sqlx::{Connection, Executor};
use tokio::sync::{mpsc, oneshot};
use tokio::time::{Instant, timeout_at};

use crate::commit::insert::{self, NewImage};
use crate::digests::row_digests;
use crate::error::CatalogueError;
use crate::query::columns::Columns;
use crate::types::InsertImage;

/// Operations that may wait for the writer: beyond it callers wait to be taken on, which slows them down before memory
/// grows.
const QUEUE: usize = 1024;
/// Most operations of one transaction: more would only delay the first of them.
const GROUP: usize = 512;
/// Most images of a transaction.
const IMAGES: usize = 64;
/// Length of the log at which it is checkpointed: twice SQLite's default, since a page that changes repeatedly is written to the file
/// once per checkpoint.
const LONG_LOG: u64 = 8 << 20;
/// From one alone to a full transaction.
const OPERATIONS_BUCKETS: [f64; 10] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0, 512.0];
/// Shared by the catalogues of a process.
static COMMIT_OPERATIONS: LazyLock<Histogram> = LazyLock::new(|| {
    register_histogram!(
        "fathom_commit_operations",
        "Images, jobs and changes of state that shared a transaction of the catalogue",
        OPERATIONS_BUCKETS.to_vec()
    )
    .expect("the name is valid and unique")
});
/// Time for which a transaction waits for further changes if the previous one had several: less than a flush to the disk. A single
/// client never waits; changes that arrive during a flush share the next one anyway.
const GATHER: Duration = Duration::from_millis(2);

/// A running change.
pub(crate) type Running<'c, T> = Pin<Box<dyn Future<Output = T> + Send + 'c>>;

/// A change and the reply to its caller. Without a connection it only replies why.
type Change =
    Box<dyn for<'c> FnOnce(Result<&'c mut SqliteConnection, CatalogueError>) -> Running<'c, Applied> + Send>;

/// An image and the reply to its caller.
type Image = (NewImage, oneshot::Sender<Result<InsertImage, CatalogueError>>);

enum Call {
    Change(Change),
    /// Apart from the others, because images that come one after the other are stored together.
    Image(Box<Image>),
}

/// Replies to one caller after the transaction has ended.
type Reply = Box<dyn FnOnce(Option<&CatalogueError>) + Send>;

/// A change that has run inside a transaction that is still open.
struct Applied {
    reply: Reply,
    /// The error that makes the whole transaction fail.
    fatal: Option<CatalogueError>,
}

/// A handle to the writer.
#[derive(Clone)]
pub(crate) struct Writer(mpsc::Sender<Call>);

impl Writer {
    /// Starts the task over the one connection that writes. It ends when every `Writer` is gone.
    pub(crate) fn start(
        connection: SqliteConnection,
        columns: Columns,
        log: PathBuf,
    ) -> (Self, tokio::task::JoinHandle<()>) {
        let (sender, receiver) = mpsc::channel(QUEUE);
        (
            Self(sender),
            tokio::spawn(run(connection, columns, log, receiver)),
        )
    }

    /// Sends a change and waits until it is durable.
    pub(crate) async fn write<T: Send + 'static>(
        &self,
        change: impl for<'c> FnOnce(&'c mut SqliteConnection) -> Running<'c, Result<T, CatalogueError>>
        + Send
        + 'static,
    ) -> Result<T, CatalogueError> {
        let (sender, receiver) = oneshot::channel();
        let change: Change = Box::new(move |connection| Box::pin(enclosed(connection, change, sender)));
        let sent = self.0.send(Call::Change(change)).await;
        sent.map_err(|_| CatalogueError::Closed)?;
        receiver.await.map_err(|_| CatalogueError::Closed)?
    }

    /// Sends an image and waits until it is durable.
    pub(crate) async fn insert(&self, image: NewImage) -> Result<InsertImage, CatalogueError> {
        let (sender, receiver) = oneshot::channel();
        let sent = self.0.send(Call::Image(Box::new((image, sender)))).await;
        sent.map_err(|_| CatalogueError::Closed)?;
        receiver.await.map_err(|_| CatalogueError::Closed)?
    }
}

async fn run(
    mut connection: SqliteConnection,
    columns: Columns,
    log: PathBuf,
    mut queue: mpsc::Receiver<Call>,
) {
    let mut are_many = false;
    while let Some(first) = queue.recv().await {
        let gather = if are_many { GATHER } else { Duration::ZERO };
        match group(&mut connection, &columns, first, &mut queue, gather).await {
            Ok(operations) => are_many = operations > 1,
            // The callers report a lock of another program.
            Err(CatalogueError::Locked) => {}
            Err(error) => tracing::error!(%error, "the catalogue could not commit"),
        }
        fold_in(&mut connection, &log).await;
    }
    if let Err(error) = connection.close().await {
        tracing::warn!(%error, "the catalogue did not close cleanly");
    }
}

/// Checkpoints a long log. SQLite would do it within a commit, which on a full disk then appears to fail although it is durable;
/// here no caller waits for it.
async fn fold_in(connection: &mut SqliteConnection, log: &Path) {
    if std::fs::metadata(log).is_ok_and(|log| log.len() > LONG_LOG)
        && let Err(error) = connection.execute("PRAGMA wal_checkpoint(PASSIVE)").await
    {
        tracing::warn!(%error, "the log of the catalogue stays for now");
    }
}

/// Runs a change and those that arrive with it in one transaction; returns their number.
async fn group(
    connection: &mut SqliteConnection,
    columns: &Columns,
    first: Call,
    queue: &mut mpsc::Receiver<Call>,
    gather: Duration,
) -> Result<usize, CatalogueError> {
    let gather_until = Instant::now() + gather;
    if let Err(error) = connection.execute("BEGIN IMMEDIATE").await {
        let failure = CatalogueError::from(error);
        refuse(first, &failure).await;
        return Err(failure);
    }
    let mut replies: Vec<Reply> = Vec::new();
    let mut images: Vec<Image> = Vec::new();
    let mut failure = None;
    let mut next = Some(first);
    while let Some(call) = next.take() {
        match call {
            Call::Image(image) => images.push(*image),
            Call::Change(change) => {
                // Images before this change are stored first, to keep the order.
                failure = store(connection, columns, &mut images, &mut replies).await;
                if failure.is_some() {
                    refuse(
                        Call::Change(change),
                        failure.as_ref().unwrap_or(&CatalogueError::Closed),
                    )
                    .await;
                    break;
                }
                let applied = change(Ok(&mut *connection)).await;
                replies.push(applied.reply);
                failure = applied.fatal;
            }
        }
        if images.len() >= IMAGES && failure.is_none() {
            failure = store(connection, columns, &mut images, &mut replies).await;
        }
        if failure.is_none() && replies.len() + images.len() < GROUP {
            next = timeout_at(gather_until, queue.recv()).await.ok().flatten();
        }
    }
    if failure.is_none() {
        failure = store(connection, columns, &mut images, &mut replies).await;
    }
    if failure.is_none() {
        failure = row_digests::fill(connection).await.err();
    }
    if failure.is_none() {
        faults::point("catalogue.written");
        failure = connection.execute("COMMIT").await.err().map(CatalogueError::from);
        faults::point("catalogue.committed");
        COMMIT_OPERATIONS.observe(replies.len() as f64);
    }
    if failure.is_some() {
        // SQLite may have rolled back already; then there is no transaction to roll back.
        let _ = connection.execute("ROLLBACK").await;
    }
    let operations = replies.len();
    replies.into_iter().for_each(|reply| reply(failure.as_ref()));
    failure.map_or(Ok(operations), Err)
}

/// Replies to a caller whose call cannot be carried out.
async fn refuse(call: Call, failure: &CatalogueError) {
    match call {
        Call::Change(change) => (change(Err(failure.clone())).await.reply)(None),
        Call::Image(image) => drop(image.1.send(Err(failure.clone()))),
    }
}

/// Stores the collected images; returns an error that makes the whole transaction fail. If they cannot be stored together, they are
/// stored one by one, so that only the faulty one fails.
async fn store(
    connection: &mut SqliteConnection,
    columns: &Columns,
    images: &mut Vec<Image>,
    replies: &mut Vec<Reply>,
) -> Option<CatalogueError> {
    let all = std::mem::take(images);
    let together: Vec<&NewImage> = all.iter().map(|(image, _)| image).collect();
    let (mut answers, mut fatal) = (Vec::with_capacity(all.len()), None);
    for some in [together.as_slice()].into_iter().chain(together.chunks(1)) {
        if some.is_empty() || answers.len() == all.len() || fatal.is_some() {
            break;
        }
        let attempt = async |c: &mut SqliteConnection| insert::insert(c, columns, some).await;
        match within_savepoint(connection, attempt).await {
            Ok(stored) => answers.extend(stored),
            Err((error, kept)) if !kept || matches!(error, CatalogueError::Full { .. }) => {
                fatal = Some(error.clone());
            }
            Err((error, _)) if some.len() == 1 => answers.push(Err(error)),
            Err(_) => {}
        }
    }
    let mut answers = answers.into_iter();
    for (_, caller) in all {
        let result = answers.next().unwrap_or(Err(CatalogueError::Closed));
        replies.push(reply(caller, result));
    }
    fatal
}

fn reply<T: Send + 'static>(
    caller: oneshot::Sender<Result<T, CatalogueError>>,
    result: Result<T, CatalogueError>,
) -> Reply {
    Box::new(move |failure| {
        let told = match failure {
            Some(failure) => Err(failure.clone()),
            None => result,
        };
        // The caller may have been dropped; the change is stored anyway.
        let _ = caller.send(told);
    })
}

/// Runs one change within a savepoint, so that a failure leaves other changes of the transaction intact. The whole transaction fails
/// only if the savepoint is lost, as on a full disk.
async fn enclosed<T: Send + 'static>(
    connection: Result<&mut SqliteConnection, CatalogueError>,
    change: impl for<'c> FnOnce(&'c mut SqliteConnection) -> Running<'c, Result<T, CatalogueError>> + Send,
    answer: oneshot::Sender<Result<T, CatalogueError>>,
) -> Applied {
    let mut fatal = None;
    let result = match connection {
        Err(error) => Err(error),
        Ok(connection) => {
            let change = async |c: &mut SqliteConnection| change(c).await;
            let result = within_savepoint(connection, change).await;
            result.map_err(|(error, kept)| {
                if !kept || matches!(error, CatalogueError::Full { .. }) {
                    fatal = Some(error.clone());
                }
                error
            })
        }
    };
    let reply = reply(answer, result);
    Applied { reply, fatal }
}

/// Returns an error together with whether the savepoint was restored.
async fn within_savepoint<T>(
    connection: &mut SqliteConnection,
    change: impl AsyncFnOnce(&mut SqliteConnection) -> Result<T, CatalogueError>,
) -> Result<T, (CatalogueError, bool)> {
    let lost = |error: sqlx::Error| (CatalogueError::from(error), false);
    connection.execute("SAVEPOINT change").await.map_err(lost)?;
    let result = change(connection).await;
    if let Err(error) = result {
        let undone = connection.execute("ROLLBACK TO change; RELEASE change").await;
        return Err((error, undone.is_ok()));
    }
    connection.execute("RELEASE change").await.map_err(lost)?;
    result.map_err(|error| (error, true))
}

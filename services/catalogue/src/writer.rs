//! The one task that writes. What callers bring within a few milliseconds shares a transaction and a flush to the disk.

use std::time::Duration;

use sqlx::sqlite::SqliteConnection;
use sqlx::{Connection, Executor};
use tokio::sync::{mpsc, oneshot};
use tokio::time::{Instant, timeout_at};

use crate::columns::Columns;
use crate::error::CatalogueError;
use crate::types::{InsertImage, InsertJob, JobRow, JobState, NewJob, SceneRow};
use crate::{images, jobs, scenes};

/// Operations that may wait for the writer: beyond it callers wait to be taken on, which slows them down before memory
/// grows.
const QUEUE: usize = 1024;
/// Most operations of one transaction: more would only delay the first of them.
const GROUP: usize = 512;
/// How long a transaction gathers: less than a flush to the disk takes.
const GATHER: Duration = Duration::from_millis(2);

type Answer<T> = oneshot::Sender<Result<T, CatalogueError>>;

/// A change, with the way to answer it.
pub(crate) enum Write {
    InsertJob(Box<NewJob>, Answer<InsertJob>),
    SetState(String, JobState, Answer<JobRow>),
    InsertImage(Box<images::NewImage>, Answer<InsertImage>),
    Strike(Box<jobs::Strike>, Answer<()>),
    InsertScene(Box<SceneRow>, Answer<String>),
}

/// Answers one caller after the transaction has ended.
type Reply = Box<dyn FnOnce(Option<&CatalogueError>) + Send>;

/// The way to the writer.
#[derive(Clone)]
pub(crate) struct Writer(mpsc::Sender<Write>);

impl Writer {
    /// Starts the task over the one connection that writes. It ends when every `Writer` is gone.
    pub(crate) fn start(
        connection: SqliteConnection,
        columns: Columns,
    ) -> (Self, tokio::task::JoinHandle<()>) {
        let (sender, receiver) = mpsc::channel(QUEUE);
        (Self(sender), tokio::spawn(run(connection, columns, receiver)))
    }

    /// Brings a change and waits until it is durable.
    pub(crate) async fn write<T>(
        &self,
        change: impl FnOnce(Answer<T>) -> Write,
    ) -> Result<T, CatalogueError> {
        let (sender, receiver) = oneshot::channel();
        self.0
            .send(change(sender))
            .await
            .map_err(|_| CatalogueError::Closed)?;
        receiver.await.map_err(|_| CatalogueError::Closed)?
    }
}

async fn run(mut connection: SqliteConnection, columns: Columns, mut queue: mpsc::Receiver<Write>) {
    while let Some(first) = queue.recv().await {
        if let Err(error) = group(&mut connection, &columns, first, &mut queue).await {
            tracing::error!(%error, "the catalogue could not commit");
        }
    }
    if let Err(error) = connection.close().await {
        tracing::warn!(%error, "the catalogue did not close cleanly");
    }
}

async fn group(
    connection: &mut SqliteConnection,
    columns: &Columns,
    first: Write,
    queue: &mut mpsc::Receiver<Write>,
) -> Result<(), sqlx::Error> {
    let gather_until = Instant::now() + GATHER;
    if let Err(error) = connection.execute("BEGIN IMMEDIATE").await {
        let failed = CatalogueError::Failed {
            message: error.to_string(),
        };
        refuse(first, &failed);
        return Err(error);
    }
    let mut replies: Vec<Reply> = Vec::new();
    let mut next = Some(first);
    while let Some(write) = next.take() {
        replies.push(apply(connection, columns, write).await);
        if replies.len() < GROUP {
            next = timeout_at(gather_until, queue.recv()).await.ok().flatten();
        }
    }
    faults::point("catalogue.written");
    let committed = connection.execute("COMMIT").await;
    faults::point("catalogue.committed");
    let failure = committed.as_ref().err().map(CatalogueError::from_ref);
    if failure.is_some() {
        let _ = connection.execute("ROLLBACK").await;
    }
    replies.into_iter().for_each(|reply| reply(failure.as_ref()));
    committed.map(|_| ())
}

/// Runs one change within a savepoint: what fails leaves its neighbours in the transaction alone.
async fn apply(connection: &mut SqliteConnection, columns: &Columns, write: Write) -> Reply {
    match write {
        Write::InsertJob(job, answer) => {
            enclosed(connection, answer, async |c: &mut SqliteConnection| {
                jobs::insert(c, &job).await
            })
            .await
        }
        Write::SetState(id, state, answer) => {
            enclosed(connection, answer, async |c: &mut SqliteConnection| {
                jobs::set_state(c, &id, state).await
            })
            .await
        }
        Write::InsertImage(image, answer) => {
            enclosed(connection, answer, async |c: &mut SqliteConnection| {
                images::insert(c, columns, &image).await
            })
            .await
        }
        Write::Strike(strike, answer) => {
            enclosed(connection, answer, async |c: &mut SqliteConnection| {
                jobs::strike(c, &strike).await
            })
            .await
        }
        Write::InsertScene(scene, answer) => {
            enclosed(connection, answer, async |c: &mut SqliteConnection| {
                scenes::insert(c, &scene).await
            })
            .await
        }
    }
}

async fn enclosed<T: Send + 'static>(
    connection: &mut SqliteConnection,
    answer: Answer<T>,
    change: impl AsyncFnOnce(&mut SqliteConnection) -> Result<T, CatalogueError>,
) -> Reply {
    let result = async {
        connection.execute("SAVEPOINT change").await?;
        let result = change(connection).await;
        if result.is_err() {
            connection.execute("ROLLBACK TO change").await?;
        }
        connection.execute("RELEASE change").await?;
        result
    }
    .await;
    Box::new(move |failure| {
        let told = match failure {
            Some(failure) => Err(failure.again()),
            None => result,
        };
        // The caller may have gone; the change stands all the same.
        let _ = answer.send(told);
    })
}

fn refuse(write: Write, error: &CatalogueError) {
    match write {
        Write::InsertJob(_, answer) => drop(answer.send(Err(error.again()))),
        Write::SetState(_, _, answer) => drop(answer.send(Err(error.again()))),
        Write::InsertImage(_, answer) => drop(answer.send(Err(error.again()))),
        Write::Strike(_, answer) => drop(answer.send(Err(error.again()))),
        Write::InsertScene(_, answer) => drop(answer.send(Err(error.again()))),
    }
}

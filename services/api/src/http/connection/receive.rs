//! Receives the body before a request acquires a permit. A slow client occupies a connection and the bytes sent so
//! far, but no permit.

use std::time::Duration;

use axum::body::{Body, BodyDataStream, Bytes};
use axum::extract::{Request, State};
use axum::http::header;
use axum::middleware::Next;
use axum::response::Response;
use futures::{StreamExt, stream};
use hyper::body::Body as _;
use tokio::time::{Instant, timeout_at};

use super::spool::{PLACE_BYTES, Spool, SpooledBody};
use crate::http::budget::{Budget, Permit, identify_caller};
use crate::http::problem::{Problem, Slug};
use crate::limits::BODY_BYTES_PER_S;

/// How bodies of a group are received.
#[derive(Clone)]
pub(crate) struct Receiving {
    pub(crate) max_bytes: usize,
    /// Time for a body in addition to the time allowed by its bytes.
    pub(crate) grace: Duration,
    /// Budget of bodies in memory or on disk, KiB.
    pub(crate) memory: Budget,
    /// Where bodies are kept; absent: in memory.
    pub(crate) spool: Option<Spool>,
}

/// Receives the whole body of a request and passes it on. Its bytes count until the response.
pub(crate) async fn receive(
    State(receiving): State<Receiving>,
    request: Request,
    next: Next,
) -> Result<Response, Problem> {
    if receiving.max_bytes == 0 || request.body().is_end_stream() {
        return Ok(next.run(request).await);
    }
    let length = request.headers().get(header::CONTENT_LENGTH);
    let length = length.and_then(|length| length.to_str().ok()?.parse::<u64>().ok());
    let is_beyond = length.is_some_and(|bytes| bytes > receiving.max_bytes as u64);
    let caller = identify_caller(&request);
    let (parts, body) = request.into_parts();
    if is_beyond {
        return Err(receiving.discarded(body.into_data_stream()).await);
    }
    let Received { kept, _memory } = receiving.whole(body, &caller).await?;
    let (body, _turn) = match kept {
        Kept::OnDisk(body) => {
            let turn = body.take_turn().await?;
            (body.into_body().await?, Some(turn))
        }
        Kept::InMemory(pieces) => {
            let pieces = pieces.into_iter().map(Ok::<_, std::convert::Infallible>);
            (Body::from_stream(stream::iter(pieces)), None)
        }
    };
    Ok(next.run(Request::from_parts(parts, body)).await)
}

/// A received body.
struct Received {
    kept: Kept,
    _memory: Vec<Permit>,
}

enum Kept {
    InMemory(Vec<Bytes>),
    OnDisk(SpooledBody),
}

impl Kept {
    async fn add(&mut self, piece: Bytes) -> Result<(), Problem> {
        match self {
            Self::InMemory(pieces) => pieces.push(piece),
            Self::OnDisk(body) => body.add(&piece).await?,
        }
        Ok(())
    }
}

impl Receiving {
    async fn whole(&self, body: Body, caller: &str) -> Result<Received, Problem> {
        let begun = Instant::now();
        let mut coming = body.into_data_stream();
        let (mut bytes, mut places) = (0, 0);
        let mut received = Received {
            kept: match self.spool.as_ref().map(Spool::begin).transpose() {
                Ok(Some(body)) => Kept::OnDisk(body),
                Ok(None) => Kept::InMemory(Vec::new()),
                Err(problem) => {
                    self.discard(coming).await;
                    return Err(problem);
                }
            },
            _memory: Vec::new(),
        };
        loop {
            // Each byte extends the deadline.
            let allowed = self.grace + Duration::from_secs_f64(bytes as f64 / BODY_BYTES_PER_S);
            let Ok(piece) = timeout_at(begun + allowed, coming.next()).await else {
                return Err(self.too_slow(bytes, begun));
            };
            let Some(piece) = piece else { return Ok(received) };
            let piece = piece.map_err(|error| Problem::new(Slug::InvalidBody, error.to_string()))?;
            bytes += piece.len();
            if bytes > self.max_bytes {
                drop(received);
                return Err(self.discarded(coming).await);
            }
            let more = bytes.div_ceil(PLACE_BYTES) - places;
            if more > 0 {
                let count = u32::try_from(more).map_err(|_| self.too_large())?;
                received
                    ._memory
                    .push(self.memory.acquire_many(caller, count).await?);
                places += more;
            }
            if let Err(problem) = received.kept.add(piece).await {
                drop(received);
                self.discard(coming).await;
                return Err(problem);
            }
        }
    }

    /// Reads and discards up to twice the limit of the route. A client that is still sending when the connection
    /// closes would not see the response.
    async fn discard(&self, mut coming: BodyDataStream) {
        let (begun, mut bytes) = (Instant::now(), 0);
        while let Ok(Some(Ok(piece))) = timeout_at(begun + self.grace, coming.next()).await {
            bytes += piece.len();
            if bytes > 2 * self.max_bytes {
                break;
            }
        }
    }

    async fn discarded(&self, coming: BodyDataStream) -> Problem {
        self.discard(coming).await;
        self.too_large()
    }

    fn too_large(&self) -> Problem {
        let detail = format!(
            "the body is larger than {} bytes, the limit of this route",
            self.max_bytes
        );
        Problem::new(Slug::TooLarge, detail)
    }

    fn too_slow(&self, bytes: usize, begun: Instant) -> Problem {
        let seconds = begun.elapsed().as_secs_f64();
        let detail = format!(
            "{bytes} bytes of the body arrived in {seconds:.1} s; after {} s it must arrive with {BODY_BYTES_PER_S} bytes per second or more",
            self.grace.as_secs_f64()
        );
        Problem::new(Slug::RequestTimeout, detail)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::http::budget::Share;

    const GRACE: Duration = Duration::from_secs(10);

    fn receiving(max_bytes: usize, memory_kib: usize) -> Receiving {
        Receiving {
            max_bytes,
            grace: GRACE,
            memory: Budget::new("bodies", memory_kib, Share { percent: 100 }, Duration::ZERO),
            spool: None,
        }
    }

    /// A body whose pieces arrive after a pause each.
    fn dripping(pieces: usize, bytes: usize, pause: Duration) -> Body {
        let pieces = stream::iter(0..pieces).then(move |_| async move {
            tokio::time::sleep(pause).await;
            Ok::<_, std::convert::Infallible>(Bytes::from(vec![7; bytes]))
        });
        Body::from_stream(pieces)
    }

    async fn bytes(receiving: &Receiving, body: Body) -> Result<usize, Problem> {
        match receiving.whole(body, "a").await?.kept {
            Kept::InMemory(pieces) => Ok(pieces.iter().map(Bytes::len).sum()),
            Kept::OnDisk(_) => Err(Problem::internal(&"it has no folder")),
        }
    }

    #[tokio::test(start_paused = true)]
    async fn a_slow_body_is_cut_and_a_steady_one_is_not() {
        let receiving = receiving(1 << 20, 1 << 20);
        let second = Duration::from_secs(1);
        let steady = bytes(&receiving, dripping(60, 1100, second)).await;
        assert_eq!(steady.ok(), Some(66_000));
        let begun = Instant::now();
        let slow = bytes(&receiving, dripping(600, 100, second)).await;
        assert!(slow.is_err_and(|problem| problem.is(Slug::RequestTimeout)));
        let after = begun.elapsed();
        assert!(after > GRACE && after < GRACE + 3 * second, "{after:?}");
        let stalled = bytes(
            &receiving,
            Body::from_stream(stream::pending::<Result<Bytes, std::io::Error>>()),
        );
        assert!(
            stalled
                .await
                .is_err_and(|problem| problem.is(Slug::RequestTimeout))
        );
    }

    #[tokio::test]
    async fn bodies_are_bounded_one_by_one_and_together() {
        let receiving = receiving(5000, 6);
        let body = |bytes: usize| Body::from(vec![0; bytes]);
        assert_eq!(bytes(&receiving, body(5000)).await.ok(), Some(5000));
        assert!(
            bytes(&receiving, body(5001))
                .await
                .is_err_and(|problem| problem.is(Slug::TooLarge))
        );
        let held = receiving.whole(body(3000), "a").await.ok();
        assert!(
            bytes(&receiving, body(4000))
                .await
                .is_err_and(|problem| problem.is(Slug::Overloaded))
        );
        drop(held);
        assert_eq!(bytes(&receiving, body(4000)).await.ok(), Some(4000));
    }
}

//! Response bodies that keep their permit until the client has received them.

use std::pin::Pin;
use std::task::{Context, Poll, ready};

use axum::body::{Body, Bytes};
use hyper::body::{Frame, SizeHint};

use crate::http::budget::Permit;

/// Bytes passed to the connection at a time. The rest and the permit wait here for the client to read.
const PIECE_BYTES: usize = 64 << 10;

/// A body and its permit.
pub(crate) struct Held {
    body: Body,
    rest: Bytes,
    _place: Permit,
}

impl Held {
    /// Wraps a body in pieces, with its permit.
    pub(crate) fn wrap(body: Body, permit: Permit) -> Body {
        Body::new(Self {
            body,
            rest: Bytes::new(),
            _place: permit,
        })
    }
}

impl hyper::body::Body for Held {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        while self.rest.is_empty() {
            match ready!(Pin::new(&mut self.body).poll_frame(context)) {
                None => return Poll::Ready(None),
                Some(Err(error)) => return Poll::Ready(Some(Err(error))),
                Some(Ok(frame)) => match frame.into_data() {
                    Ok(data) => self.rest = data,
                    Err(trailers) => return Poll::Ready(Some(Ok(trailers))),
                },
            }
        }
        let length = self.rest.len().min(PIECE_BYTES);
        let piece = self.rest.split_to(length);
        Poll::Ready(Some(Ok(Frame::data(piece))))
    }

    fn is_end_stream(&self) -> bool {
        self.rest.is_empty() && self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        let (inner, rest) = (self.body.size_hint(), self.rest.len() as u64);
        let mut hint = SizeHint::new();
        hint.set_lower(inner.lower() + rest);
        if let Some(upper) = inner.upper() {
            hint.set_upper(upper + rest);
        }
        hint
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use futures::StreamExt;
    use hyper::body::Body as _;

    use super::*;
    use crate::http::budget::{Budget, Share};

    #[tokio::test]
    async fn the_permit_is_released_with_the_last_piece_and_the_body_is_unchanged() {
        let places = Budget::new("tests", 1, Share { percent: 100 }, Duration::ZERO);
        let sent: Vec<u8> = (0..PIECE_BYTES * 2 + 9).map(|n| (n % 251) as u8).collect();
        let permit = places.acquire("a").await.ok().unwrap();
        let held = Held::wrap(Body::from(sent.clone()), permit);
        assert_eq!(held.size_hint().exact(), Some(sent.len() as u64));
        let mut pieces = held.into_data_stream();
        let mut taken = Vec::new();
        for _ in 0..3 {
            assert!(places.acquire("b").await.is_err());
            taken.extend(pieces.next().await.unwrap().unwrap());
        }
        assert!(pieces.next().await.is_none());
        drop(pieces);
        assert!(places.acquire("b").await.is_ok());
        assert_eq!(taken, sent);
    }
}

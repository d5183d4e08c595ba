//! A granted lease on its way to the worker.

use wire::messages::{FrameClaim, Lease};

use super::dispatch::Dispatch;
use super::table::{Grant, TERM_MS};

/// A granted lease. If the worker disconnects before it is sent, the frames become free immediately, without a
/// strike.
pub(crate) struct Granted<'d> {
    dispatch: &'d Dispatch,
    lease: Option<Lease>,
}

impl<'d> Granted<'d> {
    pub(super) fn new(dispatch: &'d Dispatch, grant: Grant, spec_digest: String) -> Self {
        let Grant {
            token,
            job_id,
            frames,
        } = grant;
        let frames = frames.into_iter();
        let frames = frames.map(|(frame, attempt)| FrameClaim { frame, attempt });
        let lease = Some(Lease {
            token,
            job_id,
            spec_digest,
            frames: frames.collect(),
            term_ms: TERM_MS,
        });
        Self { dispatch, lease }
    }

    /// Releases the lease to the worker: from now on only the worker or its expiry ends it.
    pub(crate) fn hand_over(mut self) -> Lease {
        self.lease
            .take()
            .expect("only this method takes it, and it ends this value")
    }
}

impl Drop for Granted<'_> {
    fn drop(&mut self) {
        if let Some(lease) = &self.lease {
            let token = lease.token;
            self.dispatch.free(|table, now| table.release(token, now));
        }
    }
}

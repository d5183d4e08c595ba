//! A lease between the table and its worker.

use crate::leases::table::Grant;

use crate::leases::dispatch::Dispatch;

/// A lease on its way to its worker. If the worker hangs up before that, the frames are free again at once, and the
/// loss counts as no strike.
pub(crate) struct Granted<'d> {
    dispatch: &'d Dispatch,
    lease: Option<Grant>,
}

impl<'d> Granted<'d> {
    pub(crate) fn new(dispatch: &'d Dispatch, lease: Grant) -> Self {
        Self {
            dispatch,
            lease: Some(lease),
        }
    }

    /// What was granted.
    pub(crate) fn lease(&self) -> &Grant {
        self.lease
            .as_ref()
            .expect("it is only taken by the methods that end this value")
    }

    /// From here on only the worker, or time, ends the lease.
    pub(crate) fn hand_over(mut self) -> Grant {
        self.lease
            .take()
            .expect("it is only taken by the methods that end this value")
    }
}

impl Drop for Granted<'_> {
    fn drop(&mut self) {
        if let Some(lease) = &self.lease {
            self.dispatch.release(lease.token);
        }
    }
}

//! The worker protocol: protobuf messages as bodies of plain requests.

pub(crate) mod artifacts;
pub(crate) mod beat;
pub(crate) mod commit;
pub(crate) mod fail;
pub(crate) mod lease;
pub(crate) mod register;
pub(crate) mod release;
pub(crate) mod workers;

use proto::message::Claim;

use crate::http::problem::{Problem, Slug};
use crate::leases::dispatch::Unknown;

fn unknown_worker(_: Unknown) -> Problem {
    Problem::new(
        Slug::UnknownWorker,
        "this life of the service does not know the worker; register again",
    )
}

fn stale_lease(claim: &Claim) -> Problem {
    let Claim {
        token,
        job_id,
        frame,
        attempt,
    } = claim;
    let detail = format!("token {token} does not hold attempt {attempt} at frame {frame} of {job_id}");
    Problem::new(Slug::StaleLease, detail).with("token", *token)
}

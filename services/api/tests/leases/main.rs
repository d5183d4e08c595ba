//! The lease table in random histories, and the worker against a service that loses responses.

#![allow(clippy::unwrap_used)]

use wire::messages::{Claim, RegisterRequest};

fn claim(job: &str, frame: u64, token: u64, attempt: u32) -> Claim {
    Claim {
        token,
        job_id: job.to_owned(),
        frame,
        attempt,
    }
}

fn about(name: &str, slots: u32) -> RegisterRequest {
    RegisterRequest {
        name: name.to_owned(),
        slots,
        ..RegisterRequest::default()
    }
}

mod control;
mod fairness;
mod fake_service;
mod poison;
mod promises;
mod simulation;
mod toolchains;
mod workers;

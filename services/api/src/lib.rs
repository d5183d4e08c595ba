//! The HTTP API: public routes, the worker protocol, and the service around them.
//!
//! [`start`] opens the data directory, takes up unfinished jobs, starts the service's own workers and answers
//! requests until [`Service::stop`]. Handlers await; whatever computes runs on a bounded pool. Every refusal is an
//! RFC 9457 problem.
//!
//! Absent on purpose: TLS (put a proxy in front), user accounts (tokens with scopes), a message broker.

mod auth;
mod child;
mod clock;
mod compute;
mod config;
mod control;
mod data;
mod dispatch;
mod estimate;
mod extract;
mod failure;
mod fleet;
mod follow;
mod granted;
mod held;
mod layers;
mod limits;
mod lines;
mod listener;
mod lock;
mod naming;
mod openapi;
mod paging;
mod patient;
mod pictures;
mod problem;
mod reclaim;
mod rerender;
mod routes;
mod service;
mod space;
mod state;
mod stored;
mod strikes;
mod styles;
mod submit;
mod telemetry;
mod time;
mod trainings;
mod uploaded;
mod uploads;
mod wait;
mod watch;
mod waters;

pub use auth::TokenError;
pub use clock::Clock;
pub use config::{Config, Surroundings};
pub use data::{Data, DataError};
pub use limits::Limits;
pub use lock::LockError;
pub use problem::Slug;
pub use routes::waters::view::WaterView;
pub use service::{Service, StartError, start, start_in};
pub use styles::{AddedStyleError, added_styles};

//! The HTTP API: public routes, the worker protocol, and the service around them.
//!
//! [`start`] opens the data folder, resumes unfinished jobs, starts the service's workers and serves requests until
//! [`Service::stop`]. Handlers await; computations run on a bounded pool. Every error response is an RFC 9457
//! problem.
//!
//! Absent on purpose: TLS (use a proxy), user accounts (tokens with scopes), a message broker.

mod app;
mod bytes;
mod clock;
mod config;
mod data;
mod datasets;
mod decode;
mod engine;
mod http;
mod images;
mod jobs;
mod leases;
mod limits;
mod lists;
mod openapi;
mod operations;
mod pictures;
mod processes;
mod renders;
mod router;
mod scenes;
mod service;
mod sets;
mod styles;
mod telemetry;
mod waters;

pub use app::StartError;
pub use bytes::sets::{ReadBucket, SetFiles, Unread};
pub use clock::Clock;
pub use config::{Config, Surroundings};
pub use data::{Data, DataError};
pub use decode::decode_folder;
pub use engine::EngineOptions;
pub use engine::orders::{Accepted, Event, Order, SeenSet};
pub use http::auth::TokenError;
pub use http::problem::Slug;
pub use leases::Worker;
pub use leases::table as lease_table;
pub use limits::{Limits, PriceLimits};
pub use lists::{Entry, List};
pub use operations::routes::backup::clear_unfinished;
pub use renders::render_pictures;
pub use service::{Service, start, start_in};
pub use sets::conformity::SetJob;
pub use sets::feed::{Known, Line, SetHead, SetImage, SetPart};
pub use sets::intake::{Intake, IntakeError, Storing, prepare};
pub use styles::{AddedStyleError, added_styles};
pub use waters::view::water_view;

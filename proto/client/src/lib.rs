//! The contract of the HTTP API: its views, which the service serializes and its clients read, and a blocking client.

mod calls;
mod client;
mod error;
mod http;
mod images;
mod pages;
mod proxy;
mod query;
mod views;

pub use calls::{JobChange, StatisticsQuery};
pub use client::{Client, Received};
pub use error::ClientError;
pub use http::{Http, HttpError, Problem, Reply};
pub use images::{ImagePages, ImageQuery, ImageRow};
pub use proxy::{InvalidProxy, choose_proxy};
pub use query::{encode, with_query};
pub use views::*;

/// Most rows of a page.
pub const PAGE_ROWS: usize = 500;

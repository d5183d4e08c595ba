//! Pages of images.

mod json;
mod order;
mod page;
#[cfg(test)]
mod plans;
mod top_k;

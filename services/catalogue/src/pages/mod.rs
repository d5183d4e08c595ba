//! Pages of images.

mod order;
mod page;
#[cfg(test)]
mod plans;
mod top_k;

//! The only conversions between wire messages and the program's.

mod frame;
mod lease;
mod scene;
#[cfg(test)]
mod tests;

//! The only conversions between wire messages and the program's.

mod frame;
mod lease;
mod scene;
mod style;
#[cfg(test)]
mod tests;

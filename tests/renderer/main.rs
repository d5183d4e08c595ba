//! Frames from description to bytes, and jobs without a service.

#![allow(clippy::unwrap_used)]

mod artifacts;
mod camera;
mod common;
mod effects;
mod enhance;
mod examples;
mod folders;
mod labels;
mod light;
mod networks;
mod noise;
#[expect(dead_code, reason = "the tests of the style crate use more of it")]
#[path = "../../workers/style/tests/suite/onnx.rs"]
mod onnx;
mod paper;
mod promise;
mod sequences;
mod stream;
mod style;
mod truth;

//! The accepted fields of a job. Each is declared with its type: see [`Frame`] and the types of its fields.
//!
//! The parser, the field table of the documentation, the OpenAPI document and the catalogue's columns use this
//! schema.

use crate::frame::Frame;
use crate::schema::{Field, Presence, Shape};

/// Maximum frames of a job, and maximum `count`.
pub const MAX_FRAMES: u64 = 100_000_000;

/// Schema of the whole description.
pub static DOCUMENT: Shape = Shape::Object(&JOB);

/// The only field of a job that its frames lack.
const COUNT: Field = Field {
    name: "count",
    shape: Shape::Integer(1, MAX_FRAMES as i128),
    presence: Presence::Default("1"),
    laws: false,
    unit: None,
    doc: "frames of each grid cell",
    rules: &[],
    type_name: None,
};

pub(crate) const JOB: [Field; Frame::FIELDS.len() + 1] = {
    let mut fields = [COUNT; Frame::FIELDS.len() + 1];
    fields[0] = Frame::FIELDS[0];
    let mut position = 1;
    while position < Frame::FIELDS.len() {
        fields[position + 1] = Frame::FIELDS[position];
        position += 1;
    }
    fields
};

//! The accepted fields of a job. Each is declared where its type stands: see [`Frame`] and the types that it is made of.
//!
//! Parsing, the field table of the documentation, the service's OpenAPI text and the columns of the catalogue read this.

use crate::frame::Frame;
use crate::schema::{Field, Presence, Shape};

/// Most frames of a job, and the greatest `count`.
pub const MAX_FRAMES: u64 = 100_000_000;

/// The whole description.
pub static DOCUMENT: Shape = Shape::Object(&JOB);

/// The one field of a job that its frames do not have.
const COUNT: Field = Field {
    name: "count",
    shape: Shape::Integer(1, MAX_FRAMES as i128),
    presence: Presence::Default("1"),
    laws: false,
    unit: None,
    doc: "frames of each grid cell",
    type_name: None,
};

/// The fields of a job.
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

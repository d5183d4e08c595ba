//! One frame from its description to stored bytes, and the worker that does it for a service.

//! The HTTP API: routes, problems, limits, and the worker protocol.

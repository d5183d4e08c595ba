//! The family `structure`.

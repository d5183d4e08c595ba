//! End-to-end tests of the fathom binary and of the house rules.

//! Damage anywhere in a data folder: it is never served as good, and scrub finds it.
//!
//! `FATHOM_TRUST_DAMAGES` sets how many damages the first test makes (40 unless set); it prints what they hit.

mod damage;
mod lost;

//! Kills, damage and lost data.

pub(crate) mod crash;
pub(crate) mod damage;
pub(crate) mod drain;
pub(crate) mod heal;
pub(crate) mod lost;
pub(crate) mod poison;
pub(crate) mod power;
pub(crate) mod refused;
pub(crate) mod restart;
pub(crate) mod scrub;
pub(crate) mod spot_checks;

//! Fields and values as they are declared.

pub mod fields;
pub(crate) mod leaves;
pub(crate) mod rules;
pub mod table;
pub(crate) mod vocabulary;

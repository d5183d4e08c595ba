//! SHA-256 digests.

use sha2::{Digest as _, Sha256};

use crate::error::StoreError;

/// The name of a blob.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Digest(pub(crate) [u8; 32]);

impl Digest {
    /// Upper case is rejected: the digest is also an ETag and must have one spelling.
    pub(crate) fn parse(text: &str) -> Result<Self, StoreError> {
        let mut bytes = [0; 32];
        let is_hex = hex::decode_to_slice(text, &mut bytes).is_ok();
        if is_hex && !text.bytes().any(|digit| digit.is_ascii_uppercase()) {
            return Ok(Self(bytes));
        }
        Err(StoreError::NotADigest {
            text: text.chars().take(80).collect(),
        })
    }

    pub(crate) fn hash(bytes: &[u8]) -> Self {
        Self(Sha256::digest(bytes).into())
    }

    pub(crate) fn from_row(bytes: &[u8]) -> Option<Self> {
        bytes.try_into().ok().map(Self)
    }
}

impl std::fmt::Display for Digest {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&hex::encode(self.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EMPTY: &str = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";

    #[test]
    fn a_digest_survives_the_way_to_text_and_back() {
        assert_eq!(Digest::hash(b"").to_string(), EMPTY);
        assert_eq!(Digest::parse(EMPTY).unwrap(), Digest::hash(b""));
    }

    #[test]
    fn anything_but_64_lower_case_hexadecimal_digits_is_refused() {
        for text in [
            "",
            "e3b0",
            &EMPTY.to_uppercase(),
            &format!("{EMPTY}00"),
            &"é".repeat(32),
            "../../etc/passwd",
        ] {
            assert!(
                matches!(Digest::parse(text), Err(StoreError::NotADigest { .. })),
                "{text}"
            );
        }
    }
}

//! Paths and queries of requests.

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};

/// Everything but the unreserved characters of RFC 3986.
const RESERVED: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'-')
    .remove(b'.')
    .remove(b'_')
    .remove(b'~');

/// Percent-encodes a segment of a path or a value of a query.
#[must_use]
pub fn encode(text: &str) -> String {
    utf8_percent_encode(text, RESERVED).to_string()
}

/// A path with a query; absent and blank parameters are left out.
#[must_use]
pub fn with_query(path: &str, parameters: &[(&str, Option<&str>)]) -> String {
    let pairs: Vec<String> = parameters
        .iter()
        .filter_map(|(name, value)| {
            let value = value.filter(|value| !value.trim().is_empty())?;
            Some(format!("{name}={}", encode(value)))
        })
        .collect();
    match pairs.is_empty() {
        true => path.to_owned(),
        false => format!("{path}?{}", pairs.join("&")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_query_has_the_parameters_that_have_a_value() {
        let parameters = [
            ("filter", Some("uiqm > 0.8")),
            ("cursor", None),
            ("order_by", Some("-uiqm")),
        ];
        assert_eq!(
            with_query("/v1/images", &parameters),
            "/v1/images?filter=uiqm%20%3E%200.8&order_by=-uiqm"
        );
        assert_eq!(with_query("/v1/jobs", &[("again", None)]), "/v1/jobs");
    }
}

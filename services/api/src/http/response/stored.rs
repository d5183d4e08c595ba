//! Responses with stored bytes: entity tags, caching, single ranges (RFC 9110 sections 13 and 14).

use std::ops::Range;

use axum::body::{Body, Bytes};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use spec::ArtifactKind;

use crate::http::extract::listed;
use crate::http::problem::{Problem, Slug};

/// Bytes named by their digest never change, so copies stay valid for the maximum time of the standard.
const IMMUTABLE: &str = "private, max-age=31536000, immutable";

/// Headers of bytes that a browser must not run, embed elsewhere, or take for another type.
pub(crate) const GUARDED: [(HeaderName, HeaderValue); 3] = [
    (
        header::X_CONTENT_TYPE_OPTIONS,
        HeaderValue::from_static("nosniff"),
    ),
    (
        header::CONTENT_SECURITY_POLICY,
        HeaderValue::from_static("sandbox; default-src 'none'"),
    ),
    (
        HeaderName::from_static("cross-origin-resource-policy"),
        HeaderValue::from_static("same-origin"),
    ),
];

/// Stored bytes to send.
pub(crate) struct Stored {
    pub(crate) digest: String,
    pub(crate) media_type: String,
    pub(crate) bytes: Vec<u8>,
}

impl Stored {
    /// The whole content, or the requested range.
    pub(crate) fn response(self, headers: &HeaderMap) -> Result<Response, Problem> {
        let known = ArtifactKind::MEDIA_TYPES
            .into_iter()
            .find(|known| *known == self.media_type);
        let media_type = HeaderValue::from_static(known.unwrap_or("application/octet-stream"));
        let length = self.bytes.len();
        let common = (
            immutable(&self.digest),
            [
                (header::CONTENT_TYPE, media_type),
                (header::ACCEPT_RANGES, HeaderValue::from_static("bytes")),
            ],
            GUARDED,
        );
        match parse_range(headers, &self.digest, length) {
            RequestedRange::All => Ok((common, self.bytes).into_response()),
            RequestedRange::Part(range) => {
                let place = format!("bytes {}-{}/{length}", range.start, range.end - 1);
                let part = Bytes::from(self.bytes).slice(range);
                let place = [(header::CONTENT_RANGE, place)];
                Ok((StatusCode::PARTIAL_CONTENT, common, place, Body::from(part)).into_response())
            }
            RequestedRange::Unsatisfiable => {
                let place = HeaderValue::from_str(&format!("bytes */{length}"));
                let problem = Problem::new(
                    Slug::RangeNotSatisfiable,
                    format!("the artifact has {length} bytes"),
                );
                Err(place.into_iter().fold(problem, |problem, place| {
                    problem.header(header::CONTENT_RANGE, place)
                }))
            }
        }
    }
}

/// Returns whether the client has a copy with this tag.
pub(crate) fn has_current_copy(headers: &HeaderMap, tag: &str) -> bool {
    let mut tags = listed(headers, header::IF_NONE_MATCH).map(|one| one.trim_start_matches("W/"));
    tags.any(|one| one == "*" || one.trim_matches('"') == tag)
}

/// 304: the client's copy is current.
pub(crate) fn not_modified(tag: &str) -> Response {
    (StatusCode::NOT_MODIFIED, immutable(tag), GUARDED).into_response()
}

/// Headers of immutable bytes.
pub(crate) fn immutable(tag: &str) -> [(HeaderName, String); 2] {
    [
        (header::ETAG, format!("\"{tag}\"")),
        (header::CACHE_CONTROL, IMMUTABLE.to_owned()),
    ]
}

/// Bytes for a worker.
pub(crate) fn octets(bytes: Vec<u8>) -> impl IntoResponse {
    ([(header::CONTENT_TYPE, "application/octet-stream")], bytes)
}

enum RequestedRange {
    All,
    Part(Range<usize>),
    Unsatisfiable,
}

/// Parses `Range`. Several ranges, other units and malformed values count as no range, as the standard allows.
fn parse_range(headers: &HeaderMap, digest: &str, length: usize) -> RequestedRange {
    let [tag, range] =
        [header::IF_RANGE, header::RANGE].map(|name| headers.get(name).and_then(|value| value.to_str().ok()));
    if tag.is_some_and(|tag| tag.trim_matches('"') != digest) {
        return RequestedRange::All;
    }
    let Some((first, last)) = range.and_then(|range| range.strip_prefix("bytes=")?.split_once('-')) else {
        return RequestedRange::All;
    };
    let (start, end) = match (first.trim().parse::<usize>(), last.trim().parse::<usize>()) {
        (Ok(first), Ok(last)) if first <= last => (first, last.saturating_add(1).min(length)),
        (Ok(first), Err(_)) if last.trim().is_empty() => (first, length),
        (Err(_), Ok(suffix)) if first.trim().is_empty() => match suffix {
            0 => return RequestedRange::Unsatisfiable,
            _ => (length.saturating_sub(suffix), length),
        },
        _ => return RequestedRange::All,
    };
    if start < end {
        RequestedRange::Part(start..end)
    } else {
        RequestedRange::Unsatisfiable
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(range: &str) -> (u16, Option<String>) {
        let mut headers = HeaderMap::new();
        headers.insert(header::RANGE, range.parse().unwrap());
        let stored = Stored {
            digest: "abc".to_owned(),
            media_type: "image/png".to_owned(),
            bytes: (0..10).collect(),
        };
        let response = stored
            .response(&headers)
            .unwrap_or_else(|problem| problem.render(None));
        let place = response
            .headers()
            .get(header::CONTENT_RANGE)
            .map(|value| value.to_str().unwrap().to_owned());
        (response.status().as_u16(), place)
    }

    #[test]
    fn a_type_that_no_artifact_has_is_served_as_octets_and_nothing_is_run() {
        let served = |media_type: &str| {
            let stored = Stored {
                digest: "abc".to_owned(),
                media_type: media_type.to_owned(),
                bytes: b"<script>".to_vec(),
            };
            stored.response(&HeaderMap::new()).ok().unwrap().headers().clone()
        };
        for (media_type, shown) in [
            ("text/html", "application/octet-stream"),
            ("image/svg+xml", "application/octet-stream"),
            ("image/png", "image/png"),
        ] {
            let headers = served(media_type);
            assert_eq!(headers[header::CONTENT_TYPE], shown);
            assert_eq!(
                headers[header::CONTENT_SECURITY_POLICY],
                "sandbox; default-src 'none'"
            );
            assert_eq!(headers["cross-origin-resource-policy"], "same-origin");
        }
        assert_eq!(
            not_modified("abc").headers()[header::X_CONTENT_TYPE_OPTIONS],
            "nosniff"
        );
    }

    #[test]
    fn a_single_range_is_honored_and_other_ranges_return_everything() {
        assert_eq!(status("bytes=2-5"), (206, Some("bytes 2-5/10".to_owned())));
        assert_eq!(status("bytes=2-99"), (206, Some("bytes 2-9/10".to_owned())));
        assert_eq!(status("bytes=7-"), (206, Some("bytes 7-9/10".to_owned())));
        assert_eq!(status("bytes=-3"), (206, Some("bytes 7-9/10".to_owned())));
        assert_eq!(status("bytes=-99"), (206, Some("bytes 0-9/10".to_owned())));
        assert_eq!(status("bytes=10-"), (416, Some("bytes */10".to_owned())));
        assert_eq!(status("bytes=-0"), (416, Some("bytes */10".to_owned())));
        for strange in [
            "bytes=5-2",
            "bytes=0-1,4-5",
            "lines=1-2",
            "bytes=x-y",
            "bytes=99999999999999999999-",
        ] {
            assert_eq!(status(strange), (200, None), "{strange}");
        }
    }

    #[test]
    fn a_copy_is_recognized_in_a_list_and_a_weak_tag() {
        let mut headers = HeaderMap::new();
        headers.insert(header::IF_NONE_MATCH, "\"x\", W/\"abc\"".parse().unwrap());
        assert!(has_current_copy(&headers, "abc"));
        assert!(!has_current_copy(&headers, "abcd"));
    }
}

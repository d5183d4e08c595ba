//! Errors of the store as errors for the caller.

use std::io::ErrorKind;

use object_store::Error;

use crate::error::SetError;
use crate::storage::location::Location;
use crate::storage::transport::io_error;

/// Error codes of S3 servers without free space.
const FULL: &[&str] = &[
    "InsufficientStorage",
    "QuotaExceeded",
    "StorageFull",
    "XMinioStorageFull",
];

/// The error for the caller. Errors of the S3 client hold no credentials: these travel in headers.
pub(crate) fn explain(location: &Location, error: &Error) -> SetError {
    if is_missing_bucket(error) {
        return SetError::Refused(format!("{location}: the bucket does not exist"));
    }
    let text = error.to_string();
    if is_full(error, &text) {
        return SetError::Later(format!("{location} is full; make room and run again: {text}"));
    }
    match error {
        Error::PermissionDenied { .. } | Error::Unauthenticated { .. } => SetError::Refused(format!(
            "{location} refuses access; check AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY and the rights on it: {text}"
        )),
        Error::NotImplemented { .. } | Error::NotSupported { .. } => {
            SetError::Refused(format!("{location} cannot hold a set: {text}"))
        }
        Error::NotFound { path, .. } => SetError::Damaged(format!("{location}: {path} is gone")),
        _ => SetError::Later(format!("{location} does not respond: {text}")),
    }
}

/// Whether the bucket is missing; the client reports it like a missing object.
pub(crate) fn is_missing_bucket(error: &Error) -> bool {
    code(&error.to_string()) == Some("NoSuchBucket")
}

fn is_full(error: &Error, text: &str) -> bool {
    let kind = io_error(error).map(std::io::Error::kind);
    matches!(kind, Some(ErrorKind::StorageFull | ErrorKind::QuotaExceeded))
        || status(text) == Some("507")
        || code(text).is_some_and(|code| FULL.contains(&code))
}

/// The status of the response. The client's errors give it as text alone; in the address before it spaces are encoded.
fn status(text: &str) -> Option<&str> {
    let (_, after) = text.split_once("status code: ")?;
    after.split([' ', ':']).next()
}

/// The code of an S3 error, from the document that is the body of the response.
fn code(text: &str) -> Option<&str> {
    let (_, after) = text.split_once("<Code>")?;
    Some(after.split_once("</Code>")?.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meaning(status: &str, body: &str) -> SetError {
        let source = format!(
            "Error performing PUT http://host/bucket/probe/4f507 in 1ms - Server returned non-2xx status code: {status}: {body}"
        );
        let error = Error::Generic {
            store: "S3",
            source: source.into(),
        };
        explain(&Location::parse("s3://bucket/set").unwrap(), &error)
    }

    #[test]
    fn a_store_is_full_where_the_status_or_the_code_says_so() {
        let full = |error: SetError| matches!(error, SetError::Later(text) if text.contains("is full"));
        assert!(full(meaning("507 Insufficient Storage", "")));
        for code in FULL {
            let body = format!("<Error><Code>{code}</Code></Error>");
            assert!(full(meaning("503 Service Unavailable", &body)), "{code}");
        }
        for body in [
            "id 507 ",
            "<HostId>a1507 </HostId>",
            "<Message>QuotaExceeded</Message>",
        ] {
            assert!(!full(meaning("500 Internal Server Error", body)), "{body}");
        }
    }

    #[test]
    fn a_missing_bucket_is_refused_whatever_else_the_response_says() {
        let body = "<Error><Code>NoSuchBucket</Code><RequestId>77507 QuotaExceeded</RequestId></Error>";
        let error = meaning("404 Not Found", body);
        assert!(
            matches!(&error, SetError::Refused(text) if text.ends_with("does not exist")),
            "{error}"
        );
    }
}

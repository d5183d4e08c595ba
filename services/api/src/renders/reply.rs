//! The response to a picture: by `Accept` the picture, or its record with all artifacts.

use axum::http::{HeaderMap, HeaderName, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use renderer::extension;
use serde_json::Value;
use spec::{FieldError, Invalid};

use super::protocol::{Outcome, OutputFile, PictureReply, ReplyFormat};
use crate::http::extract::listed;
use crate::http::problem::{Problem, Slug};
use crate::http::stored::GUARDED;

/// Warnings about the picture.
const WARNINGS: HeaderName = HeaderName::from_static("fathom-warnings");
/// Longest list of warnings in a header.
const MAX_WARNING_BYTES: usize = 4096;
/// The part of a response with the record.
const RECORD: &str = "record";

/// The first accepted type that is offered; PNG without `Accept`.
pub(crate) fn choose_format(headers: &HeaderMap) -> Result<ReplyFormat, Problem> {
    let mut accepted = listed(headers, header::ACCEPT)
        .filter(|kind| !kind.is_empty())
        .peekable();
    if accepted.peek().is_none() {
        return Ok(ReplyFormat::Png);
    }
    let offered = accepted.find_map(|kind| match kind.split(';').next().unwrap_or_default().trim() {
        "image/png" | "image/*" | "*/*" => Some(ReplyFormat::Png),
        "image/webp" => Some(ReplyFormat::Webp),
        "multipart/mixed" | "multipart/*" => Some(ReplyFormat::Mixed),
        _ => None,
    });
    offered.ok_or_else(|| {
        let given = headers
            .get(header::ACCEPT)
            .map(HeaderValue::as_bytes)
            .unwrap_or_default();
        let detail = format!(
            "Accept is `{}`; a picture is returned as image/png, image/webp or multipart/mixed",
            String::from_utf8_lossy(given)
        );
        Problem::new(Slug::InvalidHeader, detail)
    })
}

/// The response of a reply and its files.
pub(crate) fn respond(
    format: ReplyFormat,
    reply: PictureReply,
    mut warnings: Vec<String>,
    bytes: Vec<u8>,
) -> Result<Response, Problem> {
    let (record, files) = match reply.outcome {
        Outcome::Rendered {
            record,
            warnings: own,
            files,
        } => {
            warnings.extend(own);
            (record, files)
        }
        Outcome::Refused(wrong) => {
            let errors = wrong
                .into_iter()
                .map(|part| FieldError::new(&format!("/{}", part.name), part.message));
            return Err(Invalid(errors.collect()).into());
        }
        Outcome::Failed(why) => return Err(Problem::new(Slug::RenderFailed, why)),
    };
    let mut response = match (format, files.as_slice()) {
        (ReplyFormat::Mixed, _) => mix(record, &warnings, &files, &bytes)?,
        (_, [picture]) => {
            let media_type = read_header(&picture.media_type)?;
            ([(header::CONTENT_TYPE, media_type)], GUARDED, bytes).into_response()
        }
        _ => return Err(Problem::internal(&"the reply has no picture")),
    };
    if let Some(text) = join_warnings(&warnings) {
        response.headers_mut().insert(WARNINGS, text);
    }
    Ok(response)
}

/// The record, with the warnings about the job too, and the files as `multipart/mixed`.
fn mix(
    mut record: Value,
    warnings: &[String],
    files: &[OutputFile],
    bytes: &[u8],
) -> Result<Response, Problem> {
    record["warnings"] = warnings.into();
    let record = record.to_string().into_bytes();
    // The digest of the content, so that no file contains it.
    let boundary = spec::sha256([record.as_slice(), bytes].concat());
    let mut body = Vec::with_capacity(bytes.len() + record.len() + 1024);
    add_part(&mut body, &boundary, RECORD, "application/json", &record);
    let mut rest = bytes;
    for file in files {
        let length = usize::try_from(file.bytes).unwrap_or(usize::MAX).min(rest.len());
        let (content, others) = rest.split_at(length);
        add_part(&mut body, &boundary, &file.kind, &file.media_type, content);
        rest = others;
    }
    body.extend(format!("--{boundary}--\r\n").into_bytes());
    let media_type = read_header(&format!("multipart/mixed; boundary={boundary}"))?;
    Ok(([(header::CONTENT_TYPE, media_type)], GUARDED, body).into_response())
}

fn add_part(body: &mut Vec<u8>, boundary: &str, name: &str, media_type: &str, content: &[u8]) {
    let extension = extension(media_type);
    let head = format!(
        "--{boundary}\r\nContent-Type: {media_type}\r\nContent-Disposition: attachment; name=\"{name}\"; \
         filename=\"{name}.{extension}\"\r\nContent-Length: {}\r\n\r\n",
        content.len()
    );
    body.extend(head.into_bytes());
    body.extend(content);
    body.extend(b"\r\n");
}

fn read_header(text: &str) -> Result<HeaderValue, Problem> {
    HeaderValue::from_str(text).map_err(|error| Problem::internal(&error))
}

/// The warnings in a header, UTF-8, separated by `; `.
fn join_warnings(warnings: &[String]) -> Option<HeaderValue> {
    let mut text = warnings.join("; ").replace(char::is_control, " ");
    text.truncate(text.floor_char_boundary(MAX_WARNING_BYTES));
    (!text.is_empty()).then(|| HeaderValue::from_bytes(text.as_bytes()).ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_offered_type_is_chosen() {
        for (accept, format) in [
            ("", Some(ReplyFormat::Png)),
            ("*/*", Some(ReplyFormat::Png)),
            ("image/webp, */*", Some(ReplyFormat::Webp)),
            ("text/html, multipart/mixed;q=0.9", Some(ReplyFormat::Mixed)),
            ("application/json", None),
        ] {
            let headers = HeaderMap::from_iter([(header::ACCEPT, HeaderValue::from_static(accept))]);
            assert_eq!(choose_format(&headers).ok(), format, "{accept}");
        }
        assert_eq!(choose_format(&HeaderMap::new()).ok(), Some(ReplyFormat::Png));
    }

    #[test]
    fn warnings_fit_a_header() {
        assert_eq!(join_warnings(&[]), None);
        let long = join_warnings(&["×\n".repeat(3000)]).unwrap();
        assert!(long.len() <= MAX_WARNING_BYTES && !long.as_bytes().contains(&b'\n'));
    }
}

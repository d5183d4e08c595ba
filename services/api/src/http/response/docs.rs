//! The OpenAPI document and its viewer, Swagger UI. The viewer's files are stored deflated in one archive and sent as
//! gzip without recompression.

use axum::Router;
use axum::body::Bytes;
use axum::http::header::{CONTENT_ENCODING, CONTENT_TYPE};
use axum::response::{Html, Redirect};
use axum::routing::{MethodRouter, get};
use serde_json::Value;
use utoipa_swagger_ui_vendored::SWAGGER_UI_VENDORED;

const PAGE: &str = r##"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>Fathom API</title>
<link rel="stylesheet" href="swagger-ui.css">
</head>
<body>
<div id="swagger-ui"></div>
<script src="swagger-ui-bundle.js"></script>
<script>
SwaggerUIBundle({ url: "/openapi.json", dom_id: "#swagger-ui", deepLinking: true });
</script>
</body>
</html>
"##;

pub(crate) fn router(document: &Value) -> Router {
    let document = Bytes::from(document.to_string());
    Router::new()
        .route(
            "/openapi.json",
            get(async move || ([(CONTENT_TYPE, "application/json")], document.clone())),
        )
        .route("/docs", get(async || Redirect::to("/docs/")))
        .route("/docs/", get(async || Html(PAGE)))
        .route("/docs/swagger-ui.css", file("swagger-ui.css", "text/css"))
        .route(
            "/docs/swagger-ui-bundle.js",
            file("swagger-ui-bundle.js", "text/javascript"),
        )
}

fn file(name: &str, media_type: &'static str) -> MethodRouter {
    let content =
        Bytes::from(gzipped(SWAGGER_UI_VENDORED, name).expect("the archive holds the page's files"));
    get(async move || {
        (
            [(CONTENT_TYPE, media_type), (CONTENT_ENCODING, "gzip")],
            content.clone(),
        )
    })
}

/// The file `dist/NAME` of a ZIP archive as gzip: both contain the same deflate stream.
fn gzipped(archive: &[u8], name: &str) -> Option<Vec<u8>> {
    const END: &[u8] = b"PK\x05\x06";
    const ENTRY_BYTES: usize = 46;
    const LOCAL_BYTES: usize = 30;
    const GZIP_HEAD: [u8; 10] = [0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 0xff];
    let end = archive.windows(END.len()).rposition(|window| window == END)?;
    let mut entry = read_number(archive, 4, end + 16)?;
    loop {
        let name_bytes = read_number(archive, 2, entry + 28)?;
        let path = archive.get(entry + ENTRY_BYTES..)?.get(..name_bytes)?;
        if path.ends_with(format!("/dist/{name}").as_bytes()) {
            break;
        }
        entry += ENTRY_BYTES
            + name_bytes
            + read_number(archive, 2, entry + 30)?
            + read_number(archive, 2, entry + 32)?;
    }
    let local = read_number(archive, 4, entry + 42)?;
    let data_from =
        local + LOCAL_BYTES + read_number(archive, 2, local + 26)? + read_number(archive, 2, local + 28)?;
    let deflated = archive
        .get(data_from..)?
        .get(..read_number(archive, 4, entry + 20)?)?;
    let checksum = archive.get(entry + 16..entry + 20)?;
    let size = archive.get(entry + 24..entry + 28)?;
    Some([&GZIP_HEAD, deflated, checksum, size].concat())
}

/// A little-endian number of up to 8 bytes.
fn read_number(archive: &[u8], bytes: usize, offset: usize) -> Option<usize> {
    let digits = archive.get(offset..offset + bytes)?.iter().rev();
    Some(digits.fold(0, |number, byte| number << 8 | usize::from(*byte)))
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

    #[test]
    fn the_files_of_the_page_unpack_unchanged() {
        for (name, part) in [
            ("swagger-ui.css", ".swagger-ui"),
            ("swagger-ui-bundle.js", "SwaggerUIBundle"),
        ] {
            let file = gzipped(SWAGGER_UI_VENDORED, name).unwrap();
            let mut text = String::new();
            flate2::read::GzDecoder::new(&file[..])
                .read_to_string(&mut text)
                .unwrap();
            assert!(text.contains(part), "{name}");
            assert!(PAGE.contains(name));
        }
        assert!(gzipped(SWAGGER_UI_VENDORED, "absent").is_none());
    }
}

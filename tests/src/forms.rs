//! Multipart forms, as sent by a browser or curl.

use serde_json::Value;

use crate::{Service, read_json};

impl Service {
    /// POST of a form with these fields.
    ///
    /// # Panics
    /// If the service does not respond.
    #[must_use]
    pub fn form(&self, path: &str, fields: &[(&str, &[u8])]) -> (u16, Value) {
        const BOUNDARY: &str = "----fathom-test-boundary";
        let mut form = Vec::new();
        for (name, bytes) in fields {
            let head = format!("--{BOUNDARY}\r\nContent-Disposition: form-data; name=\"{name}\"\r\n\r\n");
            form.extend([head.as_bytes(), bytes, b"\r\n"].concat());
        }
        form.extend_from_slice(format!("--{BOUNDARY}--\r\n").as_bytes());
        let content_type = format!("multipart/form-data; boundary={BOUNDARY}");
        let headers = [("content-type", content_type.as_str())];
        read_json(self.http().post(path, &headers, &form))
    }
}
